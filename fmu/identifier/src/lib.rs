//! The streaming identifier as an FMI 2.0 co-simulation slave.
//!
//! One step is one sample: inputs `q`, `qd`, `F` at the step's start, outputs at its end. The model whose terms are
//! variables stands in `resources/model.toml`; parameters are taken when the initialization ends. What the identifier
//! does with a sample is the library's affair alone, so that the same samples give the same bits there and here.

mod parameters;
mod slave;
mod stream;

pub use slave::IdentifierSlave;

switchid_fmu_slave::export!(slave::IdentifierSlave);
