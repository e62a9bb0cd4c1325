//! `cargo xtask real`: what the command line makes of real records, beside an independent regression's answers.
//!
//! It measures only: the reference's answers (`reference.toml`) never reach the program measured, which gets the
//! recordings and the models to begin with.

mod answer;
mod binary;
mod clock;
mod diagnose;
mod figure;
mod identify;
mod improve;
mod options;
mod page;
mod reference;
mod score;
mod silverbox;
mod table;
mod transfer;

use crate::error::Error;
use crate::steps::Steps;
use binary::Binary;
use figure::Figure;
use options::Options;
use reference::Record;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Parts that are no record.
const PARTS: [&str; 2] = ["transfer", "silverbox"];

/// The record on which the cost of a diagnosis is measured: 25 000 samples.
const COST: &str = "emps_train";

/// All that is measured.
#[derive(Default, Serialize)]
struct Measured {
    diagnose: Vec<diagnose::Row>,
    improve: Vec<improve::Row>,
    identify: Vec<identify::Row>,
    figures: Vec<Figure>,
    #[serde(skip)]
    crashes: usize,
}

/// Measures what the arguments ask for, prints tables and figures.
///
/// # Errors
/// [`Error::Usage`]; [`Error::Records`] when there are no recordings; [`Error::Floors`] names the floors that are
/// missed.
pub fn real(arguments: &[String]) -> Result<(), Error> {
    let records = reference::records()?;
    let names: Vec<&str> = records.iter().map(|record| record.name.as_str()).chain(PARTS).collect();
    let options = Options::read(arguments, &names)?;
    let folder = recordings(&records)?;
    let wanted: Vec<&Record> = records.iter().filter(|record| options.wants(&record.name)).collect();
    let parts = PARTS.iter().filter(|part| options.wants(part)).count();
    let mut steps = Steps::new(1 + wanted.len() + parts);
    let binary = steps.run("switchid", || Binary::new(options.switchid.as_deref()))?;
    if options.page {
        return page(&mut steps, &binary, &wanted, &folder);
    }
    let mut measured = Measured::default();
    for record in wanted {
        steps.run(&record.name, || measured.record(&binary, record, &folder))?;
    }
    let transferred = measured.transfers(&mut steps, &binary, &records, &folder, &options)?;
    measured.sum_up(records.len(), transferred);
    measured.print();
    measured.write(options.json.as_deref())?;
    measured.missed()
}

/// The page of records.
const PAGE: &str = "docs/real-records.md";

fn page(steps: &mut Steps, binary: &Binary, records: &[&Record], folder: &Path) -> Result<(), Error> {
    let mut page = page::Page::begin(&crate::command::root().join(PAGE))?;
    for record in records {
        steps.run(&record.name, || page.add(binary, record, &path(folder, &record.file)))?;
    }
    page.write()
}

/// The directory of recordings, once it has all that are measured.
fn recordings(records: &[Record]) -> Result<PathBuf, Error> {
    let folder = std::env::var_os("SWITCHID_DATA").map(PathBuf::from);
    let folder = folder.ok_or_else(|| Error::Records { text: "SWITCHID_DATA is not set".into() })?;
    let files = records.iter().map(|record| record.file.as_str()).chain([SILVERBOX]);
    match files.map(|file| folder.join(file)).find(|path| !path.is_file()) {
        Some(missing) => Err(Error::Records { text: format!("{} is not there", missing.display()) }),
        None => folder.canonicalize().map_err(|source| Error::File { action: "find", path: folder, source }),
    }
}

const SILVERBOX: &str = "silverbox/silverbox_tidy.csv";

fn path(folder: &Path, file: &str) -> String {
    folder.join(file).display().to_string()
}

impl Measured {
    fn record(&mut self, binary: &Binary, record: &Record, folder: &Path) -> Result<(), Error> {
        let data = path(folder, &record.file);
        self.diagnose.push(diagnose::measure(binary, record, &data)?);
        self.improve.push(improve::measure(binary, record, &data)?);
        self.identify.extend(identify::measure(binary, record, &data)?);
        Ok(())
    }

    fn transfers(
        &mut self,
        steps: &mut Steps,
        binary: &Binary,
        records: &[Record],
        folder: &Path,
        options: &Options,
    ) -> Result<Vec<Figure>, Error> {
        let mut figures = Vec::new();
        let mut keep = |(found, crashed): (Vec<Figure>, bool)| {
            figures.extend(found);
            self.crashes += usize::from(crashed);
        };
        if let [train, test, ..] = records
            && options.wants(PARTS[0])
        {
            let [data, unseen] = [train, test].map(|record| path(folder, &record.file));
            keep(steps.run(PARTS[0], || transfer::emps(binary, &train.model(), &data, &unseen))?);
        }
        if options.wants(PARTS[1]) {
            keep(steps.run(PARTS[1], || transfer::silverbox(binary, &folder.join(SILVERBOX)))?);
        }
        Ok(figures)
    }

    /// Completes the figures; `records` is how many records there are.
    fn sum_up(&mut self, records: usize, transferred: Vec<Figure>) {
        if !self.diagnose.is_empty() {
            self.figures.extend(diagnose::figures(&self.diagnose, records));
            self.figures.extend(improve::figures(&self.improve));
            let named = self.diagnose.iter().filter(|row| row.is_unknown()).count();
            let added: usize = self.improve.iter().map(improve::Row::unknown).sum();
            let unknown = Some((named + added) as f64);
            self.figures.push(Figure::at_most("named effects with a std above their coefficient", unknown, 0.0, 0.0));
        }
        self.crashes += self.diagnose.iter().filter(|row| row.crashed()).count();
        self.crashes += self.improve.iter().filter(|row| row.crashed()).count();
        self.crashes += self.identify.iter().filter(|row| row.crashed()).count();
        self.figures.push(Figure::at_most("crashes", Some(self.crashes as f64), 0.0, 0.0));
        if !self.identify.is_empty() {
            self.figures.extend(identify::figures(&self.identify));
        }
        self.figures.extend(transferred);
        let cost = self.diagnose.iter().map(diagnose::Row::cost).find(|(record, _)| *record == COST);
        let cost =
            cost.map(|(_, seconds)| Figure::at_most("diagnose, 25 000 samples, CPU in s", Some(seconds), 3.0, 0.7));
        self.figures.extend(cost);
    }

    fn print(&self) {
        if !self.diagnose.is_empty() {
            println!("## First answers\n\n{}", diagnose::text(&self.diagnose));
            println!("## Staircases\n\n{}", improve::text(&self.improve));
        }
        if !self.identify.is_empty() {
            println!("## Laws with Coulomb friction\n\n{}", identify::text(&self.identify));
        }
        println!("## Figures\n\n{}", figure::figures(&self.figures));
    }

    fn write(&self, target: Option<&Path>) -> Result<(), Error> {
        let Some(target) = target else { return Ok(()) };
        let text = serde_json::to_string_pretty(self)?;
        std::fs::write(target, text).map_err(|source| Error::File { action: "write", path: target.into(), source })
    }

    /// The floors that are missed, as an error.
    fn missed(&self) -> Result<(), Error> {
        let missed: Vec<String> =
            self.figures.iter().filter(|figure| figure.is_missed()).map(|figure| figure.name.clone()).collect();
        if missed.is_empty() { Ok(()) } else { Err(Error::Floors { missed }) }
    }
}
