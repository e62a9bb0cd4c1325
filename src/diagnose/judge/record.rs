//! Recordings as weak equations: a column for every term, with three lengths of windows.

use super::memory::{FOLDS, Memory};
use super::windows::{self, COUNT, Cells, Windows};
use crate::diagnose::motion::{self, Impulse, Motion, Nodes, rounding, sensor_noise};
use crate::identify::Recording;
use crate::law::{Effect, Expression, Hold, Term, forgets, term_series};
use std::cell::{OnceCell, RefCell};

/// Parts of a piece in the first of which a term is to forget what it had stored; what takes longer belongs to the law.
const EARLY: usize = 5;

/// What a term is in every equation, by window length.
pub(in crate::diagnose) type Column = [Vec<f64>; COUNT];

/// When the recorded excitation acted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// What it did between samples.
    pub hold: Hold,
    /// How much later than recorded it acted, s; negative where the record comes late.
    pub delay: f64,
    /// Time constant of the first-order lag with which it acted, s; 0 for none.
    pub lag: f64,
}

/// Recordings of one system, ready to be judged.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Record {
    pub(in crate::diagnose) motions: Vec<Motion>,
    /// (motion, piece) and grid of every piece.
    nodes: Vec<(usize, usize, Nodes)>,
    pub(in crate::diagnose) windows: [Windows; COUNT],
    /// T₀, s.
    pub(in crate::diagnose) period: f64,
    /// Usual distance of two readings, s.
    pub(in crate::diagnose) sample_time: f64,
    /// Length of all pieces, s.
    pub(in crate::diagnose) duration: f64,
    /// Whether there is an excitation.
    pub(in crate::diagnose) forced: bool,
    /// Whether F is the output: an inertia is then a term that explains, in which the readings' noise would make its
    /// coefficient too small.
    pub(in crate::diagnose) is_output: bool,
    /// The user's effects.
    pub(in crate::diagnose) expressions: Vec<Expression>,
    /// By hold and piece, the excitation's integral, once it was asked for.
    impulses: [OnceCell<Vec<OnceCell<Impulse>>>; 3],
    /// Columns that were asked for and depend on the motion alone.
    columns: RefCell<Vec<(Term, Column)>>,
}

impl Record {
    /// Of recordings. None where nothing moves, or no piece is as long as a window.
    pub(in crate::diagnose) fn new(recordings: &[&Recording], expressions: &[Expression]) -> Option<Record> {
        let motions: Vec<Motion> =
            recordings.iter().filter_map(|recording| Motion::of(recording, Hold::Linear)).collect();
        let period = motion::period(&motions);
        if !(period.is_finite() && period > 0.0) {
            return None;
        }
        let sample_time = recordings.iter().map(|recording| recording.sample_time()).fold(f64::INFINITY, f64::min);
        let forced = recordings.iter().any(|recording| recording.channels().excitation);
        Record::cut(motions, period, sample_time, forced, expressions.to_vec())
    }

    fn cut(
        motions: Vec<Motion>,
        period: f64,
        sample_time: f64,
        forced: bool,
        expressions: Vec<Expression>,
    ) -> Option<Record> {
        let cell = windows::cell(period);
        let numbers =
            motions.iter().enumerate().flat_map(|(index, own)| (0..own.pieces.len()).map(move |n| (index, n)));
        let nodes: Vec<(usize, usize, Nodes)> =
            numbers.map(|(index, number)| (index, number, Nodes::new(&motions[index], number, cell))).collect();
        let cells: Vec<usize> = nodes.iter().map(|(.., nodes)| nodes.cells()).collect();
        let windows = [0, 1, 2].map(|which| Windows::new(which, &cells, cell, sample_time));
        let duration = cells.iter().sum::<usize>() as f64 * cell;
        let (impulses, columns) = Default::default();
        let is_output = false;
        let record = Record {
            motions,
            nodes,
            windows,
            period,
            sample_time,
            duration,
            forced,
            is_output,
            expressions,
            impulses,
            columns,
        };
        record.windows.iter().any(|windows| windows.rows() > 0).then_some(record)
    }

    /// The same record under other motions at the same instants.
    pub(super) fn moved(&self, motions: Vec<Motion>) -> Option<Record> {
        let record = Record::cut(motions, self.period, self.sample_time, self.forced, self.expressions.clone())?;
        Some(Record { is_output: self.is_output, ..record })
    }

    /// The same record as every second reading of each channel shows it: the even ones, and the odd ones. What noise
    /// the two have is not the same.
    pub(in crate::diagnose) fn halves(&self) -> Option<[Record; 2]> {
        let half = |first: usize| self.moved(self.motions.iter().map(|motion| motion.half(first)).collect());
        Some([half(0)?, half(1)?])
    }

    /// The same motion for equations whose q̈ another record of the same pieces shows: forces are taken between that
    /// one's readings of q̇.
    pub(in crate::diagnose) fn for_target_of(mut self, other: &Record) -> Record {
        let both = self.nodes.into_iter().zip(&other.nodes);
        self.nodes = both.map(|((index, number, own), (.., others))| (index, number, own.read_as(others))).collect();
        self.columns.take();
        self
    }

    fn column(&self, order: usize, values: impl FnMut(&(usize, usize, Nodes)) -> Vec<[f64; 2]>, factor: f64) -> Column {
        let mut column = [0, 1, 2].map(|which| vec![0.0; self.windows[which].rows()]);
        self.add(order, &self.nodes.iter().map(values).collect(), factor, &mut column);
        column
    }

    fn add(&self, order: usize, cells: &Cells, factor: f64, column: &mut Column) {
        self.windows.iter().zip(column).for_each(|(windows, rows)| windows.add(order, cells, factor, rows));
    }

    /// ∫ φ q̈ dt = −∫ φ' q̇ dt = ∫ φ'' q dt of the readings: of q̇ where it is measured, on straight lines, which every
    /// force then is taken over ([`Nodes::between_velocities`]); else of q.
    pub(in crate::diagnose) fn measured_inertia(&self) -> Column {
        let reads = |(index, number, _): &(usize, usize, Nodes)| self.motions[*index].tracks[*number].read[1];
        let velocity = |piece: &(usize, usize, Nodes)| {
            let (index, number, nodes) = piece;
            if reads(piece) { nodes.straight(&self.motions[*index], *number) } else { nodes.integrals(&nodes.qd) }
        };
        let mut column = self.column(1, velocity, -1.0);
        let beyond = |piece: &(usize, usize, Nodes)| {
            let (index, number, nodes) = piece;
            match reads(piece) {
                true => vec![[0.0; 2]; nodes.cells()],
                false => nodes.remainder(&self.motions[*index], *number),
            }
        };
        self.add(2, &self.nodes.iter().map(beyond).collect(), 1.0, &mut column);
        column
    }

    fn impulse(&self, (index, number, _): &(usize, usize, Nodes), hold: Hold) -> &Impulse {
        let piece = &self.motions[*index].pieces[*number];
        let place = self.nodes.iter().position(|(own, other, _)| (own, other) == (index, number)).unwrap_or(0);
        let impulses = self.impulses[hold as usize].get_or_init(|| vec![OnceCell::new(); self.nodes.len()]);
        impulses[place].get_or_init(|| Impulse::new(piece, hold))
    }

    fn excitation(&self, piece: &(usize, usize, Nodes), timing: Timing) -> Vec<f64> {
        let nodes = &piece.2;
        let delayed = nodes.excitation(self.impulse(piece, timing.hold), timing.delay);
        match Effect::lag(timing.lag) {
            Some(lag) => {
                let behind = term_series(Term::Effect(lag), &[], &nodes.trajectory(&delayed));
                delayed.iter().zip(behind).map(|(force, behind)| force - behind).collect()
            }
            None => delayed,
        }
    }

    /// Integrals of the excitation over the cells.
    fn impulses(&self, piece: &(usize, usize, Nodes), timing: Timing) -> Vec<[f64; 2]> {
        let nodes = &piece.2;
        if self.is_output || timing.lag != 0.0 {
            return self.integrals(nodes, self.excitation(piece, timing));
        }
        nodes.integrals(&nodes.excitation_between_velocities(self.impulse(piece, timing.hold), timing.delay))
    }

    /// Integrals of a force over the cells, as the readings of q̇ show it where q̈ is theirs.
    fn integrals(&self, nodes: &Nodes, values: Vec<f64>) -> Vec<[f64; 2]> {
        if self.is_output { nodes.integrals(&values) } else { nodes.integrals(&nodes.between_velocities(values)) }
    }

    /// ∫ φ F dt.
    pub(in crate::diagnose) fn force(&self, timing: Timing) -> Column {
        self.column(0, |piece| self.impulses(piece, timing), 1.0)
    }

    /// ∫ φ' F dt: what a little more delay adds to the force.
    pub(in crate::diagnose) fn force_slope(&self, timing: Timing) -> Column {
        self.column(1, |piece| self.impulses(piece, timing), 1.0)
    }

    /// ∫ φ f dt of a term.
    pub(in crate::diagnose) fn term(&self, term: Term, timing: Timing) -> Column {
        match term {
            Term::Inertia if self.is_output => self.column(1, |(.., nodes)| nodes.integrals(&nodes.qd), -1.0),
            Term::Inertia => self.measured_inertia(),
            // whatever the timing and the inner parameters, it is the same every time
            _ if !term.uses_excitation() && term.inner_values().is_empty() => {
                let known =
                    self.columns.borrow().iter().find(|(own, _)| *own == term).map(|(_, column)| column.clone());
                known.unwrap_or_else(|| {
                    let column = self.integrated(term, timing);
                    self.columns.borrow_mut().push((term, column.clone()));
                    column
                })
            }
            _ => self.integrated(term, timing),
        }
    }

    fn integrated(&self, term: Term, timing: Timing) -> Column {
        self.column(0, |piece| self.integrals(&piece.2, self.series(term, piece, timing)), 1.0)
    }

    /// What terms remember of the motion, as far as a fifth of a piece makes them forget it.
    pub(in crate::diagnose) fn memory(&self, terms: &[Term]) -> Memory {
        let own: Vec<Term> = terms.iter().copied().filter(|term| has_memory(*term)).collect();
        if own.is_empty() {
            return Memory::default();
        }
        // the free response of a hidden mass is fitted
        let is_fitted = |term: &&Term| matches!(term, Term::Effect(Effect::HiddenResonator { .. }));
        let stored: Vec<Term> = own.iter().filter(|term| !is_fitted(term)).copied().collect();
        let void: Vec<usize> = self.nodes.iter().map(|(.., nodes)| remembers(nodes, 0, &stored)).collect();
        let cells: usize = self.nodes.iter().map(|(.., nodes)| nodes.cells()).sum();
        let aside = |bound: usize| {
            let mut cell = cells * bound / FOLDS;
            let piece = self.nodes.iter().find(|(.., nodes)| {
                let is_in = cell < nodes.cells();
                cell -= if is_in { 0 } else { nodes.cells() };
                is_in
            });
            let cells = piece.map_or(0, |(.., nodes)| remembers(nodes, cell, &own));
            cells as f64 * windows::cell(self.period)
        };
        Memory { void: [0, 1, 2].map(|which| self.windows[which].before(&void)), aside: std::array::from_fn(aside) }
    }

    /// Number of pieces.
    pub(super) fn pieces(&self) -> usize {
        self.nodes.len()
    }

    /// A function of a piece's number and the time since it began, s, as a force.
    pub(super) fn acting(&self, value: impl Fn(usize, f64) -> f64) -> Column {
        let mut column = [0, 1, 2].map(|which| vec![0.0; self.windows[which].rows()]);
        let own = |(index, (.., nodes)): (usize, &(usize, usize, Nodes))| {
            self.integrals(nodes, nodes.elapsed().map(|t| value(index, t)).collect())
        };
        self.add(0, &self.nodes.iter().enumerate().map(own).collect(), 1.0, &mut column);
        column
    }

    /// What a law of these terms and coefficients gains by a displacement of τ to that power in one recording, τ from
    /// −1 at its beginning to 1 at its end: Σ θ ∂f ÷ ∂q τ^power. Terms with a memory gain nothing.
    pub(super) fn leaning(&self, law: &[(Term, f64)], motion: usize, power: usize) -> Column {
        let own = |(index, _, nodes): &(usize, usize, Nodes)| {
            if *index != motion {
                return vec![[0.0; 2]; nodes.cells()];
            }
            let [from, to] = self.motions[motion].span();
            let value = |(t, q, qd): (f64, f64, f64)| {
                let slopes = law.iter().map(|(term, coefficient)| coefficient * term.gradient(q, qd, 0.0).0);
                let slope: f64 = slopes.filter(|slope| slope.is_finite()).sum();
                slope * (2.0 * (t - from) / (to - from) - 1.0).powi(power as i32)
            };
            self.integrals(nodes, nodes.states().map(value).collect())
        };
        self.column(0, own, 1.0)
    }

    /// RMS of a term per unit of its coefficient.
    pub(super) fn rms(&self, term: Term, timing: Timing) -> f64 {
        let squares = self.nodes.iter().map(|piece| {
            let series = self.series(term, piece, timing);
            [series.iter().map(|value| value * value).sum::<f64>(), series.len() as f64]
        });
        let [sum, count] = squares.fold([0.0; 2], |sums, own| [sums[0] + own[0], sums[1] + own[1]]);
        (sum / count).sqrt()
    }

    /// Whether a term holds q̈ itself.
    pub(in crate::diagnose) fn accelerates(&self, term: Term) -> bool {
        // a Maxwell element is a damper less a filtered acceleration
        matches!(term, Term::Effect(Effect::HiddenResonator { .. } | Effect::Relaxation { .. }))
            || term.mass(1.0) != 0.0
    }

    fn series(&self, term: Term, piece: &(usize, usize, Nodes), timing: Timing) -> Vec<f64> {
        let nodes = &piece.2;
        let excitation = if term.uses_excitation() { self.excitation(piece, timing) } else { vec![0.0; nodes.q.len()] };
        let mut series = term_series(term, &self.expressions, &nodes.trajectory(&excitation));
        if term.mass(1.0) != 0.0 {
            let motion = nodes.q.iter().zip(&nodes.qdd);
            series.iter_mut().zip(motion).for_each(|(value, (q, qdd))| *value += term.mass(*q) * qdd);
        }
        series
    }

    /// Std of the noise of the excitation's readings: what it is rounded to where it drives the motion, for a drive may
    /// be as rough as it likes; where it is the motion's answer, also what its differences show.
    pub(in crate::diagnose) fn force_noise(&self, is_output: bool) -> f64 {
        let as_position = |motion: &Motion| {
            let pieces = motion.pieces.iter().map(|piece| {
                let mut force = piece.part(0..piece.len());
                (force.q, force.qd) = (Some(piece.excitation.clone()), None);
                force.excitation.fill(0.0);
                force.observe_again();
                force
            });
            let pieces: Vec<_> = pieces.collect();
            if is_output { sensor_noise(&pieces)[0] } else { rounding(&pieces, 0).sqrt() }
        };
        self.motions.iter().map(as_position).fold(0.0, f64::max)
    }
}

/// Cells of a piece after that one in which something is left of what the terms had stored until then; none of a term
/// that a fifth of the piece does not make forget it.
fn remembers(nodes: &Nodes, cell: usize, terms: &[Term]) -> usize {
    let none = vec![0.0; nodes.q.len()];
    let motion = nodes.trajectory(&none).after(nodes.node_of(cell));
    let cells = terms.iter().filter_map(|term| forgets(*term, &motion).map(|node| nodes.cell_of(node)));
    cells.filter(|cells| *cells <= nodes.cells() / EARLY).max().unwrap_or(0)
}

fn has_memory(term: Term) -> bool {
    term.effect().is_some_and(|effect| effect.memory_length() > 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// q̈ + ω² q = F under a force that is held between readings, 15 of them in a period: t, q, q̇, F. A sensor's noise
    /// is a thousandth of the motion.
    fn held(omega: f64) -> [Vec<f64>; 4] {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
        let h = std::f64::consts::TAU / omega / 15.0;
        let (sin, cos) = (omega * h).sin_cos();
        let mut readings: [Vec<f64>; 4] = Default::default();
        let (mut q, mut qd) = (0.3, 0.0);
        for k in 0..2000 {
            let t = h * f64::from(k);
            let force = (0.7 * omega * t).sin() + 0.5 * (1.3 * omega * t + 0.01 * t * t).cos();
            let read = [t, q + 1e-4 * noise(), qd + 3e-4 * noise(), force];
            readings.iter_mut().zip(read).for_each(|(channel, value)| channel.push(value));
            let rest = force / (omega * omega);
            (q, qd) = (rest + (q - rest) * cos + qd * sin / omega, qd * cos - (q - rest) * omega * sin);
        }
        readings
    }

    #[test]
    fn a_law_holds_between_coarse_readings_of_a_velocity_under_a_held_force() {
        let omega = 3.0;
        let [t, q, qd, force] = held(omega);
        let recording = Recording::new("held", t, Some(q), Some(qd), Some(force)).unwrap();
        let record = Record::new(&[&recording], &[]).unwrap();
        assert_eq!(record.motions[0].tracks[0].read, [true; 2]);
        let timing = Timing { hold: Hold::Zero, delay: 0.0, lag: 0.0 };
        let [inertia, spring] = [Term::Inertia, Term::power(1, 0)].map(|term| record.term(term, timing));
        let force = record.force(timing);
        for which in 1..COUNT {
            let rows = inertia[which].iter().zip(&spring[which]).zip(&force[which]);
            let [left, all] = rows.fold([0.0; 2], |[left, all], ((inertia, spring), force)| {
                [left + (inertia + omega * omega * spring - force).powi(2), all + force * force]
            });
            assert!((left / all).sqrt() < 8e-3, "{} of F over windows {which}", (left / all).sqrt());
        }
    }
}
