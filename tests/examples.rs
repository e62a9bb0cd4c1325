//! Every example runs, and says what its record holds. `cargo test` builds them; `cargo build --examples` does where a
//! single test is run.

use std::path::PathBuf;
use std::process::Command;

/// What an example prints; it must succeed.
fn printed(name: &str, arguments: &[&str]) -> String {
    let binary = PathBuf::from(env!("CARGO_BIN_EXE_switchid"));
    let example = binary.with_file_name("examples").join(name).with_extension(std::env::consts::EXE_EXTENSION);
    let output = Command::new(&example).args(arguments).output();
    let output = output.unwrap_or_else(|error| panic!("{}: {error}: cargo build --examples", example.display()));
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn identify_notices_the_switches_of_its_stream() {
    let text = printed("identify", &[]);
    assert_eq!(text.lines().filter(|line| line.starts_with("switch at")).count(), 4, "{text}");
    assert!(text.contains("\ntracking\n"), "{text}");
    for (term, truth) in [("qdd", 0.8), ("qd", 0.25), ("q", 3.0), ("q^3", 2.5), ("q^2", 0.0)] {
        let line = text.lines().find_map(|line| line.strip_prefix(&format!("{term} = "))).unwrap();
        let value: f64 = line.split(' ').next().unwrap().parse().unwrap();
        assert!((value - truth).abs() < 0.01, "{term}: {text}");
    }
}

#[test]
fn diagnose_names_the_friction_of_its_rig() {
    let text = printed("diagnose", &[]);
    assert!(text.starts_with("Missing: coulomb_friction\n") && text.contains("[terms]"), "{text}");
}

#[test]
fn known_laws_knows_mondays_law_on_tuesday() {
    let text = printed("known_laws", &[]);
    assert!(text.contains("monday, law Some(1), recognised: false"), "{text}");
    assert!(text.contains("tuesday, law Some(1), recognised: true"), "{text}");
}

#[test]
fn limits_tells_a_std_of_every_coefficient() {
    let text = printed("limits", &[]);
    assert_eq!(text.lines().filter(|line| line.contains("std at least")).count(), 4, "{text}");
}

#[test]
fn a_simulated_record_is_identified_from_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    let data = file("record.csv", &printed("simulate", &[]));
    let terms = "terms = { qdd = 'fit', qd = 'fit', q = 'fit', 'q^3' = 'fit', coulomb_friction = 'fit' }";
    let text = printed("recording", &[&data, &file("model.toml", terms)]);
    let starts: Vec<f64> = text.lines().filter_map(|line| line.split(' ').next()?.parse().ok()).collect();
    assert!(starts.len() == 2 && (starts[1] - 10.0).abs() < 0.2, "{text}");
    assert!(text.contains("sign"), "{text}");
}
