//! A model file: which terms a law may have, what is known of them, and which columns of a recording it reads.

use super::compiled::Compiled;
use super::effect::Effect;
use super::expression::Expression;
use super::hold::Hold;
use super::model_error::ModelError;
use super::term::{Monomial, Term};
use super::units::ColumnUnits;
use serde::{Deserialize, Serialize};

/// What the user knows of a coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Given {
    /// Estimated; the term stays in the law.
    Fit,
    /// Known and held at this value.
    Known(f64),
    /// Evidence decides whether the law has the term.
    Maybe,
}

impl Given {
    /// Whether the coefficient is to be estimated.
    pub fn is_free(self) -> bool {
        !matches!(self, Given::Known(_))
    }
}

/// One term of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelTerm {
    /// What the coefficient multiplies.
    pub term: Term,
    /// What is known of the coefficient.
    pub given: Given,
    /// The name the user wrote: an effect id stays one when the model is written again.
    pub key: String,
    /// Which inner parameters, in their order, are still to be fitted; the others are held at their values.
    pub open: Vec<bool>,
}

impl ModelTerm {
    /// A term under its canonical name, its inner parameters held as they are.
    pub fn new(term: Term, given: Given) -> ModelTerm {
        let inner = term.effect().map_or(0, |effect| effect.inner().len());
        ModelTerm { term, given, key: term.name(), open: vec![false; inner] }
    }
}

/// Which column of a measurement holds which quantity; `None` is the default name, which need not be there.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Columns {
    /// Time, s.
    pub t: Option<String>,
    /// Displacement.
    pub q: Option<String>,
    /// Velocity.
    pub qd: Option<String>,
    /// Excitation.
    #[serde(rename = "F")]
    pub excitation: Option<String>,
    /// Whether those that are not named are looked for by names, units and numbers; where none is named they always
    /// are.
    #[serde(skip)]
    pub rest_is_guessed: bool,
}

impl Columns {
    /// Whether columns that nobody named are looked for.
    pub fn guesses(&self) -> bool {
        let Columns { t, q, qd, excitation, rest_is_guessed } = self;
        *rest_is_guessed || [t, q, qd, excitation].into_iter().all(Option::is_none)
    }
}

/// A model of one coordinate, as its TOML file says it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// The user's name for it.
    pub name: String,
    /// What the excitation does between samples, where the file says so.
    pub hold: Option<Hold>,
    /// Which columns of a measurement it reads.
    pub columns: Columns,
    /// Which units these columns are in.
    pub units: ColumnUnits,
    /// The terms on the left-hand side, in the order of the file.
    pub terms: Vec<ModelTerm>,
    /// Terms of U₀ that are total time derivatives, `q^n*qd`: their variation integrates to zero, so that no data can
    /// determine them. They are kept to be reported.
    pub potential: Vec<Term>,
    /// The user's own effects, each with the values of its inner parameters; [`Term::Expression`] counts them. One that
    /// no term names is a candidate.
    pub expressions: Vec<Expression>,
}

impl Model {
    /// The most terms a model may have.
    pub const MAX_TERMS: usize = Compiled::MAX_TERMS;

    /// The default identifier's model: the full cubic library of eq. (11), all "maybe" but the inertia, and the
    /// constant times δq̇, which integrates to zero.
    pub fn cubic_library() -> Model {
        let powers = [(0, 0), (1, 0), (0, 1), (0, 2), (2, 0), (1, 1), (0, 3), (3, 0), (2, 1), (1, 2)];
        let maybe = powers.map(|(q, qd)| (Term::power(q, qd), Given::Maybe));
        let terms = std::iter::once((Term::Inertia, Given::Fit)).chain(maybe);
        Model { potential: vec![Term::power(0, 1)], ..Model::of("full cubic library", terms) }
    }

    /// A model of these terms, each under its canonical name.
    pub fn of(name: &str, terms: impl IntoIterator<Item = (Term, Given)>) -> Model {
        let terms = terms.into_iter().map(|(term, given)| ModelTerm::new(term, given)).collect();
        let (columns, units) = (Columns::default(), ColumnUnits::default());
        let (potential, expressions) = (Vec::new(), Vec::new());
        Model { name: name.into(), hold: None, columns, units, terms, potential, expressions }
    }

    /// The model with only the named terms, each "fit", as the FMU parameter `terms` asks. A term that the model has
    /// keeps its inner parameters.
    ///
    /// # Errors
    /// [`ModelError::Term`] for a text that is no term; what [`Model::check`] refuses.
    pub fn with_terms<'a>(&self, names: impl IntoIterator<Item = &'a str>) -> Result<Model, ModelError> {
        let fit = |name: &str| {
            let known = self.terms.iter().find(|entry| entry.key == name);
            let entry = known.cloned().map_or_else(|| self.named(name), Ok)?;
            Ok(ModelTerm { given: Given::Fit, ..entry })
        };
        let terms = names.into_iter().map(fit).collect::<Result<Vec<_>, ModelError>>()?;
        let model = Model { terms, potential: Vec::new(), ..self.clone() };
        model.check()?;
        Ok(model)
    }

    /// The model with every coefficient to be fitted.
    pub fn freed(&self) -> Model {
        let fit = |entry: &ModelTerm| ModelTerm { given: Given::Fit, ..entry.clone() };
        Model { terms: self.terms.iter().map(fit).collect(), ..self.clone() }
    }

    /// The term of that name, "fit", its inner parameters open.
    ///
    /// # Errors
    /// [`ModelError::Term`] where there is none.
    pub fn named(&self, name: &str) -> Result<ModelTerm, ModelError> {
        let own = self.expressions.iter().position(|expression| expression.name() == name);
        let (term, inner) = match own {
            Some(index) => (self.expressions[index].term(index), self.expressions[index].parameters().len()),
            None => {
                let term = Term::parse(name).map_err(|source| ModelError::Term { source })?;
                (term, term.effect().map_or(0, |effect| effect.inner().len()))
            }
        };
        Ok(ModelTerm { term, given: Given::Fit, key: name.into(), open: vec![true; inner] })
    }

    /// The first term that cannot be identified sample by sample.
    ///
    /// # Errors
    /// [`ModelError::Open`] where it has an inner parameter that is to be fitted, [`ModelError::Time`] where it depends
    /// on time, [`ModelError::Memory`] where its force is no function of the present state and excitation,
    /// [`ModelError::ExcitationAlone`] where it is the excitation and nothing gives that a scale.
    pub fn check_streaming(&self) -> Result<(), ModelError> {
        self.check_scale()?;
        for entry in &self.terms {
            if let Some(inner) = entry.open.iter().position(|open| *open) {
                let key = entry.key.clone();
                return Err(ModelError::Open { key, inner: self.inner_names(entry.term).swap_remove(inner) });
            }
        }
        let of_time = |entry: &&ModelTerm| self.formula(entry.term).is_some_and(|own| own.uses("t"));
        if let Some(entry) = self.terms.iter().find(of_time) {
            return Err(ModelError::Time { key: entry.key.clone() });
        }
        let terms: Vec<Term> = self.terms.iter().map(|entry| entry.term).collect();
        let refused = Compiled::refused(&terms).and_then(|term| self.position(term));
        refused.map_or(Ok(()), |index| Err(ModelError::Memory { key: self.terms[index].key.clone() }))
    }

    /// Checks that there is something to identify. In free motion the inertia only sets the scale.
    ///
    /// # Errors
    /// [`ModelError::NothingFree`].
    pub fn check_free(&self, forced: bool) -> Result<(), ModelError> {
        let is_free = |entry: &ModelTerm| entry.given.is_free() && (forced || entry.term != Term::Inertia);
        if self.terms.iter().any(is_free) { Ok(()) } else { Err(ModelError::NothingFree { forced }) }
    }

    /// The formula of a term that is a user's own effect.
    pub fn formula(&self, term: Term) -> Option<&Expression> {
        match term {
            Term::Expression(own) => self.expressions.get(own.place()),
            _ => None,
        }
    }

    /// Names of a term's inner parameters, in their order.
    pub fn inner_names(&self, term: Term) -> Vec<String> {
        term.inner_named(&self.expressions).into_iter().map(|(name, _)| name).collect()
    }

    /// Where the term stands among [`Model::terms`].
    pub fn position(&self, term: Term) -> Option<usize> {
        self.terms.iter().position(|entry| entry.term == term)
    }

    /// Checks what the TOML reader cannot: each term once, not too many.
    ///
    /// # Errors
    /// The first rule that is broken.
    pub fn check(&self) -> Result<(), ModelError> {
        if self.terms.is_empty() {
            return Err(ModelError::NoTerms);
        }
        if self.terms.len() > Model::MAX_TERMS {
            return Err(ModelError::TooMany { count: self.terms.len(), max: Model::MAX_TERMS });
        }
        for (index, entry) in self.terms.iter().enumerate() {
            if let Some(first) = self.terms[..index].iter().find(|other| canonical(other.term) == canonical(entry.term))
            {
                return Err(ModelError::Twice { first: first.key.clone(), second: entry.key.clone() });
            }
        }
        Ok(())
    }

    /// Checks that the law is one of motion.
    ///
    /// # Errors
    /// [`ModelError::NoInertia`], [`ModelError::Inertia`].
    pub fn check_inertia(&self) -> Result<(), ModelError> {
        let entry = &self.terms[self.position(Term::Inertia).ok_or(ModelError::NoInertia)?];
        match entry.given {
            Given::Known(value) if value <= 0.0 => Err(ModelError::Inertia { key: entry.key.clone(), value }),
            _ => Ok(()),
        }
    }

    /// Whether F is what the law gives, F = Σ θ_j f_j(q, q̇): no term multiplies q̈.
    pub fn is_force_law(&self) -> bool {
        self.terms.iter().all(|entry| !entry.term.is_inertial())
    }

    /// Checks that F stands on one side of a law that gives it.
    ///
    /// # Errors
    /// [`ModelError::OutputAmongTerms`].
    pub fn check_force_law(&self) -> Result<(), ModelError> {
        match self.terms.iter().find(|entry| entry.term.uses_excitation()) {
            Some(entry) => Err(ModelError::OutputAmongTerms { key: entry.key.clone() }),
            None => Ok(()),
        }
    }

    /// Refuses the excitation as a term where no known coefficient gives forces a scale: F = F then solves every
    /// equation.
    fn check_scale(&self) -> Result<(), ModelError> {
        let scales = |entry: &ModelTerm| matches!(entry.given, Given::Known(value) if value != 0.0);
        let alone = |entry: &&ModelTerm| entry.term == Term::EXCITATION && entry.given.is_free();
        match self.terms.iter().find(alone) {
            Some(entry) if !self.terms.iter().any(scales) => {
                Err(ModelError::ExcitationAlone { key: entry.key.clone() })
            }
            _ => Ok(()),
        }
    }
}

/// One term for all that have the same feature.
fn canonical(term: Term) -> Term {
    match term {
        Term::Effect(Effect::ExcitationGainNonlinearity { power }) => {
            Term::Monomial(Monomial { excitation: power.value() as u8, ..Monomial::default() })
        }
        _ => term,
    }
}
