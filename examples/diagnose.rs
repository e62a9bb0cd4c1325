//! Which physical effect a model lacks, and the model with it: `cargo run --release --example diagnose`

use switchid::diagnose::improved_model;
use switchid::simulate::{Scenario, columns, record};
use switchid::{Model, Recording, diagnose_stages};

// a rig with dry friction that the model below does not have; your recording in its place
const RIG: &str = r#"
    terms = ["qdd", "qd", "q"]
    duration = 20.0
    excitation = { kind = "multisine", from = 0.1, to = 2.0, count = 12, rms = 1.0 }
    noise = { q = 0.001, qd = 0.001 }
    hidden = { coulomb_friction = 0.3 }
    stage = [{ start = 0.0, coefficients = [1.0, 0.3, 4.0] }]
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [t, q, qd, force] = columns(&record(&Scenario::from_toml(RIG)?)?);
    let recording = Recording::new("rig", t, Some(q), Some(qd), Some(force))?;
    let model = Model::from_toml("terms = { qdd = 'fit', qd = 'fit', q = 'fit' }")?;

    let found = diagnose_stages(&model, &[&recording], None);
    let diagnosis = found.principal().ok_or("the record is too short for this model")?;
    println!("{:?}: {}", diagnosis.finding, diagnosis.effect.as_deref().unwrap_or("nothing"));
    for candidate in diagnosis.candidates.iter().take(3) {
        let error = candidate.error();
        println!("  {}: error {:.3} -> {:.3}", candidate.effect, error.before, error.after);
    }
    if let Some(law) = &diagnosis.improved {
        print!("{}", improved_model(&model, law).to_toml());
    }
    Ok(())
}
