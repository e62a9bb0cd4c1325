//! What makes a scenario impossible, found before the plant moves.

use super::error::ScenarioError;
use super::excitation::{Excitation, ExcitationKind};
use super::scenario::{Scenario, Stage};
use crate::law::{Dynamics, Motion, Term};

impl Scenario {
    /// Checks everything that would make the plant fail later.
    ///
    /// # Errors
    /// The first rule that is broken.
    pub fn check(&self) -> Result<(), ScenarioError> {
        self.check_terms()?;
        self.check_numbers()?;
        self.check_excitation()?;
        self.check_hidden()?;
        self.check_stages()
    }

    fn check_terms(&self) -> Result<(), ScenarioError> {
        for (index, &term) in self.terms.iter().enumerate() {
            if self.terms[..index].contains(&term) {
                return Err(ScenarioError::Twice { term });
            }
        }
        match (self.is_force_law(), self.terms.contains(&Term::Inertia)) {
            (true, _) => self.check_imposed(),
            (false, true) => Ok(()),
            (false, false) => Err(ScenarioError::NoInertia),
        }
    }

    /// Checks what a law that gives F needs of the machine and of its terms.
    fn check_imposed(&self) -> Result<(), ScenarioError> {
        let mut terms = self.terms.iter().copied().chain(self.hidden.terms());
        if let Some(term) = terms.find(|term| term.uses_excitation()) {
            return Err(ScenarioError::OutputAmongTerms { term });
        }
        match self.excitation.kind {
            ExcitationKind::None => Err(ScenarioError::NothingMoves { kind: "none", why: "imposes no motion" }),
            ExcitationKind::WhiteNoise => {
                Err(ScenarioError::NothingMoves { kind: "white_noise", why: "has no velocity" })
            }
            _ => {
                let velocity = self.initial.qd;
                within("initial.qd", velocity, velocity == 0.0, "0 where a machine imposes q: the excitation gives it")
            }
        }
    }

    fn check_numbers(&self) -> Result<(), ScenarioError> {
        let positive = [
            ("duration", self.duration),
            ("inner_step", self.inner_step),
            ("excitation.sample_time", self.excitation.sample_time),
        ];
        for (name, value) in positive {
            within(name, value, value > 0.0, "a positive number of seconds")?;
        }
        let not_negative = [
            ("excitation.intensity", self.excitation.intensity),
            ("noise.q", self.noise.q),
            ("noise.qd", self.noise.qd),
            ("noise.F", self.noise.force),
        ];
        for (name, value) in not_negative {
            within(name, value, value >= 0.0, "0 or a positive number")?;
        }
        for (name, value) in [("initial.q", self.initial.q), ("initial.qd", self.initial.qd)] {
            within(name, value, true, "a finite number")?;
        }
        let ratio = self.excitation.sample_time / self.inner_step;
        within("inner_step", self.inner_step, ratio <= 1e6, "at least a millionth of excitation.sample_time")
    }

    fn check_excitation(&self) -> Result<(), ScenarioError> {
        let Excitation { from, to, count, rms, period, .. } = self.excitation;
        within("excitation.from", from, from >= 0.0, "0 or a positive number")?;
        within("excitation.to", to, to >= from, "not below excitation.from")?;
        within("excitation.rms", rms, rms >= 0.0, "0 or a positive number")?;
        within("excitation.period", period, period > 0.0, "a positive number of seconds")?;
        let allowed = (1..=Excitation::MAX_COUNT).contains(&count);
        within("excitation.count", f64::from(count), allowed, "a whole number from 1 to 1000")
    }

    fn check_hidden(&self) -> Result<(), ScenarioError> {
        let mut wrong = self.hidden.terms().zip(self.hidden.coefficients()).filter(|(_, value)| !value.is_finite());
        if let Some((term, value)) = wrong.next() {
            return Err(ScenarioError::StageNumber { stage: 1, name: format!("hidden {term}"), value });
        }
        let terms: Vec<Term> = self.terms.iter().copied().chain(self.hidden.terms()).collect();
        Dynamics::new(Motion::new(&terms, &[]).with(self.hidden.expressions()))?;
        Ok(())
    }

    fn check_stages(&self) -> Result<(), ScenarioError> {
        let first = self.stages.first().ok_or(ScenarioError::NoStages)?;
        if first.start != 0.0 {
            return Err(ScenarioError::FirstStart { start: first.start });
        }
        for (index, stage) in self.stages.iter().enumerate() {
            self.check_stage(index + 1, stage)?;
        }
        for (index, pair) in self.stages.windows(2).enumerate() {
            let (previous, start) = (pair[0].start, pair[1].start);
            if start <= previous {
                return Err(ScenarioError::Order { stage: index + 2, start, previous });
            }
        }
        Ok(())
    }

    fn check_stage(&self, number: usize, stage: &Stage) -> Result<(), ScenarioError> {
        let (expected, found) = (self.terms.len(), stage.coefficients.len());
        if expected != found {
            return Err(ScenarioError::Count { stage: number, expected, found });
        }
        let named = [("start", stage.start), ("amplitude", stage.amplitude), ("omega", stage.omega)];
        let named = named.into_iter().map(|(name, value)| (name.to_string(), value));
        let coefficients = self.terms.iter().zip(&stage.coefficients).map(|(term, value)| (term.name(), *value));
        if let Some((name, value)) = named.chain(coefficients).find(|(_, value)| !value.is_finite()) {
            return Err(ScenarioError::StageNumber { stage: number, name, value });
        }
        let mut inertia = self.terms.iter().zip(&stage.coefficients).filter(|(term, _)| **term == Term::Inertia);
        if inertia.any(|(_, value)| *value == 0.0) {
            return Err(ScenarioError::ZeroInertia { stage: number });
        }
        Ok(())
    }
}

fn within(name: &'static str, value: f64, holds: bool, range: &'static str) -> Result<(), ScenarioError> {
    if holds && value.is_finite() { Ok(()) } else { Err(ScenarioError::OutOfRange { name, value, range }) }
}
