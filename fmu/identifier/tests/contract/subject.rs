//! An FMU's library with its unpacked resources.

use switchid_fmu_package::Fmu;
use switchid_fmu_slave::Interface;
use switchid_fmu_slave::host::{Functions, Instance, Request};

/// `fmi2OK`.
pub const OK: u32 = 0;

/// An FMU's functions with its resources unpacked.
pub struct Subject {
    /// What the library exports.
    pub functions: Functions,
    /// The unpacked resources.
    pub resources: tempfile::TempDir,
    /// The variables.
    pub interface: Interface,
}

impl Subject {
    /// The FMU with these functions.
    pub fn new(functions: Functions, fmu: &Fmu) -> Subject {
        let resources = tempfile::Builder::new().prefix("größe 100 %").tempdir().unwrap();
        for (path, content) in fmu.files() {
            if let Some(name) = path.strip_prefix("resources/") {
                std::fs::write(resources.path().join(name), content).unwrap();
            }
        }
        let interface = std::fs::read(resources.path().join("interface.json")).unwrap();
        let interface = serde_json::from_slice(&interface).unwrap();
        Subject { functions, resources, interface }
    }

    /// A fresh instance.
    pub fn instance(&self) -> Instance {
        let location = format!("file:///{}", self.resources.path().display());
        let request =
            Request { co_simulation: true, guid: &self.interface.guid, location: Some(&location), logging: true };
        Instance::new(self.functions, &request).unwrap()
    }

    /// Value reference of a variable.
    pub fn reference(&self, name: &str) -> u32 {
        self.interface.description.position(name).unwrap_or_else(|| panic!("no variable {name}")) as u32
    }
}
