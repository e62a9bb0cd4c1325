//! The law that the model knows.

use super::generator::Generator;
use super::plant::Law;
use super::secret::Secret;
use super::sensors::Sensors;
use switchid::law::Term;

/// Terms and coefficients of a law, and its scales.
#[derive(Clone, Debug)]
pub struct Base {
    /// Its terms.
    pub terms: Vec<Term>,
    /// Their coefficients.
    pub coefficients: Vec<f64>,
    /// Angular natural frequency without nonlinearities, rad/s.
    pub omega: f64,
    /// Stiffness at rest, N/m.
    pub stiffness: f64,
    /// Std of the motion that the excitation is scaled for, m.
    pub size: f64,
}

/// A linear oscillator, or one with a cubic spring beside the linear one, in units that are nobody's.
pub fn draw(generator: &mut Generator, secret: &Secret, sensors: Sensors) -> Base {
    let mass = generator.decades(1e-3..1e3);
    let omega = sensors.omega(generator);
    let ratio = generator.decades(0.01..0.1);
    // a pendulum's displacement is an angle
    let angle = secret.has("pendulum_restoring");
    let size = if angle { generator.uniform(0.6..1.1) } else { generator.decades(1e-4..1.0) };
    let stiffness = mass * omega * omega;
    let cubic = generator.uniform(0.05..0.4) * stiffness / (size * size);
    let curved = generator.chance(0.5);
    let mut base = Base { terms: Vec::new(), coefficients: Vec::new(), omega, stiffness, size };
    base.push(Term::Inertia, mass);
    base.push(Term::power(0, 1), 2.0 * ratio * mass * omega);
    base.push(Term::power(1, 0), stiffness);
    if (curved || secret.has("linear_stiffness")) && !secret.has("cubic_stiffness") {
        base.push(Term::power(3, 0), cubic);
    }
    base
}

impl Base {
    fn push(&mut self, term: Term, coefficient: f64) {
        self.terms.push(term);
        self.coefficients.push(coefficient);
    }

    /// The law with time stretched by a factor: a natural period that much longer, stiffness and damping ratio as they
    /// were.
    pub fn stretch(&mut self, factor: f64) {
        for (term, coefficient) in self.terms.iter().zip(&mut self.coefficients) {
            *coefficient *= match *term {
                Term::Inertia => factor * factor,
                term if term == Term::power(0, 1) => factor,
                _ => 1.0,
            };
        }
        self.omega /= factor;
    }

    /// All of it known to the model.
    pub fn law(&self) -> Law {
        Law { terms: self.terms.clone(), coefficients: self.coefficients.clone(), known: self.terms.len() }
    }

    /// The coefficient of a term; 0 where the law does not have it.
    pub fn coefficient(&self, term: Term) -> f64 {
        let index = self.terms.iter().position(|other| *other == term);
        index.map_or(0.0, |index| self.coefficients[index])
    }

    /// The law without a term.
    pub fn without(&self, term: Term) -> Base {
        let mut smaller = self.clone();
        if let Some(index) = self.terms.iter().position(|other| *other == term) {
            smaller.terms.remove(index);
            smaller.coefficients.remove(index);
        }
        smaller
    }
}
