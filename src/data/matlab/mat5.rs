//! MAT files of version 5 (MATLAB 5 to 7.2, `save -v6` and `-v7`), read after MathWorks' "MAT-File Format".
//!
//! After a header of 128 bytes the file is a row of elements: type, size, content. A variable is an element of type
//! matrix whose content is again a row of elements (flags, extents, name, numbers), or a compressed one that holds such
//! an element.

use super::objects::Objects;
use super::value::Value;
use flate2::read::ZlibDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Bytes of a file's header: text, where the objects are, version, order of bytes.
const HEADER: usize = 128;

/// Where in the header it stands at which byte the objects are; 0 or blanks where there are none.
const OBJECTS_AT: std::ops::Range<usize> = 116..124;

/// Bytes of the header of the file within the file that the objects are: version and order of bytes, then zeros.
const INNER_HEADER: usize = 8;

/// How deep cells and structures may lie in each other: deeper is damage, not a recording.
const DEEPEST: usize = 32;

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
const UTF8: u32 = 16;
const UTF16: u32 = 17;

/// Classes of matrices, those of numbers from first to last.
const CELLS: u8 = 1;
const STRUCTURE: u8 = 2;
const TEXT: u8 = 4;
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;
const OBJECT: u8 = 17;

/// Bit of a matrix's flags.
const COMPLEX: u8 = 0x08;

/// Why the bytes make no sense.
type Broken = String;

/// Reads every variable, and the objects that they refer to.
///
/// # Errors
/// Why the bytes make no sense.
pub(super) fn read(bytes: &[u8]) -> Result<(Vec<(String, Value)>, Objects), Broken> {
    let (header, rest) = bytes.split_at_checked(HEADER).ok_or("its header breaks off")?;
    let mut elements = Elements { rest, big_endian: header.ends_with(b"MI") };
    let objects_at = header[OBJECTS_AT].try_into().map_err(|_| short())?;
    let objects_at = if elements.big_endian { u64::from_be_bytes(objects_at) } else { u64::from_le_bytes(objects_at) };
    let (mut found, mut objects) = (Vec::new(), Objects::none());
    loop {
        let at = bytes.len() - elements.rest.len();
        let Some(element) = elements.next()? else { return Ok((found, objects)) };
        let content = element.unpacked()?;
        let Some((name, value)) = variable(&content, elements.big_endian)? else { continue };
        if at as u64 == objects_at {
            objects = stored_objects(&value)?;
        } else if !name.is_empty() {
            // The workspace of function handles is an unnamed variable.
            found.push((name, value));
        }
    }
}

/// The variable in these bytes; nothing where they are no matrix.
fn variable(bytes: &[u8], big_endian: bool) -> Result<Option<(String, Value)>, Broken> {
    let element = Elements { rest: bytes, big_endian }.next()?;
    element.filter(|element| element.kind == MATRIX).map(|matrix| matrix.matrix(big_endian, 0)).transpose()
}

/// The objects: the bytes of a file of their own, whose only variable is a structure that holds an object of cells.
fn stored_objects(bytes: &Value) -> Result<Objects, Broken> {
    let bytes: Vec<u8> = bytes.vector().map_err(|_| short())?.into_iter().map(|byte| byte as u8).collect();
    let (header, rest) = bytes.split_at_checked(INNER_HEADER).ok_or_else(short)?;
    let big_endian = &header[2..4] == b"MI";
    let Some((_, Value::Structure(fields))) = variable(rest, big_endian)? else { return Ok(Objects::none()) };
    let cells = fields.into_iter().find(|(name, _)| name == "MCOS").map(|(_, value)| value);
    match cells {
        Some(Value::Object(cells)) => match *cells {
            Value::Cells(cells) => Objects::open(cells, big_endian),
            _ => Ok(Objects::none()),
        },
        _ => Ok(Objects::none()),
    }
}

struct Element<'a> {
    kind: u32,
    content: &'a [u8],
    /// With its tag.
    whole: &'a [u8],
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
            let (whole, rest) = self.rest.split_at_checked(8).ok_or_else(short)?;
            self.rest = rest;
            return Ok(Some(Element { kind: tag & 0xffff, content, whole }));
        }
        let size = word(self.rest.get(4..).unwrap_or_default(), self.big_endian)? as usize;
        let content = self.rest.get(8..).and_then(|rest| rest.get(..size)).ok_or_else(short)?;
        let padded = if tag == COMPRESSED { size } else { size.next_multiple_of(8) };
        let whole = &self.rest[..8 + size];
        self.rest = self.rest.get(8 + padded..).unwrap_or_default();
        Ok(Some(Element { kind: tag, content, whole }))
    }

    fn required(&mut self) -> Result<Element<'a>, Broken> {
        self.next()?.ok_or_else(short)
    }
}

impl<'a> Element<'a> {
    /// The bytes of the element itself, or of the one that was compressed.
    fn unpacked(&self) -> Result<Cow<'a, [u8]>, Broken> {
        if self.kind != COMPRESSED {
            return Ok(Cow::Borrowed(self.whole));
        }
        let mut inner = Vec::new();
        ZlibDecoder::new(self.content).read_to_end(&mut inner).map_err(|error| format!("a variable: {error}"))?;
        Ok(Cow::Owned(inner))
    }

    /// The name and value that a matrix is, `depth` cells or structures down.
    fn matrix(&self, big_endian: bool, depth: usize) -> Result<(String, Value), Broken> {
        if self.content.is_empty() {
            return Ok((String::new(), Value::Numbers { shape: vec![0, 0], numbers: Box::new(Vec::new()) }));
        }
        if depth > DEEPEST {
            return Err(format!("cells lie in cells more than {DEEPEST} times"));
        }
        let mut matrix = Matrix::open(self.content, big_endian)?;
        let value = matrix.value(depth)?;
        Ok((matrix.name, value))
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

    fn text(&self, big_endian: bool) -> Result<String, Broken> {
        let text = match self.kind {
            UINT16 | UTF16 => {
                let units = each(self.content, big_endian, u16::from_le_bytes);
                String::from_utf16_lossy(&units)
            }
            INT8 | UINT8 | UTF8 => String::from_utf8_lossy(self.content).into(),
            other => return Err(format!("characters of type {other} are not known")),
        };
        Ok(text.trim_end_matches('\0').into())
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
        let class = (flags & 0xff) as u8;
        let shape = if class == OBJECT { Vec::new() } else { extents(&rest.required()?, big_endian)? };
        let name = rest.required()?.text(big_endian)?;
        Ok(Matrix { class, flags: (flags >> 8 & 0xff) as u8, shape, name, rest })
    }

    fn value(&mut self, depth: usize) -> Result<Value, Broken> {
        Ok(match self.class {
            CELLS => {
                let count: usize = self.shape.iter().product();
                Value::Cells((0..count).map(|_| self.inner(depth)).collect::<Result<_, _>>()?)
            }
            STRUCTURE => self.structure(depth)?,
            TEXT => Value::Text(self.rest.required()?.text(self.rest.big_endian)?),
            5 => Value::Other("a sparse matrix"),
            class if NUMERIC.contains(&class) => self.numbers()?,
            16 => Value::Other("a function"),
            OBJECT => {
                // Which system of objects, and which class; the object itself says the class too.
                self.rest.required()?;
                self.rest.required()?;
                Value::Object(Box::new(self.inner(depth)?))
            }
            _ => Value::Other("an object of a class that is not read"),
        })
    }

    /// The next matrix within this one.
    fn inner(&mut self, depth: usize) -> Result<Value, Broken> {
        let element = self.rest.required()?;
        if element.kind != MATRIX {
            return Err(format!("\"{}\" holds an element of type {}", self.name, element.kind));
        }
        Ok(element.matrix(self.rest.big_endian, depth + 1)?.1)
    }

    fn numbers(&mut self) -> Result<Value, Broken> {
        let (big_endian, shape) = (self.rest.big_endian, std::mem::take(&mut self.shape));
        let count: usize = shape.iter().product();
        let mut part = || {
            let numbers = self.rest.required()?.numbers(big_endian)?;
            if numbers.len() == count {
                return Ok(numbers);
            }
            Err(format!("\"{}\" has {} of {count} values", self.name, numbers.len()))
        };
        let real = part()?;
        if self.flags & COMPLEX != 0 {
            return Ok(Value::Complex { real, imaginary: part()? });
        }
        Ok(Value::Numbers { shape, numbers: Box::new(real) })
    }

    /// A structure: the length of a name, all names, then one matrix each.
    fn structure(&mut self, depth: usize) -> Result<Value, Broken> {
        if self.shape.iter().product::<usize>() != 1 {
            return Ok(Value::Other("a structure array"));
        }
        let length = word(self.rest.required()?.content, self.rest.big_endian)? as usize;
        let names = self.rest.required()?.content.chunks(length.max(1));
        let name = |name: &[u8]| String::from_utf8_lossy(until_nul(name)).into_owned();
        let fields = names.map(|bytes| Ok((name(bytes), self.inner(depth)?)));
        Ok(Value::Structure(fields.collect::<Result<_, Broken>>()?))
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

fn word(bytes: &[u8], big_endian: bool) -> Result<u32, Broken> {
    let bytes = bytes.first_chunk::<4>().ok_or_else(short)?;
    Ok(if big_endian { u32::from_be_bytes(*bytes) } else { u32::from_le_bytes(*bytes) })
}

/// Every number of `N` bytes; `read` takes little-endian ones.
fn each<const N: usize, T>(bytes: &[u8], big_endian: bool, read: impl Fn([u8; N]) -> T) -> Vec<T> {
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
