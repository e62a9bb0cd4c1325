//! MAT files of version 5 (MATLAB 5 to 7.2, `save -v6` and `-v7`), read after MathWorks' "MAT-File Format".
//!
//! After a header of 128 bytes the file is a row of elements: type, size, content. A variable is an element of type matrix whose
//! content is again a row of elements (flags, extents, name, numbers), or a compressed one that holds such an element.

use super::DataError;
use super::arrays::{Arrays, Unfit};
use super::matlab::{self, Name};
use super::rows::Source;
use flate2::read::ZlibDecoder;
use std::io::Read;

/// Bytes of a file's header: text, version, order of bytes.
const HEADER: usize = 128;

/// Numbers of a variable beyond which its extents are taken for damage: 8 TB.
const LARGEST: f64 = 1e12;

/// Types of elements ("MAT-File Format", table 1-1), with the constants below.
const INT8: u32 = 1;
const UINT8: u32 = 2;
const INT16: u32 = 3;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const SINGLE: u32 = 7;
const DOUBLE: u32 = 9;
const INT64: u32 = 12;
const UINT64: u32 = 13;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Classes of matrices: structure, and the first and last of numbers.
const STRUCTURE: u8 = 2;
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;

/// Bit of a matrix's flags.
const COMPLEX: u8 = 0x08;

/// A variable's numbers, or why it has none.
type Values = Result<Vec<f64>, Unfit>;

struct Variable {
    name: Name,
    values: Values,
}

/// The variables of a file, those of structures apart.
pub(super) struct Variables(Vec<Variable>);

/// Why the bytes make no sense.
type Broken = String;

/// Reads every variable.
///
/// # Errors
/// [`DataError::Damaged`].
pub(super) fn open(source: &Source, bytes: &[u8]) -> Result<Variables, DataError> {
    let (file, kind) = (source.file.clone(), source.kind);
    variables(bytes).map(Variables).map_err(|reason| DataError::Damaged { file, kind, reason })
}

impl Arrays for Variables {
    fn names(&self) -> Vec<String> {
        let names: Vec<Name> = self.0.iter().map(|variable| variable.name.clone()).collect();
        matlab::headers(&names)
    }

    fn values(&self, index: usize) -> Result<Vec<f64>, Unfit> {
        self.0.get(index).map_or_else(|| Err(Unfit::Is("absent".into())), |variable| variable.values.clone())
    }
}

fn variables(bytes: &[u8]) -> Result<Vec<Variable>, Broken> {
    let (header, rest) = bytes.split_at_checked(HEADER).ok_or("its header breaks off")?;
    let mut elements = Elements { rest, big_endian: header.ends_with(b"MI") };
    let mut found = Vec::new();
    while let Some(element) = elements.next()? {
        if element.kind == COMPRESSED {
            let mut inner = Vec::new();
            ZlibDecoder::new(element.content)
                .read_to_end(&mut inner)
                .map_err(|error| format!("a variable: {error}"))?;
            let mut inner = Elements { rest: &inner, big_endian: elements.big_endian };
            while let Some(element) = inner.next()? {
                found.extend(element.variables(elements.big_endian)?);
            }
        } else {
            found.extend(element.variables(elements.big_endian)?);
        }
    }
    Ok(found)
}

struct Element<'a> {
    kind: u32,
    content: &'a [u8],
}

/// Elements one after the other.
struct Elements<'a> {
    rest: &'a [u8],
    big_endian: bool,
}

impl<'a> Elements<'a> {
    /// The next element, if there is one more.
    fn next(&mut self) -> Result<Option<Element<'a>>, Broken> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        let tag = word(self.rest, self.big_endian)?;
        if tag >> 16 != 0 {
            let content = self.rest.get(4..4 + (tag >> 16) as usize).ok_or_else(short)?;
            self.rest = self.rest.get(8..).ok_or_else(short)?;
            return Ok(Some(Element { kind: tag & 0xffff, content }));
        }
        let size = word(self.rest.get(4..).unwrap_or_default(), self.big_endian)? as usize;
        let content = self.rest.get(8..).and_then(|rest| rest.get(..size)).ok_or_else(short)?;
        let padded = if tag == COMPRESSED { size } else { size.next_multiple_of(8) };
        self.rest = self.rest.get(8 + padded..).unwrap_or_default();
        Ok(Some(Element { kind: tag, content }))
    }

    fn required(&mut self) -> Result<Element<'a>, Broken> {
        self.next()?.ok_or_else(short)
    }
}

impl Element<'_> {
    /// The variable that a matrix is; the fields of a structure; nothing for other elements.
    fn variables(&self, big_endian: bool) -> Result<Vec<Variable>, Broken> {
        if self.kind != MATRIX || self.content.is_empty() {
            return Ok(Vec::new());
        }
        let mut matrix = Matrix::open(self.content, big_endian)?;
        // The workspace of function handles is an unnamed variable.
        if matrix.name.is_empty() {
            return Ok(Vec::new());
        }
        if matrix.class != STRUCTURE || matrix.shape.iter().product::<usize>() != 1 {
            return Ok(vec![Variable { name: Name::of(&matrix.name), values: matrix.values()? }]);
        }
        let name = matrix.name.clone();
        let fields = matrix.fields()?.into_iter();
        Ok(fields.map(|(field, values)| Variable { name: Name::field(&name, &field), values }).collect())
    }

    fn numbers(&self, big_endian: bool) -> Result<Vec<f64>, Broken> {
        let bytes = self.content;
        Ok(match self.kind {
            INT8 => bytes.iter().map(|byte| f64::from(byte.cast_signed())).collect(),
            UINT8 => bytes.iter().map(|byte| f64::from(*byte)).collect(),
            INT16 => each(bytes, big_endian, |bytes| i16::from_le_bytes(bytes).into()),
            UINT16 => each(bytes, big_endian, |bytes| u16::from_le_bytes(bytes).into()),
            INT32 => each(bytes, big_endian, |bytes| i32::from_le_bytes(bytes).into()),
            UINT32 => each(bytes, big_endian, |bytes| u32::from_le_bytes(bytes).into()),
            SINGLE => each(bytes, big_endian, |bytes| f32::from_le_bytes(bytes).into()),
            DOUBLE => each(bytes, big_endian, f64::from_le_bytes),
            INT64 => each(bytes, big_endian, |bytes| i64::from_le_bytes(bytes) as f64),
            UINT64 => each(bytes, big_endian, |bytes| u64::from_le_bytes(bytes) as f64),
            other => return Err(format!("numbers of type {other} are not known")),
        })
    }

    fn text(&self) -> String {
        String::from_utf8_lossy(self.content).trim_end_matches('\0').into()
    }
}

/// A matrix behind its flags, extents and name.
struct Matrix<'a> {
    class: u8,
    flags: u8,
    shape: Vec<usize>,
    name: String,
    rest: Elements<'a>,
}

impl<'a> Matrix<'a> {
    fn open(content: &'a [u8], big_endian: bool) -> Result<Matrix<'a>, Broken> {
        let mut rest = Elements { rest: content, big_endian };
        let flags = word(rest.required()?.content, big_endian)?;
        let shape = if (flags & 0xff) as u8 == 17 { Vec::new() } else { extents(&rest.required()?, big_endian)? };
        let name = rest.required()?.text();
        Ok(Matrix { class: (flags & 0xff) as u8, flags: (flags >> 8 & 0xff) as u8, shape, name, rest })
    }

    fn values(&mut self) -> Result<Values, Broken> {
        if !NUMERIC.contains(&self.class) {
            return Ok(Err(Unfit::Is(class_name(self.class).into())));
        }
        if self.flags & COMPLEX != 0 {
            return Ok(Err(Unfit::Is("complex".into())));
        }
        if let Err(unfit) = matlab::check_vector(&self.shape) {
            return Ok(Err(unfit));
        }
        let values = self.rest.required()?.numbers(self.rest.big_endian)?;
        let count: usize = self.shape.iter().product();
        if values.len() == count {
            Ok(Ok(values))
        } else {
            Err(format!("\"{}\" has {} of {count} values", self.name, values.len()))
        }
    }

    /// The fields of a structure: the length of a name, all names, then one matrix each.
    fn fields(&mut self) -> Result<Vec<(String, Values)>, Broken> {
        let length = word(self.rest.required()?.content, self.rest.big_endian)? as usize;
        let names = self.rest.required()?;
        let names =
            names.content.chunks(length.max(1)).map(|name| Element { kind: INT8, content: until_nul(name) }.text());
        let mut fields = Vec::new();
        for name in names {
            let element = self.rest.required()?;
            let values = if element.content.is_empty() {
                Err(Unfit::Is("empty".into()))
            } else {
                Matrix::open(element.content, self.rest.big_endian)?.values()?
            };
            fields.push((name, values));
        }
        Ok(fields)
    }
}

fn extents(element: &Element, big_endian: bool) -> Result<Vec<usize>, Broken> {
    let extents = element.numbers(big_endian)?;
    if extents.iter().any(|extent| *extent < 0.0) || extents.iter().product::<f64>() > LARGEST {
        return Err(format!("a variable of extents {extents:?}"));
    }
    Ok(extents.into_iter().map(|extent| extent as usize).collect())
}

fn until_nul(name: &[u8]) -> &[u8] {
    name.split(|byte| *byte == 0).next().unwrap_or_default()
}

fn class_name(class: u8) -> &'static str {
    match class {
        1 => "a cell array",
        STRUCTURE => "a structure",
        4 => "text",
        5 => "a sparse matrix",
        16 => "a function",
        _ => "an object (a table, timetable or timeseries?)",
    }
}

fn word(bytes: &[u8], big_endian: bool) -> Result<u32, Broken> {
    let bytes = bytes.first_chunk::<4>().ok_or_else(short)?;
    Ok(if big_endian { u32::from_be_bytes(*bytes) } else { u32::from_le_bytes(*bytes) })
}

/// Every number of `N` bytes; `read` takes little-endian ones.
fn each<const N: usize>(bytes: &[u8], big_endian: bool, read: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    let ordered = |chunk: &[u8; N]| {
        let mut chunk = *chunk;
        if big_endian {
            chunk.reverse();
        }
        chunk
    };
    bytes.as_chunks::<N>().0.iter().map(|chunk| read(ordered(chunk))).collect()
}

fn short() -> Broken {
    "it breaks off within a variable".into()
}
