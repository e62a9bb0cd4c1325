//! The settings that a user reaches by name: parameters of the FMU, options of the command line; and their ranges.

use super::settings::{Settings, SettingsError};

/// Samples that are kept at most: half a gigabyte.
const LONGEST: f64 = 1e7;

/// A setting that is a number.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name: `noise.q`.
    pub name: &'static str,
    /// Its unit, where it has one.
    pub unit: Option<&'static str>,
    /// Smallest value that the FMU takes; above 0 where 0 is refused.
    pub min: f64,
    /// What it does, and what 0 means where that is special.
    pub description: &'static str,
    field: Field,
}

type Field = fn(&mut Settings) -> &mut f64;

impl Parameter {
    /// Every parameter, in the order in which it is listed.
    pub const ALL: [Parameter; 11] = [
        Parameter::number("noise.q", "Std of the sensor noise on q; 0 = estimated from the data", |settings| {
            &mut settings.noise_q
        }),
        Parameter::number("noise.qd", "Std of the sensor noise on qd; 0 = estimated from the data", |settings| {
            &mut settings.noise_qd
        }),
        Parameter::number("noise.F", "Std of the sensor noise on F; 0 = F is exact", |settings| {
            &mut settings.noise_excitation
        }),
        Parameter::seconds(
            "false_alarm_interval",
            1e-3,
            "Mean time between two false alarms that is tolerated; longer = fewer of them, later detection",
            |settings| &mut settings.false_alarm_interval,
        ),
        Parameter::seconds(
            "initial_window",
            0.0,
            "Record from which the first law is identified; 0 = as soon as the data allow",
            |settings| &mut settings.initial_window,
        ),
        Parameter::seconds(
            "deviation.interval",
            1e-6,
            "Interval T over which the deviation of prediction from observation is averaged",
            |settings| &mut settings.deviation_interval,
        ),
        Parameter::number("deviation.threshold", "Deviation that raises an alarm; 0 = automatic", |settings| {
            &mut settings.deviation_threshold
        }),
        Parameter::number("weight.q", "Weight of q in the deviation", |settings| &mut settings.weight_q),
        Parameter::number("weight.qd", "Weight of qd in the deviation", |settings| &mut settings.weight_qd),
        Parameter::seconds(
            "sample_time",
            1e-9,
            "Usual time between two samples: with max_window it fixes the memory; a sample sooner than half of it after the \
             last one is left out",
            |settings| &mut settings.sample_time,
        ),
        Parameter::seconds(
            "max_window",
            1e-6,
            "Record kept to refine the law on; with sample_time it fixes the memory",
            |settings| &mut settings.max_window,
        ),
    ];

    /// A number that is at least 0.
    const fn number(name: &'static str, description: &'static str, field: Field) -> Parameter {
        Parameter { name, unit: None, min: 0.0, description, field }
    }

    /// A time, s.
    const fn seconds(name: &'static str, min: f64, description: &'static str, field: Field) -> Parameter {
        Parameter { name, unit: Some("s"), min, description, field }
    }

    /// Its value in settings that nobody touched.
    pub fn default(&self) -> f64 {
        self.value(Settings::default())
    }

    fn value(&self, mut settings: Settings) -> f64 {
        *(self.field)(&mut settings)
    }

    /// Puts its value into the settings; [`Settings::check`] judges it.
    pub fn set(&self, settings: &mut Settings, value: f64) {
        *(self.field)(settings) = value;
    }

    fn check(&self, settings: Settings) -> Result<(), SettingsError> {
        let (name, value) = (self.name, self.value(settings));
        let (holds, range) = match self.min > 0.0 {
            true => (value > 0.0, "a positive number of seconds"),
            false => (value >= 0.0, "0 or a positive number"),
        };
        if holds && value.is_finite() { Ok(()) } else { Err(SettingsError::OutOfRange { name, value, range }) }
    }
}

impl Settings {
    /// Checks every range.
    ///
    /// # Errors
    /// The first setting that is refused.
    pub fn check(&self) -> Result<(), SettingsError> {
        if !self.channels.q && !self.channels.qd {
            return Err(SettingsError::NothingMeasured);
        }
        Parameter::ALL.iter().try_for_each(|parameter| parameter.check(*self))?;
        let samples = self.max_window / self.sample_time;
        if !(100.0..=LONGEST).contains(&samples) {
            return Err(SettingsError::Window { samples });
        }
        let samples = self.deviation_interval / self.sample_time;
        if samples > LONGEST {
            return Err(SettingsError::DeviationInterval { samples });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_keep_too_many_samples_is_refused() {
        let refused = |settings: Settings| settings.check().unwrap_err().to_string();
        let window = refused(Settings { max_window: 1e6, ..Settings::default() });
        assert!(window.starts_with("max_window ÷ sample_time = 1000000000 samples"), "{window}");
        let deviation = refused(Settings { deviation_interval: 1e6, ..Settings::default() });
        assert!(deviation.starts_with("deviation.interval ÷ sample_time = 1000000000 samples"), "{deviation}");
        assert_eq!(Settings::default().check(), Ok(()));
    }
}
