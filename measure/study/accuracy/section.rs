//! What the figures of e say.

use super::super::Failure;
use super::super::chart::{Axis, Kind, Line, Panel};
use super::super::figure::{Picture, Section, table};
use super::super::limit;
use super::super::plant::Plant;
use super::super::statistics::{factor, mean, median, quantile, small};
use super::claims::{by_plant, claims};
use super::{Errors, NOISES, Point, lengths};
use plotters::prelude::SeriesLabelPosition;

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

pub fn section(measured: &[(Point, Errors)]) -> Result<Section, Failure> {
    let views = Plant::ALL.map(|plant| View::new(plant, measured));
    let [duffing, van_der_pol] = views;
    let views = [duffing?, van_der_pol?];
    let tables: String = views.iter().map(View::table).collect();
    let text = format!(
        "The publication's plants with one law throughout, both sensors with Gaussian noise of std σ, sampled every 1 ms. Its abscissa is \
         called the intensity 2D of the noise, from 0 to 0.2. Read as the density of a white noise it would be σ² · 1 ms (the column 2D); but its \
         printed e = 2.58e-4 for Duffing, 12 s, at 0.1 belongs to σ = 0.1: the published method has a median of {} there. So σ is what its \
         abscissa says.\n\nOurs is the streaming identifier with its default configuration, read at these times of one run (its memory is 30 s: \
         at 40 s it has seen the last 30). The published method identifies from a first window of that length. e is the mean over the seeds, the \
         median in brackets; the limit is the Cramér–Rao bound of e, a mean as well: \
         half of it is a good median. For van der Pol both methods are given the full cubic library of 11 terms; the limit is that of the four true terms, \
         beside it that of all 11.\n\n{}\n\n{tables}",
        small(views[0].median(PUBLISHED, NOISE, 12.0)),
        by_plant(&views, |view| view.against_limit()) + ".",
    );
    let pictures = views.iter().flat_map(|view| [view.against_noise(), view.against_length()]).collect();
    let title = "Error against noise and length of record";
    Ok(Section { title, text, pictures, claims: claims(&views) })
}

impl<'a> View<'a> {
    fn new(plant: Plant, measured: &'a [(Point, Errors)]) -> Result<View<'a>, Failure> {
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
    fn against_limit(&self) -> String {
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

    fn table(&self) -> String {
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

    fn against_noise(&self) -> Picture {
        let noises = &NOISES[1..];
        let line = |number: usize, length: f64, method: Method| {
            let points = noises.iter().map(|noise| (*noise, self.mean(method, *noise, length)));
            Line::new(&format!("{length} s"), number, Kind::Marked, points)
        };
        let limit = |number: usize, length: f64| {
            let points = noises.iter().map(|noise| (*noise, Some(self.limit(*noise, length))));
            Line::new("", number, Kind::Thin, points)
        };
        let numbered = || self.plant.intervals().into_iter().enumerate();
        let least = self.limit(noises[0], self.longest());
        let panel = |title: &str, method: Method| Panel {
            title: title.into(),
            x: Axis::log("σ of the sensor noise", &[0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2]),
            y: Axis::decades("mean e", [0.3 * least, 1.0]),
            legend: SeriesLabelPosition::UpperLeft,
            lines: numbered()
                .map(|(number, length)| line(number, length, method))
                .chain(numbered().map(|(number, length)| limit(number, length)))
                .collect(),
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

    fn against_length(&self) -> Picture {
        let line = |name: &str, colour: usize, method: Method, noise: f64| {
            let points = self.lengths.iter().map(|length| (*length, self.median(method, noise, *length)));
            Line::new(name, colour, Kind::Marked, points)
        };
        let computed = |name: &str, colour: usize, values: &[f64], noise: f64| {
            let points = self.lengths.iter().zip(values).map(|(length, limit)| (*length, Some(limit * noise * noise)));
            Line::new(name, colour, Kind::Thin, points)
        };
        let panel = |noise: f64| Panel {
            title: format!("σ = {noise}"),
            x: Axis::log("record, s", &ticks(self.plant)),
            y: Axis::decades("median e", [0.1 * self.limit(noise, self.longest()), 10.0]),
            legend: SeriesLabelPosition::UpperRight,
            lines: vec![
                line("ours", 0, OURS, noise),
                line("published", 1, PUBLISHED, noise),
                computed("limit, true terms", 5, &self.true_terms, noise),
                computed("limit, whole model", 4, &self.whole_model, noise),
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

fn ticks(plant: Plant) -> Vec<f64> {
    match plant {
        Plant::Duffing => vec![0.6, 1.0, 2.0, 5.0, 10.0, 30.0],
        Plant::VanDerPol => vec![1.5, 3.0, 6.0, 12.0, 24.0, 40.0],
    }
}
