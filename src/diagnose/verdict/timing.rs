//! How the sensors of a record keep time.

use super::case::Case;
use super::errors::TIE;
use super::law::Law;
use crate::diagnose::judge::{COUNT, delay_of};
use crate::law::Term;
use crate::law::numerals::{digits, number};

/// Std that a delay must be away from 0 to be said.
const SURE: f64 = 3.0;

/// How late the channels of a record are, s, each with its std.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// How late F is recorded; negative where it acts later than recorded. None without an excitation.
    pub force: Option<[f64; 2]>,
    /// How late q̇ is behind the derivative of q. None where one of them is absent.
    pub velocity: Option<[f64; 2]>,
    /// q̇ ÷ the derivative of q.
    pub scale: Option<f64>,
    /// Whether q̇ is computed from q, so that it is no second measurement.
    pub is_derivative: Option<bool>,
    /// Whether q̇ is the derivative of q at all.
    pub is_velocity: Option<bool>,
    /// Whether the law leaves clearly less with the delay of F than without.
    pub force_is_clear: bool,
    /// How much q wandered over the first recording, m, before its drift was taken out; none where it does not.
    pub wandering: Option<f64>,
    /// Usual distance of two samples, s.
    sample_time: f64,
}

impl Clock {
    /// Of the first recording, as a law has it; what an effect of the law takes is no sensor's.
    pub(in crate::diagnose) fn of(case: &Case, law: &Law, wandering: &[f64]) -> Clock {
        let taken = law.terms.iter().find_map(|term| delay_of(*term)).unwrap_or(0.0);
        let kinematics = case.record.motions.first().and_then(|motion| motion.kinematics);
        Clock {
            force: law.delay.map(|[late, std]| [taken - late, std]),
            velocity: kinematics.map(|found| [found.lag, found.lag_std]),
            scale: kinematics.map(|found| found.scale),
            is_derivative: kinematics.map(|found| found.is_derivative),
            is_velocity: kinematics.map(|found| found.is_velocity()),
            force_is_clear: is_clear(case, law),
            wandering: wandering.first().copied(),
            sample_time: case.record.sample_time,
        }
    }

    /// What is to be said of it, one sentence each; nothing where all is in time.
    pub fn sentences(&self) -> Vec<String> {
        let late = |[delay, std]: [f64; 2]| delay.abs() > SURE * std && delay.abs() > 0.5 * self.sample_time;
        let milliseconds = |[delay, std]: [f64; 2]| format!("{} ms", number(1e3 * delay.abs(), 1e3 * std));
        let mut said = Vec::new();
        if let Some(wandering) = self.wandering {
            said.push(format!(
                "q drifts by {} over the record: taken out before anything was judged; mend its sensor",
                digits(wandering, 3)
            ));
        }
        match (self.is_derivative, self.is_velocity) {
            (Some(true), _) => said.push("qd is computed from q: it is no second measurement".into()),
            (_, Some(false)) => {
                said.push("qd is not the derivative of q: it is left out; check its column and unit".into())
            }
            _ => {}
        }
        if let Some(scale) =
            self.scale.filter(|scale| (scale.abs() - 1.0).abs() > 0.05 && self.is_velocity == Some(true))
        {
            said.push(format!("qd is {} times the derivative of q: check its unit", digits(scale, 4)));
        }
        if self.scale.is_some_and(|scale| scale < 0.0) && self.is_velocity == Some(true) {
            said.push("qd has the sign of −q̇".into());
        }
        if let Some(velocity) = self.velocity.filter(|own| late(*own) && self.is_velocity == Some(true)) {
            let direction = if velocity[0] > 0.0 { "late" } else { "early" };
            said.push(format!("qd comes {} {direction} against q", milliseconds(velocity)));
        }
        match self.force.filter(|own| late(*own) && self.force_is_clear) {
            Some(force) if force[0] > 0.0 => {
                said.push(format!("F comes {} late: its sensor or bus", milliseconds(force)));
            }
            Some(force) => {
                said.push(format!("F comes {} early, or acts so much later: sensor or drive", milliseconds(force)))
            }
            None => {}
        }
        said
    }
}

/// Whether the law's held-out errors are clearly lower with the delay of F refitted than without any but its own. Where
/// F is the output, a delay τ of c q̇ + k q is c τ q̈ + k τ q̇, a mass and a damping as well: no sensor is blamed for
/// it.
fn is_clear(case: &Case, law: &Law) -> bool {
    if !law.terms.contains(&Term::Inertia) {
        return false;
    }
    let punctual = case.folds.judge(&case.punctual(&law.terms));
    let standing = case.at(&law.terms, law.timing);
    standing.is_some_and(|standing| standing.held.score(&punctual) < -TIE * COUNT as f64)
}
