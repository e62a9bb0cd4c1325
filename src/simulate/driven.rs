//! A plant whose excitation comes from outside, one value for each step: behind a controller, in a simulation of
//! others.
//!
//! The integration goes from one communication point to the next, in equal steps no longer than the scenario's inner
//! one, cut where the law switches. So what it shows depends on the steps as far as the excitation does.

use super::error::ScenarioError;
use super::plant::{Law, PlantError, Truth, diverged, sensor_noise, too_far};
use super::reading::Reading;
use super::scenario::Scenario;
use crate::law::{Dynamics, History, Phase};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// A plant under an imposed excitation, and where it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DrivenPlant {
    scenario: Scenario,
    law: Law,
    t: f64,
    phase: Phase,
    past: Past,
}

/// What acted from which time on, as far back as the law's delay reaches; before the first, what acted first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Past {
    values: VecDeque<(f64, f64)>,
    delay: f64,
}

impl Past {
    fn present(&self) -> f64 {
        self.values.back().map_or(0.0, |(_, value)| *value)
    }

    fn add(&mut self, t: f64, value: f64) {
        match self.values.back_mut() {
            Some((begun, last)) if *begun == t => *last = value,
            Some((_, last)) if *last == value => {}
            _ => self.values.push_back((t, value)),
        }
        while self.values.get(1).is_some_and(|(begun, _)| *begun <= t - self.delay) {
            self.values.pop_front();
        }
    }

    fn at(&self, t: f64) -> f64 {
        let after = self.values.partition_point(|(begun, _)| *begun <= t);
        self.values.get(after.saturating_sub(1)).map_or(0.0, |(_, value)| *value)
    }
}

impl History for Past {
    fn over(&self, from: f64, to: f64) -> [f64; 3] {
        let begun = self.values.partition_point(|(begun, _)| *begun <= from);
        let within = self.values.iter().skip(begun).take_while(|(begun, _)| *begun < to);
        let (mut start, mut value, mut sum) = (from, self.at(from), 0.0);
        for (begun, next) in within {
            sum += value * (begun - start);
            (start, value) = (*begun, *next);
        }
        if start == from {
            return [value; 3];
        }
        [(sum + value * (to - start)) / (to - from); 3]
    }
}

impl DrivenPlant {
    /// A plant at t = 0, on which nothing acts yet; of the scenario's excitation only `sample_time` counts, over which
    /// a reading's noise stays.
    ///
    /// # Errors
    /// What [`Scenario::check`] refuses, and a law without inertia, which moves nothing.
    pub fn new(scenario: Scenario) -> Result<DrivenPlant, ScenarioError> {
        if scenario.is_force_law() {
            return Err(ScenarioError::NoInertia);
        }
        scenario.check()?;
        let law = Law::of(&scenario);
        let phase = Dynamics::new(law.motion(&scenario, 0))?.rest(scenario.initial);
        let past = Past { delay: law.delay(), ..Past::default() };
        Ok(DrivenPlant { scenario, law, t: 0.0, phase, past })
    }

    /// Moves to time t, s, the excitation being this all the way.
    ///
    /// # Errors
    /// [`PlantError`]; the plant then stays where it was.
    pub fn advance_to(&mut self, t: f64, excitation: f64) -> Result<(), PlantError> {
        if !t.is_finite() {
            return Err(PlantError::Time { t });
        }
        if !excitation.is_finite() {
            return Err(PlantError::Excitation { t: self.t, value: excitation });
        }
        let dt = t - self.t;
        if dt < -self.resolution(t) {
            return Err(PlantError::Backwards { t, present: self.t });
        }
        let steps = (dt / self.scenario.inner_step - Scenario::ROUNDING).ceil().max(1.0);
        too_far(steps, self.t, self.scenario.inner_step)?;
        let mut past = self.past.clone();
        past.add(self.t, excitation);
        let node = |number: u64| if number == steps as u64 { t } else { self.t + dt * (number as f64 / steps) };
        let phase = (0..steps as u64)
            .fold(self.phase, |phase, number| self.integrate(phase, node(number), node(number + 1), &past));
        diverged(&phase, t)?;
        (self.t, self.phase, self.past) = (t, phase, past);
        Ok(())
    }

    /// The excitation that acted last; 0 before the first step.
    pub fn excitation(&self) -> f64 {
        self.past.present()
    }

    /// q̈ now, m/s², under the excitation that acted last.
    pub fn acceleration(&self) -> f64 {
        self.law.acceleration(&self.scenario, self.truth().stage, &self.phase, self.t, &self.past)
    }

    /// What is measured now; the excitation is the one that acted last.
    pub fn reading(&self) -> Reading {
        let noise = sensor_noise(&self.scenario, self.t);
        Reading {
            t: self.t,
            q: self.phase.state.q + noise.q,
            qd: self.phase.state.qd + noise.qd,
            excitation: self.past.present() + noise.force,
        }
    }

    /// What is the case now.
    pub fn truth(&self) -> Truth<'_> {
        let stage = self.scenario.stage_at(self.t + self.resolution(self.t));
        Truth { stage, coefficients: &self.scenario.stages[stage].coefficients, state: self.phase.state }
    }

    /// Differences of time that rounding explains, s.
    fn resolution(&self, t: f64) -> f64 {
        Scenario::ROUNDING * self.scenario.inner_step + 4.0 * f64::EPSILON * t.abs()
    }

    fn integrate(&self, mut phase: Phase, mut from: f64, to: f64, past: &Past) -> Phase {
        let stages = &self.scenario.stages;
        let mut stage = self.scenario.stage_at(from + self.resolution(from));
        while let Some(next) = stages.get(stage + 1).filter(|next| next.start < to - self.resolution(to)) {
            phase = self.law.step(&self.scenario, stage, &phase, [from, next.start], past.present(), past);
            from = next.start;
            stage += 1;
        }
        self.law.step(&self.scenario, stage, &phase, [from, to], past.present(), past)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_past_reaches_as_far_back_as_asked() {
        let mut past = Past { delay: 1.0, ..Past::default() };
        for (t, value) in [(0.0, 1.0), (0.5, 1.0), (1.0, 3.0), (1.5, 2.0), (2.75, 5.0)] {
            past.add(t, value);
        }
        assert_eq!(past.values, [(1.5, 2.0), (2.75, 5.0)]);
        assert_eq!((past.at(2.0), past.at(0.0), past.at(9.0), past.present()), (2.0, 2.0, 5.0, 5.0));
        assert_eq!((past.over(2.0, 2.5), past.over(2.25, 3.25)), ([2.0; 3], [3.5; 3]));
    }
}
