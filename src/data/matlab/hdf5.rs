//! MAT files of version 7.3, which are HDF5 behind a header of 512 bytes; plain HDF5 is read alike.
//!
//! Variables are datasets of the root group, structures are groups with one dataset per field. MATLAB says what a
//! dataset means in its attribute `MATLAB_class`; its row and column vectors are 1 × n and n × 1 here too. What cells
//! hold is in a group of its own, to which they refer by address.

use super::super::arrays::Unfit;
use super::objects::Objects;
use super::value::{Numbers, Value};
use hdf5_reader::error::Error;
use hdf5_reader::group::Group;
use hdf5_reader::{Dataset, Datatype, H5Type, Hdf5File};
use std::collections::HashMap;

/// The group of what cells refer to, and the one of the objects.
const REFERRED: &str = "#refs#";
const OBJECTS: &str = "#subsystem#";

/// How deep cells and structures may lie in each other: deeper is damage, not a recording.
const DEEPEST: usize = 32;

/// What references lead to, by address.
#[derive(Default)]
struct Referred {
    datasets: HashMap<u64, Dataset>,
    groups: HashMap<u64, Group>,
}

/// Finds every variable, and the objects that they refer to; long rows of numbers are read later.
///
/// # Errors
/// Why the bytes make no sense.
pub(super) fn read(bytes: Vec<u8>) -> Result<(Vec<(String, Value)>, Objects), String> {
    let (groups, datasets) = members(bytes).map_err(|error| error.to_string())?;
    let mut referred = Referred::default();
    if let Some(group) = groups.iter().find(|group| group.name() == REFERRED) {
        let (groups, datasets) = group.members().map_err(|error| error.to_string())?;
        referred.datasets = datasets.into_iter().map(|dataset| (dataset.address(), dataset)).collect();
        referred.groups = groups.into_iter().map(|group| (group.address(), group)).collect();
    }
    let mut found: Vec<(String, Value)> =
        datasets.into_iter().map(|dataset| (dataset.name().to_owned(), referred.value(&dataset, 0))).collect();
    // MATLAB's own groups have names that begin with #.
    for group in groups.iter().filter(|group| !group.name().starts_with('#')) {
        found.push((group.name().to_owned(), referred.structure(group, 0).map_err(|error| error.to_string())?));
    }
    Ok((found, referred.objects(&groups)?))
}

fn members(bytes: Vec<u8>) -> Result<(Vec<Group>, Vec<Dataset>), Error> {
    Hdf5File::from_vec(bytes)?.root_group()?.members()
}

impl Referred {
    fn objects(&self, groups: &[Group]) -> Result<Objects, String> {
        let Some(group) = groups.iter().find(|group| group.name() == OBJECTS) else { return Ok(Objects::none()) };
        let Ok(dataset) = group.dataset("MCOS") else { return Ok(Objects::none()) };
        match self.cells(&dataset, 0) {
            Some(cells) => Objects::open(cells, false),
            None => Ok(Objects::none()),
        }
    }

    fn value(&self, dataset: &Dataset, depth: usize) -> Value {
        let class = dataset.attribute("MATLAB_class").ok().and_then(|class| class.read_string().ok());
        let mut shape: Vec<usize> = dataset.shape().iter().map(|extent| *extent as usize).collect();
        if dataset.attribute("MATLAB_empty").is_ok() {
            shape = vec![0, 0];
        }
        match (class.as_deref(), dataset.dtype()) {
            (Some("char"), _) => text(dataset).map_or(Value::Other("text"), Value::Text),
            (Some("cell"), _) => self.cells(dataset, depth).map_or(Value::Other("a cell array"), Value::Cells),
            (Some("struct"), _) => Value::Other("a structure"),
            (_, Datatype::Compound { fields, .. }) if fields.iter().any(|field| field.name == "imag") => {
                let parts = complex(dataset).unwrap_or_default();
                Value::Complex { real: parts.0, imaginary: parts.1 }
            }
            (_, Datatype::String { .. } | Datatype::VarLen { .. }) => Value::Other("text"),
            (_, Datatype::Reference { .. }) => Value::Other("a cell array or an array of structures"),
            (_, Datatype::FloatingPoint { .. } | Datatype::FixedPoint { .. }) => {
                let numbers = Value::Numbers { shape, numbers: Box::new(Later(dataset.clone())) };
                match dataset.attribute("MATLAB_object_decode") {
                    Ok(_) => Value::Object(Box::new(numbers)),
                    Err(_) => numbers,
                }
            }
            _ => Value::Other("of a type that holds no numbers"),
        }
    }

    /// The values that a dataset of references refers to.
    fn cells(&self, dataset: &Dataset, depth: usize) -> Option<Vec<Value>> {
        let bytes = dataset.read_raw_bytes().ok().filter(|_| depth < DEEPEST)?;
        let addresses = bytes.as_chunks::<8>().0.iter().map(|address| u64::from_le_bytes(*address));
        let value = |address| match (self.datasets.get(&address), self.groups.get(&address)) {
            (Some(dataset), _) => self.value(dataset, depth + 1),
            (_, Some(group)) => self.structure(group, depth + 1).unwrap_or(Value::Other("a structure")),
            _ => Value::Other("a reference to nothing"),
        };
        Some(addresses.map(value).collect())
    }

    fn structure(&self, group: &Group, depth: usize) -> Result<Value, Error> {
        if depth > DEEPEST {
            return Ok(Value::Other("a structure"));
        }
        let (groups, datasets) = group.members()?;
        let mut fields: Vec<(String, Value)> =
            datasets.iter().map(|field| (field.name().to_owned(), self.value(field, depth + 1))).collect();
        for inner in &groups {
            fields.push((inner.name().to_owned(), self.structure(inner, depth + 1)?));
        }
        Ok(Value::Structure(fields))
    }
}

/// Numbers that stay in the file until they are asked for.
struct Later(Dataset);

impl Numbers for Later {
    fn read(&self) -> Result<Vec<f64>, Unfit> {
        numbers(&self.0)
    }
}

/// MATLAB keeps characters as numbers of two bytes.
fn text(dataset: &Dataset) -> Option<String> {
    let units: Vec<u16> = numbers(dataset).ok()?.into_iter().map(|unit| unit as u16).collect();
    Some(String::from_utf16_lossy(&units).trim_end_matches('\0').into())
}

/// Real and imaginary parts, which MATLAB keeps as pairs of doubles.
fn complex(dataset: &Dataset) -> Option<(Vec<f64>, Vec<f64>)> {
    let bytes = dataset.read_native_bytes().ok().filter(|_| dataset.raw_element_size().ok() == Some(16))?;
    let numbers = bytes.as_chunks::<8>().0.iter().map(|number| f64::from_ne_bytes(*number));
    let (real, imaginary): (Vec<(usize, f64)>, Vec<_>) = numbers.enumerate().partition(|(index, _)| index % 2 == 0);
    let parts = |part: Vec<(usize, f64)>| part.into_iter().map(|(_, number)| number).collect();
    Some((parts(real), parts(imaginary)))
}

fn numbers(dataset: &Dataset) -> Result<Vec<f64>, Unfit> {
    match dataset.dtype() {
        Datatype::FloatingPoint { size: 8, .. } => read_as::<f64>(dataset, |value| value),
        Datatype::FloatingPoint { size: 4, .. } => read_as::<f32>(dataset, f64::from),
        Datatype::FixedPoint { size: 1, signed: true, .. } => read_as::<i8>(dataset, f64::from),
        Datatype::FixedPoint { size: 1, .. } => read_as::<u8>(dataset, f64::from),
        Datatype::FixedPoint { size: 2, signed: true, .. } => read_as::<i16>(dataset, f64::from),
        Datatype::FixedPoint { size: 2, .. } => read_as::<u16>(dataset, f64::from),
        Datatype::FixedPoint { size: 4, signed: true, .. } => read_as::<i32>(dataset, f64::from),
        Datatype::FixedPoint { size: 4, .. } => read_as::<u32>(dataset, f64::from),
        Datatype::FixedPoint { size: 8, signed: true, .. } => read_as::<i64>(dataset, |value| value as f64),
        Datatype::FixedPoint { size: 8, .. } => read_as::<u64>(dataset, |value| value as f64),
        _ => Err(Unfit::Is("of a type that holds no numbers".into())),
    }
}

fn read_as<T: H5Type>(dataset: &Dataset, number: impl Fn(T) -> f64) -> Result<Vec<f64>, Unfit> {
    let values = dataset.read_array::<T>().map_err(|error| Unfit::Damaged(error.to_string()))?;
    Ok(values.into_iter().map(number).collect())
}
