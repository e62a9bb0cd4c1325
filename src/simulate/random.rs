//! Stages drawn from a seed.
//!
//! Each number is uniform in its range, drawn again until it differs from the last stage's by at least [`CHANGE`].
//! Duffing: m 0.7–1.4, c 0.15–0.6, k₁ 2.5–6, k₃ 1–4, P 1.4–3, ω 1.1–1.9. Van der Pol: L 0.7–1.4, α 0.3–1.2, a 0.7–1.3
//! (limit cycle) or −0.8 to −0.3 (focus) by turns, C 0.7–1.4, P 0.8–1.8, ω 0.8–1.4. Five to seven stages of 12 to 25 s,
//! switches at multiples of 0.1 ms, so that most fall between two samples.

use super::plants::{duffing, van_der_pol};
use super::scenario::Stage;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// Smallest change of any number at a switch, relative to its old value; 1/C then changes by a tenth at least.
const CHANGE: f64 = 0.12;

/// Instants in a second at which a switch may lie.
const INSTANTS: f64 = 1e4;

const DUFFING: [Range<f64>; 6] = [0.7..1.4, 0.15..0.6, 2.5..6.0, 1.0..4.0, 1.4..3.0, 1.1..1.9];
const LIMIT_CYCLE: [Range<f64>; 6] = [0.7..1.4, 0.3..1.2, 0.7..1.3, 0.7..1.4, 0.8..1.8, 0.8..1.4];
const FOCUS: [Range<f64>; 6] = [0.7..1.4, 0.3..1.2, -0.8..-0.3, 0.7..1.4, 0.8..1.8, 0.8..1.4];

/// The stages and the duration of the record, s.
pub(super) fn stages(van_der_pol_plant: bool, seed: u64) -> (Vec<Stage>, f64) {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let count = generator.random_range(5..=7);
    let cycle_first = generator.random_bool(0.5);
    let mut numbers = None;
    let mut start = 0.0;
    let mut stages = Vec::with_capacity(count);
    for index in 0..count {
        let ranges = match (van_der_pol_plant, (index % 2 == 0) == cycle_first) {
            (false, _) => &DUFFING,
            (true, true) => &LIMIT_CYCLE,
            (true, false) => &FOCUS,
        };
        let drawn = changed(&mut generator, ranges, numbers);
        let [a, b, c, d, amplitude, omega] = drawn;
        let stage = if van_der_pol_plant { van_der_pol } else { duffing };
        stages.push(stage(start, [a, b, c, d], amplitude, omega));
        numbers = Some(drawn);
        start = ((start + generator.random_range(12.0..25.0)) * INSTANTS).round() / INSTANTS;
    }
    (stages, start)
}

/// One number in each range, none within [`CHANGE`] of the last one.
fn changed(generator: &mut ChaCha8Rng, ranges: &[Range<f64>; 6], last: Option<[f64; 6]>) -> [f64; 6] {
    std::array::from_fn(|index| {
        loop {
            let number = generator.random_range(ranges[index].clone());
            if last.is_none_or(|last| differs(last[index], number)) {
                return number;
            }
        }
    })
}

fn differs(old: f64, new: f64) -> bool {
    (new - old).abs() >= CHANGE * old.abs()
}
