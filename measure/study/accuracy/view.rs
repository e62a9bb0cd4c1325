//! The points of one plant beside its limits, in tables and pictures.

use super::super::Failure;
use super::super::figure::{Picture, table};
use super::super::limit;
use super::super::lines::{decades, limit as limit_line, line};
use super::super::plant::Plant;
use super::super::statistics::{factor, mean, median, quantile, small};
use super::{Errors, NOISES, Point, lengths};
use switchid::report::{Axis, Panel};

/// Noise at which lengths of record are compared.
pub const NOISE: f64 = 0.1;

/// Points of one plant, with its limits.
pub struct View<'a> {
    /// The plant.
    pub plant: Plant,
    measured: Vec<&'a (Point, Errors)>,
    lengths: Vec<f64>,
    /// Limits of e at noise 1 of the true terms …
    true_terms: Vec<f64>,
    /// … and of the whole model.
    whole_model: Vec<f64>,
}

/// One of the two methods.
pub type Method = fn(&Errors) -> &[f64];

/// The default one.
pub const OURS: Method = |errors| &errors.ours;
/// The published one.
pub const PUBLISHED: Method = |errors| &errors.published;

/// One piece of evidence for each plant.
pub fn by_plant(views: &[View], evidence: impl Fn(&View) -> String) -> String {
    views.iter().map(|view| format!("{}: {}", view.plant.name(), evidence(view))).collect::<Vec<_>>().join("; ")
}

impl<'a> View<'a> {
    pub fn new(plant: Plant, measured: &'a [(Point, Errors)]) -> Result<View<'a>, Failure> {
        let lengths = lengths(plant);
        Ok(View {
            plant,
            measured: measured.iter().filter(|(point, _)| point.plant == plant).collect(),
            true_terms: limit::errors(plant, &lengths, false)?,
            whole_model: limit::errors(plant, &lengths, true)?,
            lengths,
        })
    }

    fn at(&self, length: f64) -> usize {
        self.lengths.partition_point(|other| *other < length - 1e-9).min(self.lengths.len() - 1)
    }

    /// e of every record with this noise after this length, s.
    pub fn errors(&self, method: Method, noise: f64, length: f64) -> Vec<f64> {
        let of_noise = self.measured.iter().filter(|(point, _)| point.noise == noise);
        of_noise.map(|(_, errors)| method(errors)[self.at(length)]).collect()
    }

    /// Their mean.
    fn mean(&self, method: Method, noise: f64, length: f64) -> Option<f64> {
        mean(&self.errors(method, noise, length))
    }

    /// Their median.
    pub fn median(&self, method: Method, noise: f64, length: f64) -> Option<f64> {
        median(&self.errors(method, noise, length))
    }

    /// The limit of e for the true terms.
    pub fn limit(&self, noise: f64, length: f64) -> f64 {
        self.true_terms[self.at(length)] * noise * noise
    }

    /// The longest record, s.
    pub fn longest(&self) -> f64 {
        self.lengths.last().copied().unwrap_or_default()
    }

    /// How far both methods stay from the limit, over the rows of the table.
    pub fn against_limit(&self) -> String {
        let rows = || {
            self.plant.intervals().into_iter().flat_map(|length| NOISES[1..].iter().map(move |noise| (length, *noise)))
        };
        let words = |method: Method| {
            let ratio = |(length, noise)| Some(self.mean(method, noise, length)? / self.limit(noise, length));
            let ratios: Vec<f64> = rows().filter_map(ratio).collect();
            format!("{} times the limit (worst {})", factor(median(&ratios)), factor(quantile(&ratios, 1.0)))
        };
        format!(
            "mean e of ours is {}, of the published method {}, median over the rows below with noise",
            words(OURS),
            words(PUBLISHED)
        )
    }

    pub fn table(&self) -> String {
        let cells = |method: Method, noise: f64, length: f64| {
            format!("{} ({})", small(self.mean(method, noise, length)), small(self.median(method, noise, length)))
        };
        let row = |noise: f64, length: f64| {
            let limit = self.limit(noise, length);
            let ratio = self.mean(OURS, noise, length).filter(|_| limit > 0.0).map(|mean| mean / limit);
            vec![
                format!("{length}"),
                format!("{noise}"),
                small(noise * noise * 1e-3),
                format!("{} / {}", small(limit), small(self.whole_model[self.at(length)] * noise * noise)),
                cells(OURS, noise, length),
                factor(ratio),
                cells(PUBLISHED, noise, length),
            ]
        };
        let intervals = self.plant.intervals();
        let rows = intervals.into_iter().flat_map(|length| NOISES.into_iter().map(move |noise| (noise, length)));
        let head = [
            "interval, s",
            "σ",
            "2D, s",
            "limit of e: true / all terms",
            "ours: mean (median)",
            "÷ limit",
            "published: mean (median)",
        ];
        let seeds = self.errors(OURS, NOISE, 0.0).len();
        let table = table(&head, rows.map(|(noise, length)| row(noise, length)));
        format!("**{}**, {seeds} seeds a row (one without noise)\n\n{table}\n", self.plant.name())
    }

    pub fn against_noise(&self) -> Picture {
        let noises = &NOISES[1..];
        let measured = |length: f64, method: Method| {
            line(&format!("{length} s"), noises.iter().map(|noise| (*noise, self.mean(method, *noise, length))))
        };
        let least_of =
            |length: f64| limit_line("", noises.iter().map(|noise| (*noise, Some(self.limit(*noise, length)))));
        let intervals = || self.plant.intervals().into_iter();
        let least = self.limit(noises[0], self.longest());
        let panel = |title: &str, method: Method| Panel {
            title: title.into(),
            x: Axis::log("σ of the sensor noise").over(0.002, 0.2),
            y: decades("mean e", [0.3 * least, 1.0]),
            layers: intervals().map(|length| measured(length, method)).chain(intervals().map(least_of)).collect(),
        };
        Picture {
            name: format!("{}-noise", self.plant.id()),
            caption: format!(
                "{}: mean e against noise, by integral interval; thin lines: the limit",
                self.plant.name()
            ),
            panels: vec![panel("published method", PUBLISHED), panel("ours", OURS)],
        }
    }

    pub fn against_length(&self) -> Picture {
        let measured = |name: &str, method: Method, noise: f64| {
            line(name, self.lengths.iter().map(|length| (*length, self.median(method, noise, *length))))
        };
        let computed = |values: &[f64], noise: f64| {
            let of = |(length, limit): (&f64, &f64)| (*length, Some(limit * noise * noise));
            self.lengths.iter().zip(values).map(of).collect::<Vec<_>>()
        };
        let panel = |noise: f64| Panel {
            title: format!("σ = {noise}"),
            x: Axis::log("record, s").over(self.lengths[0], self.longest()),
            y: decades("median e", [0.1 * self.limit(noise, self.longest()), 10.0]),
            layers: vec![
                measured("ours", OURS, noise),
                measured("published", PUBLISHED, noise),
                line("limit, whole model", computed(&self.whole_model, noise)),
                limit_line("limit, true terms", computed(&self.true_terms, noise)),
            ],
        };
        Picture {
            name: format!("{}-length", self.plant.id()),
            caption: format!(
                "{}: median e against the length of the record; the natural period is {} s; e = 1 where nothing is known yet",
                self.plant.name(),
                self.plant.period()
            ),
            panels: vec![panel(0.01), panel(NOISE)],
        }
    }
}
