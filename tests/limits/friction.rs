//! A block of mass 1 on a spring with dry friction, in closed form: between reversals it swings about ∓f/k.

use switchid::law::{Drive, Effect, State, Term};
use switchid::limits::{Course, Law};

#[derive(Clone, Copy)]
pub struct Block {
    pub stiffness: f64,
    pub friction: f64,
}

pub fn law(block: &Block) -> Law {
    let friction = Term::Effect(Effect::CoulombFriction);
    let pairs = [(Term::Inertia, 1.0), (Term::power(1, 0), block.stiffness), (friction, block.friction)];
    Law::new(&pairs, &[1, 2]).unwrap()
}

pub fn course(block: &Block, start: State, dt: f64, count: usize) -> Course {
    let t = (0..=count).map(|k| k as f64 * dt).collect();
    Course { t, drives: vec![Drive::Held(0.0); count], states: block.motion(start, dt, count) }
}

impl Block {
    /// The states at multiples of dt, as long as the block does not stick.
    pub fn motion(&self, start: State, dt: f64, count: usize) -> Vec<State> {
        (0..=count).map(|k| self.at(start, k as f64 * dt)).collect()
    }

    fn at(&self, mut state: State, mut time: f64) -> State {
        let omega = self.stiffness.sqrt();
        loop {
            let direction = if state.qd != 0.0 { state.qd.signum() } else { -state.q.signum() };
            let centre = -direction * self.friction / self.stiffness;
            let from = state.q - centre;
            let phase = (-state.qd / omega).atan2(from);
            let half_turns = (phase / std::f64::consts::PI + 1e-12).floor() + 1.0;
            let until = (half_turns * std::f64::consts::PI - phase) / omega;
            let swing = |t: f64| {
                let (sin, cos) = (omega * t).sin_cos();
                State { q: centre + from * cos + state.qd / omega * sin, qd: state.qd * cos - omega * from * sin }
            };
            if time <= until {
                return swing(time);
            }
            state = State { q: swing(until).q, qd: 0.0 };
            time -= until;
        }
    }
}
