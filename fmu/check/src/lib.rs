//! Tests only, kept apart because they need libclang to be built: the slave's signatures against those of `fmi-sys`,
//! and the packed FMUs, as `cargo xtask fmu` wrote them, through the importer of the `fmi` crate.
