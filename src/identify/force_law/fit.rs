//! One law over a whole recording: the regression that the stream comes to, with the motion as all readings tell it.

use super::segment::Segment;
use crate::estimation::{FixedLagSmoother, Instant, LONGEST, MotionNoise};
use crate::identify::check::{BuildError, check};
use crate::identify::problem::Problem;
use crate::identify::recording::{Recording, settings_for};
use crate::identify::sample::Sample;
use crate::identify::settings::Settings;
use crate::law::{Model, State};

/// Times that the weights of the samples are renewed with the law that they gave: each changes them by the square of
/// what the one before did.
const ROUNDS: usize = 3;

/// A force law with numbers, and the motion that it was found on.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceFit {
    /// Coefficients in the order of the model's terms; 0 of a "maybe" term that the law does not have.
    pub coefficients: Vec<f64>,
    /// Std of what the law leaves.
    pub residual: f64,
    /// Whether that is white, as far as the recording tells.
    pub is_white: bool,
    /// Time, s, and motion at every sample but the few after a gap that tell none.
    pub motion: Vec<(f64, State)>,
}

/// Fits the model to a recording, `None` where that does not determine it.
///
/// # Errors
/// [`BuildError`] for a model or a recording that [`crate::identify::Identifier::new`] refuses.
pub fn fit_force_law(model: &Model, recording: &Recording) -> Result<Option<ForceFit>, BuildError> {
    let settings = settings_for(recording, Settings::default());
    check(model, &settings)?;
    let problem = Problem::new(model, &settings);
    let instants = believed(&settings, recording);
    let mut segment = Segment::new(&problem, settings.noise_excitation);
    for _ in 0..ROUNDS {
        segment.restart();
        for instant in &instants {
            if let Some(expected) = segment.expected(&problem, instant) {
                segment.add(&problem, instant, &expected);
            }
        }
        segment.solve(&problem, true);
    }
    let motion =
        instants.iter().map(|instant| (instant.t, State { q: instant.state[0], qd: instant.state[1] })).collect();
    Ok(segment.is_determined().then(|| ForceFit {
        coefficients: segment.coefficients().to_vec(),
        residual: segment.variance().sqrt(),
        is_white: !segment.is_coloured(),
        motion,
    }))
}

/// The motion of every piece between gaps.
fn believed(settings: &Settings, recording: &Recording) -> Vec<Instant> {
    let mut noise = MotionNoise::new(settings.channels.of_motion(), settings.sample_time);
    for piece in recording.pieces() {
        noise.interrupt();
        piece.for_each(|index| {
            let Sample { t, q, qd, .. } = recording.sample(index);
            noise.add(t, [q, qd]);
        });
    }
    let Some(beliefs) = noise.likeliest(settings.given_noise()) else { return Vec::new() };
    let mut instants = Vec::with_capacity(recording.count());
    for piece in recording.pieces() {
        let mut smoother = FixedLagSmoother::new();
        smoother.believe(beliefs);
        let count = piece.len();
        for index in piece {
            let sample = recording.sample(index);
            smoother.add(sample.t, [sample.q, sample.qd], sample.excitation);
            instants.extend(smoother.at(LONGEST));
        }
        instants.extend((0..LONGEST.min(count)).rev().filter_map(|lag| smoother.at(lag)));
    }
    instants
}
