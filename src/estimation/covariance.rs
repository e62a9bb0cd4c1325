//! The two steps of every Kalman filter on its covariance P, row-major and symmetric.
//!
//! Of N states that move and n constants c beside them, x⁺ = A x + B c, an interval makes Φ P Φᵀ + Q with
//! Φ = [A B; 0 1]; a measurement of state i with noise R makes P − K s Kᵀ with s = Pᵢᵢ + R and the gain K = P eᵢ ÷ s
//! (Särkkä, *Bayesian Filtering and Smoothing*, 2013, eq. 4.20 and 4.21).

/// N × N, row by row.
pub type Matrix<const N: usize> = [[f64; N]; N];

/// P over an interval: `map` is A, `inputs` are the columns of B, `noise` is Q; `moved` is room for N columns of P.
#[inline(always)]
pub(super) fn carry<const N: usize>(
    covariance: &mut [f64],
    moved: &mut [[f64; N]],
    map: impl Fn([f64; N]) -> [f64; N],
    inputs: &[[f64; N]],
    noise: &Matrix<N>,
) {
    let size = moved.len();
    // [A B] P, row by row of the symmetric P
    for (entries, row) in moved.iter_mut().zip(covariance.chunks_exact(size)) {
        *entries = map(std::array::from_fn(|state| row[state]));
        add(entries, inputs, &row[N..]);
    }
    for (row, noise) in noise.iter().enumerate() {
        let mut block = map(std::array::from_fn(|column| moved[column][row]));
        for (input, entries) in inputs.iter().zip(&moved[N..]) {
            block.iter_mut().zip(input).for_each(|(sum, input)| *sum += input * entries[row]);
        }
        for column in row..size {
            let entry = if column < N { block[column] + noise[column] } else { moved[column][row] };
            (covariance[row * size + column], covariance[column * size + row]) = (entry, entry);
        }
    }
}

/// Adds B c.
#[inline(always)]
fn add<const N: usize>(sums: &mut [f64; N], inputs: &[[f64; N]], constants: &[f64]) {
    for (input, constant) in inputs.iter().zip(constants) {
        sums.iter_mut().zip(input).for_each(|(sum, input)| *sum += input * constant);
    }
}

/// P after a measurement of state `place` with noise `variance`; `column` is the state's column of P before it, `gain`
/// that column ÷ (its own entry + `variance`).
#[inline(always)]
pub(super) fn correct(covariance: &mut [f64], column: &[f64], gain: &[f64], place: usize, variance: f64) {
    let size = column.len();
    for (row, (entries, own)) in covariance.chunks_exact_mut(size).zip(gain).enumerate() {
        for (entry, other) in entries.iter_mut().zip(column) {
            *entry -= own * other;
        }
        entries[row] = entries[row].max(0.0);
    }
    // K R is what is left of the measured state's row: the difference of two large numbers, exactly
    for (other, gain) in gain.iter().enumerate() {
        (covariance[place * size + other], covariance[other * size + place]) = (gain * variance, gain * variance);
    }
}
