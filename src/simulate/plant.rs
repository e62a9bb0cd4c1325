//! A plant in motion.
//!
//! The inner integration runs on its own grid, the excitation's grid refined by a whole number of RK4 steps, and cuts a
//! step in two where the law switches within it. A value between two points of the inner grid comes from a shortened
//! step that is then thrown away, so that what a plant shows at t does not depend on the way there.

use super::error::ScenarioError;
use super::excitation::ExcitationKind;
use super::imposed;
use super::noise::{Stream, standard_normal};
use super::reading::Reading;
use super::scenario::{Scenario, SensorNoise};
use crate::law::{Dynamics, Effect, History, MAX_MEMORY, Motion, Phase, State, Term};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What no estimator may see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth<'a> {
    /// Index of the present stage, from 0.
    pub stage: usize,
    /// Its coefficients, in the order of the scenario's terms.
    pub coefficients: &'a [f64],
    /// Displacement and velocity without noise.
    pub state: State,
}

/// Why a plant did not advance; it stays as it was.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum PlantError {
    /// No time.
    #[error("a plant cannot advance to t = {t}")]
    Time {
        /// The time asked for, s.
        t: f64,
    },
    /// A time that is past.
    #[error("a plant at t = {present} s cannot go back to {t} s: restore a saved state instead")]
    Backwards {
        /// The time asked for, s.
        t: f64,
        /// The time reached, s.
        present: f64,
    },
    /// A step that would take too long.
    #[error("from t = {from} s to t = {to} s is too far for one step: take steps of {longest} s or less")]
    TooFar {
        /// The time reached, s.
        from: f64,
        /// The time asked for, s.
        to: f64,
        /// How far a step may go, s.
        longest: f64,
    },
    /// An excitation that is no number.
    #[error("the excitation from t = {t} s on is {value}: it must be a finite number")]
    Excitation {
        /// From when on, s.
        t: f64,
        /// Its value.
        value: f64,
    },
    /// The motion grew beyond all numbers.
    #[error("the motion diverges before t = {t} s: the law has no bounded motion from this state")]
    Diverged {
        /// A time by which it had, s.
        t: f64,
    },
}

/// The most inner steps that one call takes, some seconds of computing: whoever asks for more waits in vain.
const MAX_STEPS: f64 = 1e7;

/// Refuses more inner steps than a caller would wait for.
pub(super) fn too_far(steps: f64, from: f64, step: f64) -> Result<(), PlantError> {
    match steps > MAX_STEPS {
        true => Err(PlantError::TooFar { from, to: from + steps * step, longest: MAX_STEPS * step }),
        false => Ok(()),
    }
}

/// Refuses a state beyond all numbers.
pub(super) fn diverged(phase: &Phase, t: f64) -> Result<(), PlantError> {
    if phase.is_finite() { Ok(()) } else { Err(PlantError::Diverged { t }) }
}

/// The sensors' noise at time t, drawn once per interval of the excitation's grid.
pub(super) fn sensor_noise(scenario: &Scenario, t: f64) -> SensorNoise {
    noise_of(scenario, interval(scenario, t))
}

/// The sensors' noise in that interval of the excitation's grid.
pub(super) fn noise_of(scenario: &Scenario, index: u64) -> SensorNoise {
    let noise = |std: f64, stream| match std {
        0.0 => 0.0,
        std => std * standard_normal(scenario.seed, stream, index),
    };
    SensorNoise {
        q: noise(scenario.noise.q, Stream::Displacement),
        qd: noise(scenario.noise.qd, Stream::Velocity),
        force: noise(scenario.noise.force, Stream::Force),
    }
}

/// The interval of the excitation's grid to which t belongs.
pub(super) fn interval(scenario: &Scenario, t: f64) -> u64 {
    (t / scenario.excitation.sample_time + Scenario::TIME_JITTER).floor().max(0.0) as u64
}

/// A plant: its scenario, which does not change, and where it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plant {
    pub(super) scenario: Scenario,
    pub(super) law: Law,
    /// Phases of the multisine, rad.
    phases: Vec<f64>,
    /// Last point of the inner grid that was reached, and the phase there.
    node: u64,
    at_node: Phase,
    /// The time asked for last, and the phase there.
    t: f64,
    phase: Phase,
}

/// The scenario's terms and the hidden ones, with the coefficients of each stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Law {
    terms: Vec<Term>,
    coefficients: Vec<Vec<f64>>,
    /// Whether no term keeps it from being smooth.
    pub(super) smooth: bool,
}

impl Law {
    pub(super) fn of(scenario: &Scenario) -> Law {
        let Scenario { terms, hidden, stages, .. } = scenario;
        let terms: Vec<Term> = terms.iter().copied().chain(hidden.terms()).collect();
        let all = stages.iter().map(|stage| stage.coefficients.iter().copied().chain(hidden.coefficients()).collect());
        Law { smooth: terms.iter().copied().all(is_smooth), coefficients: all.collect(), terms }
    }

    /// A term that keeps it from being smooth.
    pub(super) fn rough(&self) -> Option<Term> {
        self.terms.iter().copied().find(|term| !is_smooth(*term))
    }

    pub(super) fn motion<'a>(&'a self, scenario: &'a Scenario, stage: usize) -> Motion<'a> {
        Motion::new(&self.terms, &self.coefficients[stage]).with(scenario.hidden.expressions())
    }

    /// How far back the excitation acts, s.
    pub(super) fn delay(&self) -> f64 {
        let delay = |term: &Term| match term {
            Term::Effect(Effect::ExcitationDelay { delay }) => delay.value(),
            _ => 0.0,
        };
        self.terms.iter().map(delay).fold(0.0, f64::max)
    }

    /// q̈ at time t, s.
    pub(super) fn acceleration(
        &self,
        scenario: &Scenario,
        stage: usize,
        phase: &Phase,
        t: f64,
        history: &impl History,
    ) -> f64 {
        let dynamics = Dynamics::new(self.motion(scenario, stage));
        dynamics.map_or(f64::NAN, |dynamics| dynamics.acceleration(phase, t, history))
    }

    /// From one time to another, within which neither law nor excitation changes.
    pub(super) fn step(
        &self,
        scenario: &Scenario,
        stage: usize,
        phase: &Phase,
        [from, to]: [f64; 2],
        excitation: f64,
        history: &impl History,
    ) -> Phase {
        let motion = self.motion(scenario, stage);
        if self.smooth {
            return Phase { state: motion.step_held(phase.state, to - from, excitation), ..*phase };
        }
        let dynamics = Dynamics::new(motion);
        dynamics.map_or(NOWHERE, |dynamics| dynamics.step(phase, from, to - from, history))
    }
}

/// Whether the state and the excitation alone determine the term's force, which does not jump.
pub fn is_smooth(term: Term) -> bool {
    term.is_pointwise() && !term.effect().is_some_and(Effect::is_dry)
}

/// Where the motion goes that a law has no numbers for.
const NOWHERE: Phase = Phase { state: State { q: f64::NAN, qd: f64::NAN }, memory: [f64::NAN; MAX_MEMORY] };

impl Plant {
    /// A plant at t = 0.
    ///
    /// # Errors
    /// What [`Scenario::check`] refuses, and a law without inertia, which moves nothing.
    pub fn new(scenario: Scenario) -> Result<Plant, ScenarioError> {
        if scenario.is_force_law() {
            return Err(ScenarioError::NoInertia);
        }
        scenario.check()?;
        let law = Law::of(&scenario);
        let initial = Dynamics::new(law.motion(&scenario, 0))?.rest(scenario.initial);
        let phases = scenario.excitation.phases(scenario.seed);
        Ok(Plant { scenario, law, phases, node: 0, at_node: initial, t: 0.0, phase: initial })
    }

    /// Moves to time t, s.
    ///
    /// # Errors
    /// [`PlantError`]; the plant then stays where it was.
    pub fn advance_to(&mut self, t: f64) -> Result<(), PlantError> {
        if !t.is_finite() {
            return Err(PlantError::Time { t });
        }
        let (node, rest) = self.locate(t);
        if t < self.t - self.resolution(t) || node < self.node {
            return Err(PlantError::Backwards { t, present: self.t });
        }
        too_far((node - self.node) as f64, self.t, self.scenario.inner_step)?;
        let mut at_node = self.at_node;
        for passed in self.node..node {
            at_node = self.integrate(at_node, passed, self.node_time(passed + 1));
        }
        let phase = if rest { self.integrate(at_node, node, t) } else { at_node };
        diverged(&at_node, t)?;
        diverged(&phase, t)?;
        (self.node, self.at_node, self.t, self.phase) = (node, at_node, t, phase);
        Ok(())
    }

    /// What is measured now. Sensor noise is drawn once per interval of the excitation's grid.
    pub fn reading(&self) -> Reading {
        let noise = sensor_noise(&self.scenario, self.t);
        Reading {
            t: self.t,
            q: self.phase.state.q + noise.q,
            qd: self.phase.state.qd + noise.qd,
            excitation: self.held(interval(&self.scenario, self.t)) + noise.force,
        }
    }

    /// What is the case now.
    pub fn truth(&self) -> Truth<'_> {
        let stage = self.scenario.stage_at(self.t + self.resolution(self.t));
        Truth { stage, coefficients: &self.scenario.stages[stage].coefficients, state: self.phase.state }
    }

    /// q̈ now, m/s², under the excitation that is held from now on.
    pub fn acceleration(&self) -> f64 {
        let excitation = self.held(interval(&self.scenario, self.t));
        let held = HeldFrom { plant: self, from: self.t, excitation };
        self.law.acceleration(&self.scenario, self.truth().stage, &self.phase, self.t, &held)
    }

    /// The scenario it was built from.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Differences of time that rounding explains, s.
    pub(super) fn resolution(&self, t: f64) -> f64 {
        Scenario::ROUNDING * self.scenario.excitation.sample_time + 4.0 * f64::EPSILON * t.abs()
    }

    fn node_time(&self, node: u64) -> f64 {
        let substeps = self.scenario.substeps();
        let part = (node % substeps) as f64 / substeps as f64;
        ((node / substeps) as f64 + part) * self.scenario.excitation.sample_time
    }

    /// The last inner point not after t, and whether t lies beyond it.
    fn locate(&self, t: f64) -> (u64, bool) {
        let position = t / self.scenario.excitation.sample_time * self.scenario.substeps() as f64;
        let nearest = position.round().max(0.0) as u64;
        if (t - self.node_time(nearest)).abs() <= self.resolution(t) {
            return (nearest, false);
        }
        (position.floor().max(0.0) as u64, true)
    }

    /// The excitation that is held over an interval of the grid. Its amplitude and frequency are those of the stage
    /// at the interval's start: where a switch falls between two grid points, they follow at the next one.
    pub(super) fn held(&self, interval: u64) -> f64 {
        let excitation = self.scenario.excitation;
        let t = interval as f64 * excitation.sample_time;
        match excitation.kind {
            ExcitationKind::None => 0.0,
            ExcitationKind::Sine => {
                let stage = &self.scenario.stages[self.scenario.stage_at(t + self.resolution(t))];
                stage.amplitude * (stage.omega * t).sin()
            }
            ExcitationKind::WhiteNoise => {
                let std = (excitation.intensity / excitation.sample_time).sqrt();
                std * standard_normal(self.scenario.seed, Stream::Excitation, interval)
            }
            ExcitationKind::Multisine => excitation.multisine(&self.phases, t),
            ExcitationKind::Sweep => excitation.sweep(t),
        }
    }

    /// From inner point `node` to time `end`, at most one inner step later, cut where the law switches.
    fn integrate(&self, mut phase: Phase, node: u64, end: f64) -> Phase {
        let excitation = self.held(node / self.scenario.substeps());
        let mut t = self.node_time(node);
        let mut stage = self.scenario.stage_at(t + self.resolution(t));
        while let Some(next) =
            self.scenario.stages.get(stage + 1).filter(|next| next.start < end - self.resolution(end))
        {
            phase = self.step(stage, &phase, t, next.start, excitation);
            t = next.start;
            stage += 1;
        }
        self.step(stage, &phase, t, end, excitation)
    }

    fn step(&self, stage: usize, phase: &Phase, from: f64, to: f64, excitation: f64) -> Phase {
        let held = HeldFrom { plant: self, from, excitation };
        self.law.step(&self.scenario, stage, phase, [from, to], excitation, &held)
    }
}

/// A plant's excitation: one value from a time on, before that what was held then, and before 0 what was held at 0.
struct HeldFrom<'a> {
    plant: &'a Plant,
    from: f64,
    excitation: f64,
}

impl History for HeldFrom<'_> {
    fn over(&self, from: f64, to: f64) -> [f64; 3] {
        if from >= self.from {
            return [self.excitation; 3];
        }
        if from >= to {
            return [self.plant.held(interval(&self.plant.scenario, from)); 3];
        }
        let sample_time = self.plant.scenario.excitation.sample_time;
        let (mut start, mut sum) = (from, 0.0);
        let mut interval = interval(&self.plant.scenario, from);
        while start < to {
            let next = ((interval + 1) as f64 * sample_time).min(to).max(start);
            sum += self.plant.held(interval) * (next - start);
            (start, interval) = (next, interval + 1);
        }
        [sum / (to - from); 3]
    }
}

/// Why a scenario gives no record.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SimulateError {
    /// The scenario is refused.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// Its motion cannot be followed to the end.
    #[error(transparent)]
    Plant(#[from] PlantError),
}

/// The readings of a whole scenario, of a plant that moves or of one that a machine moves, one per point of the
/// excitation's grid, from 0 to its duration.
///
/// # Errors
/// [`SimulateError`] for a scenario that [`Scenario::check`] refuses or whose motion has no bounds.
pub fn record(scenario: &Scenario) -> Result<Vec<Reading>, SimulateError> {
    if scenario.is_force_law() {
        return Ok(imposed::record(scenario)?);
    }
    let mut plant = Plant::new(scenario.clone())?;
    let sample_time = scenario.excitation.sample_time;
    let last = (scenario.duration / sample_time + Scenario::TIME_JITTER).floor() as u64;
    let mut readings = Vec::with_capacity(last as usize + 1);
    for index in 0..=last {
        plant.advance_to(index as f64 * sample_time)?;
        readings.push(plant.reading());
    }
    Ok(readings)
}
