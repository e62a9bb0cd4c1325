//! Parquet files: flat columns of numbers, in as many row groups as the writer made.

use super::arrays::{Arrays, Unfit};
use super::error::DataError;
use super::rows::Source;
use ::parquet::basic::{ConvertedType, LogicalType, Type};
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use ::parquet::data_type::DataType;
use ::parquet::errors::ParquetError;
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::schema::types::ColumnDescriptor;
use bytes::Bytes;

/// The columns of a file.
pub(super) struct Columns(SerializedFileReader<Bytes>);

/// Reads the schema; numbers are read later.
///
/// # Errors
/// [`DataError::Damaged`].
pub(super) fn open(source: &Source, bytes: Vec<u8>) -> Result<Columns, DataError> {
    SerializedFileReader::new(Bytes::from(bytes)).map(Columns).map_err(|error| {
        let (file, kind) = (source.file.clone(), source.kind);
        DataError::Damaged { file, kind, reason: error.to_string() }
    })
}

impl Arrays for Columns {
    fn names(&self) -> Vec<String> {
        let columns = self.0.metadata().file_metadata().schema_descr().columns();
        columns.iter().map(|column| column.path().string()).collect()
    }

    fn values(&self, index: usize) -> Result<Vec<f64>, Unfit> {
        let schema = self.0.metadata().file_metadata().schema_descr();
        let unsigned = check(&schema.column(index))?;
        let mut values = Vec::new();
        for group in 0..self.0.num_row_groups() {
            self.read_group(group, index, unsigned, &mut values).map_err(|error| Unfit::Damaged(error.to_string()))?;
        }
        Ok(values)
    }
}

/// Refuses what is not a plain number; says whether it is an unsigned one.
fn check(column: &ColumnDescriptor) -> Result<bool, Unfit> {
    let is = |what: &str| Err(Unfit::Is(what.into()));
    if column.max_rep_level() > 0 {
        return is("a list");
    }
    match (column.physical_type(), column.logical_type_ref()) {
        (_, Some(LogicalType::Timestamp { .. } | LogicalType::Date | LogicalType::Time { .. })) => {
            is("a date or time of day (write seconds as numbers)")
        }
        (_, Some(LogicalType::Decimal { .. })) => is("decimal (write floating-point numbers)"),
        (Type::BOOLEAN | Type::FLOAT | Type::DOUBLE | Type::INT32 | Type::INT64, _) => Ok(matches!(
            column.converted_type(),
            ConvertedType::UINT_8 | ConvertedType::UINT_16 | ConvertedType::UINT_32 | ConvertedType::UINT_64
        )),
        (Type::BYTE_ARRAY, _) => is("text"),
        _ => is("of a type that holds no plain numbers"),
    }
}

impl Columns {
    fn read_group(
        &self,
        group: usize,
        index: usize,
        unsigned: bool,
        values: &mut Vec<f64>,
    ) -> Result<(), ParquetError> {
        let group = self.0.get_row_group(group)?;
        let rows = group.metadata().num_rows() as usize;
        let before = values.len();
        match group.get_column_reader(index)? {
            ColumnReader::BoolColumnReader(reader) => read(reader, rows, values, |value| f64::from(u8::from(value))),
            ColumnReader::Int32ColumnReader(reader) if unsigned => {
                read(reader, rows, values, |value| value.cast_unsigned().into())
            }
            ColumnReader::Int32ColumnReader(reader) => read(reader, rows, values, f64::from),
            ColumnReader::Int64ColumnReader(reader) if unsigned => {
                read(reader, rows, values, |value| value.cast_unsigned() as f64)
            }
            ColumnReader::Int64ColumnReader(reader) => read(reader, rows, values, |value| value as f64),
            ColumnReader::FloatColumnReader(reader) => read(reader, rows, values, f64::from),
            ColumnReader::DoubleColumnReader(reader) => read(reader, rows, values, |value| value),
            _ => Err(ParquetError::General("this column holds no numbers".into())),
        }?;
        let found = values.len() - before;
        if found == rows { Ok(()) } else { Err(ParquetError::EOF(format!("{found} of {rows} rows"))) }
    }
}

/// Appends every row of a column; NaN where the row has no value, which its definition level says.
fn read<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
    values: &mut Vec<f64>,
    number: impl Fn(T::T) -> f64,
) -> Result<(), ParquetError> {
    let (mut present, mut levels) = (Vec::new(), Vec::new());
    let mut read = 0;
    while read < rows {
        let (records, ..) = reader.read_records(rows - read, Some(&mut levels), None, &mut present)?;
        if records == 0 {
            break;
        }
        read += records;
    }
    if levels.is_empty() {
        values.extend(present.into_iter().map(number));
        return Ok(());
    }
    let deepest = levels.iter().copied().max().unwrap_or_default();
    let all = present.len() == levels.len();
    let mut present = present.into_iter();
    let value = |level: i16| if all || level == deepest { present.next().map_or(f64::NAN, &number) } else { f64::NAN };
    values.extend(levels.into_iter().map(value));
    Ok(())
}
