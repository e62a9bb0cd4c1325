//! MAT files of version 7.3, which are HDF5 behind a header of 512 bytes; plain HDF5 is read alike.
//!
//! Variables are datasets of the root group, structures are groups with one dataset per field. MATLAB says what a
//! dataset means in its attribute `MATLAB_class`; its row and column vectors are 1 × n and n × 1 here too.

use super::DataError;
use super::arrays::{Arrays, Unfit};
use super::matlab::{self, Name};
use super::rows::Source;
use hdf5_reader::{Dataset, Datatype, H5Type, Hdf5File};

/// The variables of a file.
pub(super) struct Variables {
    names: Vec<String>,
    datasets: Vec<Dataset>,
}

/// Finds every variable; numbers are read later.
///
/// # Errors
/// [`DataError::Damaged`].
pub(super) fn open(source: &Source, bytes: Vec<u8>) -> Result<Variables, DataError> {
    variables(bytes).map_err(|error| {
        let (file, kind) = (source.file.clone(), source.kind);
        DataError::Damaged { file, kind, reason: error.to_string() }
    })
}

fn variables(bytes: Vec<u8>) -> Result<Variables, hdf5_reader::error::Error> {
    let (groups, datasets) = Hdf5File::from_vec(bytes)?.root_group()?.members()?;
    let mut found: Vec<(Name, Dataset)> =
        datasets.into_iter().map(|dataset| (Name::of(dataset.name()), dataset)).collect();
    // MATLAB keeps what cells refer to in groups whose name begins with #.
    for group in groups.into_iter().filter(|group| !group.name().starts_with('#')) {
        let fields = group.members()?.1.into_iter();
        found.extend(fields.map(|field| (Name::field(group.name(), field.name()), field)));
    }
    let (names, datasets): (Vec<Name>, Vec<Dataset>) = found.into_iter().unzip();
    Ok(Variables { names: matlab::headers(&names), datasets })
}

impl Arrays for Variables {
    fn names(&self) -> Vec<String> {
        self.names.clone()
    }

    fn values(&self, index: usize) -> Result<Vec<f64>, Unfit> {
        let dataset = self.datasets.get(index).ok_or_else(|| Unfit::Is("absent".into()))?;
        if dataset.attribute("MATLAB_empty").is_ok() {
            return Err(Unfit::Is("empty".into()));
        }
        let class = dataset.attribute("MATLAB_class").ok().and_then(|class| class.read_string().ok());
        if let Some(unfit) = class.as_deref().and_then(not_numeric) {
            return Err(Unfit::Is(unfit.into()));
        }
        let shape: Vec<usize> = dataset.shape().iter().map(|extent| *extent as usize).collect();
        matlab::check_vector(&shape)?;
        numbers(dataset)
    }
}

fn not_numeric(class: &str) -> Option<&'static str> {
    match class {
        "char" => Some("text"),
        "cell" => Some("a cell array"),
        "struct" => Some("a structure"),
        _ => None,
    }
}

fn numbers(dataset: &Dataset) -> Result<Vec<f64>, Unfit> {
    match dataset.dtype() {
        Datatype::FloatingPoint { size: 8, .. } => read::<f64>(dataset, |value| value),
        Datatype::FloatingPoint { size: 4, .. } => read::<f32>(dataset, f64::from),
        Datatype::FixedPoint { size: 1, signed: true, .. } => read::<i8>(dataset, f64::from),
        Datatype::FixedPoint { size: 1, .. } => read::<u8>(dataset, f64::from),
        Datatype::FixedPoint { size: 2, signed: true, .. } => read::<i16>(dataset, f64::from),
        Datatype::FixedPoint { size: 2, .. } => read::<u16>(dataset, f64::from),
        Datatype::FixedPoint { size: 4, signed: true, .. } => read::<i32>(dataset, f64::from),
        Datatype::FixedPoint { size: 4, .. } => read::<u32>(dataset, f64::from),
        Datatype::FixedPoint { size: 8, signed: true, .. } => read::<i64>(dataset, |value| value as f64),
        Datatype::FixedPoint { size: 8, .. } => read::<u64>(dataset, |value| value as f64),
        Datatype::Compound { fields, .. } if fields.iter().any(|field| field.name == "imag") => {
            Err(Unfit::Is("complex".into()))
        }
        Datatype::String { .. } | Datatype::VarLen { .. } => Err(Unfit::Is("text".into())),
        Datatype::Reference { .. } => Err(Unfit::Is("a cell array or an array of structures".into())),
        _ => Err(Unfit::Is("of a type that holds no numbers".into())),
    }
}

fn read<T: H5Type>(dataset: &Dataset, number: impl Fn(T) -> f64) -> Result<Vec<f64>, Unfit> {
    let values = dataset.read_array::<T>().map_err(|error| Unfit::Damaged(error.to_string()))?;
    Ok(values.into_iter().map(number).collect())
}
