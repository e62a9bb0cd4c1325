//! The motion at every sample: displacement, velocity and acceleration from local polynomials.
//!
//! About every sample a polynomial of degree 3 is fitted to the readings of q and q̇ within ± `reach` samples, each
//! weighed by its noise (Savitzky and Golay, Analytical Chemistry 36 (1964), 1627, with both channels). The reach is
//! the longest at which the readings still lie about the polynomial as far as their noise explains.

use crate::diagnose::piece::Piece;
use nalgebra::{Matrix4, Vector4};

/// Reaches tried, samples on each side.
const REACHES: [usize; 11] = [2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64];

/// How much of the readings' scatter beyond their noise, as a share of its variance, is taken for noise.
const TOLERANCE: f64 = 0.01;

/// The same share, times the square root of the number of samples, for what chance does to the scatter.
const CHANCE: f64 = 4.0;

/// The motion of one piece; all slices are as long as the piece.
#[derive(Clone, Debug)]
pub struct Trajectory {
    /// Displacement. Where it is not measured it is the velocity's integral, about a mean of 0.
    pub q: Vec<f64>,
    /// Velocity.
    pub qd: Vec<f64>,
    /// Acceleration.
    pub qdd: Vec<f64>,
    /// Variance that the sensors' noise gives the velocity.
    pub velocity_variance: f64,
    /// Variance that the sensors' noise gives the acceleration.
    pub acceleration_variance: f64,
}

/// Weights that take readings to the polynomial's (q, q̇ dt, q̈ dt²) at sample `offset` of a stretch.
struct Kernel {
    q: Vec<[f64; 3]>,
    qd: Vec<[f64; 3]>,
}

impl Trajectory {
    /// The motion of every piece under this sensor noise (std of q and q̇).
    pub fn all(pieces: &[Piece], noise: [f64; 2]) -> Vec<Trajectory> {
        let reach = reach(pieces, noise);
        pieces.iter().map(|piece| Trajectory::of(piece, noise, reach)).collect()
    }

    fn of(piece: &Piece, noise: [f64; 2], reach: usize) -> Trajectory {
        let dt = spacing(piece);
        let count = piece.len();
        let reach = reach.min((count - 1) / 2);
        let length = 2 * reach + 1;
        let kernels: Vec<Kernel> = (0..length).map(|offset| Kernel::new(piece, noise, dt, length, offset)).collect();
        let mut motion = Trajectory {
            q: Vec::with_capacity(count),
            qd: Vec::with_capacity(count),
            qdd: Vec::with_capacity(count),
            velocity_variance: kernels[reach].variance(1, noise, dt) / dt.powi(2),
            acceleration_variance: kernels[reach].variance(2, noise, dt) / dt.powi(4),
        };
        for k in 0..count {
            let first = k.saturating_sub(reach).min(count - length);
            let [q, qd, qdd] = kernels[k - first].apply(piece, first, dt);
            motion.q.push(q);
            motion.qd.push(qd / dt);
            motion.qdd.push(qdd / (dt * dt));
        }
        if piece.q.is_none() {
            motion.q = integral(piece);
        }
        motion
    }
}

impl Kernel {
    fn new(piece: &Piece, noise: [f64; 2], dt: f64, length: usize, offset: usize) -> Kernel {
        let weight = weights(piece, noise, dt);
        let position = |k: usize| k as f64 - offset as f64;
        let mut information = Matrix4::<f64>::zeros();
        for x in (0..length).map(position) {
            for (row, weight) in [values(x), slopes(x)].into_iter().zip(weight) {
                information += weight * row * row.transpose();
            }
        }
        if piece.q.is_none() {
            information[(0, 0)] += 1.0;
        }
        let inverse = information.try_inverse().unwrap_or_else(Matrix4::zeros);
        let column = |row: Vector4<f64>, weight: f64| {
            let taken = inverse * row * weight;
            [taken[0], taken[1], 2.0 * taken[2]]
        };
        Kernel {
            q: (0..length).map(|k| column(values(position(k)), weight[0])).collect(),
            qd: (0..length).map(|k| column(slopes(position(k)), weight[1])).collect(),
        }
    }

    fn apply(&self, piece: &Piece, first: usize, dt: f64) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for (signal, kernel, scale) in [(&piece.q, &self.q, 1.0), (&piece.qd, &self.qd, dt)] {
            let Some(signal) = signal else { continue };
            for (value, weights) in signal[first..].iter().zip(kernel) {
                for (sum, weight) in sums.iter_mut().zip(weights) {
                    *sum += weight * value * scale;
                }
            }
        }
        sums
    }

    /// Variance of what is asked, in units of q, from noise of these std.
    fn variance(&self, which: usize, noise: [f64; 2], dt: f64) -> f64 {
        let sum = |weights: &[[f64; 3]]| weights.iter().map(|weight| weight[which].powi(2)).sum::<f64>();
        sum(&self.q) * noise[0].powi(2) + sum(&self.qd) * (noise[1] * dt).powi(2)
    }
}

/// 1, x, x², x³.
fn values(x: f64) -> Vector4<f64> {
    Vector4::new(1.0, x, x * x, x * x * x)
}

/// The derivative of [`values`].
fn slopes(x: f64) -> Vector4<f64> {
    Vector4::new(0.0, 1.0, 2.0 * x, 3.0 * x * x)
}

/// How much a reading of q and one of q̇ dt weigh; the largest is 1.
fn weights(piece: &Piece, noise: [f64; 2], dt: f64) -> [f64; 2] {
    match (&piece.q, &piece.qd) {
        (Some(_), None) => [1.0, 0.0],
        (None, _) => [0.0, 1.0],
        _ => {
            let (q, qd) = (noise[0].powi(2), (noise[1] * dt).powi(2));
            let least = q.min(qd).max(f64::MIN_POSITIVE);
            [least / q.max(least), least / qd.max(least)]
        }
    }
}

/// Mean distance of two samples, s.
fn spacing(piece: &Piece) -> f64 {
    (piece.t[piece.len() - 1] - piece.t[0]) / (piece.len() - 1) as f64
}

/// The longest reach at which the readings scatter about the polynomial no more than at the shortest, as far as their
/// noise explains.
fn reach(pieces: &[Piece], noise: [f64; 2]) -> usize {
    let shortest = scatter(pieces, noise, REACHES[0]);
    let count = pieces.iter().map(Piece::len).sum::<usize>() as f64;
    let allowed = TOLERANCE + CHANCE / count.sqrt();
    let fits = |reach: usize| {
        let ratios = scatter(pieces, noise, reach);
        ratios.iter().zip(shortest).all(|(ratio, shortest)| *ratio <= (1.0 + allowed) * shortest.max(1.0 - allowed))
    };
    let longest = pieces.iter().map(|piece| (piece.len() - 1) / 2).min().unwrap_or(REACHES[0]);
    REACHES.into_iter().rfind(|reach| *reach <= longest && fits(*reach)).unwrap_or(REACHES[0])
}

/// Scatter of the readings of q and q̇ about the polynomial ÷ what their noise explains; 0 where not measured.
fn scatter(pieces: &[Piece], noise: [f64; 2], reach: usize) -> [f64; 2] {
    [0, 1].map(|channel| {
        let (mut squares, mut expected) = (0.0, 0.0);
        for piece in pieces.iter().filter(|piece| 2 * reach < piece.len()) {
            let Some(signal) = piece.measured()[channel] else { continue };
            let kernel = Kernel::new(piece, noise, spacing(piece), 2 * reach + 1, reach);
            let (found, explained) = misfit(piece, signal, &kernel, channel, noise, reach);
            squares += found;
            expected += explained;
        }
        if expected > 0.0 { squares / expected } else { 0.0 }
    })
}

/// Sum of squared distances of the readings from the polynomial at its centre, and what noise alone would make of it.
fn misfit(piece: &Piece, signal: &[f64], kernel: &Kernel, channel: usize, noise: [f64; 2], reach: usize) -> (f64, f64) {
    let dt = spacing(piece);
    let scale = if channel == 0 { 1.0 } else { dt };
    let own = if channel == 0 { kernel.q[reach][0] } else { kernel.qd[reach][1] };
    let std = noise[channel] * scale;
    let each = std * std * (1.0 - 2.0 * own) + kernel.variance(channel, noise, dt);
    let centres = reach..piece.len() - reach;
    let count = centres.len() as f64;
    let squares = centres.map(|k| (signal[k] * scale - kernel.apply(piece, k - reach, dt)[channel]).powi(2));
    (squares.sum(), each * count)
}

/// Displacement of a measured velocity by the trapezoidal rule, its mean taken off.
fn integral(piece: &Piece) -> Vec<f64> {
    let qd = piece.qd.as_deref().unwrap_or_default();
    let mut q = vec![0.0; piece.len()];
    for k in 1..qd.len() {
        q[k] = q[k - 1] + 0.5 * (qd[k] + qd[k - 1]) * (piece.t[k] - piece.t[k - 1]);
    }
    let mean = q.iter().sum::<f64>() / q.len() as f64;
    q.iter().map(|value| value - mean).collect()
}
