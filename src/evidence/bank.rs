//! Hypotheses that the law switched, at many instants at once.
//!
//! Each [`Hypothesis`] says: since its start the coefficients differ by δ from those in use. δ makes the innovations ε of the
//! law in use linear in it, ε = ψδ + white, ψ carried from sensitivity 0 at the start (the state is continuous across a
//! switch). With M = Σψψᵀ/s and g = Σψε/s, and a Gaussian prior N(μ, Λ⁻¹) of δ, the log-evidence of the data since the
//! start is
//!
//! ```text
//! ½ (g + Λμ)ᵀ (M + Λ)⁻¹ (g + Λμ) − ½ μᵀΛμ − ½ ln det(M + Λ) + ½ ln det Λ   (+ what all priors share)
//! ```
//!
//! "No switch" has the information that the stage gave on its own coefficients up to the start; "switch" a prior as wide as
//! physics makes plausible. Their difference is the evidence of a switch (Willsky and Jones 1976, with a prior in the
//! place of the maximum). Starts are kept on a grid whose spacing grows with age.

mod instant;

use super::filter::Innovation;
use super::information::Information;
use super::pass::IntervalMap;
use super::single::{Single, either, log_sum};
use super::symmetric::{Lane, System, WIDTH};
use super::weighing::{Belief, Weighing, likelihood};
use serde::{Deserialize, Serialize};

/// Pivots this far below their diagonal are rounding.
const TOLERANCE: f64 = 1e-13;

/// A law that explains its record is trusted with this fraction of its information: its covariance is that of a linearisation.
const CAUTION: f64 = 0.3;

/// One that does not, with this: what it leaves comes and goes with the motion.
const MORE_CAUTION: f64 = 0.03;

/// Evidence of this many levels at once comes from the last samples alone.
const OVERWHELMING: f64 = 10.0;

/// Starts with this much less evidence than the best are as good, nats.
const MARGIN: f64 = 5.0;

/// Starts with this much less evidence than the best are none that a switch may have had, nats.
const FAR_BELOW: f64 = 12.0;

/// Looks at a hypothesis this much older come half as often, samples.
const AGING: f64 = 20.0;

/// Evidence that chance seldom gives a start which lies between others, nats.
const OUTSTANDING: f64 = 4.0;

/// A law of this probability is none, as a logarithm.
const NEGLIGIBLE: f64 = -60.0;

/// A hypothesis whose innovations together hold less than this cannot speak for a switch, nats.
const SILENT: f64 = 4.0;

/// What the law in use knows of its coefficients when a hypothesis starts.
#[derive(Clone, Copy, Debug)]
pub struct Law<'a> {
    /// Information on the coefficients from the stage so far.
    pub information: &'a Information,
    /// Which of them it may have.
    pub open: &'a [bool],
    /// Which of those it has.
    pub own: &'a [bool],
    /// Whether it explains its record down to the sensors' noise.
    pub explains: bool,
}

/// A switch that the data speak for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suspect {
    /// Log-evidence of the switch, nats.
    pub evidence: f64,
    /// Number of the last sample before the switch.
    pub start: u64,
    /// The hypothesis it is.
    index: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Hypothesis {
    start: u64,
    age: u32,
    /// Age at the last look.
    looked: u32,
    evidence: f64,
    /// ½ Σ ε²/s since the start: no change explains more.
    unexplained: f64,
    /// The same at the last look.
    unexplained_then: f64,
    /// ∂q/∂δ and ∂q̇/∂δ, each n long and filled up with zeros.
    sensitivity: [Vec<Lane>; 2],
    information: Information,
    /// Λ of "no switch", as [`Information::matrix`].
    prior: Vec<f64>,
    /// Λμ of "no switch": what the stage up to the start says about the coefficients in use.
    pull: Vec<f64>,
    /// With every coefficient that the law may have.
    full: Unswitched,
    /// With its own alone, where it has dropped others.
    own: Unswitched,
}

/// "No switch", of a law with certain terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Unswitched {
    active: Vec<bool>,
    /// μᵀΛμ.
    at_mean: f64,
    /// ln det Λ.
    log_determinant: f64,
    /// Logarithm of its probability before the hypothesis starts.
    log_weight: f64,
}

/// What a step of the stream does to every hypothesis alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Shared {
    /// What the interval adds to ∂q/∂δ and ∂q̇/∂δ.
    input: [Vec<Lane>; 2],
    /// ∂ε/∂δ by channel, with a minus.
    rows: [Vec<Lane>; 2],
}

/// A bounded set of hypotheses, ordered by start, the youngest last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bank {
    n: usize,
    hypotheses: Vec<Hypothesis>,
    count: usize,
    /// 1/τ² by coefficient, the prior of "switch".
    spread: Vec<f64>,
    spread_log_determinant: f64,
    shared: Shared,
    system: System,
    single: Single,
}

impl Bank {
    /// Room for `capacity` ≥ 4 hypotheses on `n` coefficients.
    pub fn new(n: usize, capacity: usize) -> Bank {
        let lanes = || vec![[0.0; WIDTH]; n.div_ceil(WIDTH)];
        let hypothesis = Hypothesis {
            start: 0,
            age: 0,
            looked: 0,
            evidence: 0.0,
            unexplained: 0.0,
            unexplained_then: 0.0,
            sensitivity: [lanes(), lanes()],
            information: Information::none(n),
            prior: Information::none(n).matrix,
            pull: vec![0.0; n],
            full: Unswitched::none(n),
            own: Unswitched::none(n),
        };
        Bank {
            n,
            hypotheses: vec![hypothesis; capacity],
            count: 0,
            spread: vec![1.0; n],
            spread_log_determinant: 0.0,
            shared: Shared { input: [lanes(), lanes()], rows: [lanes(), lanes()] },
            system: System::new(n),
            single: Single::new(n),
        }
    }

    /// Forgets all hypotheses.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// How far a switch moves the coefficients, std τ > 0 of each.
    pub fn set_spread(&mut self, std: &[f64]) {
        for (spread, std) in self.spread.iter_mut().zip(std) {
            *spread = (std * std).recip();
        }
        self.spread_log_determinant = self.spread.iter().map(|spread| spread.ln()).sum();
    }

    /// Adds the hypothesis that the law switches after sample `start`, in the place of the one that is missed least.
    pub fn spawn(&mut self, start: u64, law: &Law) {
        if self.count == self.hypotheses.len() {
            let least = self.least_missed(start);
            self.remove(least);
        }
        let n = self.n;
        let hypothesis = &mut self.hypotheses[self.count];
        (hypothesis.start, hypothesis.age, hypothesis.looked) = (start, 0, 0);
        (hypothesis.evidence, hypothesis.unexplained, hypothesis.unexplained_then) = (0.0, 0.0, 0.0);
        hypothesis.sensitivity.iter_mut().for_each(|channel| channel.fill([0.0; WIDTH]));
        hypothesis.information.clear();
        let trust = if law.explains { CAUTION } else { MORE_CAUTION };
        hypothesis.prior.iter_mut().zip(&law.information.matrix).for_each(|(slot, entry)| *slot = trust * entry);
        for (index, (slot, open)) in hypothesis.full.active.iter_mut().zip(law.open).enumerate() {
            *slot = *open && law.information.matrix[index * n + index] > 0.0;
        }
        hypothesis.pull.iter_mut().zip(&law.information.score).for_each(|(pull, score)| *pull = trust * score);
        hypothesis.full.settle(&hypothesis.prior, &mut hypothesis.pull, &mut self.system);
        hypothesis.full.log_weight = 0.0;
        let mut dropped = false;
        for ((slot, full), own) in hypothesis.own.active.iter_mut().zip(&hypothesis.full.active).zip(law.own) {
            *slot = *full && *own;
            dropped |= *full && !*own;
        }
        hypothesis.own.log_weight = f64::NEG_INFINITY;
        if dropped {
            hypothesis.own.settle_beside(&hypothesis.prior, &hypothesis.pull, &mut self.system);
            hypothesis.share(&self.spread);
        }
        self.count += 1;
    }

    /// Drops hypotheses that start before sample `oldest`.
    pub fn forget_before(&mut self, oldest: u64) {
        while self.count > 0 && self.hypotheses[0].start < oldest {
            self.remove(0);
        }
    }

    /// Takes what one interval did and what its measurements said.
    pub fn step(&mut self, map: &IntervalMap, innovations: &[Option<Innovation>; 2]) {
        self.shared.set_input(map);
        let said = innovations.map(|innovation| innovation.map_or(Said::NOTHING, Said::from));
        let unexplained = said.iter().map(|said| 0.5 * said.weight * said.residual * said.residual).sum::<f64>();
        for hypothesis in &mut self.hypotheses[..self.count] {
            hypothesis.age += 1;
            hypothesis.unexplained += unexplained;
            self.shared.carry(&map.transition, &said, &mut hypothesis.sensitivity);
            let [q, qd] = &self.shared.rows;
            let [first, second] = &said;
            let (residuals, weights) = ([first.residual, second.residual], [first.weight, second.weight]);
            hypothesis.information.add_pair([q, qd], residuals, weights);
        }
    }

    /// The coefficients in use have become those plus `step`.
    pub fn shift(&mut self, step: &[f64]) {
        for hypothesis in &mut self.hypotheses[..self.count] {
            hypothesis.shift(step);
        }
    }

    /// Looks at up to `looks` hypotheses: first that which may by now hold most, then those that have waited longest for their age.
    pub fn look(&mut self, looks: usize) {
        let promises = self.hypotheses[..self.count].iter().map(Hypothesis::promise).enumerate();
        if let Some((index, _)) = promises.max_by(|a, b| a.1.total_cmp(&b.1)) {
            self.look_at(index);
        }
        for _ in 0..looks {
            let waiting = self.hypotheses[..self.count].iter().map(Hypothesis::wait).enumerate();
            match waiting.max_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((index, wait)) if wait > 0.0 => self.look_at(index),
                _ => return,
            }
        }
    }

    fn look_at(&mut self, index: usize) {
        let evidence = self.evidence(index);
        let hypothesis = &mut self.hypotheses[index];
        (hypothesis.evidence, hypothesis.looked) = (evidence, hypothesis.age);
        hypothesis.unexplained_then = hypothesis.unexplained;
    }

    /// The hypothesis with most evidence, as last looked at.
    pub fn suspect(&self) -> Option<Suspect> {
        let live = self.hypotheses[..self.count].iter().enumerate();
        let best = live.max_by(|a, b| a.1.evidence.total_cmp(&b.1.evidence));
        best.map(|(index, hypothesis)| Suspect { evidence: hypothesis.evidence, start: hypothesis.start, index })
    }

    /// Brings every evidence up to date.
    pub fn look_at_all(&mut self) {
        (0..self.count).for_each(|index| self.look_at(index));
    }

    /// The likeliest start: the suspect's, or where the evidence is overwhelming the latest that alone passes `level`.
    pub fn likeliest_start(&self, suspect: &Suspect, level: f64) -> u64 {
        match suspect.evidence > OVERWHELMING * level {
            true => self.hypotheses[self.latest(suspect, level)].start,
            false => suspect.start,
        }
    }

    /// The first start that is too late: a switch after it is not plausible.
    pub fn after(&self, suspect: &Suspect, level: f64) -> u64 {
        self.hypotheses[(self.latest(suspect, level) + 1).min(self.count - 1)].start
    }

    /// Writes the starts with most evidence into `starts`, in their order; those that are left where few are plausible repeat the last.
    pub fn likeliest_starts(&self, starts: &mut [u64]) {
        let least = self.suspect().map_or(0.0, |suspect| suspect.evidence) - FAR_BELOW;
        let mut bound = (f64::INFINITY, usize::MAX);
        for slot in starts.iter_mut() {
            let live = self.hypotheses[..self.count].iter().map(|hypothesis| hypothesis.evidence).zip(0..);
            let below = live.filter(|next| *next < bound && next.0 > least);
            bound = below.max_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).unwrap_or(bound);
            *slot = self.hypotheses[bound.1.min(self.count - 1)].start;
        }
        starts.sort_unstable();
    }

    fn latest(&self, suspect: &Suspect, level: f64) -> usize {
        let enough = level.min(suspect.evidence - MARGIN);
        let plausible = |hypothesis: &Hypothesis| hypothesis.evidence >= enough;
        self.hypotheses[..self.count].iter().rposition(plausible).unwrap_or(suspect.index)
    }

    /// Writes the most plausible change of the coefficients under the suspect into `change`.
    pub fn change(&mut self, suspect: &Suspect, change: &mut [f64]) {
        self.all_switched(suspect.index);
        self.system.solve(change);
    }

    /// Log-evidence, nats, of a switch to coefficients that are known beforehand, their offset counted from those in use, at the start
    /// that suits them best; and of a switch to any law at that start. Both against the law in use exactly as it is.
    pub fn of_known_law(&mut self, belief: &Belief, weighing: &mut Weighing) -> [f64; 2] {
        let fit = |index: usize| likelihood(&self.hypotheses[index].information, &belief.offset);
        let starts = (0..self.count).map(|index| (index, fit(index)));
        match starts.max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((index, _)) => {
                let known = weighing.evidence(&self.hypotheses[index].information, belief);
                [known, self.weigh(index)[0]]
            }
            None => [f64::NEG_INFINITY, 0.0],
        }
    }

    /// Log-evidence of a switch against that of none.
    fn evidence(&mut self, index: usize) -> f64 {
        let [switched, unswitched] = self.weigh(index);
        switched - unswitched
    }

    /// Log-evidence of a switch, of one coefficient or of all, and of none, against the law in use exactly as it is.
    fn weigh(&mut self, index: usize) -> [f64; 2] {
        let all = self.all_switched(index);
        let Bank { hypotheses, system, single, spread, .. } = self;
        let hypothesis = &hypotheses[index];
        let [mut one, mut none] = [f64::NEG_INFINITY; 2];
        for law in [&hypothesis.full, &hypothesis.own] {
            if law.log_weight > NEGLIGIBLE {
                let unswitched = law.log_weight + law.evidence(hypothesis, system);
                none = log_sum(none, unswitched);
                one = log_sum(one, unswitched + single.evidence(&hypothesis.information, system, &law.active, spread));
            }
        }
        [either(all, one), none]
    }

    /// Log-evidence of a switch of all coefficients; leaves the eliminated system behind.
    fn all_switched(&mut self, index: usize) -> f64 {
        let information = &self.hypotheses[index].information;
        self.system.load(&information.matrix, None);
        for (row, spread) in self.spread.iter().enumerate() {
            self.system.row(row)[row] += spread;
        }
        self.system.set_right(information.score.iter().copied());
        self.system.eliminate(TOLERANCE);
        0.5 * (self.system.squares() - self.system.log_determinant() + self.spread_log_determinant)
    }

    /// The hypothesis whose neighbours leave the smallest gap, relative to their age; one that stands out from them is kept.
    fn least_missed(&self, now: u64) -> usize {
        let most = self.suspect().map_or(0.0, |suspect| suspect.evidence);
        let evidence = |index: usize| self.hypotheses[index].evidence;
        let stands_out = |index: usize| {
            let own = evidence(index);
            own >= most || own > OUTSTANDING && own > 0.5 * most && own > evidence(index - 1) && own > evidence(index + 1)
        };
        let gap = |index: usize| {
            let (before, after) = (self.hypotheses[index - 1].start, self.hypotheses[index + 1].start);
            (after - before) as f64 / ((now - after) as f64 + 4.0)
        };
        let others = (1..self.count - 1).filter(|index| !stands_out(*index));
        others.min_by(|a, b| gap(*a).total_cmp(&gap(*b))).unwrap_or(0)
    }

    fn remove(&mut self, index: usize) {
        self.hypotheses[index..self.count].rotate_left(1);
        self.count -= 1;
    }
}

impl Hypothesis {
    /// Evidence at the last look, and what has come since.
    fn promise(&self) -> f64 {
        let fresh = self.unexplained - self.unexplained_then;
        if fresh > 0.0 && self.unexplained > SILENT { self.evidence + fresh } else { f64::NEG_INFINITY }
    }

    /// Samples since the last look, in terms of how often one is due at this age; 0 where none can find anything.
    fn wait(&self) -> f64 {
        let wait = f64::from(self.age - self.looked) / (1.0 + f64::from(self.age) / AGING);
        if self.unexplained > SILENT { wait } else { 0.0 }
    }

    /// Shares the probability among the law's own terms alone and all that it may have: what all of them gain in likelihood, against how
    /// much of what a dropped one could have been the record leaves (Savage and Dickey).
    fn share(&mut self, precision: &[f64]) {
        let Hypothesis { full, own, .. } = self;
        let dropped = full.active.iter().zip(&own.active).zip(precision).filter(|((full, own), _)| **full && !**own);
        let width: f64 = dropped.map(|(_, precision)| -0.5 * precision.ln()).sum();
        let odds =
            0.5 * (own.at_mean - full.at_mean) + 0.5 * (full.log_determinant - own.log_determinant) + width;
        own.log_weight = -(1.0 + (-odds).exp()).ln();
        full.log_weight = -(1.0 + odds.exp()).ln();
    }

    /// Moves the point about which δ is counted: Λμ becomes Λ(μ − step).
    fn shift(&mut self, step: &[f64]) {
        let (n, active) = (step.len(), &self.full.active);
        self.information.shift(step);
        let before: f64 = (0..n).filter(|row| active[*row]).map(|row| step[row] * self.pull[row]).sum();
        for row in (0..n).filter(|row| active[*row]) {
            self.pull[row] -= self.prior[row * n + row] * step[row];
            for column in (row + 1..n).filter(|column| active[*column]) {
                let entry = self.prior[row * n + column];
                self.pull[row] -= entry * step[column];
                self.pull[column] -= entry * step[row];
            }
        }
        let after: f64 = (0..n).filter(|row| active[*row]).map(|row| step[row] * self.pull[row]).sum();
        self.full.at_mean -= before + after;
        self.own.at_mean -= before + after;
        // what it did not have moves: its terms are others now
        if (0..n).any(|row| step[row] != 0.0 && !self.own.active[row]) {
            (self.full.log_weight, self.own.log_weight) = (0.0, f64::NEG_INFINITY);
        }
    }
}

impl Unswitched {
    fn none(n: usize) -> Unswitched {
        Unswitched { active: vec![false; n], at_mean: 0.0, log_determinant: 0.0, log_weight: 0.0 }
    }

    /// Leaves out what the prior says nothing of.
    fn settle(&mut self, prior: &[f64], pull: &mut [f64], system: &mut System) {
        self.settle_beside(prior, pull, system);
        for (index, (active, pull)) in self.active.iter_mut().zip(pull).enumerate() {
            *active &= system.is_solved(index);
            *pull = if *active { *pull } else { 0.0 };
        }
    }

    fn settle_beside(&mut self, prior: &[f64], pull: &[f64], system: &mut System) {
        system.load(prior, None);
        system.set_right(pull.iter().copied());
        self.isolate_inactive(system);
        system.eliminate(TOLERANCE);
        (self.at_mean, self.log_determinant) = (system.squares(), system.log_determinant());
    }

    /// Log-evidence of no switch; leaves the eliminated system behind.
    fn evidence(&self, hypothesis: &Hypothesis, system: &mut System) -> f64 {
        system.load(&hypothesis.information.matrix, Some(&hypothesis.prior));
        system.set_right(hypothesis.information.score.iter().zip(&hypothesis.pull).map(|(score, pull)| score + pull));
        self.isolate_inactive(system);
        system.eliminate(TOLERANCE);
        0.5 * (system.squares() - self.at_mean - (system.log_determinant() - self.log_determinant))
    }

    /// Takes what the law does not have out of the system.
    fn isolate_inactive(&self, system: &mut System) {
        for (unknown, _) in self.active.iter().enumerate().filter(|(_, active)| !**active) {
            system.isolate(unknown);
        }
    }
}

/// What a measurement does to a sensitivity, and how much it counts.
struct Said {
    gain: [f64; 2],
    residual: f64,
    weight: f64,
}

impl Said {
    const NOTHING: Said = Said { gain: [0.0; 2], residual: 0.0, weight: 0.0 };
}

impl From<Innovation> for Said {
    fn from(innovation: Innovation) -> Said {
        Said { gain: innovation.gain, residual: innovation.residual, weight: innovation.precision }
    }
}

impl Shared {
    fn set_input(&mut self, map: &IntervalMap) {
        let [to_q, to_qd] = &mut self.input;
        let slots = to_q.as_flattened_mut().iter_mut().zip(to_qd.as_flattened_mut());
        for ((q, qd), input) in slots.zip(&map.input) {
            (*q, *qd) = (input[0], input[1]);
        }
    }

    /// Carries a sensitivity over the interval and through its measurements, which leave their rows behind.
    #[inline]
    fn carry(&mut self, transition: &[[f64; 2]; 2], said: &[Said; 2], sensitivity: &mut [Vec<Lane>; 2]) {
        let [[a, b], [c, d]] = *transition;
        let [first, second] = said;
        let [q_state, qd_state] = sensitivity;
        let ([q_row, qd_row], [q_input, qd_input]) = (&mut self.rows, &self.input);
        let states = q_state.iter_mut().zip(qd_state);
        let rows = q_row.iter_mut().zip(qd_row);
        let inputs = q_input.iter().zip(qd_input);
        for (((q_state, qd_state), (q_row, qd_row)), (q_input, qd_input)) in states.zip(rows).zip(inputs) {
            let (q, qd) = (*q_state, *qd_state);
            let carried_q: Lane = std::array::from_fn(|lane| a * q[lane] + b * qd[lane] + q_input[lane]);
            let carried_qd: Lane = std::array::from_fn(|lane| c * q[lane] + d * qd[lane] + qd_input[lane]);
            let seen_qd: Lane = std::array::from_fn(|lane| carried_qd[lane] - first.gain[1] * carried_q[lane]);
            let rest_q = 1.0 - first.gain[0];
            *q_row = carried_q;
            *qd_row = seen_qd;
            *q_state = std::array::from_fn(|lane| rest_q * carried_q[lane] - second.gain[0] * seen_qd[lane]);
            *qd_state = std::array::from_fn(|lane| seen_qd[lane] - second.gain[1] * seen_qd[lane]);
        }
    }
}
