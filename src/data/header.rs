//! Which column holds which quantity, and in which unit.

use super::DataError;
use super::kind::FileKind;
use crate::law::{Channel, ColumnUnits, Model, Unit, Units};

/// A column that is read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Column {
    pub(super) index: usize,
    /// Its header as written.
    pub(super) header: String,
    /// SI units per unit of the column.
    pub(super) factor: f64,
    unit: Option<Unit>,
}

/// What the column of time holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TimeBase {
    /// The time of every sample.
    Stamps,
    /// One number: the distance of two samples.
    Step,
    /// One number: samples per second.
    Rate,
}

/// Names under which a MAT file may hold a time base in place of times.
const TIME_BASES: [(&str, TimeBase); 3] = [("dt", TimeBase::Step), ("Ts", TimeBase::Step), ("fs", TimeBase::Rate)];

/// The columns of a recording.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    kind: FileKind,
    pub(super) time_base: TimeBase,
    pub(super) t: Column,
    pub(super) q: Option<Column>,
    pub(super) qd: Option<Column>,
    pub(super) excitation: Option<Column>,
}

/// A header taken apart: its name, and the unit that it ends in.
struct Heading<'a> {
    name: &'a str,
    unit: Written<'a>,
}

enum Written<'a> {
    Nothing,
    Known(&'a str, Unit),
    Unknown(&'a str),
}

impl Layout {
    /// Finds the columns in the headers of a file.
    pub(super) fn find(kind: FileKind, file: &str, headers: &[String], model: &Model) -> Result<Layout, DataError> {
        let finder = Finder { kind, file, headers, units: &model.units };
        let columns = &model.columns;
        let optional = |channel, name: &Option<String>| match name {
            Some(name) => finder.required(channel, name).map(Some),
            None => finder.column(channel, channel.name()),
        };
        let q = optional(Channel::Displacement, &columns.q)?;
        let qd = optional(Channel::Velocity, &columns.qd)?;
        let excitation = optional(Channel::Excitation, &columns.excitation)?;
        let (t, time_base) = finder.time(&columns.t)?;
        if q.is_none() && qd.is_none() {
            return Err(DataError::NoMotion { file: file.into(), kind, columns: quoted(headers) });
        }
        let layout = Layout { kind, time_base, t, q, qd, excitation };
        layout.check_apart(file)?;
        layout.check_rate(file)?;
        Ok(layout)
    }

    /// One line per column: what was taken for what.
    pub(super) fn describe(&self) -> Vec<String> {
        let line = |(channel, column): (Channel, &Column)| {
            let base = if channel == Channel::Time { self.time_base } else { TimeBase::Stamps };
            column.describe(self.kind, channel, base)
        };
        self.columns().map(line).collect()
    }

    /// What the columns say of the units of coefficients. In free motion these are relative to the inertia, unless the model
    /// holds it at a number.
    pub(super) fn units(&self, inertia_held: bool) -> Units {
        let quantity =
            |column: &Option<Column>| column.as_ref().and_then(|column| column.unit).map(|unit| unit.quantity);
        let (q, qd) = (quantity(&self.q), quantity(&self.qd));
        match &self.excitation {
            None if !inertia_held => Units::free(q, qd),
            excitation => Units::forced(q, qd, quantity(excitation)),
        }
    }

    /// No column is two quantities.
    fn check_apart(&self, file: &str) -> Result<(), DataError> {
        let columns: Vec<(Channel, &Column)> = self.columns().collect();
        for (place, (second, column)) in columns.iter().enumerate() {
            if let Some((first, _)) = columns[..place].iter().find(|(_, other)| other.index == column.index) {
                let (file, kind, column) = (file.into(), self.kind, column.header.clone());
                return Err(DataError::Shared { file, kind, column, first: first.name(), second: second.name() });
            }
        }
        Ok(())
    }

    /// The columns that are read.
    fn columns(&self) -> impl Iterator<Item = (Channel, &Column)> {
        let columns = [Some(&self.t), self.q.as_ref(), self.qd.as_ref(), self.excitation.as_ref()];
        Channel::ALL.into_iter().zip(columns).filter_map(|(channel, column)| Some((channel, column?)))
    }

    fn check_rate(&self, file: &str) -> Result<(), DataError> {
        let (Some(q), Some(qd)) = (&self.q, &self.qd) else { return Ok(()) };
        let (Some(q_unit), Some(qd_unit)) = (q.unit, qd.unit) else { return Ok(()) };
        if q_unit.quantity.rate() == Some(qd_unit.quantity) {
            return Ok(());
        }
        Err(DataError::UnitsDisagree {
            file: file.into(),
            kind: self.kind,
            displacement: q.header.clone(),
            displacement_quantity: q_unit.quantity.name(),
            velocity: qd.header.clone(),
            velocity_quantity: qd_unit.quantity.name(),
        })
    }
}

impl Column {
    fn describe(&self, kind: FileKind, channel: Channel, base: TimeBase) -> String {
        let unit = self.unit.map_or("SI", |unit| unit.name);
        let meaning = match base {
            TimeBase::Stamps => "",
            TimeBase::Step => " (distance of two samples)",
            TimeBase::Rate => " (samples per second)",
        };
        format!("{} = {} \"{}\"{meaning} in {unit}", channel.name(), kind.column(), self.header)
    }
}

struct Finder<'a> {
    kind: FileKind,
    file: &'a str,
    headers: &'a [String],
    units: &'a ColumnUnits,
}

impl Finder<'_> {
    /// The column of time, or a MAT file's distance of two samples.
    fn time(&self, name: &Option<String>) -> Result<(Column, TimeBase), DataError> {
        let wanted = name.as_deref().unwrap_or(Channel::Time.name());
        if let Some(column) = self.column(Channel::Time, wanted)? {
            return Ok((column, TimeBase::Stamps));
        }
        if self.kind.is_mat() && name.is_none() {
            for (name, base) in TIME_BASES {
                let plain = Finder { units: &ColumnUnits::default(), ..*self };
                if let Some(column) = plain.column(Channel::Time, name)? {
                    return Ok((column, base));
                }
            }
        }
        self.required(Channel::Time, wanted).map(|column| (column, TimeBase::Stamps))
    }

    fn required(&self, channel: Channel, name: &str) -> Result<Column, DataError> {
        self.column(channel, name)?.ok_or_else(|| DataError::MissingColumn {
            file: self.file.into(),
            kind: self.kind,
            column: name.into(),
            channel: channel.name(),
            columns: quoted(self.headers),
        })
    }

    /// The column whose header is `name`, or else `name` with a unit.
    fn column(&self, channel: Channel, name: &str) -> Result<Option<Column>, DataError> {
        let exact: Vec<usize> = self.positions(|header| header == name);
        let found = if exact.is_empty() { self.positions(|header| heading(header).name == name) } else { exact };
        match found[..] {
            [] => Ok(None),
            [index] => self.read(channel, index).map(Some),
            _ => {
                let fitting: Vec<String> = found.iter().map(|index| self.headers[*index].clone()).collect();
                Err(DataError::Ambiguous {
                    file: self.file.into(),
                    kind: self.kind,
                    column: name.into(),
                    columns: quoted(&fitting),
                })
            }
        }
    }

    fn positions(&self, fits: impl Fn(&str) -> bool) -> Vec<usize> {
        (0..self.headers.len()).filter(|index| fits(&self.headers[*index])).collect()
    }

    fn read(&self, channel: Channel, index: usize) -> Result<Column, DataError> {
        let header = self.headers[index].clone();
        let (file, kind, column) = (self.file.to_string(), self.kind, header.clone());
        let declared = self.units.unit(channel);
        match heading(&self.headers[index]).unit {
            Written::Nothing => {
                Ok(Column { index, header, factor: declared.map_or(1.0, |unit| unit.factor), unit: declared })
            }
            Written::Known(_, unit) if declared.is_some_and(|declared| declared.is_not(unit)) => {
                let declared = self.units.written(channel).unwrap_or_default().into();
                Err(DataError::UnitContradicts { file, column, unit: unit.name, channel: channel.name(), declared })
            }
            Written::Known(_, unit) if channel.accepts(unit.quantity) => {
                Ok(Column { index, header, factor: unit.factor, unit: Some(unit) })
            }
            Written::Known(text, unit) => Err(DataError::WrongUnit {
                file,
                kind,
                column,
                unit: text.into(),
                quantity: unit.quantity.name(),
                channel: channel.name(),
                expected: channel.meaning(),
            }),
            Written::Unknown(text) => Err(DataError::UnknownUnit {
                file,
                kind,
                column,
                unit: text.into(),
                channel: channel.name(),
                known: channel.known_units(),
            }),
        }
    }
}

/// `q [mm]`, `q (mm)` or `q_mm`. What stands in brackets is meant as a unit; an ending after `_` only if it is one.
fn heading(header: &str) -> Heading<'_> {
    for (open, close) in [('[', ']'), ('(', ')')] {
        let inside = header.strip_suffix(close).and_then(|rest| rest.rsplit_once(open));
        if let Some((name, text)) = inside {
            let unit = Unit::parse(text).map_or(Written::Unknown(text), |unit| Written::Known(text, unit));
            return Heading { name: name.trim(), unit };
        }
    }
    endings(header)
        .find_map(|(name, ending)| Some(Heading { name, unit: Written::Known(ending, written_unit(ending)?) }))
        .unwrap_or(Heading { name: header, unit: Written::Nothing })
}

/// The header cut at each `_`, longest ending first: `v_mm_per_s` is v in mm/s, not v_mm_per in s.
fn endings(header: &str) -> impl Iterator<Item = (&str, &str)> {
    header.match_indices('_').map(|(at, _)| (&header[..at], &header[at + 1..])).filter(|(name, _)| !name.is_empty())
}

/// The unit of an ending: as it stands, or `mm_s` for mm/s and `N_m` for N m.
fn written_unit(ending: &str) -> Option<Unit> {
    let worded = || ending.strip_suffix("_s").and_then(|length| Unit::parse(&format!("{length}/s")));
    let product = || if ending == "N_m" { Unit::parse("Nm") } else { None };
    // A bare digit or dash is a numbering, no unit.
    Unit::parse(ending).filter(|unit| unit.name.chars().any(char::is_alphabetic)).or_else(worded).or_else(product)
}

fn quoted(headers: &[String]) -> String {
    headers.iter().map(|header| format!("\"{header}\"")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_of(header: &str) -> (String, Option<f64>) {
        let heading = heading(header);
        match heading.unit {
            Written::Known(_, unit) => (heading.name.into(), Some(unit.factor)),
            Written::Nothing => (heading.name.into(), None),
            Written::Unknown(text) => (text.into(), Some(f64::NAN)),
        }
    }

    #[test]
    fn headings_are_taken_apart() {
        for (header, name, factor) in [
            ("position_mm", "position", Some(1e-3)),
            ("q [mm]", "q", Some(1e-3)),
            ("force (kN)", "force", Some(1e3)),
            ("v_mm_per_s", "v", Some(1e-3)),
            ("v_m_s", "v", Some(1.0)),
            ("input_V", "input", Some(1.0)),
            ("torque_N_m", "torque", Some(1.0)),
            ("q_left", "q_left", None),
            ("sensor_1", "sensor_1", None),
            ("qd", "qd", None),
            ("_m", "_m", None),
        ] {
            assert_eq!(unit_of(header), (name.to_string(), factor), "{header}");
        }
        assert_eq!(unit_of("q [furlong]").0, "furlong");
    }
}
