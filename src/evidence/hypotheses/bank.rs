//! Hypotheses that the law switched, at many instants at once.
//!
//! Each [`Hypothesis`] says: since its start the coefficients differ by δ from those in use. δ makes the innovations ε
//! of the law in use linear in it, ε = ψδ + white, ψ carried from sensitivity 0 at the start (the state is continuous
//! across a switch). "No switch" says that they differ by δ before it too, as far as that law errs (`hypothesis`).
//! With M = Σψψᵀ/s and g = Σψε/s, and a Gaussian prior N(μ, Λ⁻¹) of δ, the log-evidence of the data since the start is
//!
//! ```text
//! ½ (g + Λμ)ᵀ (M + Λ)⁻¹ (g + Λμ) − ½ μᵀΛμ − ½ ln det(M + Λ) + ½ ln det Λ   (+ what all priors share)
//! ```
//!
//! "No switch" has the information that the stage gave on its coefficients up to the start, on all that the law may
//! have or on its own alone; "switch" a prior as wide as physics makes plausible, of all coefficients or of one
//! ([`SingleChange`]). Their difference is the evidence of a switch (Willsky and Jones 1976, with a prior in the place
//! of the maximum). Starts are kept on a grid whose spacing grows with age, and where the evidence has a peak.

use super::hypothesis::{Hypothesis, Law};
use crate::estimation::{Information, Innovation, IntervalMap, Lane, System, WIDTH, log_sum};
use crate::evidence::bayes_factor::{BayesFactor, GaussianPrior, TOLERANCE, likelihood};
use crate::evidence::single_change::{SingleChange, either};
use serde::{Deserialize, Serialize};

/// Evidence of this many levels at once comes from the last samples alone: what grows sample by sample would have
/// passed one level before.
const OVERWHELMING: f64 = 10.0;

/// Starts with this much less evidence than the best may be the switch's own, nats: odds of 150 to one against.
const MARGIN: f64 = 5.0;

/// Starts with this much less evidence than the best are none that a switch may have had, nats: odds of 160 000 to one.
const FAR_BELOW: f64 = 12.0;

/// Evidence that chance gives a start which lies between others once in 55, nats.
const OUTSTANDING: f64 = 4.0;

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
    pub(super) hypotheses: Vec<Hypothesis>,
    pub(super) count: usize,
    /// The likeliest start when the hypotheses were last forgotten although the data spoke for a switch.
    forgotten: Option<u64>,
    /// 1/τ² by coefficient, the prior of "switch".
    spread: Vec<f64>,
    spread_log_determinant: f64,
    shared: Shared,
    /// What the data since a hypothesis's start say of a change there, and of the error of the law in use.
    since: Information,
    told: Information,
    /// Room for a step of the coefficients and of the state.
    moved: Vec<f64>,
    /// Of changes, and of the law's errors.
    system: System,
    erring: System,
    single: SingleChange,
}

impl Bank {
    /// Room for `capacity` ≥ 4 hypotheses on `n` coefficients that a switch may move. The law errs in those and in that
    /// of an effect beside them.
    pub fn new(n: usize, capacity: usize) -> Bank {
        let erring = n + 1;
        let lanes = || vec![[0.0; WIDTH]; (erring + 2).div_ceil(WIDTH)];
        Bank {
            n,
            hypotheses: vec![Hypothesis::none(erring); capacity],
            count: 0,
            forgotten: None,
            spread: vec![1.0; n],
            spread_log_determinant: 0.0,
            shared: Shared { input: [lanes(), lanes()], rows: [lanes(), lanes()] },
            since: Information::none(n),
            told: Information::none(erring),
            moved: vec![0.0; erring + 2],
            system: System::new(n),
            erring: System::new(erring),
            single: SingleChange::new(n, erring),
        }
    }

    /// Forgets all hypotheses, but the start of what the data spoke for: another cause that was told does not rule a
    /// switch out.
    pub fn clear(&mut self) {
        let suspect = self.suspect().filter(|suspect| suspect.evidence > OUTSTANDING);
        self.forgotten = suspect.map(|suspect| suspect.start).or(self.forgotten);
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
        self.hypotheses[self.count].begin(start, law, &self.spread, &mut self.erring);
        self.count += 1;
    }

    /// Drops hypotheses that start before sample `oldest`.
    pub fn forget_before(&mut self, oldest: u64) {
        self.forgotten = self.forgotten.filter(|start| *start >= oldest);
        while self.count > 0 && self.hypotheses[0].start < oldest {
            self.remove(0);
        }
    }

    /// Takes what one interval did, to the state by unit of the effect's coefficient that much, and what its
    /// measurements said.
    pub fn step(&mut self, map: &IntervalMap, effect: [f64; 2], innovations: &[Option<Innovation>; 2]) {
        self.shared.set_input(map, effect);
        let said = innovations.map(|innovation| innovation.map_or(Said::NOTHING, Said::from));
        let (residuals, weights) = (said.each_ref().map(|said| said.residual), said.each_ref().map(|said| said.weight));
        let unexplained = said.iter().map(|said| 0.5 * said.weight * said.residual * said.residual).sum::<f64>();
        for hypothesis in &mut self.hypotheses[..self.count] {
            hypothesis.age += 1;
            hypothesis.unexplained += unexplained;
            self.shared.carry(&map.transition, &said, &mut hypothesis.sensitivity);
            let [q, qd] = &self.shared.rows;
            hypothesis.information.add_pair([q, qd], residuals, weights);
        }
    }

    /// The coefficients in use, that of the effect the last, have become those plus `step`.
    pub fn shift(&mut self, step: impl Iterator<Item = f64>) {
        self.moved.iter_mut().zip(step).for_each(|(slot, step)| *slot = step);
        for hypothesis in &mut self.hypotheses[..self.count] {
            hypothesis.shift(&mut self.moved);
        }
    }

    /// Looks at up to `looks` hypotheses: first that which may by now hold most, then those that have waited longest
    /// for their age.
    pub fn look(&mut self, looks: usize) {
        let promises = self.hypotheses[..self.count].iter().map(Hypothesis::promise).enumerate();
        if let Some((index, _)) = promises.max_by(|a, b| a.1.total_cmp(&b.1)) {
            self.look_at(index);
        }
        for _ in 0..looks {
            let waiting = self.hypotheses[..self.count].iter().map(Hypothesis::wait).enumerate();
            match waiting.max_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((index, wait)) if wait > 0.0 => self.look_at(index),
                _ => break,
            }
        }
        // what is made anew at every look takes no room in a saved state
        self.since.clear();
        self.told.clear();
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

    /// Writes the starts with most evidence into `starts`, in their order, one that was forgotten among them; those
    /// that are left where few are plausible repeat the last.
    pub fn likeliest_starts(&self, starts: &mut [u64]) {
        let least = self.suspect().map_or(0.0, |suspect| suspect.evidence) - FAR_BELOW;
        let mut bound = (f64::INFINITY, usize::MAX);
        starts.iter_mut().zip(self.forgotten).for_each(|(slot, start)| *slot = start);
        for slot in starts.iter_mut().skip(usize::from(self.forgotten.is_some())) {
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
        self.hypotheses[suspect.index].information.lead(&mut self.since);
        self.all_switched();
        self.system.solve(change);
    }

    /// Log-evidence, nats, of a switch to coefficients that are known beforehand, their offset counted from those in
    /// use, at the start that suits them best; and of a switch to any law at that start. Both against the law in use
    /// exactly as it is.
    pub fn of_known_law(&mut self, belief: &GaussianPrior, weighing: &mut BayesFactor) -> [f64; 2] {
        let mut best = (f64::NEG_INFINITY, None);
        for index in 0..self.count {
            self.hypotheses[index].information.lead(&mut self.since);
            let fit = likelihood(&self.since, &belief.offset);
            best = if fit > best.0 { (fit, Some(index)) } else { best };
        }
        let Some(index) = best.1 else { return [f64::NEG_INFINITY, 0.0] };
        let [any, _] = self.weigh(index);
        [weighing.evidence(&self.since, belief), any]
    }

    /// Log-evidence of a switch against that of none.
    fn evidence(&mut self, index: usize) -> f64 {
        let [switched, unswitched] = self.weigh(index);
        switched - unswitched
    }

    /// Log-evidence of a switch, of one coefficient or of all, and of none, against the law in use exactly as it is;
    /// leaves what the data say of a change behind.
    fn weigh(&mut self, index: usize) -> [f64; 2] {
        self.hypotheses[index].information.lead(&mut self.since);
        let all = self.all_switched();
        let Bank { hypotheses, since, told, erring: system, single, spread, .. } = self;
        let hypothesis = &hypotheses[index];
        hypothesis.tell_of_error(told);
        let shared = |changed, erring| hypothesis.shared(changed, erring);
        let [mut one, mut none] = [f64::NEG_INFINITY; 2];
        for law in hypothesis.likely_laws() {
            let unswitched = law.log_weight + hypothesis.unswitched(law, told, system);
            none = log_sum(none, unswitched);
            one = log_sum(one, unswitched + single.evidence(since, shared, system, &law.active, spread));
        }
        [either(all, one), none]
    }

    /// Log-evidence of a switch of all coefficients, of which the data say `since`; leaves the eliminated system.
    fn all_switched(&mut self) -> f64 {
        self.system.load(&self.since.matrix, None);
        for (row, spread) in self.spread.iter().enumerate() {
            self.system.row(row)[row] += spread;
        }
        self.system.set_right(self.since.score.iter().copied());
        self.system.eliminate(TOLERANCE);
        0.5 * (self.system.squares() - self.system.log_determinant() + self.spread_log_determinant)
    }

    /// The hypothesis whose neighbours leave the smallest gap, relative to their age; the suspect is kept, and one that
    /// stands out as much from its other neighbours.
    fn least_missed(&self, now: u64) -> usize {
        let suspect = self.suspect();
        let most = suspect.map_or(0.0, |suspect| suspect.evidence);
        let is_suspect = |index: usize| suspect.is_some_and(|suspect| suspect.index == index);
        let evidence = |index: usize| self.hypotheses[index].evidence;
        let stands_out = |index: usize| {
            let own = evidence(index);
            let above = |neighbour: usize| own > evidence(neighbour) || is_suspect(neighbour);
            is_suspect(index) || own > OUTSTANDING.max(0.5 * most) && above(index - 1) && above(index + 1)
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
    fn set_input(&mut self, map: &IntervalMap, effect: [f64; 2]) {
        let [to_q, to_qd] = &mut self.input;
        let slots = to_q.as_flattened_mut().iter_mut().zip(to_qd.as_flattened_mut());
        for ((q, qd), input) in slots.zip(map.input.iter().chain([&effect])) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    const TRANSITION: [[f64; 2]; 2] = [[0.98, 0.02], [-0.02, 0.98]];

    /// What an interval does to (q, q̇) by unit of each of eight coefficients.
    fn input(number: u64) -> Vec<[f64; 2]> {
        (0..8).map(|k| [0.0, 0.1 * (0.05 * (f64::from(k) + 1.0) * number as f64).sin()]).collect()
    }

    /// A law of eight coefficients of which that much is known, and all of whose state but for what an effect beside
    /// them does to it.
    fn law(information: &Information, effect: [f64; 2]) -> Law<'_> {
        let sensitivity = &[[0.0; 2]; 8];
        Law { information, sensitivity, effect, open: &[true; 8], own: &[true; 8], explains: true }
    }

    /// A bank that has seen `samples`, q̇ alone measured with std 1; at sample `switch` a coefficient moves by
    /// `change`.
    fn bank(samples: u64, switch: u64, change: f64) -> Bank {
        bank_beside(samples, [switch as f64, change], [0.0, f64::INFINITY])
    }

    /// The same where the coefficient of an effect beside the law's own is said to be known to `std`, and errs by
    /// `error`.
    fn bank_beside(samples: u64, [switch, change]: [f64; 2], [error, std]: [f64; 2]) -> Bank {
        let mut generator = ChaCha8Rng::seed_from_u64(7);
        let (mut bank, mut information) = (Bank::new(8, 12), Information::none(9));
        bank.set_spread(&[5.0; 8]);
        (0..8).for_each(|k| information.matrix[10 * k] = 1e4);
        information.matrix[80] = 1.0 / (std * std);
        let carried = |[q, qd]: [f64; 2], push: f64| [0.98 * q + 0.02 * qd, -0.02 * q + 0.98 * qd + push];
        let (mut state, mut sensitivity) = ([0.0; 2], [0.0; 2]);
        for number in 1..=samples {
            let map = IntervalMap { transition: TRANSITION, input: input(number), push: [0.0; 2] };
            let moved = if number as f64 > switch { change * map.input[2][1] } else { 0.0 };
            let effect = [0.0, 0.1 * (0.27 * number as f64).cos()];
            state = carried(state, moved + error * effect[1]);
            sensitivity = carried(sensitivity, effect[1]);
            let residual = state[1] + generator.sample::<f64, _>(StandardNormal);
            let said = Innovation { residual, variance: 1.0, precision: 1.0, gain: [0.0; 2] };
            bank.step(&map, effect, &[None, Some(said)]);
            bank.look_at_all();
            if number.is_multiple_of(2) {
                bank.spawn(number, &law(&information, sensitivity));
            }
        }
        bank
    }

    /// Of a switch that leaves every coefficient open.
    fn of_all(bank: &mut Bank, index: usize) -> f64 {
        bank.hypotheses[index].information.lead(&mut bank.since);
        let all = bank.all_switched();
        let Bank { hypotheses, told, erring, .. } = bank;
        let hypothesis = &hypotheses[index];
        let law = hypothesis.likely_laws().next().unwrap();
        hypothesis.tell_of_error(told);
        all - hypothesis.unswitched(law, told, erring)
    }

    #[test]
    fn a_switch_of_one_coefficient_has_more_evidence_than_all_of_them_leave() {
        let mut bank = bank(400, 200, 1.0);
        let suspect = bank.suspect().unwrap();
        let all = of_all(&mut bank, suspect.index);
        assert!(suspect.evidence > all + 3.0 && suspect.start.abs_diff(200) < 40, "{suspect:?}, {all}");
    }

    #[test]
    fn without_a_switch_nothing_speaks_for_one() {
        let evidence = bank(400, 400, 0.0).suspect().unwrap().evidence;
        assert!(evidence < 3.0, "{evidence}");
    }

    #[test]
    fn an_effect_whose_coefficient_errs_as_it_may_is_no_switch() {
        let evidence = |std| bank_beside(400, [400.0, 0.0], [3.0, std]).suspect().unwrap().evidence;
        assert!(evidence(1.0) < 3.0 && evidence(0.01) > 20.0, "{} {}", evidence(1.0), evidence(0.01));
    }

    #[test]
    fn the_likeliest_starts_lie_about_the_switch_in_their_order() {
        let bank = bank(500, 200, 1.5);
        let mut starts = [0; 4];
        bank.likeliest_starts(&mut starts);
        assert!(starts.is_sorted() && starts.iter().all(|start| start.abs_diff(200) < 60), "{starts:?}");
    }

    #[test]
    fn a_start_that_stands_out_is_kept_while_others_are_thinned_out() {
        let mut bank = bank(60, 60, 0.0);
        let start = bank.hypotheses[5].start;
        (bank.hypotheses[5].evidence, bank.hypotheses[8].evidence) = (6.0, 9.0);
        let nothing = Information::none(9);
        for number in 61..200 {
            bank.spawn(number, &law(&nothing, [0.0; 2]));
        }
        assert!(bank.hypotheses.iter().any(|hypothesis| hypothesis.start == start));
    }

    #[test]
    fn a_start_that_the_data_spoke_for_stays_possible_when_all_else_is_forgotten() {
        let mut bank = bank(400, 200, 30.0);
        let suspect = bank.suspect().unwrap();
        assert!(suspect.evidence > OUTSTANDING, "{suspect:?}");
        bank.clear();
        bank.clear();
        let information = Information::none(9);
        [400, 402].into_iter().for_each(|start| bank.spawn(start, &law(&information, [0.0; 2])));
        let mut starts = [0; 4];
        bank.likeliest_starts(&mut starts);
        assert_eq!(starts[0], suspect.start);
        assert!(starts[1..].iter().all(|start| *start >= 400), "{starts:?}");
        bank.forget_before(suspect.start + 1);
        bank.likeliest_starts(&mut starts);
        assert!(starts.iter().all(|start| *start >= 400), "{starts:?}");
    }
}
