//! The columns that a file's variables are: vectors, fields of structures, and the columns of tables and time series.

use super::super::arrays::Unfit;
use super::super::names::Name;
use super::objects::{Objects, Properties};
use super::value::Value;

/// Milliseconds, in which MATLAB keeps durations and dates, in a second.
const MILLISECONDS: f64 = 1e3;

/// A column: its name and unit, and where its numbers are.
pub(super) struct Column<'a> {
    pub(super) name: Name,
    pub(super) unit: Option<&'a str>,
    pub(super) content: Content<'a>,
}

/// A column's numbers.
pub(super) enum Content<'a> {
    /// As they are in the file.
    Stored(&'a Value),
    /// Computed: times, or why there are none.
    Times(Result<Vec<f64>, Unfit>),
}

/// The columns of these variables. Time series with the same times share one column of them.
pub(super) fn columns<'a>(variables: &'a [(String, Value)], objects: &'a Objects) -> Vec<Column<'a>> {
    let mut found = Vec::new();
    let mut clocks: Vec<Vec<f64>> = Vec::new();
    for (name, value) in variables {
        let properties = objects.properties(value);
        match (value, &properties) {
            (Value::Structure(fields), _) => {
                let field = |(field, value): &'a (String, Value)| stored(Name::field(name, field), None, value);
                found.extend(fields.iter().map(field));
            }
            (_, Some(properties)) if properties.class == "timetable" => {
                found.extend(
                    timetable(name, properties, objects).unwrap_or_else(|| vec![stored(Name::of(name), None, value)]),
                );
            }
            (_, Some(properties)) if properties.class == "table" => {
                found.extend(table(name, properties).unwrap_or_else(|| vec![stored(Name::of(name), None, value)]));
            }
            (_, Some(properties)) if properties.class == "timeseries" => {
                let Some(data) = either(properties, "Data") else { continue };
                let times = series_times(properties, data, objects);
                if let Ok(times) = &times
                    && clocks.iter().all(|clock| clock != times)
                {
                    let clock = if clocks.is_empty() { Name::of("Time") } else { Name::field(name, "Time") };
                    clocks.push(times.clone());
                    found.push(Column { name: clock, unit: None, content: Content::Times(Ok(times.clone())) });
                }
                let unit = either(properties, "DataInfo").and_then(|info| either(&objects.properties(info)?, "Units"));
                found.push(stored(Name::of(name), unit.and_then(Value::text), data));
            }
            _ => found.push(stored(Name::of(name), None, value)),
        }
    }
    found
}

fn stored<'a>(name: Name, unit: Option<&'a str>, value: &'a Value) -> Column<'a> {
    Column { name, unit: unit.filter(|unit| !unit.is_empty()), content: Content::Stored(value) }
}

/// A property under its public name or under the one that ends in `_`, in which the class keeps it.
fn either<'a>(properties: &Properties<'a>, name: &str) -> Option<&'a Value> {
    let empty = |value: &&Value| matches!(value, Value::Numbers { shape, .. } if shape.contains(&0));
    let kept = properties.get(&format!("{name}_")).filter(|value| !empty(value));
    kept.or_else(|| properties.get(name)).filter(|value| !empty(value))
}

/// A timetable keeps a structure: a cell for each variable's numbers, their names, their units, the times of the rows.
fn timetable<'a>(name: &str, properties: &Properties<'a>, objects: &Objects) -> Option<Vec<Column<'a>>> {
    let all = properties.get("any")?;
    let rows = all.field("numRows")?.number()? as usize;
    let clock = all.field("dimNames").and_then(|names| names.texts().first().copied()).unwrap_or("Time");
    let times = row_times(all.field("rowTimes")?, rows, objects);
    let mut columns = vec![Column { name: Name::field(name, clock), unit: None, content: Content::Times(times) }];
    columns.extend(named(name, all.field("data")?, all.field("varNames")?, all.field("varUnits"))?);
    Some(columns)
}

/// A table keeps the same without times, each as a property.
fn table<'a>(name: &str, properties: &Properties<'a>) -> Option<Vec<Column<'a>>> {
    let units = properties.get("props").and_then(|props| props.field("VariableUnits"));
    named(name, properties.get("data")?, properties.get("varnames")?, units)
}

fn named<'a>(table: &str, data: &'a Value, names: &'a Value, units: Option<&'a Value>) -> Option<Vec<Column<'a>>> {
    let Value::Cells(data) = data else { return None };
    let units = units.map(Value::texts).unwrap_or_default();
    let columns = data.iter().zip(names.texts()).enumerate();
    Some(columns.map(|(at, (value, own))| stored(Name::field(table, own), units.get(at).copied(), value)).collect())
}

/// The times of a timetable's rows (s): durations or dates, or a start and a step or rate.
fn row_times(times: &Value, rows: usize, objects: &Objects) -> Result<Vec<f64>, Unfit> {
    let unknown = || Unfit::Is("a kind of times that is not read".into());
    if let Value::Structure(_) = times {
        let rate = times.field("sampleRate").and_then(Value::number);
        let step = times.field("stepSize").and_then(|step| moments(step, objects)?.ok()?.first().copied());
        let by_rate = times.field("specifiedAsRate").and_then(Value::number) == Some(1.0);
        let at = |row: usize| if by_rate { Some(row as f64 / rate?) } else { Some(row as f64 * step?) };
        let start = times.field("origin").and_then(|start| moments(start, objects)?.ok()?.first().copied());
        let start = start.unwrap_or_default();
        return (0..rows).map(|row| at(row).map(|t| start + t).ok_or_else(unknown)).collect();
    }
    moments(times, objects).ok_or_else(unknown)?
}

/// The times (s) that an array of durations is, or an array of dates, from its first.
fn moments(value: &Value, objects: &Objects) -> Option<Result<Vec<f64>, Unfit>> {
    let properties = objects.properties(value)?;
    let seconds = |milliseconds: Vec<f64>| milliseconds.into_iter().map(|t| t / MILLISECONDS).collect();
    match properties.class {
        "duration" => Some(properties.get("millis")?.vector().map(seconds)),
        // A date is the sum of two numbers, the second of which holds what the first one rounds off.
        "datetime" => Some(match properties.get("data")? {
            Value::Complex { real, imaginary } => {
                let (first, rest) = (*real.first()?, *imaginary.first()?);
                Ok(seconds(real.iter().zip(imaginary).map(|(t, small)| (t - first) + (small - rest)).collect()))
            }
            dates => dates.vector().map(|dates| {
                let first = dates.first().copied().unwrap_or_default();
                seconds(dates.into_iter().map(|t| t - first).collect())
            }),
        }),
        _ => None,
    }
}

/// The times (s) of a time series: as they are, or where they are even a start and an increment.
fn series_times(properties: &Properties, data: &Value, objects: &Objects) -> Result<Vec<f64>, Unfit> {
    let info = either(properties, "TimeInfo").and_then(|info| objects.properties(info));
    let unit = info.as_ref().and_then(|info| either(info, "Units")?.text()).unwrap_or("seconds");
    let unknown = || Unfit::Is(format!("a time series whose times, in {unit}, are not read"));
    let factor = match unit {
        "seconds" => 1.0,
        "milliseconds" => 1e-3,
        "microseconds" => 1e-6,
        "nanoseconds" => 1e-9,
        "minutes" => 60.0,
        "hours" => 3600.0,
        _ => return Err(unknown()),
    };
    let times = match either(properties, "Time") {
        Some(times) => times.vector()?,
        None => {
            let number = |name: &str| info.as_ref().and_then(|info| either(info, name)?.number());
            let (start, step) = (number("Start").unwrap_or_default(), number("Increment").ok_or_else(unknown)?);
            (0..data.vector()?.len()).map(|index| start + index as f64 * step).collect()
        }
    };
    Ok(times.into_iter().map(|t| t * factor).collect())
}
