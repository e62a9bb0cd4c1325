//! A simulated plant with a switching law, for co-simulation and model exchange by FMI 2.0.
//!
//! The law stands in `resources/plant.toml`, so that Duffing, van der Pol and any other law are the same binary with
//! another file. Time counts from the start of the simulation. What the plant shows at an instant does not depend on
//! the communication steps that led there.

mod equations;
mod moving;
mod places;
mod slave;
mod specimen;

pub use slave::PlantSlave;

switchid_fmu_slave::export!(slave::PlantSlave);
switchid_fmu_slave::export_exchange!(slave::PlantSlave);
