//! The objects of MATLAB's classes in a file: their properties, which the file keeps apart from the variables.
//!
//! MathWorks does not document that part. Its layout has been worked out from files by several people, and is: a cell
//! array whose first cell holds bytes (names, classes, objects and which property is which value), whose cells from the
//! third on are the properties' values, and whose last one holds what properties of each class are where an object says
//! nothing.

use super::value::Value;

/// Bytes before the names: version, count of names, where each of eight tables begins.
const HEADER: usize = 40;

/// Cells before the values: the tables, and one that is empty.
const LEADING: usize = 2;

/// How a property's value is given: as one of the values. (Others are a name or a whole number, which no signal is.)
const STORED: u32 = 1;

/// Why the tables make no sense.
const BROKEN: &str = "its objects refer to what is not there";

/// Where an object's class and properties are.
struct Object {
    class: usize,
    /// Which record of the first table of properties, if it is there: what the class's own `saveobj` left.
    converted: usize,
    /// Which record of the second one.
    plain: usize,
}

/// The objects of a file.
pub(super) struct Objects {
    names: Vec<String>,
    /// Where each class's name is, from 1.
    classes: Vec<usize>,
    objects: Vec<Object>,
    converted: Vec<u32>,
    plain: Vec<u32>,
    cells: Vec<Value>,
}

/// An object's properties by name, those of its class last.
pub(super) struct Properties<'a> {
    /// The class.
    pub(super) class: &'a str,
    own: Vec<(&'a str, &'a Value)>,
    class_wide: Option<&'a Value>,
}

impl<'a> Properties<'a> {
    /// The property of this name.
    pub(super) fn get(&self, name: &str) -> Option<&'a Value> {
        let own = self.own.iter().find(|(own, _)| *own == name).map(|(_, value)| *value);
        own.or_else(|| self.class_wide?.field(name))
    }
}

impl Objects {
    /// Of a file without any.
    pub(super) fn none() -> Objects {
        let (names, classes, objects, cells) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Objects { names, classes, objects, converted: Vec::new(), plain: Vec::new(), cells }
    }

    /// Reads the tables in these cells' first one.
    ///
    /// # Errors
    /// What makes no sense.
    pub(super) fn open(cells: Vec<Value>, big_endian: bool) -> Result<Objects, String> {
        let bytes = cells.first().ok_or(BROKEN)?.vector().map_err(|_| BROKEN)?;
        let bytes: Vec<u8> = bytes.into_iter().map(|byte| byte as u8).collect();
        let words = |from: usize, to: usize| -> Result<Vec<u32>, String> {
            let table = bytes.get(from..to).ok_or(BROKEN)?.as_chunks::<4>().0;
            let word = |word: &[u8; 4]| if big_endian { u32::from_be_bytes(*word) } else { u32::from_le_bytes(*word) };
            Ok(table.iter().map(word).collect())
        };
        let starts: Vec<usize> = words(8, HEADER)?.into_iter().map(|start| start as usize).collect();
        let names = bytes.get(HEADER..starts[0]).ok_or(BROKEN)?.split(|byte| *byte == 0);
        let names = names.filter(|name| !name.is_empty()).map(|name| String::from_utf8_lossy(name).into()).collect();
        let classes =
            words(starts[0], starts[1])?.as_chunks::<4>().0.iter().map(|[_, name, ..]| *name as usize).collect();
        let object = |[class, _, _, converted, plain, _]: &[u32; 6]| Object {
            class: *class as usize,
            converted: *converted as usize,
            plain: *plain as usize,
        };
        let objects = words(starts[2], starts[3])?.as_chunks::<6>().0.iter().map(object).collect();
        let (converted, plain) = (words(starts[1], starts[2])?, words(starts[3], starts[4])?);
        Ok(Objects { names, classes, objects, converted, plain, cells })
    }

    /// The properties of the object that this value refers to.
    pub(super) fn properties(&self, value: &Value) -> Option<Properties<'_>> {
        let object = self.objects.get(value.object()?)?;
        let class = self.name(*self.classes.get(object.class)?)?;
        let record = match object.converted {
            0 => record(&self.plain, object.plain)?,
            converted => record(&self.converted, converted)?,
        };
        let stored = record.iter().filter(|[_, kind, _]| *kind == STORED);
        let own = stored.filter_map(|[name, _, value]| {
            Some((self.name(*name as usize)?, self.cells.get(LEADING + *value as usize)?))
        });
        let class_wide = match self.cells.last() {
            Some(Value::Cells(classes)) => classes.get(object.class),
            _ => None,
        };
        Some(Properties { class, own: own.collect(), class_wide })
    }

    /// A name by its place, from 1.
    fn name(&self, place: usize) -> Option<&str> {
        self.names.get(place.checked_sub(1)?).map(String::as_str)
    }
}

/// Record number `index` of a table: how many properties, then three words for each; records begin at even words.
fn record(table: &[u32], index: usize) -> Option<&[[u32; 3]]> {
    let mut at = 0;
    for _ in 0..index {
        at += (1 + 3 * *table.get(at)? as usize).next_multiple_of(2);
    }
    let count = *table.get(at)? as usize;
    Some(table.get(at + 1..at + 1 + 3 * count)?.as_chunks::<3>().0)
}
