//! Units from the header or the model go into the coefficients.

use super::bench::{Bench, MODEL, plain};
use serde_json::Value;

fn stage(bench: &Bench, file: &str) -> Value {
    let output = bench.identify(&[file, "--json"]);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    found["stages"][0].clone()
}

/// The first seconds of a Duffing oscillator under this header, q times a scale.
fn duffing(bench: &Bench, header: &str, scale: f64) -> String {
    assert!(bench.run(&["simulate", "duffing-sine", "-o", "duffing.csv", "--force"]).status.success());
    let record = std::fs::read_to_string(bench.0.join("duffing.csv")).unwrap();
    let line = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        format!("{},{},{},{}\n", cells[0], cells[1] * scale, cells[2], cells[3])
    };
    format!("{header}\n{}", record.lines().skip(1).take(4000).map(line).collect::<String>())
}

#[test]
fn coefficients_carry_the_units_of_the_header() {
    let bench = Bench::new("units_header");
    bench.write("data.csv", &duffing(&bench, "t,q [mm],qd,F [N]", 1e3));
    let stage = stage(&bench, "data.csv");
    let units = stage["units"].as_object().unwrap();
    assert_eq!(units.len(), stage["coefficients"].as_object().unwrap().len());
    assert_eq!((units["qdd"].as_str(), units["q^3"].as_str()), (Some("kg"), Some("N/m³")));
    let text = String::from_utf8(bench.identify(&["data.csv"]).stdout).unwrap();
    assert!(text.lines().any(|line| line.trim_start().starts_with("qdd ") && line.ends_with(" kg")), "{text}");
}

#[test]
fn the_model_names_units_where_the_header_does_not() {
    let bench = Bench::new("units_model");
    bench.write("data.csv", &duffing(&bench, "t,q,qd,F", 1.0));
    let plain = stage(&bench, "data.csv");
    assert_eq!(plain["units"], serde_json::json!({}));
    bench.write("model.toml", &format!("[units]\nq = \"mm\"\nF = \"V\"\n{MODEL}"));
    bench.write("scaled.csv", &duffing(&bench, "t,q,qd,F", 1e3));
    let scaled = stage(&bench, "scaled.csv");
    assert_eq!(scaled["units"]["q"], "V/m");
    for (term, value) in plain["coefficients"].as_object().unwrap() {
        let other = scaled["coefficients"][term].as_f64().unwrap();
        assert!((other / value.as_f64().unwrap() - 1.0).abs() < 1e-6, "{term}: {value} and {other}");
    }
}

#[test]
fn a_header_that_contradicts_the_model_is_refused() {
    let bench = Bench::new("units_contradict");
    bench.write("model.toml", &format!("[units]\nq = \"mm\"\n{MODEL}"));
    bench.write("metres.csv", &plain("t,q [m],qd,F", 50));
    bench.identify_refuses("metres.csv", &["metres.csv", "\"q [m]\" is in m", "[units] q = \"mm\""]);
    bench.write("same.csv", &plain("t,q_mm,qd,F", 500));
    assert!(bench.identify(&["same.csv"]).status.success());
    bench.write("model.toml", &format!("[units]\nqd = \"N\"\n{MODEL}"));
    bench.identify_refuses("same.csv", &["model.toml", "[units] qd = \"N\"", "a velocity"]);
}
