//! The motion between and behind the readings: the posterior mean of a displacement whose fourth derivative is white.
//!
//! This is the smoothing spline of order 4 (Wahba, Spline Models for Observational Data, SIAM 1990, ch. 1; Kohn and
//! Ansley, Biometrika 74 (1987), 49), computed by a Kalman filter of (x, ẋ, ẍ, x⃛) and a smoother of Bryson and
//! Frazier's kind, so that instants may be anywhere and either reading of an instant may be absent. A velocity that
//! comes late by τ is read as ẋ − τ ẍ + τ²/2 x⃛.

type Vector = [f64; 4];
type Matrix = [Vector; 4];

/// Variance of the state at the first instant, beyond the guess of its beginning ÷ what the cutoff leaves of the noise.
const VAGUE: f64 = 1e6;

/// How the readings of a recording are to be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Std of the noise of q and q̇.
    pub noise: [f64; 2],
    /// How late q̇ is read, s.
    pub lag: f64,
    /// What q̇ is read as ÷ the derivative of q.
    pub scale: f64,
    /// Angular frequency up to which the motion is followed, rad/s.
    pub cutoff: f64,
}

impl Sensors {
    /// What a channel reads of a unit of what it measures.
    pub(crate) fn unit(&self, channel: usize) -> f64 {
        if channel == 0 { 1.0 } else { self.scale }
    }

    /// What a channel measures of position, velocity, acceleration and jerk.
    pub(crate) fn reading(&self, channel: usize, state: &[f64; 4]) -> f64 {
        dot(&row(channel, self.lag), state)
    }

    /// How late a channel is, s.
    pub(crate) fn lag(&self, channel: usize) -> f64 {
        if channel == 0 { 0.0 } else { self.lag }
    }
}

/// Position, velocity, acceleration and jerk at every instant, SI units.
pub(crate) type States = Vec<Vector>;

/// The gains of a record, ready for any readings at its instants.
#[derive(Clone, Debug)]
pub(crate) struct Spline {
    sensors: Sensors,
    steps: Vec<Step>,
    /// Σ ln variance of the innovations.
    log_determinant: f64,
}

#[derive(Clone, Debug)]
struct Step {
    /// Scaled time since the instant before.
    width: f64,
    gains: [Vector; 2],
    precision: [f64; 2],
    filtered: Matrix,
}

/// What a reading is of the state.
fn row(channel: usize, lag: f64) -> Vector {
    if channel == 0 { [1.0, 0.0, 0.0, 0.0] } else { [0.0, 1.0, -lag, 0.5 * lag * lag] }
}

impl Spline {
    /// The gains at instants `t`, s, at least two; `read` says which channels are read, `doubt` by what factor the
    /// variance of a reading of each channel is larger than usual (empty: none is).
    pub(crate) fn new(t: &[f64], sensors: Sensors, read: [bool; 2], doubt: [&[f64]; 2]) -> Spline {
        let omega = sensors.cutoff;
        let typical = (t[t.len() - 1] - t[0]) / (t.len() - 1) as f64;
        let variance = [sensors.noise[0].powi(2), (sensors.noise[1] / (sensors.scale * omega)).powi(2)];
        let precision: f64 = (0..2).filter(|channel| read[*channel]).map(|channel| variance[channel].recip()).sum();
        let intensity = omega * typical / precision;
        let mut covariance = [[0.0; 4]; 4];
        (0..4).for_each(|index| covariance[index][index] = VAGUE * intensity);
        let rows = [row(0, 0.0), row(1, sensors.lag * omega)];
        let mut spline = Spline { sensors, steps: Vec::with_capacity(t.len()), log_determinant: 0.0 };
        for k in 0..t.len() {
            let width = if k == 0 { 0.0 } else { omega * (t[k] - t[k - 1]) };
            if k > 0 {
                covariance = predicted(&covariance, width, intensity);
            }
            let mut step = Step { width, gains: [[0.0; 4]; 2], precision: [0.0; 2], filtered: covariance };
            for channel in (0..2).filter(|channel| read[*channel]) {
                let factor = doubt[channel].get(k).copied().unwrap_or(1.0);
                let own = apply(&covariance, &rows[channel]);
                let total = dot(&rows[channel], &own) + variance[channel] * factor;
                step.precision[channel] = total.recip();
                step.gains[channel] = own.map(|entry| entry / total);
                (0..4).for_each(|a| (0..4).for_each(|b| covariance[a][b] -= own[a] * own[b] / total));
                spline.log_determinant += total.ln();
            }
            step.filtered = covariance;
            spline.steps.push(step);
        }
        spline
    }

    /// −2 ln likelihood of the readings, a constant apart, under the noise level up to the given one that suits them
    /// best: differences of the readings hold all of the noise and some of the motion.
    pub(crate) fn deviance(&self, readings: [Option<&[f64]>; 2]) -> f64 {
        let (_, innovations) = self.filter(readings);
        let steps = innovations.iter().zip(&self.steps);
        let [squares, count] = steps.fold([0.0; 2], |[squares, count], (e, step)| {
            let own = e[0] * e[0] * step.precision[0] + e[1] * e[1] * step.precision[1];
            [squares + own, count + step.precision.iter().filter(|p| **p > 0.0).count() as f64]
        });
        let loudness = (squares / count).min(1.0);
        squares / loudness + count * loudness.ln() + self.log_determinant
    }

    /// The smoothed states.
    pub(crate) fn smooth(&self, readings: [Option<&[f64]>; 2]) -> States {
        let (mut states, innovations) = self.filter(readings);
        let omega = self.sensors.cutoff;
        let rows = [row(0, 0.0), row(1, self.sensors.lag * omega)];
        let mut adjoint = [0.0; 4];
        for k in (0..states.len()).rev() {
            let step = &self.steps[k];
            let shift = apply(&step.filtered, &adjoint);
            let state = &mut states[k];
            (0..4).for_each(|index| state[index] -= shift[index]);
            for channel in [1, 0] {
                if step.precision[channel] > 0.0 {
                    let taken = dot(&step.gains[channel], &adjoint) + innovations[k][channel] * step.precision[channel];
                    (0..4).for_each(|index| adjoint[index] -= rows[channel][index] * taken);
                }
            }
            adjoint = carried_back(step.width, &adjoint);
            *state = [state[0], state[1] * omega, state[2] * omega * omega, state[3] * omega * omega * omega];
        }
        states
    }

    /// The cubic through the readings of the first part of the motion, in scaled units.
    fn beginning(&self, readings: [Option<&[f64]>; 2]) -> Vector {
        let omega = self.sensors.cutoff;
        let rows = [row(0, 0.0), row(1, self.sensors.lag * omega)];
        let units = [1.0, (self.sensors.scale * omega).recip()];
        let mut gram = nalgebra::Matrix4::<f64>::zeros();
        let mut moment = nalgebra::Vector4::<f64>::zeros();
        let mut time = 0.0;
        for (k, step) in self.steps.iter().enumerate() {
            time += step.width;
            if k >= 8 && time > 1.0 {
                break;
            }
            for channel in 0..2 {
                let Some(values) = readings[channel] else { continue };
                let design = nalgebra::Vector4::from(carried_back(time, &rows[channel]));
                gram += design * design.transpose();
                moment += design * (values[k] * units[channel]);
            }
        }
        gram.pseudo_inverse(1e-10).map_or([0.0; 4], |inverse| (inverse * moment).into())
    }

    /// Filtered states in scaled units, and innovations.
    fn filter(&self, readings: [Option<&[f64]>; 2]) -> (States, Vec<[f64; 2]>) {
        let omega = self.sensors.cutoff;
        let rows = [row(0, 0.0), row(1, self.sensors.lag * omega)];
        let units = [1.0, (self.sensors.scale * omega).recip()];
        let mut state = self.beginning(readings);
        let mut states = Vec::with_capacity(self.steps.len());
        let mut innovations = Vec::with_capacity(self.steps.len());
        for (k, step) in self.steps.iter().enumerate() {
            state = carried(step.width, &state);
            let mut seen = [0.0; 2];
            for channel in 0..2 {
                let Some(values) = readings[channel].filter(|_| step.precision[channel] > 0.0) else { continue };
                seen[channel] = values[k] * units[channel] - dot(&rows[channel], &state);
                (0..4).for_each(|index| state[index] += step.gains[channel][index] * seen[channel]);
            }
            states.push(state);
            innovations.push(seen);
        }
        (states, innovations)
    }
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn apply(a: &Matrix, x: &Vector) -> Vector {
    std::array::from_fn(|row| dot(&a[row], x))
}

/// Taylor's series over a scaled time.
fn carried(h: f64, x: &Vector) -> Vector {
    [x[0] + h * (x[1] + h * (0.5 * x[2] + h / 6.0 * x[3])), x[1] + h * (x[2] + 0.5 * h * x[3]), x[2] + h * x[3], x[3]]
}

/// The transposed of [`carried`].
fn carried_back(h: f64, x: &Vector) -> Vector {
    [x[0], x[1] + h * x[0], x[2] + h * (x[1] + 0.5 * h * x[0]), x[3] + h * (x[2] + h * (0.5 * x[1] + h / 6.0 * x[0]))]
}

/// The covariance after a scaled time with a white fourth derivative of that intensity.
fn predicted(covariance: &Matrix, h: f64, intensity: f64) -> Matrix {
    const FACTORIAL: Vector = [6.0, 2.0, 1.0, 1.0];
    let half: Matrix = std::array::from_fn(|row| carried(h, &covariance[row]));
    let mut full = [[0.0; 4]; 4];
    for column in 0..4 {
        let moved = carried(h, &std::array::from_fn(|row| half[row][column]));
        (0..4).for_each(|row| full[row][column] = moved[row]);
    }
    for a in 0..4 {
        for b in 0..4 {
            let power = 7 - a - b;
            full[a][b] += intensity * h.powi(power as i32) / (power as f64 * FACTORIAL[a] * FACTORIAL[b]);
        }
    }
    // rounding that is not the same on both sides would grow from step to step
    std::array::from_fn(|a| std::array::from_fn(|b| 0.5 * (full[a][b] + full[b][a])))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A motion sampled coarsely, with lost samples, and what is read of it.
    fn readings(distance: f64, noise: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let mut noise_state = 1u64;
        let mut draw = || {
            noise_state = noise_state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((noise_state >> 33) as f64 / (1u64 << 31) as f64 - 0.5) * 12f64.sqrt() * noise
        };
        let t: Vec<f64> = (0..20_000).filter(|k| k % 31 != 7).map(|k| f64::from(k) * distance).collect();
        let q = t.iter().map(|t| t.sin() + 0.3 * (2.3 * t).cos() + draw()).collect();
        let qd = t.iter().map(|t| t.cos() - 0.69 * (2.3 * t).sin() + draw()).collect();
        (t, q, qd)
    }

    fn worst(states: &States, t: &[f64], order: usize) -> f64 {
        let truth = |t: f64| match order {
            0 => t.sin() + 0.3 * (2.3 * t).cos(),
            1 => t.cos() - 0.69 * (2.3 * t).sin(),
            _ => -t.sin() - 1.587 * (2.3 * t).cos(),
        };
        let inner = states.iter().zip(t).skip(100).take(t.len() - 200);
        inner.map(|(state, t)| (state[order] - truth(*t)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_motion_is_followed_whatever_the_cutoff_and_whichever_channel_is_read() {
        let (t, q, qd) = readings(0.02, 1e-3);
        for cutoff in [8.0, 20.0, 60.0, 94.0] {
            for read in [[true, false], [true, true]] {
                let sensors = Sensors { noise: [1e-3; 2], lag: 0.0, scale: 1.0, cutoff };
                let spline = Spline::new(&t, sensors, read, [&[], &[]]);
                let states = spline.smooth([Some(&q), read[1].then_some(&qd)]);
                assert!(worst(&states, &t, 0) < 5e-3, "q at {cutoff}: {}", worst(&states, &t, 0));
                assert!(worst(&states, &t, 1) < 0.2, "q̇ at {cutoff}: {}", worst(&states, &t, 1));
            }
        }
    }
}
