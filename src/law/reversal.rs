//! Where a step of integration must be cut because dry friction reverses.
//!
//! Under friction the acceleration jumps where q̇ passes zero. A step is cut there: it slides in one direction, as if
//! friction kept its sign, up to the root of q̇; at rest the forces beside friction decide whether it slides back or
//! sticks until they exceed it (Leine and Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems,
//! Springer 2004, ch. 4 and 7).

use super::effect::Effect;
use super::motion::State;

/// Pieces into which a step may be cut; the last one goes through to its end.
pub(super) const MOST_CUTS: usize = 12;

/// Newton's steps towards the instant of rest: each squares the error, so that four lead from 0.1 of the step to
/// rounding.
pub(super) const REFINEMENTS: usize = 4;

/// Share of a step within which the instant of rest is known: rounding of the state leaves some 10⁻¹⁴ of it.
pub(super) const NEGLIGIBLE: f64 = 1e-13;

/// Evaluations of a search for a root: halving alone needs 50 from the whole bracket to [`RESOLUTION`].
const EVALUATIONS: usize = 60;

/// Share of a bracket within which a root is known: a few spacings of numbers at 1.
const RESOLUTION: f64 = 1e-15;

/// How far past its reversal, in Stribeck speeds, friction is continued as if it had not reversed.
const OVERSHOOT: f64 = 1.0;

impl Effect {
    /// Whether the force jumps where the velocity reverses.
    pub fn is_dry(self) -> bool {
        matches!(
            self,
            Effect::CoulombFriction
                | Effect::StribeckFriction { .. }
                | Effect::LoadDependentFriction
                | Effect::PositionDependentFriction { .. }
        )
    }

    /// Dry friction of a motion that slides in a direction (+1, −1), continued smoothly past its reversal; none of
    /// another effect.
    #[inline]
    pub(super) fn sliding(self, state: State, excitation: f64, direction: f64) -> Option<f64> {
        match self {
            Effect::StribeckFriction { speed } => {
                Some(direction * (-direction * state.qd / speed.value()).min(OVERSHOOT).exp())
            }
            _ if self.is_dry() => Some(self.force(state.q, direction, excitation)),
            _ => None,
        }
    }
}

/// The direction in which a body at rest begins to slide, given q̈ if it slid forward and if it slid backward; 0 where
/// it sticks.
#[inline]
pub(super) fn direction_from_rest(forward: f64, backward: f64) -> f64 {
    if forward > 0.0 {
        1.0
    } else if backward < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// The share of a step at which a motion that slides in `direction` first comes to rest: the root of the cubic with
/// these q̇ at the step's ends and these q̈ times its length.
#[inline]
pub(super) fn rest_within(direction: f64, qd: [f64; 2], rates: [f64; 2]) -> Option<f64> {
    let [from, to] = qd.map(|qd| direction * qd);
    let [rate, last] = rates.map(|rate| direction * rate);
    if to >= 0.0 && !(rate < 0.0 && last > 0.0) {
        return None;
    }
    let (square, cube) = (3.0 * (to - from) - 2.0 * rate - last, rate + last - 2.0 * (to - from));
    let speed = |share: f64| from + share * (rate + share * (square + share * cube));
    let turns = roots(3.0 * cube, 2.0 * square, rate);
    let inside = |sign: f64| {
        let turning = move |share: &f64| sign * (square + 3.0 * cube * share) > 0.0;
        turns.into_iter().flatten().filter(|share| (0.0..1.0).contains(share)).find(turning)
    };
    let end = if to < 0.0 { 1.0 } else { inside(1.0).filter(|share| speed(*share) < 0.0)? };
    let begin = if from > 0.0 { 0.0 } else { inside(-1.0).filter(|share| *share < end && speed(*share) > 0.0)? };
    Some(root([begin, end], speed))
}

/// The first share of a step from `from` on at which a body that sticks begins to slide, and its direction; q̈ if it
/// slid forward and backward is a function of the share.
pub(super) fn release(from: f64, accelerations: impl Fn(f64) -> [f64; 2]) -> Option<(f64, f64)> {
    let at = |share: f64| {
        let [forward, backward] = accelerations(share);
        direction_from_rest(forward, backward)
    };
    let mut before = from;
    for share in [0.5 * (from + 1.0), 1.0] {
        let direction = at(share);
        if direction != 0.0 {
            let own = |share: f64| {
                let [forward, backward] = accelerations(share);
                if direction > 0.0 { -forward } else { backward }
            };
            return Some((root([before, share], own), direction));
        }
        before = share;
    }
    None
}

/// Real roots of a x² + b x + c.
fn roots(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return [None; 2];
    }
    let larger = -0.5 * (b + b.signum() * discriminant.sqrt());
    [(a != 0.0).then(|| larger / a), (larger != 0.0).then(|| c / larger)]
}

/// A root of a function that is positive (or 0) at the first end and negative at the second, by the Illinois method
/// (Dowell and Jarratt, BIT 11 (1971), 168); the end of the bracket where it is negative or 0.
fn root([mut low, mut high]: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    let width = RESOLUTION * (high - low);
    let (mut above, mut below) = (value(low), value(high));
    let mut last = 0;
    for _ in 0..EVALUATIONS {
        if high - low <= width || below == 0.0 {
            break;
        }
        let next = (low * below - high * above) / (below - above);
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        let there = value(next);
        if there > 0.0 {
            (low, above) = (next, there);
            below *= if last == 1 { 0.5 } else { 1.0 };
            last = 1;
        } else {
            (high, below) = (next, there);
            above *= if last == -1 { 0.5 } else { 1.0 };
            last = -1;
        }
        if next == low && high - low <= 4.0 * f64::EPSILON * high.abs() {
            break;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic with a given value, and its ends as a step has them.
    fn ends(speed: impl Fn(f64) -> f64, rate: impl Fn(f64) -> f64) -> ([f64; 2], [f64; 2]) {
        ([speed(0.0), speed(1.0)], [rate(0.0), rate(1.0)])
    }

    #[test]
    fn the_first_rest_is_found_whichever_way_it_slides() {
        let cubic = |s: f64| (0.3 - s) * (2.0 + s * s);
        let rate = |s: f64| -(2.0 + s * s) + (0.3 - s) * 2.0 * s;
        let (qd, rates) = ends(cubic, rate);
        assert!((rest_within(1.0, qd, rates).unwrap() - 0.3).abs() < 1e-14);
        let [qd, rates] = [qd, rates].map(|pair| pair.map(|value| -value));
        assert!((rest_within(-1.0, qd, rates).unwrap() - 0.3).abs() < 1e-14);
    }

    #[test]
    fn a_dip_through_zero_and_back_is_seen() {
        let (qd, rates) = ends(|s| (s - 0.4) * (s - 0.7), |s| 2.0 * s - 1.1);
        assert!((rest_within(1.0, qd, rates).unwrap() - 0.4).abs() < 1e-14);
        let (qd, rates) = ends(|s| (s - 0.5).powi(2) + 0.01, |s| 2.0 * s - 1.0);
        assert_eq!(rest_within(1.0, qd, rates), None);
    }

    #[test]
    fn from_rest_the_way_out_is_no_reversal_but_the_way_back_is() {
        let (qd, rates) = ends(|s| s * (0.6 - s), |s| 0.6 - 2.0 * s);
        assert!((rest_within(1.0, qd, rates).unwrap() - 0.6).abs() < 1e-14);
        let (qd, rates) = ends(|s| s * (1.6 - s), |s| 1.6 - 2.0 * s);
        assert_eq!(rest_within(1.0, qd, rates), None);
    }

    #[test]
    fn what_sticks_is_released_when_the_other_forces_exceed_friction() {
        let pulled = |s: f64| [3.0 * s * s - 1.2, 3.0 * s * s + 1.2];
        let (share, direction) = release(0.0, pulled).unwrap();
        assert!((share - f64::sqrt(0.4)).abs() < 1e-14 && direction == 1.0, "{share}");
        let (share, direction) = release(0.2, |s: f64| [-2.0 * s - 1.0, -2.0 * s + 1.0]).unwrap();
        assert!((share - 0.5).abs() < 1e-14 && direction == -1.0, "{share}");
        assert_eq!(release(0.0, |s: f64| [s - 1.0, s + 1.0]), None);
    }
}
