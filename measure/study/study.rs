//! Measuring the points of a figure on all cores, what is kept already left out.

use super::Failure;
use super::arguments::Arguments;
use super::figure::{Figure, Section};
use super::store::{Store, fingerprint, key};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use std::path::Path;

/// Where the library's sources are, from this crate's folder.
const SOURCES: &str = "../src";

/// Points with their outcomes.
type Measured<F> = Vec<(<F as Figure>::Point, <F as Figure>::Outcome)>;

/// A study under way.
pub struct Study {
    store: Store,
    pool: rayon::ThreadPool,
    seeds: u64,
}

impl Study {
    /// A study of the library as its sources are now.
    ///
    /// # Errors
    /// Sources or kept points that cannot be read.
    pub fn new(arguments: &Arguments) -> Result<Study, Failure> {
        let sources = fingerprint(&Path::new(env!("CARGO_MANIFEST_DIR")).join(SOURCES))?;
        Ok(Study {
            store: Store::open(&arguments.points.join(format!("{sources}.jsonl")))?,
            pool: rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build()?,
            seeds: arguments.seeds,
        })
    }

    /// Measures all points of a figure and sums them up.
    ///
    /// # Errors
    /// The first point that could not be measured.
    pub fn section<F: Figure>(&self) -> Result<Section, Failure> {
        let points = F::points(self.seeds);
        let bar = bar(F::NAME, points.len());
        let measure = |point: F::Point| {
            let outcome = self.outcome::<F>(&point);
            bar.inc(1);
            Ok((point, outcome?))
        };
        let measured: Result<Measured<F>, Failure> = match F::ALONE {
            true => points.into_iter().map(measure).collect(),
            false => self.pool.install(|| points.into_par_iter().map(measure).collect()),
        };
        bar.finish_and_clear();
        F::section(&measured?)
    }

    fn outcome<F: Figure>(&self, point: &F::Point) -> Result<F::Outcome, Failure> {
        let key = key(F::NAME, point)?;
        if let Some(known) = self.store.get(&key) {
            return Ok(known);
        }
        let outcome = F::measure(point).map_err(|failure| format!("{key}: {failure}"))?;
        self.store.put(&key, &outcome)?;
        Ok(outcome)
    }
}

fn bar(name: &'static str, points: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:10} {bar:40} {pos}/{len}  {elapsed}, {eta} left");
    ProgressBar::new(points as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        .with_message(name)
}
