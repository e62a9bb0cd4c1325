//! The study behind docs/study.md: `cargo xtask study [--help]`.
//!
//! The publication's figures 4 and 8, the limits and ours drawn in; its claims, each confirmed or refuted; delays
//! against noise, against the false-alarm interval, under rapid switching; cost against the number of terms. Points
//! that were measured are kept in target/study and not measured again while the library's sources stay as they are.

mod accuracy;
mod alarms;
mod arguments;
mod cost;
mod delays;
mod figure;
mod follow;
mod limit;
mod lines;
mod loops;
mod page;
mod plant;
mod rapid;
mod statistics;
mod store;
mod study;

use accuracy::Accuracy;
use alarms::Alarms;
use arguments::Arguments;
use clap::Parser;
use cost::Cost;
use delays::Delays;
use figure::{Figure, Section};
use loops::Loops;
use rapid::Rapid;
use study::Study;

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// A figure's name, and what measures it and sums it up.
type Part = (&'static str, fn(&Study) -> Result<Section, Failure>);

const PARTS: [Part; 6] =
    [part::<Accuracy>(), part::<Loops>(), part::<Delays>(), part::<Alarms>(), part::<Rapid>(), part::<Cost>()];

const fn part<F: Figure>() -> Part {
    (F::NAME, Study::section::<F>)
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::parse();
    let study = Study::new(&arguments)?;
    let Some(only) = &arguments.only else {
        let sections: Vec<Section> = PARTS.iter().map(|(_, section)| section(&study)).collect::<Result<_, _>>()?;
        page::write(&arguments.out, &sections, arguments.seeds)?;
        println!("{}", page::path(&arguments.out).display());
        return Ok(());
    };
    let names = PARTS.map(|(name, _)| name).join(", ");
    let part = PARTS.iter().find(|(name, _)| name == only);
    let (_, section) = part.ok_or_else(|| format!("--only {only}: there is no such figure; there are {names}"))?;
    let section = section(&study)?;
    page::pictures(&arguments.out, &section)?;
    println!("{}", page::text(&arguments.out, &section));
    Ok(())
}
