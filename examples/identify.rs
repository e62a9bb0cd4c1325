//! A stream of samples: the law as it stands after each of them, and its switches.
//! `cargo run --release --example identify`

use switchid::simulate::{Builtin, record};
use switchid::{Identifier, Model, Sample, Settings};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::from_toml("terms = { qdd = 'fit', qd = 'fit', q = 'fit', 'q^3' = 'maybe', 'q^2' = 'maybe' }")?;
    let mut identifier = Identifier::new(&model, Settings::default())?;
    let mut switches = 0;

    // a simulated Duffing oscillator, its law switching every 18 s; your sensors in its place
    for reading in record(&Builtin::DuffingSine.scenario().with_noise(0.01))? {
        let sample = Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation };
        if let Err(skipped) = identifier.step(sample) {
            eprintln!("{skipped}");
        }
        let output = identifier.output();
        if output.switch_count > switches {
            switches = output.switch_count;
            println!("switch at {:.3} s, noticed at {:.3} s", output.switch_time, reading.t);
        }
    }

    println!("{}", identifier.output().status.id());
    for coefficient in identifier.coefficients() {
        match coefficient.std {
            Some(std) => println!("{} = {:.4} ± {std:.1e}", coefficient.term, coefficient.value),
            None => println!("{} is not known", coefficient.term),
        }
    }
    Ok(())
}
