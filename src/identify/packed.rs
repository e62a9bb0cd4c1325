//! Readings in few bytes, every number bit by bit.
//!
//! Each number is written as its distance from the straight line through the two before, in steps of the last binary
//! digit, by as many bytes as that needs: a clock needs one or two, a smooth force half of its eight. A reading is three
//! bytes with a 4-bit count for each number and a bit for each faulty channel, then the bytes.

use super::reading::Reading;
use super::sample::Sample;
use serde::de::{Error, Visitor};
use serde::{Deserializer, Serializer};
use std::fmt;

/// t, q, q̇, F, and the intensity of what may have acted unseen.
type Channels = [f64; 5];

/// Bytes before those of the numbers.
const HEAD: usize = 3;

/// Bits of the counts; the channels' faults come after them.
const COUNTS: usize = 20;

/// Writes readings as bytes; for `#[serde(with)]`.
///
/// # Errors
/// What the serializer says.
pub fn serialize<T: Copy + Into<Reading>, S: Serializer>(readings: &[T], serializer: S) -> Result<S::Ok, S::Error> {
    let readings: Vec<Reading> = readings.iter().map(|own| (*own).into()).collect();
    serializer.serialize_bytes(&pack(&readings))
}

/// Reads them back.
///
/// # Errors
/// Bytes that [`serialize`] did not write, and what the deserializer says.
pub fn deserialize<'de, T: From<Reading>, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<T>, D::Error> {
    Ok(deserializer.deserialize_bytes(Bytes)?.into_iter().map(T::from).collect())
}

struct Bytes;

impl<'de> Visitor<'de> for Bytes {
    type Value = Vec<Reading>;

    fn expecting(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str("packed readings")
    }

    fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Vec<Reading>, E> {
        unpack(bytes).ok_or_else(|| E::custom("packed readings end too early"))
    }

    fn visit_seq<A: serde::de::SeqAccess<'de>>(self, mut sequence: A) -> Result<Vec<Reading>, A::Error> {
        let mut bytes = Vec::new();
        while let Some(byte) = sequence.next_element()? {
            bytes.push(byte);
        }
        self.visit_bytes(&bytes)
    }
}

fn pack(readings: &[Reading]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(24 * readings.len());
    let mut before = [[0.0; 5]; 2];
    for Reading { sample, faulty, unseen } in readings {
        let channels = [sample.t, sample.q, sample.qd, sample.excitation, *unseen];
        let place = bytes.len();
        bytes.extend([0; HEAD]);
        let mut head = u32::from(faulty[0]) << COUNTS | u32::from(faulty[1]) << (COUNTS + 1);
        for (channel, value) in channels.iter().enumerate() {
            let distance = folded(steps(*value).wrapping_sub(steps(line(&before, channel))));
            let count = 8 - distance.leading_zeros() / 8;
            bytes.extend_from_slice(&distance.to_le_bytes()[..count as usize]);
            head |= count << (4 * channel);
        }
        bytes[place..place + HEAD].copy_from_slice(&head.to_le_bytes()[..HEAD]);
        before = [before[1], channels];
    }
    bytes
}

fn unpack(mut bytes: &[u8]) -> Option<Vec<Reading>> {
    let mut readings = Vec::with_capacity(bytes.len() / 16);
    let mut before = [[0.0; 5]; 2];
    while !bytes.is_empty() {
        let ([a, b, c], rest) = bytes.split_first_chunk::<HEAD>()?;
        let head = u32::from_le_bytes([*a, *b, *c, 0]);
        bytes = rest;
        let mut channels = [0.0; 5];
        for (channel, value) in channels.iter_mut().enumerate() {
            let (digits, rest) = bytes.split_at_checked((head >> (4 * channel) & 15) as usize)?;
            let mut distance = [0; 8];
            distance.get_mut(..digits.len())?.copy_from_slice(digits);
            *value = value_at(steps(line(&before, channel)).wrapping_add(unfolded(u64::from_le_bytes(distance))));
            bytes = rest;
        }
        let [t, q, qd, excitation, unseen] = channels;
        let faulty = [COUNTS, COUNTS + 1].map(|bit| head >> bit & 1 == 1);
        readings.push(Reading { sample: Sample { t, q, qd, excitation }, faulty, unseen });
        before = [before[1], channels];
    }
    Some(readings)
}

/// Where the straight line through the two before arrives; 0 where that is no number, of which machines keep different bits.
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

    fn bits(readings: &[Reading]) -> Vec<([u64; 5], [bool; 2])> {
        let own = |Reading { sample: s, faulty, unseen }: &Reading| {
            ([s.t, s.q, s.qd, s.excitation, *unseen].map(f64::to_bits), *faulty)
        };
        readings.iter().map(own).collect()
    }

    #[test]
    fn every_bit_comes_back() {
        let odd = [0.0, -0.0, 1e-310, -1e300, f64::MAX, f64::INFINITY, -f64::NAN, 0.3, f64::from_bits(1), -7.0];
        let reading = |k: usize| Reading {
            sample: Sample {
                t: odd[k % odd.len()],
                q: odd[k * 7 % odd.len()],
                qd: odd[k * 3 % odd.len()],
                excitation: odd[k / 3 % odd.len()],
            },
            faulty: [k % 2 == 0, k % 3 == 0],
            unseen: odd[k / 5 % odd.len()],
        };
        let readings: Vec<Reading> = (0..100).map(reading).collect();
        assert_eq!(bits(&unpack(&pack(&readings)).unwrap()), bits(&readings));
    }

    #[test]
    fn a_smooth_record_takes_less_than_half() {
        let reading = |k: u32| {
            let t = f64::from(k) * 1e-3;
            Reading::from(Sample { t, q: t.sin(), qd: t.cos(), excitation: (2.0 * t).sin() })
        };
        let readings: Vec<Reading> = (0..10_000).map(reading).collect();
        let bytes = pack(&readings);
        assert_eq!(bits(&unpack(&bytes).unwrap()), bits(&readings));
        assert!(bytes.len() < size_of::<Reading>() * readings.len() / 2, "{}", bytes.len());
    }

    #[test]
    fn bytes_that_end_too_early_are_refused() {
        let bytes = pack(&[Sample { t: 0.1, q: 0.2, qd: 0.3, excitation: 0.4 }.into()]);
        assert_eq!(unpack(&bytes[..bytes.len() - 1]), None);
        assert_eq!(unpack(&[255, 255, 1, 2, 3]), None);
    }
}
