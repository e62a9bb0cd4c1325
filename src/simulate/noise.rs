//! Gaussian numbers by index.
//!
//! Number k of a stream is a function of (seed, stream, k) alone: ChaCha is a counter cipher, so that any place of its
//! key stream is reached directly. A plant therefore carries no generator, and its noise cannot depend on how often it
//! is asked.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Who uses the numbers; each has a stream of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stream {
    /// The white excitation.
    Excitation = 1,
    /// The displacement's sensor.
    Displacement = 2,
    /// The velocity's sensor.
    Velocity = 3,
    /// The phases of a multisine.
    Phase = 4,
    /// The force's sensor.
    Force = 5,
}

/// Words of key stream that one number may use: the ziggurat takes two, rarely a few more.
const WORDS: u128 = 64;

/// Number `index` of the stream, standard normal.
pub(super) fn standard_normal(seed: u64, stream: Stream, index: u64) -> f64 {
    StandardNormal.sample(&mut generator(seed, stream, index))
}

/// Number `index` of the stream, uniform between 0 and 1.
pub(super) fn uniform(seed: u64, stream: Stream, index: u64) -> f64 {
    generator(seed, stream, index).random()
}

fn generator(seed: u64, stream: Stream, index: u64) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(stream as u64);
    generator.set_word_pos(u128::from(index) * WORDS);
    generator
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(seed: u64, stream: Stream) -> (f64, f64, f64) {
        let numbers: Vec<f64> = (0..40_000).map(|index| standard_normal(seed, stream, index)).collect();
        let count = numbers.len() as f64;
        let mean = numbers.iter().sum::<f64>() / count;
        let variance = numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
        let lagged = numbers.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / count;
        (mean, variance, lagged)
    }

    #[test]
    fn numbers_are_standard_normal_and_uncorrelated() {
        for stream in [Stream::Excitation, Stream::Displacement, Stream::Velocity] {
            let (mean, variance, lagged) = moments(7, stream);
            assert!(mean.abs() < 5.0 / 200.0, "mean {mean}");
            assert!((variance - 1.0).abs() < 5.0 * 2.0_f64.sqrt() / 200.0, "variance {variance}");
            assert!(lagged.abs() < 5.0 / 200.0, "correlation {lagged}");
        }
    }

    #[test]
    fn seeds_and_streams_differ() {
        let number = standard_normal(1, Stream::Velocity, 5);
        assert_eq!(number, standard_normal(1, Stream::Velocity, 5));
        assert_ne!(number, standard_normal(2, Stream::Velocity, 5));
        assert_ne!(number, standard_normal(1, Stream::Displacement, 5));
        assert_ne!(number, standard_normal(1, Stream::Velocity, 6));
    }
}
