//! The motion of a recording, its sensors, and how fast it is.

use super::kinematics::Kinematics;
use super::noise::sensor_noise;
use super::spline::{Sensors, Spline};
use super::track::{Track, UNREAD, follow, readings, track};
use crate::diagnose::piece::Piece;
use crate::diagnose::piece::thinned;
use crate::identify::Recording;
use crate::law::{Hold, State};
use std::f64::consts::{PI, TAU};

/// Ratio between the cutoffs that are tried.
const RATIO: f64 = 1.5;

/// Factor by which the likeliest cutoff is raised: one that is too low biases coefficients, one that is too high lets a
/// little more noise in.
const MARGIN: f64 = 1.5;

/// −2 ln likelihood by which a q̇ that comes late must be likelier than a punctual one, as most are, and one that reads
/// another scale than one that is calibrated: chance gives it once in 10⁴.
const PRICE: f64 = 15.0;

/// Samples from which the cutoff is chosen, at most.
const LOOKED_AT: usize = 4000;

/// Highest cutoff relative to half the sampling frequency.
const NYQUIST: f64 = 0.9;

/// Angular frequency up to which the motion counts for its period, in its own: what the shortest window of the judge
/// resolves.
const RESOLVED: f64 = 10.0;

/// Smallest noise std ÷ range of a channel: rounding of the numbers in a file.
const ROUNDED: f64 = 1e-7;

/// The motion of one recording.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Motion {
    /// What q̇ is of q; none where one of them is absent.
    pub(in crate::diagnose) kinematics: Option<Kinematics>,
    /// How its readings are taken.
    pub(in crate::diagnose) sensors: Sensors,
    /// Its pieces.
    pub(in crate::diagnose) pieces: Vec<Piece>,
    /// Their motions.
    pub(in crate::diagnose) tracks: Vec<Track>,
}

impl Motion {
    /// Of a recording whose excitation did this between samples. None where no piece has samples enough.
    pub(in crate::diagnose) fn of(recording: &Recording, hold: Hold) -> Option<Motion> {
        let pieces = Piece::all(recording, hold);
        let pieces: Vec<Piece> = pieces.into_iter().filter(|piece| piece.len() >= Recording::MINIMUM).collect();
        let first = pieces.first()?;
        let has = first.measured().map(|channel| channel.is_some());
        let noise = noise_levels(&pieces);
        let blank = Sensors { noise, lag: 0.0, scale: 1.0, cutoff: 1.0 };
        let single = [has[0], has[1] && !has[0]];
        let sensors = likeliest(&pieces, blank, single);
        let tracks = follow(&pieces, sensors, single);
        let motion = Motion { kinematics: None, sensors, pieces, tracks };
        Some(if has == [true, true] { motion.with_velocity() } else { motion })
    }

    /// With the readings of q̇, where they are a measurement of their own.
    fn with_velocity(self) -> Motion {
        let Some(kinematics) = Kinematics::of(&self.pieces, &self.tracks, self.sensors) else { return self };
        if kinematics.is_derivative || !kinematics.is_velocity() {
            return Motion { kinematics: Some(kinematics), ..self };
        }
        let both = [true, true];
        let late = Sensors { lag: kinematics.lag, scale: kinematics.scale, ..self.sensors };
        let late = likeliest(&self.pieces, late, both);
        let of = |[lag, scale]: [f64; 2]| Sensors { lag, scale, ..late };
        let priced = |by: f64, values: [f64; 2]| (deviance(&self.pieces, of(values), both) + by * PRICE, values);
        let all = [
            priced(0.0, [0.0, 1.0]),
            priced(1.0, [late.lag, 1.0]),
            priced(1.0, [0.0, late.scale]),
            priced(2.0, [late.lag, late.scale]),
        ];
        let likeliest = all.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let sensors = likeliest.map_or(late, |(_, values)| of(values));
        let tracks = follow(&self.pieces, sensors, both);
        Motion { kinematics: Some(kinematics), sensors, tracks, ..self }
    }

    /// Where it begins and ends, s.
    pub(in crate::diagnose) fn span(&self) -> [f64; 2] {
        let ends = self.pieces.first().and_then(|piece| piece.t.first());
        let last = self.pieces.last().and_then(|piece| piece.t.last());
        [ends, last].map(|t| t.copied().unwrap_or_default())
    }

    /// The smoothed motion as its sensors would read it without noise.
    pub(in crate::diagnose) fn as_followed(&self) -> Motion {
        let mut motion = self.clone();
        for (piece, track) in motion.pieces.iter_mut().zip(&self.tracks) {
            for (channel, values) in [&mut piece.q, &mut piece.qd].into_iter().enumerate() {
                let read = |state| self.sensors.unit(channel) * self.sensors.reading(channel, state);
                let all = || track.states.iter().map(read).collect();
                *values = values.as_ref().filter(|_| track.read[channel]).map(|_| all()).or_else(|| values.take());
            }
        }
        motion
    }

    /// The motion as every second reading shows it, from the first or from the second on.
    pub(in crate::diagnose) fn half(&self, first: usize) -> Motion {
        let tracks = self.pieces.iter().zip(&self.tracks).map(|(piece, whole)| {
            let doubt = [0, 1].map(|channel| {
                let usual = |k: usize| whole.doubt[channel].get(k).copied().unwrap_or(1.0);
                (0..piece.len()).map(|k| if k % 2 == first { usual(k) } else { UNREAD }).collect()
            });
            track(piece, self.sensors, whole.read, doubt)
        });
        Motion { tracks: tracks.collect(), ..self.clone() }
    }

    /// (q, q̇) at every sample, piece by piece.
    pub(in crate::diagnose) fn states(&self) -> impl Iterator<Item = Vec<State>> {
        let state = |own: &[f64; 4]| State { q: own[0], qd: own[1] };
        self.tracks.iter().map(move |track| track.states.iter().map(state).collect())
    }

    /// Σ ẋ² and Σ ẍ² of the motion followed up to an angular frequency, rad/s.
    fn powers(&self, cutoff: f64) -> [f64; 2] {
        let read = self.tracks.first().map_or([true; 2], |track| track.read);
        let cutoff = cutoff.min(self.sensors.cutoff);
        let tracks = follow(&self.pieces, Sensors { cutoff, ..self.sensors }, read);
        let states = || tracks.iter().flat_map(|track| &track.states);
        [1, 2].map(|order| states().map(|state| state[order] * state[order]).sum())
    }
}

/// T₀ = 2π rms q̇ ÷ rms q̈, s, of the motion followed up to ten times its own frequency: what lies beyond is no motion
/// that a window of the judge could see. Not finite where nothing moves.
pub(in crate::diagnose) fn period(motions: &[Motion]) -> f64 {
    let highest = motions.iter().map(|motion| motion.sensors.cutoff).fold(0.0, f64::max);
    let (mut cutoff, mut period) = (highest, f64::NAN);
    for _ in 0..20 {
        let sums = motions.iter().map(|motion| motion.powers(cutoff)).fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        period = TAU * (sums[0] / sums[1]).sqrt();
        let next = RESOLVED * TAU / period;
        if next.is_nan() || next >= 0.97 * cutoff {
            break;
        }
        cutoff = next;
    }
    period
}

/// Noise std of both channels, at least what the numbers of a file are rounded to.
fn noise_levels(pieces: &[Piece]) -> [f64; 2] {
    let noise = sensor_noise(pieces);
    [0, 1].map(|channel| {
        let values = || pieces.iter().filter_map(|piece| piece.measured()[channel]).flatten();
        let [low, high] =
            [values().fold(f64::INFINITY, |a, b| a.min(*b)), values().fold(f64::NEG_INFINITY, |a, b| a.max(*b))];
        noise[channel].max(ROUNDED * (high - low)).max(f64::MIN_POSITIVE.sqrt())
    })
}

/// −2 ln likelihood of all readings, a constant apart.
fn deviance(pieces: &[Piece], sensors: Sensors, read: [bool; 2]) -> f64 {
    let of = |piece: &Piece| Spline::new(&piece.t, sensors, read, [&[], &[]]).deviance(readings(piece, read));
    pieces.iter().map(of).sum()
}

/// The sensors with the cutoff under which the readings are likeliest, with a margin.
fn likeliest(pieces: &[Piece], sensors: Sensors, read: [bool; 2]) -> Sensors {
    let parts = thinned(pieces, LOOKED_AT);
    let duration = |piece: &Piece| piece.t[piece.len() - 1] - piece.t[0];
    let distance = pieces.iter().map(|piece| duration(piece) / (piece.len() - 1) as f64).fold(f64::INFINITY, f64::min);
    let top = NYQUIST * PI / distance;
    // a motion slower than the parts that are looked at is a polynomial in each of them, whatever the cutoff
    let least = 2.0 * TAU / parts.iter().map(duration).fold(0.0, f64::max);
    let at = |cutoff: f64| deviance(&parts, Sensors { cutoff, ..sensors }, read);
    let cutoffs = std::iter::successors(Some(top), |cutoff| Some(cutoff / RATIO)).take_while(|cutoff| *cutoff > least);
    let best = cutoffs.map(|cutoff| (at(cutoff), cutoff)).min_by(|a, b| a.0.total_cmp(&b.0));
    let cutoff = best.map_or(top, |(_, cutoff)| cutoff);
    Sensors { cutoff: (MARGIN * cutoff).min(top), ..sensors }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn a_velocity_of_its_own_is_none_of_a_noisy_displacement_however_coarse() {
        for per_period in [25.0, 60.0, 400.0] {
            let mut random = ChaCha8Rng::seed_from_u64(1);
            let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
            let t: Vec<f64> = (0..4000).map(|k| std::f64::consts::TAU / per_period * f64::from(k)).collect();
            let q: Vec<f64> = t.iter().map(|t| t.sin() + 0.3 * (2.7 * t).cos() + 1e-3 * noise()).collect();
            let own: Vec<f64> = t.iter().map(|t| t.cos() - 0.81 * (2.7 * t).sin() + 1e-3 * noise()).collect();
            let between = |k: usize| (q[k.min(3998) + 1] - q[k.max(1) - 1]) / (t[k.min(3998) + 1] - t[k.max(1) - 1]);
            let computed: Vec<f64> = (0..4000).map(between).collect();
            let is_derivative = |qd: Vec<f64>| {
                let recording = Recording::new("q", t.clone(), Some(q.clone()), Some(qd), None).unwrap();
                Motion::of(&recording, Hold::Linear).unwrap().kinematics.unwrap().is_derivative
            };
            assert_eq!((is_derivative(own), is_derivative(computed)), (false, true), "{per_period} a period");
        }
    }

    /// Differences of q behind a low-pass of second order at a fifth of half the sampling frequency, which delays the
    /// motion by a twentieth of its period and more where it is faster; three in a hundred readings are lost. The
    /// filter had been running when the record began.
    #[test]
    fn a_velocity_computed_from_a_fast_displacement_through_a_filter_is_none_of_its_own() {
        let mut random = ChaCha8Rng::seed_from_u64(2);
        let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
        let t: Vec<f64> = (0..4000).map(|k| 5e-3 * f64::from(k)).collect();
        let phase = |t: f64| 18.0 * t + 0.4 * t * t;
        let q: Vec<f64> =
            t.iter().map(|t| ((phase(*t).sin() + 0.2 * (40.0 * t).cos()) * 500.0).floor() / 500.0).collect();
        let differences: Vec<f64> = (0..4000).map(|k| (q[k] - q[k.max(1) - 1]) / 5e-3).collect();
        let exact = |t: &f64| (18.0 + 0.8 * t) * phase(*t).cos() - 8.0 * (40.0 * t).sin();
        let own: Vec<f64> = t.iter().map(|t| exact(t) + 0.1 * noise()).collect();
        let low_passed = |signal: &[f64]| {
            let k = (0.1 * PI).tan();
            let scale = (1.0 + 2.0_f64.sqrt() * k + k * k).recip();
            let mut state = [0.0; 2];
            let mut next = |value: &f64| {
                let output = k * k * scale * value + state[0];
                state = [
                    2.0 * k * k * scale * value - 2.0 * (k * k - 1.0) * scale * output + state[1],
                    k * k * scale * value - (1.0 - 2.0_f64.sqrt() * k + k * k) * scale * output,
                ];
                output
            };
            signal.iter().map(&mut next).collect::<Vec<f64>>()
        };
        let kept = |signal: &[f64]| -> Vec<f64> {
            signal.iter().enumerate().filter(|(k, _)| *k > 100 && (k * 37) % 100 > 2).map(|(_, value)| *value).collect()
        };
        let is_derivative = |qd: Vec<f64>| {
            let recording = Recording::new("q", kept(&t), Some(kept(&q)), Some(kept(&qd)), None).unwrap();
            Motion::of(&recording, Hold::Linear).unwrap().kinematics.unwrap().is_derivative
        };
        assert_eq!((is_derivative(low_passed(&own)), is_derivative(low_passed(&differences))), (false, true));
    }
}
