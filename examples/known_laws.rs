//! Laws of one recording, recognised in the next one: `cargo run --release --example known_laws`

use switchid::identify::{identify_knowing, settings_for};
use switchid::simulate::{Builtin, columns, record};
use switchid::{Model, Recording, SavedLaws, Settings};

/// A simulated record of one law; your recording in its place.
fn recorded(name: &str, seed: u64) -> Result<Recording, Box<dyn std::error::Error>> {
    let [t, q, qd, force] = columns(&record(&Builtin::DuffingNoise.random(seed).with_noise(0.01))?);
    Ok(Recording::new(name, t, Some(q), Some(qd), Some(force))?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::from_toml("terms = { qdd = 'fit', qd = 'fit', q = 'fit', 'q^3' = 'fit' }")?;
    let mut known = SavedLaws::default();
    for (name, seed) in [("monday", 1), ("tuesday", 2)] {
        let recording = recorded(name, seed)?;
        let settings = settings_for(&recording, Settings::default());
        let found = identify_knowing(&model, settings, &known, &recording, |_, _| {})?;
        for stage in &found.stages {
            let law = stage.law(true).unwrap_or_else(|| "not known".into());
            println!("{name}, law {:?}, recognised: {}: {law}", stage.law_number, stage.recognised);
        }
        known = found.known_laws;
    }
    print!("{}", known.to_toml()?);
    Ok(())
}
