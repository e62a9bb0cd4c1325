//! Whether an improvement could be chance, whatever the error is like.
//!
//! The record is cut into blocks of at least one correlation length of the residual. Were an effect not there, its gain
//! in each block would as likely have the other sign: random signs over the blocks, the same for all candidates, tell
//! how large the largest total gain of any candidate would be by chance (a randomisation test: Fisher, The Design of
//! Experiments, 1935, sect. 21; the maximum over candidates: Westfall and Young, Resampling-Based Multiple Testing,
//! Wiley 1993).

use super::held_out::HeldOut;
use super::record::Record;
use super::windows::{COUNT, PRINCIPAL, Windows};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Numbers of blocks, the largest that fits is taken.
const BLOCKS: [usize; 3] = [32, 16, 8];

/// Patterns of signs that are drawn: a chance of one in a hundred is then known to a fifth.
const DRAWS: usize = 2000;

/// Autocorrelation down to which residuals belong together: 1 ÷ e, the usual correlation length.
const CORRELATED: f64 = 0.37;

/// How a record is cut for the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::diagnose) struct Blocks {
    /// How many; none where the record is too short for eight.
    pub(in crate::diagnose) count: Option<usize>,
    /// Length of the record, s.
    duration: f64,
}

impl Blocks {
    /// Blocks of at least the residual's correlation length and three tenths of T₀.
    pub(in crate::diagnose) fn new(record: &Record, residual: &HeldOut) -> Blocks {
        let least = correlation_length(record, residual).max(0.3 * record.period);
        let fits = |count: &&usize| record.duration / **count as f64 >= least;
        Blocks { count: BLOCKS.iter().find(fits).copied(), duration: record.duration }
    }

    /// The block of an instant; as many as there are, eight where there are too few for a test.
    pub(in crate::diagnose) fn of(&self, centre: f64) -> usize {
        let count = self.len();
        ((centre / self.duration * count as f64) as usize).min(count - 1)
    }

    /// Number of blocks over which a covariance is summed.
    pub(in crate::diagnose) fn len(&self) -> usize {
        self.count.unwrap_or(BLOCKS[BLOCKS.len() - 1])
    }

    /// ½ ln(loss before ÷ loss after) in every block, the mean over window lengths and their test functions: each
    /// function sees a band of frequencies, and where the error is small a little less of it says as much as a lot less
    /// where it is large.
    pub(in crate::diagnose) fn gains(&self, record: &Record, before: &HeldOut, after: &HeldOut) -> Vec<f64> {
        let mut gains = vec![0.0; self.len()];
        for (which, windows) in record.windows.iter().enumerate() {
            for function in 0..windows.functions {
                let [before, after] =
                    self.losses(windows, function, [before, after].map(|held| &held.residuals[which]));
                let own = log_ratios(&before, &after);
                let share = 0.5 / (COUNT * windows.functions) as f64;
                gains.iter_mut().zip(own).for_each(|(gain, own)| *gain += share * own);
            }
        }
        gains
    }

    /// Σ residual² of one test function in every block, of two laws over the equations that both tell.
    fn losses(&self, windows: &Windows, function: usize, residuals: [&Vec<f64>; 2]) -> [Vec<f64>; 2] {
        let mut losses = [0, 1].map(|_| vec![0.0; self.len()]);
        let own = residuals[0].iter().zip(residuals[1]).enumerate().skip(function).step_by(windows.functions);
        for (row, (before, after)) in own.filter(|(_, (before, after))| before.is_finite() && after.is_finite()) {
            let block = self.of(windows.centre(row));
            losses[0][block] += before * before;
            losses[1][block] += after * after;
        }
        losses
    }

    /// Probability of each candidate's total gain by chance, all of them having been tried. None where there are too
    /// few blocks.
    pub(in crate::diagnose) fn p_values(&self, gains: &[Vec<f64>]) -> Option<Vec<f64>> {
        let count = self.count?;
        let mut random = ChaCha8Rng::seed_from_u64(count as u64);
        let drawn = (0..DRAWS).map(|_| random.next_u64());
        // eight blocks have so few patterns of signs that all are looked at; the record's own is one of them
        let patterns: Vec<u64> = match 1_usize << count.min(BLOCKS[0]) {
            all if all <= DRAWS => (0..all as u64).collect(),
            _ => [0].into_iter().chain(drawn).collect(),
        };
        let totals: Vec<f64> = gains.iter().map(|own| own.iter().sum()).collect();
        let mut reached = vec![0.0; gains.len()];
        for bits in &patterns {
            let sign = |block: usize| if bits >> block & 1 == 1 { -1.0 } else { 1.0 };
            let total = |own: &Vec<f64>| own.iter().enumerate().map(|(block, gain)| sign(block) * gain).sum::<f64>();
            let largest = gains.iter().map(total).fold(f64::NEG_INFINITY, f64::max);
            let reaches = totals.iter().zip(&mut reached).filter(|(own, _)| largest >= **own);
            reaches.for_each(|(_, reached)| *reached += 1.0);
        }
        Some(reached.into_iter().map(|reached| reached / patterns.len() as f64).collect())
    }
}

/// ln(before ÷ after) of every block's loss, which is its own and the usual one's mean: what a few readings of slow
/// motion say of the error's size is little, and one bad stretch does not decide either (the log loss of a Student
/// distribution, whose variance has the record's as its prior: Gelman et al., Bayesian Data Analysis, 2013, sect. 2.6).
fn log_ratios(before: &[f64], after: &[f64]) -> Vec<f64> {
    let usual = after.iter().sum::<f64>() / after.len() as f64;
    let ratio = |(before, after): (&f64, &f64)| ((before + usual) / (after + usual)).ln();
    if usual > 0.0 { before.iter().zip(after).map(ratio).collect() } else { vec![0.0; before.len()] }
}

/// How long residuals of the principal windows belong together, s.
fn correlation_length(record: &Record, residual: &HeldOut) -> f64 {
    let windows = &record.windows[PRINCIPAL];
    let own: Vec<f64> = residual.residuals[PRINCIPAL].iter().step_by(windows.functions).copied().collect();
    let own: Vec<f64> = own.into_iter().filter(|value| value.is_finite()).collect();
    if own.len() < 3 {
        return record.duration;
    }
    let mean = own.iter().sum::<f64>() / own.len() as f64;
    let product = |lag: usize| {
        let pairs = own.iter().zip(&own[lag..]);
        pairs.map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / (own.len() - lag) as f64
    };
    let whole = product(0);
    let lag = (1..own.len() / 2).find(|lag| product(*lag) < CORRELATED * whole).unwrap_or(own.len() / 2);
    lag as f64 * (windows.centres[1] - windows.centres[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_eight_blocks_every_pattern_of_signs_counts_once() {
        let blocks = Blocks { count: Some(8), duration: 8.0 };
        let gains = [0.2, 0.3, 0.1, 0.4, 0.2, 0.3, 0.5, 0.2];
        assert_eq!(blocks.p_values(&[gains.to_vec()]), Some(vec![1.0 / 256.0]));
        // one small loss: its own sign, and the other one, which only adds
        let mostly = gains.map(|gain| if gain == 0.1 { -0.05 } else { gain });
        assert_eq!(blocks.p_values(&[mostly.to_vec()]), Some(vec![2.0 / 256.0]));
        assert_eq!(Blocks { count: None, ..blocks }.p_values(&[gains.to_vec()]), None);
    }
}
