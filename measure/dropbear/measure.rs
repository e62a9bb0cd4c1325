//! DROPBEAR through the streaming identifier, and what came of it against the measured roller.
//!
//! The beam's first bending mode is q̈ + c q̇ + k q = const, q the strain in V. Its stiffness is known from the
//! roller's position r (V): k = 24766 − 4346 r + 5009 r², (rad/s)². The identifier sees the strain alone.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;
use switchid::identify::{Recording, Settings, identify_recording, settings_for};
use switchid::law::{Given, Model, Term};
use switchid::weak::Variation;

pub type Failure = Box<dyn Error + Send + Sync>;

/// Until then the beam is still, s.
pub const STILL_UNTIL: f64 = 0.6;

/// From then on it moves, s.
pub const MOVES_FROM: f64 = 0.7;

/// Samples in a window of the residual.
const WINDOW: usize = 251;

/// The record, one entry per sample.
pub struct Beam {
    /// Time, s.
    pub t: Vec<f64>,
    /// Strain, V.
    pub strain: Vec<f64>,
    /// What the roller says of the frequency, Hz.
    pub frequency: Vec<f64>,
}

/// What the identifier had validated after a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// c, 1/s.
    pub damping: f64,
    /// k, (rad/s)².
    pub stiffness: f64,
    /// Std of k as published.
    pub std: f64,
}

impl Mode {
    /// √k ÷ 2π, Hz.
    pub fn frequency(&self) -> f64 {
        self.stiffness.sqrt() / TAU
    }

    /// Its std, Hz.
    pub fn frequency_std(&self) -> f64 {
        0.5 * self.std / self.stiffness.sqrt() / TAU
    }
}

/// The figures of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Share of the time from [`MOVES_FROM`] on for which a law was valid.
    pub identified: f64,
    /// The same until [`STILL_UNTIL`].
    pub identified_still: f64,
    /// Median of the relative error of the frequency while identified.
    pub median: f64,
    /// Its 90th percentile.
    pub ninth_decile: f64,
    /// RMS of the weak residual over windows of 251 samples under the law known at their start ÷ RMS of the inertia's
    /// integral.
    pub residual: f64,
    /// Mean of (error ÷ stated std)² of the stiffness.
    pub normalised_error: f64,
}

/// Reads the record.
pub fn read(path: &Path) -> Result<Beam, Failure> {
    let mut reader = csv::Reader::from_path(path)?;
    let names = reader.headers()?.clone();
    let column = |name: &str| names.iter().position(|found| found == name).ok_or(format!("no column \"{name}\""));
    let [t, strain, roller] = [column("time_s")?, column("strain_a_V")?, column("roller_V")?];
    let mut beam = Beam { t: Vec::new(), strain: Vec::new(), frequency: Vec::new() };
    for row in reader.records() {
        let row = row?;
        let position: f64 = row[roller].parse()?;
        beam.t.push(row[t].parse()?);
        beam.strain.push(row[strain].parse()?);
        beam.frequency.push((24766.0 - 4346.0 * position + 5009.0 * position * position).sqrt() / TAU);
    }
    Ok(beam)
}

/// Runs the default identifier over the strain; after every sample the mode of its valid law.
pub fn identify(beam: &Beam) -> Result<Vec<Option<Mode>>, Failure> {
    let terms = [Term::Inertia, Term::power(0, 1), Term::power(1, 0), Term::power(0, 0)];
    let model = Model::of("beam with a roller", terms.into_iter().map(|term| (term, Given::Fit)));
    let recording = Recording::new("DROPBEAR", beam.t.clone(), Some(beam.strain.clone()), None, None)?;
    let mut modes = Vec::with_capacity(beam.t.len());
    identify_recording(&model, settings_for(&recording, Settings::default()), &recording, |identifier, _| {
        let [_, damping, stiffness, _] = identifier.coefficients() else { return };
        let known = stiffness.std.filter(|_| identifier.output().valid && stiffness.value > 0.0);
        modes.push(known.map(|std| Mode { damping: damping.value, stiffness: stiffness.value, std }));
    })?;
    Ok(modes)
}

/// The figures of what was identified.
pub fn figures(beam: &Beam, modes: &[Option<Mode>]) -> Figures {
    let share = |range: &dyn Fn(f64) -> bool| {
        let chosen: Vec<bool> = (0..modes.len()).filter(|k| range(beam.t[*k])).map(|k| modes[k].is_some()).collect();
        chosen.iter().filter(|known| **known).count() as f64 / chosen.len() as f64
    };
    let known = || (0..modes.len()).filter(|k| beam.t[*k] > MOVES_FROM).filter_map(|k| Some((k, modes[k]?)));
    let mut errors: Vec<f64> = known().map(|(k, mode)| (mode.frequency() / beam.frequency[k] - 1.0).abs()).collect();
    errors.sort_by(f64::total_cmp);
    let quantile = |share: f64| errors.get((share * errors.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    let normalised = known().map(|(k, mode)| ((mode.stiffness - (TAU * beam.frequency[k]).powi(2)) / mode.std).powi(2));
    Figures {
        identified: share(&|t| t > MOVES_FROM),
        identified_still: share(&|t| t < STILL_UNTIL),
        median: quantile(0.5),
        ninth_decile: quantile(0.9),
        residual: residual(beam, modes),
        normalised_error: normalised.sum::<f64>() / errors.len() as f64,
    }
}

/// Over all windows from [`MOVES_FROM`] on at whose start a law was valid, against one variation with ∫ φ dt = 0, which
/// the offset of the strain does not enter.
fn residual(beam: &Beam, modes: &[Option<Mode>]) -> f64 {
    let length = beam.t[WINDOW - 1] - beam.t[0];
    let variation = Variation::SmoothSine { mode: 2 };
    let phi: Vec<[f64; 3]> = (0..WINDOW)
        .map(|k| variation.at(k as f64 / (WINDOW - 1) as f64))
        .map(|[value, slope, curvature]| [value, slope / length, curvature / (length * length)])
        .collect();
    let (mut left, mut inertia) = (0.0, 0.0);
    for (start, window) in beam.strain.windows(WINDOW).enumerate() {
        let Some(mode) = modes[start].filter(|_| beam.t[start] > MOVES_FROM) else { continue };
        let integral = |order: usize| window.iter().zip(&phi).map(|(q, phi)| q * phi[order]).sum::<f64>();
        let [by_q, by_qd, by_qdd] = [integral(0), -integral(1), integral(2)];
        left += (by_qdd + mode.damping * by_qd + mode.stiffness * by_q).powi(2);
        inertia += by_qdd * by_qdd;
    }
    (left / inertia).sqrt()
}
