//! A plant that switches, recorded as CSV: `cargo run --release --example simulate > record.csv`

use std::io::Write;
use switchid::simulate::{Scenario, record};

const PLANT: &str = r#"
    terms = ["qdd", "qd", "q", "q^3"]
    duration = 20.0
    seed = 7
    excitation = { kind = "sine", sample_time = 0.001 }
    noise = { q = 0.01, qd = 0.01 }
    hidden = { coulomb_friction = 0.1 }

    [[stage]]
    start = 0.0
    coefficients = [1.0, 0.3, 4.0, 2.0]   # m, c, k1, k3
    amplitude = 2.0                       # N
    omega = 1.5                           # rad/s

    [[stage]]
    start = 10.0
    coefficients = [1.0, 0.3, 3.0, 2.0]
    amplitude = 2.0
    omega = 1.5
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "t,q,qd,F")?;
    for row in record(&Scenario::from_toml(PLANT)?)? {
        writeln!(out, "{},{},{},{}", row.t, row.q, row.qd, row.excitation)?;
    }
    Ok(())
}
