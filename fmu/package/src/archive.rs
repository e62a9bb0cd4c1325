//! An FMU as an archive: the same content gives the same bytes.

use crate::platform::Platform;
use crate::terminals::terminals;
use crate::xml::model_description;
use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use switchid_fmu_slave::{Description, INTERFACE_FILE, Interface};
use thiserror::Error;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// The licences, shipped with every FMU.
const LICENCES: [(&str, &str); 2] = [
    ("LICENSE-MIT", include_str!("../../../LICENSE-MIT")),
    ("LICENSE-APACHE", include_str!("../../../LICENSE-APACHE")),
];

/// What the crates in the binaries are licensed under; `cargo xtask fmu` renews it.
const THIRD_PARTY: &str = include_str!("../assets/third-party-licenses.txt");

/// The picture that a simulator shows.
const ICON: &[u8] = include_bytes!("../assets/model.png");

/// Deflate's level of the smallest archive.
const SMALLEST: i64 = 9;

/// Why an FMU cannot be packed.
#[derive(Debug, Error)]
pub enum PackageError {
    /// The name cannot name a binary.
    #[error("{name:?} cannot name an FMU: a letter, then letters, digits and underscores")]
    Name {
        /// As given.
        name: String,
    },
    /// The interface cannot be written.
    #[error("modelDescription.xml cannot be written: {0}")]
    Xml(#[from] std::io::Error),
    /// The interface cannot be written for the slave.
    #[error("{INTERFACE_FILE} cannot be written: {0}")]
    Interface(#[from] serde_json::Error),
    /// The archive cannot be written.
    #[error("the archive cannot be written: {0}")]
    Archive(#[from] zip::result::ZipError),
}

/// An FMU, file by file.
#[derive(Clone, Debug)]
pub struct Fmu {
    name: String,
    guid: String,
    xml: String,
    files: BTreeMap<String, Vec<u8>>,
}

impl Fmu {
    /// An FMU of that interface with these resources and documentation page, still without binaries.
    ///
    /// # Errors
    /// [`PackageError`].
    pub fn new(
        description: Description,
        resources: Vec<(String, Vec<u8>)>,
        documentation: String,
    ) -> Result<Fmu, PackageError> {
        let name = check_name(&description.name)?;
        let (xml, guid) = model_description(&description, &resources)?;
        let mut files = BTreeMap::new();
        files.extend(resources.into_iter().map(|(name, content)| (format!("resources/{name}"), content)));
        files.insert("documentation/index.html".into(), documentation.into_bytes());
        let licences =
            LICENCES.map(|(name, text)| (format!("documentation/licenses/{name}"), text.as_bytes().to_vec()));
        files.extend(licences);
        files.insert("documentation/licenses/third-party.txt".into(), THIRD_PARTY.into());
        files.insert("model.png".into(), ICON.into());
        files.insert("terminalsAndIcons/icon.png".into(), ICON.into());
        files.insert("terminalsAndIcons/terminalsAndIcons.xml".into(), terminals(&description)?.into_bytes());
        files.insert("modelDescription.xml".into(), xml.clone().into_bytes());
        let interface = Interface { guid: guid.clone(), description };
        files.insert(format!("resources/{INTERFACE_FILE}"), serde_json::to_vec_pretty(&interface)?);
        Ok(Fmu { name, guid, xml, files })
    }

    /// Adds the binary of a platform.
    pub fn with_binary(mut self, platform: Platform, binary: Vec<u8>) -> Fmu {
        self.files.insert(format!("binaries/{}/{}.{}", platform.name, self.name, platform.extension), binary);
        self
    }

    /// The model's name, which is the binary's too.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// `modelDescription.xml`.
    pub fn xml(&self) -> &str {
        &self.xml
    }

    /// Its GUID.
    pub fn guid(&self) -> &str {
        &self.guid
    }

    /// Every file by its path in the archive.
    pub fn files(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.files.iter().map(|(path, content)| (path.as_str(), content.as_slice()))
    }

    /// The archive.
    ///
    /// # Errors
    /// [`PackageError::Archive`].
    pub fn to_bytes(&self) -> Result<Vec<u8>, PackageError> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        for (path, content) in self.files() {
            let mode = if path.starts_with("binaries/") { 0o755 } else { 0o644 };
            let options = SimpleFileOptions::default()
                .compression_method(CompressionMethod::Deflated)
                .compression_level(Some(SMALLEST))
                .last_modified_time(DateTime::default())
                .unix_permissions(mode);
            archive.start_file(path, options)?;
            archive.write_all(content)?;
        }
        Ok(archive.finish()?.into_inner())
    }
}

fn check_name(name: &str) -> Result<String, PackageError> {
    let legal = name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    if legal && name.starts_with(|letter: char| letter.is_ascii_alphabetic()) {
        return Ok(name.into());
    }
    Err(PackageError::Name { name: name.into() })
}
