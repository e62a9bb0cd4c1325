//! A Bouc–Wen loop along a displacement, and friction that is Dahl's, its case s = n = 1, with or without play.
//!
//! The loop does not depend on the rate: with ρ = z ÷ x_y taken in the direction of motion and u the way since ρ was 0,
//! in units of x_y, dρ/du = 1 − ρⁿ while loading (ρ > 0) and 1 + (2s − 1) |ρ|ⁿ while unloading. Both are tabulated
//! once, on the way u, which simply grows as the coordinate moves on; where it turns, ρ becomes −ρ. Play of ± g is a
//! way of 2g between unloading and loading. So a loop costs the same however sharp it is, where integration in time has
//! to follow every yielding.

use super::effect::Effect;
use super::motion::State;

/// Way between nodes of the tables, in yield displacements: Runge and Kutta's step of order 4 then errs by some 0.04⁵ ÷
/// 120 a node.
const SPACING: f64 = 0.04;

/// Nodes of each table: they reach 20 yield displacements, where 1 − ρ of the smoothest loop, exp(−20), is 2e-9: it has
/// yielded.
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
    /// Half the play, in units of the limit.
    gap: f64,
    /// The feature where the loop has yielded.
    level: f64,
    loading: Branch,
    unloading: Branch,
}

/// Where a motion stands on a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Direction of motion, +1 or −1.
    direction: f64,
    /// Way since ρ began to load, negative before it will.
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

/// What a loop is made of: yield displacement or slip length, m, half the play, m, the feature where it has yielded, s
/// and n.
struct Bend {
    limit: f64,
    gap: f64,
    level: f64,
    share: f64,
    exponent: f64,
}

impl Bend {
    fn of(effect: Effect) -> Option<Bend> {
        let dahl = |limit: f64, gap: f64| Some(Bend { limit, gap, level: 1.0, share: 1.0, exponent: 1.0 });
        match effect {
            Effect::Hysteresis { yield_displacement, share, exponent } => {
                let limit = yield_displacement.value();
                Some(Bend { limit, gap: 0.0, level: limit, share: share.value(), exponent: exponent.value() })
            }
            Effect::PreslidingFriction { slip_length } => dahl(slip_length.value(), 0.0),
            Effect::FrictionWithBacklash { slip_length, gap } => dahl(slip_length.value(), gap.value()),
            _ => None,
        }
    }
}

impl Effect {
    /// ∂f/∂q of a loop whose feature is f there, and what a short way `dq` leaves of a difference in f; none of an
    /// effect that is no loop.
    pub fn loop_tangent(self, feature: f64, dq: f64) -> Option<[f64; 2]> {
        let Bend { limit, gap, level, share, exponent } = Bend::of(self)?;
        if gap > 0.0 && feature == 0.0 {
            return Some([0.0, 1.0]);
        }
        let ratio = (feature * dq.signum() / level).clamp(-1.0, 1.0);
        let factor = if ratio > 0.0 { -1.0 } else { 2.0 * share - 1.0 };
        let bend = factor * exponent * ratio.abs().powf(exponent - 1.0) * ratio.signum();
        let slope = level / limit * (1.0 + factor * ratio.abs().powf(exponent));
        Some([slope, (bend * dq.abs() / limit).exp()])
    }

    /// The largest distance of a loop's internal state from 0; none of an effect that is no loop.
    pub(super) fn largest_state(self) -> Option<f64> {
        Bend::of(self).map(|bend| bend.limit + bend.gap)
    }
}

impl Loop {
    /// The loop of an effect; none of one that is no loop.
    pub(super) fn of(effect: Effect) -> Option<Loop> {
        let Bend { limit, gap, level, share, exponent } = Bend::of(effect)?;
        Some(Loop {
            limit,
            gap: gap / limit,
            level,
            loading: Branch::new(-1.0, exponent),
            unloading: Branch::new(2.0 * share - 1.0, exponent),
        })
    }

    /// On the loop with this internal state, moving in the direction of `moving`.
    pub(super) fn place(&self, state: f64, moving: f64) -> Place {
        let direction = if moving < 0.0 { -1.0 } else { 1.0 };
        let along = direction * state / self.limit;
        let way = if along > self.gap {
            self.loading.way((along - self.gap).min(1.0))
        } else if along >= -self.gap {
            along - self.gap
        } else {
            -2.0 * self.gap - self.unloading.way((-self.gap - along).min(1.0))
        };
        Place { direction, way }
    }

    /// ρ there, in the direction of motion.
    fn ratio(&self, way: f64) -> f64 {
        let unloading = -2.0 * self.gap - way;
        if way >= 0.0 {
            self.loading.at(way)
        } else if unloading > 0.0 {
            -self.unloading.at(unloading)
        } else {
            0.0
        }
    }

    /// The feature there.
    pub(super) fn feature(&self, place: Place) -> f64 {
        self.level * place.direction * self.ratio(place.way)
    }

    /// The internal state there: z, and beyond it the play.
    pub(super) fn state(&self, Place { direction, way }: Place) -> f64 {
        let ratio = self.ratio(way);
        let play = (way + self.gap).clamp(-self.gap, self.gap);
        self.limit * direction * (ratio + play)
    }

    /// After the way from one state to the next, between which the velocity turns at most once; `at` gives the
    /// displacement at a share of the time between them.
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
        let turned = self.place(self.state(place), -place.direction);
        Place { way: turned.way - way, ..turned }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::inner::Inner;

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
                let found = shape.feature(place);
                assert!((found - z).abs() < 2e-5 * 0.3, "share {share}, exponent {exponent}, {turn}: {found} for {z}");
            }
        }
    }

    /// ė = q̇ − |q̇| z ÷ x_s, z what of e is beyond the gap, in small steps, through play and partial reversals within
    /// it.
    #[test]
    fn play_is_a_way_without_force() {
        let (slip, gap) = (0.3, 0.2);
        let effect = Effect::FrictionWithBacklash { slip_length: Inner::new(slip), gap: Inner::new(gap) };
        let shape = Loop::of(effect).unwrap();
        let (mut e, mut place) = (0.0_f64, shape.place(0.0, 1.0));
        let beyond = |e: f64| e.signum() * (e.abs() - gap).max(0.0);
        for turn in [0.15, -0.1, 0.7, -0.2, -0.25, 0.1, -0.3, -0.9, 2.5] {
            let steps = 20_000;
            let dq: f64 = turn / f64::from(steps);
            for _ in 0..steps {
                let slope = |e: f64| dq - dq.abs() * beyond(e) / slip;
                e += slope(e + 0.5 * slope(e));
            }
            place = shape.moved(place, turn);
            let found = shape.feature(place);
            assert!((found - beyond(e) / slip).abs() < 5e-5, "{turn}: {found} for {}", beyond(e) / slip);
        }
        assert!((effect.loop_tangent(0.0, 1.0), effect.largest_state()) == (Some([0.0, 1.0]), Some(slip + gap)));
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
                    let ends = [-1e-4, 1e-4].map(|way| shape.feature(Place { way: place.way + way / 0.3, ..place }));
                    let slope = (ends[1] - ends[0]) / (2e-4 * direction);
                    let [found, kept] = effect.loop_tangent(z, 1e-4 * direction).unwrap();
                    assert!((found - slope).abs() < 1e-3, "{share}, {exponent}, z {z}: {found} for {slope}");
                    let after = |z: f64| shape.feature(shape.moved(shape.place(z, direction), 2e-3 * direction));
                    let left = (after(z + 1e-5) - after(z - 1e-5)) / 2e-5;
                    let expected = kept.powi(20);
                    assert!((left - expected).abs() < 3e-3, "{share}, {exponent}, z {z}: {expected} for {left}");
                }
            }
        }
    }
}
