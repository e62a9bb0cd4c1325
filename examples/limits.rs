//! How well any method could know a law from a planned record: `cargo run --release --example limits`

use switchid::Term;
use switchid::law::{Drive, Motion, State};
use switchid::limits::{Course, Law, Sensors, Start, bound};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // m q̈ + c q̇ + k₁ q + k₃ q³ = F, all four sought
    let pairs = [(Term::Inertia, 1.0), (Term::power(0, 1), 0.3), (Term::power(1, 0), 4.0), (Term::power(3, 0), 2.0)];
    let law = Law::new(&pairs, &[0, 1, 2, 3])?;

    // 12 s at 1 kHz from q = 0.5 under a sine, q and q̇ read with a std of 0.01
    let t: Vec<f64> = (0..=12_000).map(|k| 1e-3 * f64::from(k)).collect();
    let force = |t: f64| 2.0 * (1.5 * t).sin();
    let drives = t.windows(2).map(|pair| Drive::Line(force(pair[0]), force(pair[1]))).collect();
    let motion = Motion::new(law.terms(), law.coefficients());
    let course = Course::own(&motion, State { q: 0.5, qd: 0.0 }, t, drives);

    let found = bound(&law, &[course], Sensors([Some(0.01), Some(0.01)]), Start::Unknown)?;
    for ((term, value), std) in pairs.iter().zip(&found.std) {
        match std {
            Some(std) => println!("{term} = {value}: std at least {std:.2e}"),
            None => println!("{term}: such a record does not determine it"),
        }
    }
    Ok(())
}
