//! Effects that the catalogue does not have.

use super::drive::low_passed;
use super::generator::Generator;
use std::f64::consts::TAU;
use switchid::law::State;

/// An effect of which no entry of the catalogue is an approximation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// q cos Ωt.
    ParametricStiffness,
    /// q̇ cos Ωt.
    ModulatedDamping,
    /// A sine that is not in F.
    UnmeasuredSine,
    /// Noise near resonance that is not in F.
    UnmeasuredNoise,
    /// A stiffness that grows with time.
    DriftingStiffness,
    /// A stiffness that jumps in the middle of the record.
    JumpingStiffness,
    /// A spring pulled through play: it stays where it was until the play is used up.
    Backlash,
    /// Five relaxation times over three decades, as of a fractional derivative.
    Relaxations,
    /// F arrives late by a time that depends on q.
    DelayByPosition,
    /// An actuator whose gain falls as it heats.
    HeatedActuator,
    /// A force periodic in q with a short period, as of teeth.
    Cogging,
}

/// Relaxations in [`Outside::Relaxations`].
const RELAXATIONS: usize = 5;

impl Outside {
    /// All of them.
    pub const ALL: [Outside; 11] = [
        Outside::ParametricStiffness,
        Outside::ModulatedDamping,
        Outside::UnmeasuredSine,
        Outside::UnmeasuredNoise,
        Outside::DriftingStiffness,
        Outside::JumpingStiffness,
        Outside::Backlash,
        Outside::Relaxations,
        Outside::DelayByPosition,
        Outside::HeatedActuator,
        Outside::Cogging,
    ];

    /// A name for tables.
    pub fn name(self) -> &'static str {
        match self {
            Outside::ParametricStiffness => "outside: parametric stiffness",
            Outside::ModulatedDamping => "outside: modulated damping",
            Outside::UnmeasuredSine => "outside: unmeasured sine",
            Outside::UnmeasuredNoise => "outside: unmeasured noise",
            Outside::DriftingStiffness => "outside: drifting stiffness",
            Outside::JumpingStiffness => "outside: jumping stiffness",
            Outside::Backlash => "outside: backlash",
            Outside::Relaxations => "outside: relaxations",
            Outside::DelayByPosition => "outside: delay by position",
            Outside::HeatedActuator => "outside: heated actuator",
            Outside::Cogging => "outside: cogging",
        }
    }
}

/// An effect at work in a plant.
#[derive(Clone, Debug)]
pub struct Agent {
    effect: Outside,
    std: State,
    omega: f64,
    duration: f64,
    /// What is drawn: a frequency, a share, a phase.
    numbers: [f64; 3],
    sample_time: f64,
    noise: Vec<f64>,
    memory: [f64; RELAXATIONS],
    past: Vec<f64>,
}

impl Agent {
    /// An effect for a motion of these std and natural frequency, over `count` samples.
    pub fn draw(
        generator: &mut Generator,
        effect: Outside,
        std: State,
        omega: f64,
        sample_time: f64,
        count: usize,
    ) -> Agent {
        let numbers = [generator.uniform(0.3..1.7), generator.uniform(0.2..0.6), generator.uniform(0.0..TAU)];
        let noise = low_passed(generator, 1.5 * omega * sample_time, count + 2);
        let duration = sample_time * count as f64;
        Agent { effect, std, omega, duration, numbers, sample_time, noise, memory: [0.0; RELAXATIONS], past: vec![] }
    }

    /// Its force per unit of strength at time t, which it is asked for in steps of `dt`, s.
    pub fn force(&mut self, t: f64, dt: f64, State { q, qd }: State, excitation: f64) -> f64 {
        let [frequency, share, phase] = self.numbers;
        let wave = (frequency * self.omega * t + phase).cos();
        match self.effect {
            Outside::ParametricStiffness => q * wave,
            Outside::ModulatedDamping => qd * wave,
            Outside::UnmeasuredSine => wave,
            Outside::UnmeasuredNoise => self.noise_at(t),
            Outside::DriftingStiffness => q * (t / self.duration - 0.5),
            Outside::JumpingStiffness => q * if t > (0.3 + share) * self.duration { 1.0 } else { 0.0 },
            Outside::Backlash => {
                let play = 2.0 * share * self.std.q;
                self.memory[0] = self.memory[0].clamp(q - play, q + play);
                self.memory[0]
            }
            Outside::Relaxations => self.relaxations(dt, qd),
            Outside::DelayByPosition => self.late(dt, q, excitation),
            Outside::HeatedActuator => {
                let warm = 1.0 - (-dt * self.omega / (TAU * 8.0)).exp();
                self.memory[0] += warm * (excitation * excitation - self.memory[0]);
                excitation * self.memory[0]
            }
            Outside::Cogging => (TAU * q / (3.0 * share * self.std.q) + phase).cos(),
        }
    }

    fn noise_at(&self, t: f64) -> f64 {
        let position = (t / self.sample_time).max(0.0);
        let index = (position as usize).min(self.noise.len() - 2);
        let share = position - index as f64;
        self.noise[index] * (1.0 - share) + self.noise[index + 1] * share
    }

    /// Σ of Maxwell elements with times from 1/30 to 30 ÷ ω, their stiffness falling as √time.
    fn relaxations(&mut self, dt: f64, qd: f64) -> f64 {
        let mut force = 0.0;
        for (index, element) in self.memory.iter_mut().enumerate() {
            let time = 30f64.powf(index as f64 / 2.0 - 1.0) / self.omega;
            let kept = (-dt / time).exp();
            *element = *element * kept + qd * time * (1.0 - kept);
            force += *element / time.sqrt();
        }
        force
    }

    /// F less F as it was a time ago that grows with q.
    fn late(&mut self, dt: f64, q: f64, excitation: f64) -> f64 {
        self.past.push(excitation);
        let delay = 0.3 / self.omega * (q / self.std.q).clamp(0.0, 3.0);
        let back = ((delay / dt) as usize).min(self.past.len() - 1);
        excitation - self.past[self.past.len() - 1 - back]
    }
}
