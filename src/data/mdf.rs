//! MDF 4 files (ASAM), as measuring instruments and loggers write them: channels in groups that share a clock.

use super::arrays::{Arrays, Unfit};
use super::error::DataError;
use super::names::{Name, headers};
use super::rows::Source;
use falcon_mdf::{Channel, Mf4Error as Error, Mf4File};

/// The channels of a file, those of one clock once.
pub(super) struct Channels {
    file: Mf4File,
    columns: Vec<(Name, Channel)>,
}

/// Reads which channels there are; their numbers are read later, but for the clocks'.
///
/// # Errors
/// [`DataError::Damaged`].
pub(super) fn open(source: &Source, bytes: Vec<u8>) -> Result<Channels, DataError> {
    channels(bytes).map_err(|error| {
        let (file, kind) = (source.file.clone(), source.kind);
        DataError::Damaged { file, kind, reason: error.to_string() }
    })
}

fn channels(bytes: Vec<u8>) -> Result<Channels, Error> {
    let file = Mf4File::from_bytes(bytes)?;
    let groups = file.data_groups().iter().flat_map(|group| &group.channel_groups);
    let groups: Vec<_> = groups.filter(|group| group.sample_count > 0).collect();
    let (mut columns, mut clocks): (_, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    for (number, group) in (1..).zip(&groups) {
        let name =
            if group.acquisition_name.is_empty() { format!("group {number}") } else { group.acquisition_name.clone() };
        for channel in &group.channels {
            if channel.is_master() {
                let clock = file.signal(channel)?.values_f64()?;
                if clocks.contains(&clock) {
                    continue;
                }
                clocks.push(clock);
            }
            let own = if groups.len() == 1 { Name::of(&channel.name) } else { Name::field(&name, &channel.name) };
            columns.push((own, channel.clone()));
        }
    }
    // Groups that share one clock are one table.
    if clocks.len() == 1 {
        for (name, _) in &mut columns {
            *name = Name::of(&name.own);
        }
    }
    Ok(Channels { file, columns })
}

impl Arrays for Channels {
    fn names(&self) -> Vec<String> {
        let names: Vec<Name> = self.columns.iter().map(|(name, _)| name.clone()).collect();
        let with_unit = |(header, (_, channel)): (String, &(Name, Channel))| match channel.unit.as_str() {
            "" => header,
            unit => format!("{header} [{unit}]"),
        };
        headers(&names).into_iter().zip(&self.columns).map(with_unit).collect()
    }

    fn values(&self, index: usize) -> Result<Vec<f64>, Unfit> {
        let (_, channel) = self.columns.get(index).ok_or_else(|| Unfit::Is("absent".into()))?;
        if !channel.is_numeric() {
            return Err(Unfit::Is("text or bytes".into()));
        }
        let damaged = |error: Error| Unfit::Damaged(error.to_string());
        let signal = self.file.signal(channel).map_err(damaged)?;
        let values = signal.values_f64().map_err(damaged)?;
        // A sample that the logger marked as invalid is as good as missing.
        let valid = signal.validity();
        let checked = |(index, value)| match &valid {
            Some(valid) if !valid.get(index).copied().unwrap_or(true) => f64::NAN,
            _ => value,
        };
        Ok(values.into_iter().enumerate().map(checked).collect())
    }
}
