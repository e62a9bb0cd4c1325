//! Which column holds which quantity, and in which unit.

use super::error::DataError;
use super::guess;
use super::kind::FileKind;
use super::preamble;
use crate::law::{Channel, ColumnUnits, Columns, Model, Unit, Units};

/// A column that is read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Column {
    pub(super) index: usize,
    /// Its header as written.
    pub(super) header: String,
    /// SI units per unit of the column.
    pub(super) factor: f64,
    pub(super) unit: Option<Unit>,
    /// What told which quantity it holds, where nobody named it.
    pub(super) guessed: Option<&'static str>,
}

/// What the column of time holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TimeBase {
    /// The time of every sample.
    Stamps,
    /// One number: the distance of two samples.
    Step,
    /// One number: samples per second.
    Rate,
    /// Nothing: samples are this far apart, s.
    Grid(f64),
}

/// Position of a column that the file does not have.
const NOWHERE: usize = usize::MAX;

/// What a file says of its columns.
pub(super) struct Headings<'a> {
    kind: FileKind,
    file: &'a str,
    headers: &'a [String],
    /// Which columns hold dates or clock times; those beyond its end do not.
    pub(super) dated: Vec<bool>,
    /// The distance of two samples that the file names above its table, s.
    pub(super) rate: Option<f64>,
    /// Columns without names, as their numbers tell them apart.
    pub(super) by_content: Option<Columns>,
}

impl<'a> Headings<'a> {
    /// Headers alone.
    pub(super) fn of(kind: FileKind, file: &'a str, headers: &'a [String]) -> Headings<'a> {
        Headings { kind, file, headers, dated: Vec::new(), rate: None, by_content: None }
    }
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
    /// Finds the columns in the headings of a file: those that are named, those of the default names, and where these
    /// do not do, those that names, units or numbers tell.
    pub(super) fn find(headings: &Headings, model: &Model) -> Result<Layout, DataError> {
        let finder = Finder { headings, units: &model.units };
        let (file, kind) = (headings.file, headings.kind);
        let (named, guesses) = (&model.columns, model.columns.guesses());
        let told = headings.by_content.clone().filter(|_| guesses).unwrap_or_default();
        let optional = |channel: Channel, name: &Option<String>, told: &Option<String>| match (name, told) {
            (Some(name), _) => finder.required(channel, name).map(Some),
            (None, Some(told)) => {
                finder.required(channel, told).map(|column| Some(column.guessed_by("by their numbers")))
            }
            (None, None) => finder.column(channel, channel.name()),
        };
        let q = optional(Channel::Displacement, &named.q, &told.q)?;
        let qd = optional(Channel::Velocity, &named.qd, &told.qd)?;
        let excitation = optional(Channel::Excitation, &named.excitation, &told.excitation)?;
        let found = [q, qd, excitation];
        let looks = guesses && (matches!(found, [None, None, _]) || named.rest_is_guessed || !finder.is_timed()?);
        let [q, qd, excitation] = if looks { finder.guess(found)? } else { found };
        let taken: Vec<usize> = [&q, &qd, &excitation].into_iter().flatten().map(|column| column.index).collect();
        let (t, time_base) = finder.time(&named.t.clone().or(told.t), &taken)?;
        if q.is_none() && qd.is_none() {
            return Err(DataError::NoMotion { file: file.into(), kind, columns: quoted(headings.headers) });
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

    /// `q = "Weg [mm]"` for every column that nobody named.
    pub(super) fn guesses(&self) -> Vec<String> {
        let guess = |(channel, column): (Channel, &Column)| {
            column.guessed.map(|how| format!("{} = \"{}\" ({how})", channel.name(), column.header))
        };
        self.columns().filter_map(guess).collect()
    }

    /// What the columns say of the units of coefficients. In free motion these are relative to the inertia, unless the
    /// model holds it at a number.
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
    pub(super) fn columns(&self) -> impl Iterator<Item = (Channel, &Column)> {
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
    /// The same column, which nobody named: how it was found.
    fn guessed_by(self, how: &'static str) -> Column {
        Column { guessed: Some(how), ..self }
    }

    fn describe(&self, kind: FileKind, channel: Channel, base: TimeBase) -> String {
        let unit = self.unit.map_or("SI", |unit| unit.name);
        let meaning = match base {
            TimeBase::Stamps => "",
            TimeBase::Step => " (distance of two samples)",
            TimeBase::Rate => " (samples per second)",
            TimeBase::Grid(step) => return format!("t = {} in steps of {step} s", self.header),
        };
        let guessed = self.guessed.map_or_else(String::new, |how| format!(", guessed {how}"));
        format!("{} = {} \"{}\"{meaning} in {unit}{guessed}", channel.name(), kind.column(), self.header)
    }
}

struct Finder<'a> {
    headings: &'a Headings<'a>,
    units: &'a ColumnUnits,
}

impl Finder<'_> {
    /// The column of time, a MAT file's distance of two samples, or a rate that is named in place of times.
    fn time(&self, name: &Option<String>, taken: &[usize]) -> Result<(Column, TimeBase), DataError> {
        let wanted = name.as_deref().unwrap_or(Channel::Time.name());
        if let Some(column) = self.column(Channel::Time, wanted)? {
            return Ok((column, TimeBase::Stamps));
        }
        if let Some(step) = name.as_deref().and_then(grid) {
            return Ok((nowhere(step, None), TimeBase::Grid(step)));
        }
        if name.is_none() {
            if let Some(found) = self.time_base()? {
                return Ok(found);
            }
            let free: Vec<usize> = (0..self.headings.headers.len()).filter(|index| !taken.contains(index)).collect();
            if let Some(column) = self.likely(Channel::Time, &free)? {
                return Ok((column, TimeBase::Stamps));
            }
            if let Some(step) = self.headings.rate {
                return Ok((nowhere(step, Some("by the lines above the table")), TimeBase::Grid(step)));
            }
        }
        self.required(Channel::Time, wanted).map(|column| (column, TimeBase::Stamps))
    }

    /// Whether the times go by their default name: then so do the other columns.
    fn is_timed(&self) -> Result<bool, DataError> {
        let column = self.column(Channel::Time, Channel::Time.name())?;
        Ok(column.is_some() || self.time_base()?.is_some() || self.headings.rate.is_some())
    }

    /// A variable of a MAT file that stands for times.
    fn time_base(&self) -> Result<Option<(Column, TimeBase)>, DataError> {
        if !self.headings.kind.is_mat() {
            return Ok(None);
        }
        for (name, base) in TIME_BASES {
            let plain = Finder { units: &ColumnUnits::default(), ..*self };
            if let Some(column) = plain.column(Channel::Time, name)? {
                return Ok(Some((column, base)));
            }
        }
        Ok(None)
    }

    /// The columns of q, q̇ and F that their names or units tell, beside those found.
    fn guess(&self, found: [Option<Column>; 3]) -> Result<[Option<Column>; 3], DataError> {
        let taken: Vec<usize> = found.iter().flatten().map(|column| column.index).collect();
        let mut free: Vec<usize> = (0..self.headings.headers.len()).filter(|index| !taken.contains(index)).collect();
        let mut guessed = found;
        let channels = [Channel::Displacement, Channel::Velocity, Channel::Excitation];
        for (slot, channel) in guessed.iter_mut().zip(channels).filter(|(slot, _)| slot.is_none()) {
            *slot = self.likely(channel, &free)?;
            free.retain(|index| slot.as_ref().is_none_or(|column| column.index != *index));
        }
        Ok(guessed)
    }

    /// The only column among these whose name is one of the quantity's, else the only one in a unit of it alone.
    fn likely(&self, channel: Channel, free: &[usize]) -> Result<Option<Column>, DataError> {
        let headers = self.headings.headers;
        let is_dated = |index: usize| self.headings.dated.get(index).copied().unwrap_or(false);
        let fits = |index: &&usize| match heading(&headers[**index]).unit {
            Written::Known(_, unit) => channel.accepts(unit.quantity),
            Written::Nothing => is_dated(**index) == (channel == Channel::Time) || channel == Channel::Time,
            Written::Unknown(_) => false,
        };
        let named = |index: &&usize| fits(index) && guess::is_named(channel, heading(&headers[**index]).name);
        let in_unit = |index: &&usize| match heading(&headers[**index]).unit {
            Written::Known(_, unit) => {
                Channel::ALL.into_iter().filter(|other| other.accepts(unit.quantity)).eq([channel])
            }
            _ => channel == Channel::Time && is_dated(**index),
        };
        let only = |fits: &dyn Fn(&&usize) -> bool| {
            let mut fitting = free.iter().filter(fits);
            fitting.next().copied().filter(|_| fitting.next().is_none())
        };
        let told =
            only(&named).map(|index| (index, "by its name")).or(only(&in_unit).map(|index| (index, "by its unit")));
        let Some((index, how)) = told else { return Ok(None) };
        self.read(channel, index).map(|column| Some(Column { guessed: Some(how), ..column }))
    }

    fn required(&self, channel: Channel, name: &str) -> Result<Column, DataError> {
        self.column(channel, name)?.ok_or_else(|| DataError::MissingColumn {
            file: self.headings.file.into(),
            kind: self.headings.kind,
            column: name.into(),
            channel: channel.name(),
            columns: quoted(self.headings.headers),
        })
    }

    /// The column whose header is `name`, or else `name` with a unit, or else the one at that position, from 1.
    fn column(&self, channel: Channel, name: &str) -> Result<Option<Column>, DataError> {
        let exact: Vec<usize> = self.positions(|header| header == name);
        let found = if exact.is_empty() { self.positions(|header| heading(header).name == name) } else { exact };
        let position = name.parse::<usize>().ok().filter(|_| found.is_empty());
        if let Some(index) = position.filter(|position| (1..=self.headings.headers.len()).contains(position)) {
            return self.read(channel, index - 1).map(Some);
        }
        match found[..] {
            [] => Ok(None),
            [index] => self.read(channel, index).map(Some),
            _ => {
                let fitting: Vec<String> = found.iter().map(|index| self.headings.headers[*index].clone()).collect();
                Err(DataError::Ambiguous {
                    file: self.headings.file.into(),
                    kind: self.headings.kind,
                    column: name.into(),
                    columns: quoted(&fitting),
                })
            }
        }
    }

    fn positions(&self, fits: impl Fn(&str) -> bool) -> Vec<usize> {
        let headers = self.headings.headers;
        (0..headers.len()).filter(|index| fits(&headers[*index])).collect()
    }

    fn read(&self, channel: Channel, index: usize) -> Result<Column, DataError> {
        let header = self.headings.headers[index].clone();
        let (file, kind, column) = (self.headings.file.to_string(), self.headings.kind, header.clone());
        let declared = self.units.unit(channel);
        if channel == Channel::Time && self.headings.dated.get(index) == Some(&true) {
            return Ok(Column { index, header, factor: 1.0, unit: None, guessed: None });
        }
        match heading(&self.headings.headers[index]).unit {
            Written::Nothing => {
                let factor = declared.map_or(1.0, |unit| unit.factor);
                Ok(Column { index, header, factor, unit: declared, guessed: None })
            }
            Written::Known(_, unit) if declared.is_some_and(|declared| declared.is_not(unit)) => {
                let declared = self.units.written(channel).unwrap_or_default().into();
                Err(DataError::UnitContradicts { file, column, unit: unit.name, channel: channel.name(), declared })
            }
            Written::Known(_, unit) if channel.accepts(unit.quantity) => {
                Ok(Column { index, header, factor: unit.factor, unit: Some(unit), guessed: None })
            }
            Written::Known(text, unit) => Err(DataError::WrongUnit {
                file,
                kind,
                column: column.into(),
                unit: text.into(),
                quantity: unit.quantity.name(),
                channel: channel.name(),
                expected: channel.meaning(),
            }),
            Written::Unknown(text) if is_acceleration(text) => {
                Err(DataError::Acceleration { file, kind, column, channel: channel.name() })
            }
            Written::Unknown(text) => Err(DataError::UnknownUnit {
                file,
                kind,
                column,
                unit: text.into(),
                channel: channel.name(),
                known: channel.known_units().into(),
            }),
        }
    }
}

/// A column that the file does not have, for times that follow from a rate.
fn nowhere(step: f64, guessed: Option<&'static str>) -> Column {
    let rate = (1e9 / step).round() / 1e9;
    Column { index: NOWHERE, header: format!("{rate} Hz"), factor: 1.0, unit: None, guessed }
}

/// Whether a unit is one of acceleration.
fn is_acceleration(unit: &str) -> bool {
    let rate = |end: &str| unit.trim().strip_suffix(end).and_then(Unit::parse);
    unit.trim() == "g" || ["/s^2", "/s²", "/s2", "/s/s"].into_iter().any(|end| rate(end).is_some())
}

/// The distance of two samples that `1000 Hz` or `2 ms` names, s.
fn grid(text: &str) -> Option<f64> {
    let end = text.trim().find(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E'))?;
    let (value, unit) = text.trim().split_at(end);
    let value: f64 = value.trim().parse().ok().filter(|value: &f64| *value > 0.0 && value.is_finite())?;
    preamble::hertz(unit).map(|hertz| 1.0 / (value * hertz)).or_else(|| Some(value * preamble::seconds(unit)?))
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

/// The unit of an ending: as it stands, or `mm_s` and `mmps` for mm/s and `N_m` for N m.
fn written_unit(ending: &str) -> Option<Unit> {
    let per_second = || ending.strip_suffix("ps").and_then(|length| Unit::parse(&format!("{length}/s")));
    let worded = || ending.strip_suffix("_s").and_then(|length| Unit::parse(&format!("{length}/s")));
    let product = || if ending == "N_m" { Unit::parse("Nm") } else { None };
    // A bare digit or dash is a numbering, no unit.
    Unit::parse(ending)
        .filter(|unit| unit.name.chars().any(char::is_alphabetic))
        .or_else(worded)
        .or_else(per_second)
        .or_else(product)
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
            ("v_mmps", "v", Some(1e-3)),
            ("amps", "amps", None),
            ("n_steps", "n_steps", None),
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
