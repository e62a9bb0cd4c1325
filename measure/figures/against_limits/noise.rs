//! The sensors' noise as estimated after 4 s of record, beside what it is.

use super::Asked;
use super::disturbed::Disturbance;
use super::recorded::{Library, Recorded};
use super::spread::Spread;
use crate::Failure;
use switchid::identify::{Identifier, Sample, Settings};
use switchid::simulate::Builtin;

const SECONDS: f64 = 4.0;

const PLANTS: [Builtin; 4] =
    [Builtin::DuffingSine, Builtin::DuffingWhite, Builtin::VanDerPolSine, Builtin::VanDerPolWhite];

const NOISES: [f64; 5] = [1e-4, 1e-3, 0.01, 0.1, 0.2];

/// Prints relative errors by plant, disturbance and σ, q and q̇ together; an estimate that is not there counts as
/// infinitely wrong.
pub fn run(asked: &Asked) -> Result<(), Failure> {
    println!("| record | disturbed | σ | relative error of std after {SECONDS} s, %, median | worst | alarms |");
    println!("|---|---|---|---|---|---|");
    for builtin in PLANTS {
        for disturbance in Disturbance::ALL {
            for noise in NOISES {
                let label = format!("{} | {} | {noise}", builtin.id(), disturbance.id());
                if !asked.wants(&label) {
                    continue;
                }
                let found = asked.each(|seed| errors(builtin, disturbance, noise, seed))?;
                let spread = Spread::of(found.iter().flat_map(|(errors, _)| errors.map(|error| 100.0 * error)));
                let alarms: u32 = found.iter().map(|(_, alarms)| alarms).sum();
                println!("| {label} | {} | {alarms} |", spread.cells());
            }
        }
    }
    Ok(())
}

fn errors(builtin: Builtin, disturbance: Disturbance, noise: f64, seed: u64) -> Result<([f64; 2], u32), Failure> {
    let mut scenario = builtin.random(seed).with_noise(noise);
    scenario.stages.truncate(1);
    scenario.duration = SECONDS;
    let recorded = Recorded::of(&scenario)?;
    let mut identifier = Identifier::new(&Library::Given.model(builtin), Settings::default())?;
    for reading in disturbance.apply(&recorded.readings, noise, seed) {
        identifier.step(Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation })?;
    }
    let output = identifier.output();
    let truth = disturbance.std(noise);
    let error = |found: Option<f64>| found.map_or(f64::INFINITY, |found| (found / truth - 1.0).abs());
    Ok(([output.noise.q, output.noise.qd].map(error), output.switch_count))
}
