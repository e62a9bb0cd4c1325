//! The motion and the excitation of a piece on a uniform grid, whatever the instants of its readings.
//!
//! Nodes are as close as the readings or closer; several make a cell, over which everything is summed before it meets a
//! test function.

use super::smoothed::Motion;
use super::track::{UNREAD, readings};
use crate::diagnose::piece::Piece;
use crate::law::{Hold, NODES, Trajectory};

/// A piece on a uniform grid; a value stands for the middle of its node.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Nodes {
    /// Where the first node begins, s.
    start: f64,
    /// How long a node is, s.
    width: f64,
    /// Nodes in a cell.
    per_cell: usize,
    /// Middles of the nodes, s.
    t: Vec<f64>,
    /// Displacement, m.
    pub(in crate::diagnose) q: Vec<f64>,
    /// Velocity, m/s.
    pub(in crate::diagnose) qd: Vec<f64>,
    /// Acceleration, m/s².
    pub(in crate::diagnose) qdd: Vec<f64>,
    /// Where q̇ is read, in nodes from the first one's beginning; empty where it is not.
    velocities: Vec<f64>,
}

impl Nodes {
    /// A piece of a motion, in cells of that length, s.
    pub(in crate::diagnose) fn new(motion: &Motion, number: usize, cell: f64) -> Nodes {
        let (piece, states) = (&motion.pieces[number], &motion.tracks[number].states);
        let last = piece.len() - 1;
        let duration = piece.t[last] - piece.t[0];
        let per_cell = (cell * last as f64 / duration).ceil().max(1.0) as usize;
        let width = cell / per_cell as f64;
        let count = (duration / cell).floor() as usize * per_cell;
        let start = piece.t[0];
        let (t, q, qd, qdd, velocities) = Default::default();
        let mut nodes = Nodes { start, width, per_cell, t, q, qd, qdd, velocities };
        let mut k = 0;
        for index in 0..count {
            let t = nodes.start + (index as f64 + 0.5) * width;
            while k + 1 < last && piece.t[k + 1] <= t {
                k += 1;
            }
            let [q, qd, qdd] = between([&states[k], &states[k + 1]], piece.t[k + 1] - piece.t[k], t - piece.t[k]);
            nodes.t.push(t);
            nodes.q.push(q);
            nodes.qd.push(qd);
            nodes.qdd.push(qdd);
        }
        let lag = motion.sensors.lag(1);
        let read = taken(motion, number, 1).map(|k| (piece.t[k] - lag - nodes.start) / width);
        nodes.velocities = read.filter(|place| *place > 0.0 && *place < count as f64).collect();
        nodes
    }

    /// The same where q̇ is read as in others of the same piece.
    pub(in crate::diagnose) fn read_as(self, others: &Nodes) -> Nodes {
        Nodes { velocities: others.velocities.clone(), ..self }
    }

    /// Number of cells.
    pub(in crate::diagnose) fn cells(&self) -> usize {
        self.t.len() / self.per_cell
    }

    /// The first cell that begins no earlier than a node.
    pub(in crate::diagnose) fn cell_of(&self, node: usize) -> usize {
        node.div_ceil(self.per_cell)
    }

    /// The first node of a cell.
    pub(in crate::diagnose) fn node_of(&self, cell: usize) -> usize {
        cell * self.per_cell
    }

    /// Time, s, displacement and velocity at every node.
    pub(in crate::diagnose) fn states(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        self.t.iter().zip(&self.q).zip(&self.qd).map(|((t, q), qd)| (*t, *q, *qd))
    }

    /// Time since the piece began at every node, s.
    pub(in crate::diagnose) fn elapsed(&self) -> impl Iterator<Item = f64> {
        self.t.iter().map(|t| t - self.start)
    }

    /// The motion under an excitation at the nodes.
    pub(in crate::diagnose) fn trajectory<'a>(&'a self, excitation: &'a [f64]) -> Trajectory<'a> {
        Trajectory { t: &self.t, q: &self.q, qd: &self.qd, excitation, hold: Hold::Linear }
    }

    /// The mean over each node of the excitation `delay` s ago.
    pub(in crate::diagnose) fn excitation(&self, force: &Impulse, delay: f64) -> Vec<f64> {
        let mut place = 0;
        let edge = |index: usize| self.start + index as f64 * self.width - delay;
        let mut edges = (0..=self.t.len()).map(|index| force.until(edge(index), &mut place));
        let mut before = edges.next().unwrap_or_default();
        let mean = |after: f64| (after - std::mem::replace(&mut before, after)) / self.width;
        edges.map(mean).collect()
    }

    /// Integrals over the cells, and their first moments about the middles, in cells: the test functions are straight
    /// lines over a cell.
    pub(in crate::diagnose) fn integrals(&self, values: &[f64]) -> Vec<[f64; 2]> {
        let count = self.per_cell as f64;
        let sum = |values: &[f64]| {
            let moment = |(index, value): (usize, &f64)| ((index as f64 + 0.5) / count - 0.5) * value;
            let moment: f64 = values.iter().enumerate().map(moment).sum();
            [values.iter().sum::<f64>() * self.width, moment * self.width]
        };
        values.chunks_exact(self.per_cell).map(sum).collect()
    }

    /// Means of a force from one reading of q̇ to the next: what q̇ on straight lines between them shows of it,
    /// exactly, however it varies there. As it is where q̇ is not read.
    pub(in crate::diagnose) fn between_velocities(&self, values: Vec<f64>) -> Vec<f64> {
        if self.velocities.is_empty() {
            return values;
        }
        let last = values.len() - 1;
        let mut sums = vec![0.0];
        values.iter().for_each(|value| sums.push(sums[sums.len() - 1] + value));
        self.means(|place| {
            let node = (place as usize).min(last);
            let part = place - node as f64;
            let slope = 0.5 * (values[(node + 1).min(last)] - values[node.saturating_sub(1)]);
            sums[node] + part * (values[node] + 0.5 * slope * (part - 1.0))
        })
    }

    /// The same of the excitation `delay` s ago, which may jump at a reading.
    pub(in crate::diagnose) fn excitation_between_velocities(&self, force: &Impulse, delay: f64) -> Vec<f64> {
        if self.velocities.is_empty() {
            return self.excitation(force, delay);
        }
        let mut near = 0;
        self.means(|place| force.until(self.start + place * self.width - delay, &mut near) / self.width)
    }

    /// Means between readings of q̇ of what has this integral up to a place, in nodes.
    fn means(&self, mut until: impl FnMut(f64) -> f64) -> Vec<f64> {
        let count = self.t.len();
        let places = [0.0].into_iter().chain(self.velocities.iter().copied()).chain([count as f64]);
        let points: Vec<[f64; 2]> = places.map(|place| [place, until(place)]).collect();
        let edges = lines(&points, (0..=count).map(|edge| edge as f64));
        edges.windows(2).map(|edges| edges[1] - edges[0]).collect()
    }

    /// What the readings of q have beyond the smoothed motion, a straight line from reading to reading, integrated over
    /// the cells: with it the smoothed motion is the measured one again, without what smoothing may take from it.
    pub(in crate::diagnose) fn remainder(&self, motion: &Motion, number: usize) -> Vec<[f64; 2]> {
        self.integrals(&self.followed(motion, number, 0, |state| motion.sensors.reading(0, state)))
    }

    /// The readings of q̇ on straight lines, integrated over the cells.
    pub(in crate::diagnose) fn straight(&self, motion: &Motion, number: usize) -> Vec<[f64; 2]> {
        self.integrals(&self.followed(motion, number, 1, |_| 0.0))
    }

    /// Readings less `than` of the smoothed state, at the nodes, on straight lines from reading to reading that is
    /// taken.
    fn followed(&self, motion: &Motion, number: usize, channel: usize, than: impl Fn(&[f64; 4]) -> f64) -> Vec<f64> {
        let (piece, track, sensors) = (&motion.pieces[number], &motion.tracks[number], &motion.sensors);
        let Some(values) = readings(piece, track.read)[channel] else { return vec![0.0; self.t.len()] };
        let point = |k: usize| {
            let state = &track.states[k];
            let smoothed = sensors.reading(channel, state);
            let beyond = (values[k] / sensors.unit(channel) - smoothed) / doubt(motion, number, channel, k);
            [piece.t[k] - sensors.lag(channel), smoothed + beyond - than(state)]
        };
        lines(&taken(motion, number, channel).map(point).collect::<Vec<_>>(), self.t.iter().copied())
    }
}

/// Factor on the variance of a reading.
fn doubt(motion: &Motion, number: usize, channel: usize, k: usize) -> f64 {
    motion.tracks[number].doubt[channel].get(k).copied().unwrap_or(1.0)
}

/// The readings of a channel that are taken; none where it is not read.
fn taken(motion: &Motion, number: usize, channel: usize) -> impl Iterator<Item = usize> {
    let piece = &motion.pieces[number];
    let count = readings(piece, motion.tracks[number].read)[channel].map_or(0, <[f64]>::len);
    (0..count).filter(move |k| doubt(motion, number, channel, *k) < UNREAD)
}

/// Straight lines between points [t, value] at instants in their order; the first and the last value beyond them.
fn lines(points: &[[f64; 2]], instants: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut k = 0;
    let at = |t: f64| {
        while k + 1 < points.len() && points[k + 1][0] <= t {
            k += 1;
        }
        let [from, value] = points.get(k).copied().unwrap_or_default();
        let [to, next] = points.get(k + 1).copied().unwrap_or([f64::INFINITY, value]);
        value + (next - value) * ((t - from) / (to - from)).max(0.0)
    };
    instants.map(at).collect()
}

/// ∫ F dt from the first reading of a piece on. Before it and after the last one the excitation counts as they are.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Impulse {
    t: Vec<f64>,
    value: Vec<f64>,
    hold: Hold,
    /// At every reading.
    sums: Vec<f64>,
    /// Of a band-limited excitation, its values at equidistant nodes of every interval.
    nodes: Vec<[f64; NODES + 1]>,
}

impl Impulse {
    /// Of a piece whose excitation did that between readings.
    pub(in crate::diagnose) fn new(piece: &Piece, hold: Hold) -> Impulse {
        let nodes = if hold == Hold::BandLimited { piece.band_limited() } else { Vec::new() };
        let (t, value) = (piece.t.clone(), piece.excitation.clone());
        let mut impulse = Impulse { t, value, hold, sums: vec![0.0], nodes };
        for k in 0..piece.len() - 1 {
            let next = impulse.sums[k] + impulse.within(k, piece.t[k + 1] - piece.t[k]);
            impulse.sums.push(next);
        }
        impulse
    }

    /// Over the first part, s, of an interval.
    fn within(&self, k: usize, x: f64) -> f64 {
        let (t, value) = (&self.t, &self.value);
        let dt = t[k + 1] - t[k];
        match self.hold {
            Hold::Zero => x * value[k],
            Hold::Linear => x * (value[k] + 0.5 * (value[k + 1] - value[k]) * x / dt),
            Hold::BandLimited => {
                let nodes = &self.nodes[k];
                let place = (x / dt * NODES as f64).clamp(0.0, NODES as f64);
                let whole = (place as usize).min(NODES - 1);
                let trapezoids = nodes[..=whole].windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum::<f64>();
                let share = place - whole as f64;
                let last = share * (nodes[whole] + 0.5 * share * (nodes[whole + 1] - nodes[whole]));
                (trapezoids + last) * dt / NODES as f64
            }
        }
    }

    /// ∫ F dt up to an instant; `place` is where the one before was found, fast where instants come in their order.
    fn until(&self, t: f64, place: &mut usize) -> f64 {
        let (times, values) = (&self.t, &self.value);
        let last = times.len() - 1;
        if t <= times[0] {
            return (t - times[0]) * values[0];
        }
        if t >= times[last] {
            return self.sums[last] + (t - times[last]) * values[last];
        }
        while times[*place] > t {
            *place -= 1;
        }
        while times[*place + 1] <= t {
            *place += 1;
        }
        self.sums[*place] + self.within(*place, t - times[*place])
    }
}

/// Position, velocity and acceleration within an interval of length h, a time x after its start: the quintic through
/// both ends.
fn between([from, to]: [&[f64; 4]; 2], h: f64, x: f64) -> [f64; 3] {
    let s = x / h;
    let [p, v, a] = [from[0], from[1] * h, from[2] * h * h];
    let position = to[0] - p - v - 0.5 * a;
    let velocity = to[1] * h - v - a;
    let acceleration = to[2] * h * h - a;
    let c = [
        10.0 * position - 4.0 * velocity + 0.5 * acceleration,
        -15.0 * position + 7.0 * velocity - acceleration,
        6.0 * position - 3.0 * velocity + 0.5 * acceleration,
    ];
    [
        p + s * (v + s * (0.5 * a + s * (c[0] + s * (c[1] + s * c[2])))),
        (v + s * (a + s * (3.0 * c[0] + s * (4.0 * c[1] + s * 5.0 * c[2])))) / h,
        (a + s * (6.0 * c[0] + s * (12.0 * c[1] + s * 20.0 * c[2]))) / (h * h),
    ]
}
