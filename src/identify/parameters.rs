//! The settings that a user reaches by name: parameters of the FMU, options of the command line.

use super::settings::Settings;

/// A setting that is a number.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name: `noise.q`.
    pub name: &'static str,
    /// Its unit, where it has one.
    pub unit: Option<&'static str>,
    /// Smallest allowed value.
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
        *(self.field)(&mut Settings::default())
    }

    /// Puts its value into the settings; [`Settings::check`] judges it.
    pub fn set(&self, settings: &mut Settings, value: f64) {
        *(self.field)(settings) = value;
    }
}
