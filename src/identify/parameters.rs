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
    field: fn(&mut Settings) -> &mut f64,
}

impl Parameter {
    /// Every parameter, in the order in which it is listed.
    pub const ALL: [Parameter; 11] = [
        Parameter {
            name: "noise.q",
            unit: None,
            min: 0.0,
            description: "Std of the sensor noise on q; 0 = estimated from the data",
            field: |settings| &mut settings.noise_q,
        },
        Parameter {
            name: "noise.qd",
            unit: None,
            min: 0.0,
            description: "Std of the sensor noise on qd; 0 = estimated from the data",
            field: |settings| &mut settings.noise_qd,
        },
        Parameter {
            name: "noise.F",
            unit: None,
            min: 0.0,
            description: "Std of the sensor noise on F; 0 = F is exact",
            field: |settings| &mut settings.noise_excitation,
        },
        Parameter {
            name: "false_alarm_interval",
            unit: Some("s"),
            min: 1e-3,
            description: "Mean time between two false alarms that is tolerated; longer = fewer of them, later detection",
            field: |settings| &mut settings.false_alarm_interval,
        },
        Parameter {
            name: "initial_window",
            unit: Some("s"),
            min: 0.0,
            description: "Record from which the first law is identified; 0 = as soon as the data allow",
            field: |settings| &mut settings.initial_window,
        },
        Parameter {
            name: "deviation.interval",
            unit: Some("s"),
            min: 1e-6,
            description: "Interval T over which the deviation of prediction from observation is averaged",
            field: |settings| &mut settings.deviation_interval,
        },
        Parameter {
            name: "deviation.threshold",
            unit: None,
            min: 0.0,
            description: "Deviation that raises an alarm; 0 = automatic",
            field: |settings| &mut settings.deviation_threshold,
        },
        Parameter {
            name: "weight.q",
            unit: None,
            min: 0.0,
            description: "Weight of q in the deviation",
            field: |settings| &mut settings.weight_q,
        },
        Parameter {
            name: "weight.qd",
            unit: None,
            min: 0.0,
            description: "Weight of qd in the deviation",
            field: |settings| &mut settings.weight_qd,
        },
        Parameter {
            name: "sample_time",
            unit: Some("s"),
            min: 1e-9,
            description: "Usual time between two samples: with max_window it fixes the memory; a sample sooner than half of it after the \
                          last one is left out",
            field: |settings| &mut settings.sample_time,
        },
        Parameter {
            name: "max_window",
            unit: Some("s"),
            min: 1e-6,
            description: "Record kept to refine the law on; with sample_time it fixes the memory",
            field: |settings| &mut settings.max_window,
        },
    ];

    /// The parameter of that name.
    pub fn from_name(name: &str) -> Option<&'static Parameter> {
        const ALL: &[Parameter] = &Parameter::ALL;
        ALL.iter().find(|parameter| parameter.name == name)
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
