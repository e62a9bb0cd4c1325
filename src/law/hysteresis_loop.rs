//! A Bouc–Wen loop along a displacement.
//!
//! The loop does not depend on the rate: with ρ = z ÷ x_y taken in the direction of motion and u the way since ρ was 0, in units of x_y,
//! dρ/du = 1 − ρⁿ while loading (ρ > 0) and 1 + (2s − 1) |ρ|ⁿ while unloading. Both are tabulated once, on the way u, which simply grows as
//! the coordinate moves on; where it turns, ρ becomes −ρ. So a loop costs the same however sharp it is, where integration in time has
//! to follow every yielding.

use super::{Effect, State};

/// Way between nodes of the tables, in yield displacements: Runge and Kutta's step of order 4 then errs by some 0.04⁵ ÷ 120 a node.
const SPACING: f64 = 0.04;

/// Nodes of each table: they reach 20 yield displacements, where 1 − ρ of the smoothest loop, exp(−20), is 2e-9: it has yielded.
const NODES: usize = 512;

/// ρ from which on a loading branch stays: the loop has yielded.
const FILLED: f64 = 1.0 - 1e-9;

/// ρ beyond which no branch is read: an unloading one would grow without bounds.
const UNUSED: f64 = 2.0;

/// Newton's steps for the way to a ρ, from the node before it: four square an error below a node's way to rounding.
const NEWTON: usize = 4;

/// Way over which the slope is taken for them; any short part of [`SPACING`] serves, the steps correct what it errs by.
const NEAR: f64 = 1e-4;

/// Least slope that is divided by: where the loop has yielded there is none, and the clamp to the node decides.
const FLAT: f64 = 1e-12;

/// ρ against the way from 0, and its slope, at every node.
#[derive(Clone, Debug)]
struct Branch {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

/// The shape of a loop.
#[derive(Clone, Debug)]
pub(super) struct Loop {
    limit: f64,
    loading: Branch,
    unloading: Branch,
}

/// Where a motion stands on a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Direction of motion, +1 or −1.
    direction: f64,
    /// Way since ρ was 0, negative before it will be.
    way: f64,
}

impl Branch {
    /// Integrates dρ/du = 1 + factor · ρⁿ from 0; ρ stops at 1.
    fn new(factor: f64, exponent: f64) -> Branch {
        let power = |value: f64| if exponent == 1.0 { value } else { value.powf(exponent) };
        let slope = |value: f64| 1.0 + factor * power(value.clamp(0.0, 1.0));
        let mut values = vec![0.0; NODES];
        for node in 1..NODES {
            let value = values[node - 1];
            if value > UNUSED || (factor < 0.0 && value >= FILLED) {
                values[node] = value;
                continue;
            }
            let first = slope(value);
            let second = slope(value + 0.5 * SPACING * first);
            let third = slope(value + 0.5 * SPACING * second);
            let fourth = slope(value + SPACING * third);
            let mean = (first + 2.0 * (second + third) + fourth) / 6.0;
            values[node] = if factor < 0.0 { (value + SPACING * mean).min(1.0) } else { value + SPACING * mean };
        }
        let slopes = values.iter().map(|value| slope(*value)).collect();
        Branch { values, slopes }
    }

    /// ρ after that way (cubic by Hermite).
    fn at(&self, way: f64) -> f64 {
        let place = way / SPACING;
        let node = place as usize;
        if node >= NODES - 1 {
            return self.values[NODES - 1];
        }
        let (share, bend) = (place - node as f64, 1.0 - (place - node as f64));
        let (from, to) = (self.values[node], self.values[node + 1]);
        let rise = to - from;
        let (before, after) = (self.slopes[node] * SPACING - rise, rise - self.slopes[node + 1] * SPACING);
        from + share * rise + share * bend * (bend * before + share * after)
    }

    /// The way to ρ, 0 to 1.
    fn way(&self, value: f64) -> f64 {
        let node = self.values.partition_point(|other| *other <= value).clamp(1, NODES - 1) - 1;
        let mut way = SPACING * node as f64;
        let slope = |way: f64| (self.at(way + NEAR) - self.at(way)) / NEAR;
        for _ in 0..NEWTON {
            let change = (value - self.at(way)) / slope(way).max(FLAT);
            way = (way + change).clamp(SPACING * node as f64, SPACING * (node + 1) as f64);
        }
        way
    }
}

impl Effect {
    /// dz/dq of a hysteresis at this z, and what a short way `dq` from there leaves of a difference in z; none of any other effect.
    pub fn loop_tangent(self, z: f64, dq: f64) -> Option<[f64; 2]> {
        let Effect::Hysteresis { yield_displacement, share, exponent } = self else { return None };
        let (limit, exponent) = (yield_displacement.value(), exponent.value());
        let ratio = (z * dq.signum() / limit).clamp(-1.0, 1.0);
        let factor = if ratio > 0.0 { -1.0 } else { 2.0 * share.value() - 1.0 };
        let bend = factor * exponent * ratio.abs().powf(exponent - 1.0) * ratio.signum();
        Some([1.0 + factor * ratio.abs().powf(exponent), (bend * dq.abs() / limit).exp()])
    }
}

impl Loop {
    /// The loop of a hysteresis; none of any other effect.
    pub(super) fn of(effect: Effect) -> Option<Loop> {
        let Effect::Hysteresis { yield_displacement, share, exponent } = effect else { return None };
        let (share, exponent) = (share.value(), exponent.value());
        Some(Loop {
            limit: yield_displacement.value(),
            loading: Branch::new(-1.0, exponent),
            unloading: Branch::new(2.0 * share - 1.0, exponent),
        })
    }

    /// On the loop with this z, moving in the direction of `moving`.
    pub(super) fn place(&self, z: f64, moving: f64) -> Place {
        let direction = if moving < 0.0 { -1.0 } else { 1.0 };
        let ratio = (direction * z / self.limit).clamp(-1.0, 1.0);
        let way = if ratio < 0.0 { -self.unloading.way(-ratio) } else { self.loading.way(ratio) };
        Place { direction, way }
    }

    /// z there.
    pub(super) fn z(&self, place: Place) -> f64 {
        let ratio = if place.way < 0.0 { -self.unloading.at(-place.way) } else { self.loading.at(place.way) };
        self.limit * place.direction * ratio
    }

    /// After the way from one state to the next, between which the velocity turns at most once; `at` gives the displacement at a share of
    /// the time between them.
    pub(super) fn followed(&self, place: Place, [from, to]: [State; 2], at: impl Fn(f64) -> f64) -> Place {
        if from.qd * to.qd >= 0.0 {
            return self.moved(place, to.q - from.q);
        }
        let turn = at(from.qd / (from.qd - to.qd));
        self.moved(self.moved(place, turn - from.q), to.q - turn)
    }

    /// After a displacement without a turn.
    fn moved(&self, place: Place, displacement: f64) -> Place {
        let way = displacement * place.direction / self.limit;
        if way >= 0.0 {
            return Place { way: place.way + way, ..place };
        }
        let turned = self.place(self.z(place), -place.direction);
        Place { way: turned.way - way, ..turned }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Inner;

    /// Against the rate equation integrated in small steps, through loading, turning in mid-way and full reversal.
    #[test]
    fn the_tables_follow_the_rate_equation() {
        for (share, exponent) in [(1.0, 1.0), (0.5, 2.0), (0.8, 1.4), (1.7, 3.0)] {
            let inner = [0.3, share, exponent].map(Inner::new);
            let effect = Effect::Hysteresis { yield_displacement: inner[0], share: inner[1], exponent: inner[2] };
            let shape = Loop::of(effect).unwrap();
            let (mut z, mut place) = (0.0_f64, shape.place(0.0, 1.0));
            for turn in [0.2, -0.1, 0.15, -0.9, 0.25, -0.05, 1.4] {
                let steps = 20_000;
                let dq: f64 = turn / f64::from(steps);
                for _ in 0..steps {
                    let slope = |z: f64| {
                        let filled = (z / 0.3).abs().powf(exponent);
                        1.0 - filled * (share * z.signum() * dq.signum() + 1.0 - share)
                    };
                    let middle = z + 0.5 * dq * slope(z);
                    z += dq * slope(middle);
                }
                place = shape.moved(place, turn);
                let found = shape.z(place);
                assert!((found - z).abs() < 2e-5 * 0.3, "share {share}, exponent {exponent}, {turn}: {found} for {z}");
            }
        }
    }

    #[test]
    fn the_tangent_is_that_of_the_loop() {
        for (share, exponent) in [(1.0, 1.0), (0.5, 2.0), (0.8, 1.4), (1.7, 3.0)] {
            let inner = [0.3, share, exponent].map(Inner::new);
            let effect = Effect::Hysteresis { yield_displacement: inner[0], share: inner[1], exponent: inner[2] };
            let shape = Loop::of(effect).unwrap();
            for z in [-0.2, -0.05, 0.1, 0.25] {
                for direction in [-1.0, 1.0] {
                    let place = shape.place(z, direction);
                    let ends = [-1e-4, 1e-4].map(|way| shape.z(Place { way: place.way + way / 0.3, ..place }));
                    let slope = (ends[1] - ends[0]) / (2e-4 * direction);
                    let [found, kept] = effect.loop_tangent(z, 1e-4 * direction).unwrap();
                    assert!((found - slope).abs() < 1e-3, "{share}, {exponent}, z {z}: {found} for {slope}");
                    let after = |z: f64| shape.z(shape.moved(shape.place(z, direction), 2e-3 * direction));
                    let left = (after(z + 1e-5) - after(z - 1e-5)) / 2e-5;
                    let expected = kept.powi(20);
                    assert!((left - expected).abs() < 3e-3, "{share}, {exponent}, z {z}: {expected} for {left}");
                }
            }
        }
    }
}
