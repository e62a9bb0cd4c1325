//! What a hidden mass did before the record began: its free response, which the recorded motion does not give.
//!
//! The memory of an effect runs through the whole record from rest. A hidden mass that was moving when the record began
//! adds e^(−ζωt) (a cos ω_d t + b sin ω_d t) in every piece, which is linear in a and b: they are fitted beside the law
//! once, and its column is then that of the mass as it moved.

use super::memory::Memory;
use super::record::{Column, Record, Timing};
use super::regression::{self, Normal};
use super::windows::PRINCIPAL;
use crate::law::{Effect, Term};

/// Amplitude of a free response, in RMS of what the record drives the mass to, beyond which it is no hidden mass's: it
/// moved no more before the record than in it, and one in 10⁴ Gaussian amplitudes is larger.
const LARGEST: f64 = 4.3;

/// The column of a hidden resonator, at that place among a law's, with what it did before the record began; none of
/// another term.
pub(super) fn begun(
    record: &Record,
    (term, timing): (Term, Timing),
    (left, right, memory): (&[Column], &Column, &Memory),
    place: usize,
) -> Option<Column> {
    let responses = responses(record, term)?;
    let columns: Vec<&[f64]> = left.iter().chain(&responses).map(|column| column[PRINCIPAL].as_slice()).collect();
    let right = &right[PRINCIPAL];
    let mut weights = vec![1.0; right.len()];
    memory.void[PRINCIPAL].iter().for_each(|row| weights[*row] = 0.0);
    let solution = Normal::of(&columns, right, &weights).solve()?;
    let coefficient = Some(solution[place]).filter(|value| *value != 0.0)?;
    let usual = record.rms(term, timing);
    let amplitudes = solution[left.len()..].chunks_exact(2).map(|pair| (pair[0].hypot(pair[1]) / coefficient).abs());
    if amplitudes.fold(0.0, f64::max) > LARGEST * usual {
        return None;
    }
    let mut column = left[place].clone();
    for (response, value) in responses.iter().zip(&solution[left.len()..]) {
        regression::add(&mut column, response, value / coefficient);
    }
    Some(column)
}

/// The two free responses of a hidden resonator in every piece; none of another term, or of one that does not swing.
fn responses(record: &Record, term: Term) -> Option<Vec<Column>> {
    let Term::Effect(Effect::HiddenResonator { frequency, damping_ratio }) = term else { return None };
    let (omega, damping) = (frequency.value(), damping_ratio.value());
    let swings = omega * (1.0 - damping * damping).sqrt();
    let fades = omega * damping;
    let of = |piece: usize, shape: fn(f64) -> f64| {
        record.acting(|own, t| if own == piece { (-fades * t).exp() * shape(swings * t) } else { 0.0 })
    };
    let both = |piece: usize| [of(piece, f64::cos), of(piece, f64::sin)];
    (damping < 1.0).then(|| (0..record.pieces()).flat_map(both).collect())
}
