//! Samples in few bytes, every number bit by bit.
//!
//! Each channel is written as its distance from the straight line through the two samples before, in steps of the last
//! binary digit, by as many bytes as that needs: a clock needs one or two, a smooth force half of its eight. A sample
//! is a word of four 4-bit counts, then the bytes.

use super::sample::Sample;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

type Channels = [f64; 4];

/// Writes samples as bytes; for `#[serde(with)]`.
///
/// # Errors
/// What the serializer says.
pub fn serialize<S: Serializer>(samples: &[Sample], serializer: S) -> Result<S::Ok, S::Error> {
    pack(samples).serialize(serializer)
}

/// Reads them back.
///
/// # Errors
/// Bytes that [`serialize`] did not write, and what the deserializer says.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Sample>, D::Error> {
    let bytes = Vec::<u8>::deserialize(deserializer)?;
    unpack(&bytes).ok_or_else(|| D::Error::custom("packed samples end too early"))
}

fn pack(samples: &[Sample]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(24 * samples.len());
    let mut before = [[0.0; 4]; 2];
    for sample in samples {
        let channels = [sample.t, sample.q, sample.qd, sample.excitation];
        let place = bytes.len();
        bytes.extend([0; 2]);
        let mut counts = 0;
        for (channel, value) in channels.iter().enumerate() {
            let distance = folded(steps(*value).wrapping_sub(steps(line(&before, channel))));
            let count = 8 - distance.leading_zeros() / 8;
            bytes.extend_from_slice(&distance.to_le_bytes()[..count as usize]);
            counts |= (count as u16) << (4 * channel);
        }
        bytes[place..place + 2].copy_from_slice(&counts.to_le_bytes());
        before = [before[1], channels];
    }
    bytes
}

fn unpack(mut bytes: &[u8]) -> Option<Vec<Sample>> {
    let mut samples = Vec::with_capacity(bytes.len() / 16);
    let mut before = [[0.0; 4]; 2];
    while !bytes.is_empty() {
        let (counts, rest) = bytes.split_first_chunk::<2>()?;
        let counts = u16::from_le_bytes(*counts);
        bytes = rest;
        let mut channels = [0.0; 4];
        for (channel, value) in channels.iter_mut().enumerate() {
            let (digits, rest) = bytes.split_at_checked(usize::from(counts >> (4 * channel) & 15))?;
            let mut distance = [0; 8];
            distance.get_mut(..digits.len())?.copy_from_slice(digits);
            *value = value_at(steps(line(&before, channel)).wrapping_add(unfolded(u64::from_le_bytes(distance))));
            bytes = rest;
        }
        let [t, q, qd, excitation] = channels;
        samples.push(Sample { t, q, qd, excitation });
        before = [before[1], channels];
    }
    Some(samples)
}

/// Where the straight line through the two before arrives; 0 where that is no number, of which machines keep different
/// bits.
fn line([first, second]: &[Channels; 2], channel: usize) -> f64 {
    let next = 2.0 * second[channel] - first[channel];
    if next.is_finite() { next } else { 0.0 }
}

/// The number's place among all numbers in order.
fn steps(value: f64) -> i64 {
    let bits = value.to_bits() as i64;
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}

fn value_at(steps: i64) -> f64 {
    f64::from_bits((steps ^ (((steps >> 63) as u64) >> 1) as i64) as u64)
}

/// Small distances of either sign as small numbers.
fn folded(distance: i64) -> u64 {
    ((distance << 1) ^ (distance >> 63)) as u64
}

fn unfolded(folded: u64) -> i64 {
    (folded >> 1) as i64 ^ -((folded & 1) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(samples: &[Sample]) -> Vec<[u64; 4]> {
        samples.iter().map(|s| [s.t, s.q, s.qd, s.excitation].map(f64::to_bits)).collect()
    }

    #[test]
    fn every_bit_comes_back() {
        let odd = [0.0, -0.0, 1e-310, -1e300, f64::MAX, f64::INFINITY, -f64::NAN, 0.3, f64::from_bits(1), -7.0];
        let sample = |k: usize| Sample {
            t: odd[k % odd.len()],
            q: odd[k * 7 % odd.len()],
            qd: odd[k * 3 % odd.len()],
            excitation: odd[k / 3 % odd.len()],
        };
        let samples: Vec<Sample> = (0..100).map(sample).collect();
        assert_eq!(bits(&unpack(&pack(&samples)).unwrap()), bits(&samples));
    }

    #[test]
    fn a_smooth_record_takes_six_tenths() {
        let sample = |k: u32| {
            let t = f64::from(k) * 1e-3;
            Sample { t, q: t.sin(), qd: t.cos(), excitation: (2.0 * t).sin() }
        };
        let samples: Vec<Sample> = (0..10_000).map(sample).collect();
        let bytes = pack(&samples);
        assert_eq!(bits(&unpack(&bytes).unwrap()), bits(&samples));
        assert!(10 * bytes.len() < 6 * size_of_val(&samples[..]), "{}", bytes.len());
    }

    #[test]
    fn bytes_that_end_too_early_are_refused() {
        let bytes = pack(&[Sample { t: 0.1, q: 0.2, qd: 0.3, excitation: 0.4 }]);
        assert_eq!(unpack(&bytes[..bytes.len() - 1]), None);
        assert_eq!(unpack(&[255, 255, 1, 2, 3]), None);
    }
}
