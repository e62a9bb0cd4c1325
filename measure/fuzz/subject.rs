//! What is called: an FMU's library with its resources.

use super::Failure;
use std::path::Path;
use switchid::fmu::{DUFFING, Fmu, VAN_DER_POL, identifier, plant};
use switchid::law::Model;
use switchid_fmu_slave::Interface;
use switchid_fmu_slave::host::{ExchangeFunctions, Functions};
use tempfile::TempDir;

/// An FMU, ready to be instantiated.
pub struct Subject {
    pub functions: Functions,
    /// Of one that can be integrated from outside.
    pub exchange: Option<ExchangeFunctions>,
    pub interface: Interface,
    resources: TempDir,
}

impl Subject {
    /// The identifier and both plants.
    ///
    /// # Errors
    /// A library that was not built.
    pub fn all(libraries: &Path) -> Result<Vec<Subject>, Failure> {
        let library = |package: &str| {
            libraries.join(format!(
                "{}switchid_fmu_{package}{}",
                std::env::consts::DLL_PREFIX,
                std::env::consts::DLL_SUFFIX
            ))
        };
        let identifier = identifier("SwitchedIdentifier", &Model::cubic_library())?;
        Ok(vec![
            Subject::new(&identifier, &library("identifier"), false)?,
            Subject::new(&plant(DUFFING)?, &library("plant"), true)?,
            Subject::new(&plant(VAN_DER_POL)?, &library("plant"), true)?,
        ])
    }

    fn new(fmu: &Fmu, library: &Path, integrated: bool) -> Result<Subject, Failure> {
        let resources = tempfile::tempdir()?;
        for (path, content) in fmu.files() {
            if let Some(name) = path.strip_prefix("resources/") {
                std::fs::write(resources.path().join(name), content)?;
            }
        }
        let interface = serde_json::from_slice(&std::fs::read(resources.path().join("interface.json"))?)?;
        let built = |error| format!("{}: {error}: run `cargo xtask fuzz`", library.display());
        let functions = Functions::load(library).map_err(built)?;
        let exchange = if integrated { Some(ExchangeFunctions::load(library).map_err(built)?) } else { None };
        Ok(Subject { functions, exchange, interface, resources })
    }

    /// Where its resources are.
    pub fn location(&self) -> String {
        self.resources.path().display().to_string()
    }
}
