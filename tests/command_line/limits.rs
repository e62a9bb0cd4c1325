//! What `switchid limits` prints and refuses, and what `identify` says of the limit.

use super::bench::{Bench, MODEL, plain};
use serde_json::Value;

/// A noisy Duffing record of the built-in plant, `record.csv`; one law holds over its first 15 s.
fn bench(name: &str) -> Bench {
    let bench = Bench::new(name);
    let output = bench.run(&["simulate", "duffing-white", "--seed", "3", "--noise", "0.01", "-o", "record.csv"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    bench
}

fn limits<'a>(extra: &[&'a str]) -> Vec<&'a str> {
    [&["limits", "record.csv@0:8", "--model", "model.toml", "--hold", "zero"], extra].concat()
}

fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap_or_else(|| panic!("{key}: {report:#}"))
}

#[test]
fn json_has_every_key() {
    let bench = bench("limits-json");
    let report = bench.json(&limits(&["--json", "--change", "linear_damping=0.8", "--change", "q^3=1"]));
    for term in ["qdd", "qd", "q", "q^3"] {
        let (std, value) = (&report["coefficient_std"][term], &report["coefficients"][term]);
        assert!(std.as_f64().unwrap() < 0.01 * value.as_f64().unwrap(), "{term}: {report:#}");
    }
    for channel in ["q", "qd"] {
        assert!((report["noise"][channel].as_f64().unwrap() / 0.01 - 1.0).abs() < 0.03, "{report:#}");
    }
    assert!(number(&report, "relative_error") < 1e-5);
    assert!((0.1..4.0).contains(&number(&report, "shortest_record")));
    let seen = &report["detection"];
    assert!(number(seen, "smallest") <= number(seen, "median") && number(seen, "median") <= number(seen, "largest"));
    assert!(number(&report, "detection_delay") > 0.0 && number(seen, "level") > 20.0);
    assert_eq!((&seen["change"]["qd"], &seen["change"]["q^3"]), (&Value::from(0.8), &Value::from(1.0)));
}

#[test]
fn std_grow_with_the_noise_that_is_named_and_nothing_is_detected_unasked() {
    let bench = bench("limits-noise");
    let error = |noise: &str| {
        let report = bench.json(&limits(&["--json", "--noise", noise]));
        assert!(report["detection_delay"].is_null() && report["detection"].is_null());
        number(&report, "relative_error")
    };
    assert!((error("q=0.02,qd=0.04") / error("q=0.01,qd=0.02") - 4.0).abs() < 1e-3);
}

#[test]
fn text_answers_first_and_says_what_was_left_out_and_what_is_known() {
    let bench = bench("limits-text");
    let model = MODEL.replace("\"q^3\" = \"fit\"", "\"q^3\" = \"fit\"\n\"q^2\" = \"maybe\"");
    bench.write("model.toml", &model.replace("inertia = \"fit\"", "inertia = 1.341"));
    let text = String::from_utf8(bench.run(&limits(&["--change", "q=6"])).stdout).unwrap();
    let heads: Vec<&str> = text.lines().take(3).filter_map(|line| line.split([':', ' ']).next()).collect();
    assert_eq!(heads, ["coefficients", "known", "switch"], "{text}");
    assert!(text.contains("left out, since the record does not speak for them: q^2"), "{text}");
    assert!(text.contains(" 1.341 (known)"), "{text}");
    bench.write("model.toml", "[terms]\ninertia = 1.341\nqd = 0.51\nq = 5.23\n\"q^3\" = 1.9\n");
    let text = String::from_utf8(bench.run(&limits(&[])).stdout).unwrap();
    assert!(text.contains("numbers only: all of them count as sought") && !text.contains("(known)"), "{text}");
}

/// What a stuck sensor leaves is neither compared with the limit nor laid to the law.
#[test]
fn a_fault_of_a_sensor_is_not_laid_to_the_law() {
    let bench = bench("limits-fault");
    let record = std::fs::read_to_string(bench.0.join("record.csv")).unwrap();
    let mut lines: Vec<String> = record.lines().map(String::from).take(10_001).collect();
    let rest = |line: &str| line.split_once(',').unwrap().1.to_string();
    let last = rest(&lines[6000]);
    for line in &mut lines[6001..7001] {
        *line = format!("{},{last}", line.split_once(',').unwrap().0);
    }
    bench.write("stalled.csv", &(lines.join("\n") + "\n"));
    let text = String::from_utf8(bench.run(&["identify", "stalled.csv", "--model", "model.toml"]).stdout).unwrap();
    assert!(text.contains("sensor of q: stuck from 6.0"), "{text}");
    assert!(text.contains("a sensor's fault lies in this stage: no comparison"), "{text}");
    assert!(!text.contains("switchid diagnose") && !text.contains("the law leaves more"), "{text}");
}

/// Some wild readings leave the law as it is, and would make the limit that of a worse sensor.
#[test]
fn wild_readings_make_no_limit() {
    let bench = bench("limits-wild");
    let record = std::fs::read_to_string(bench.0.join("record.csv")).unwrap();
    let mut lines: Vec<String> = record.lines().map(String::from).take(10_001).collect();
    for (line, by) in lines[6001..6009].iter_mut().zip([3.0, -2.0].into_iter().cycle()) {
        let mut cells: Vec<String> = line.split(',').map(String::from).collect();
        cells[2] = (cells[2].parse::<f64>().unwrap() + by).to_string();
        *line = cells.join(",");
    }
    bench.write("wild.csv", &(lines.join("\n") + "\n"));
    let text = String::from_utf8(bench.run(&["identify", "wild.csv", "--model", "model.toml"]).stdout).unwrap();
    assert!(text.contains("sensor of qd: outlier from 6.0"), "{text}");
    assert!(text.contains("a sensor's fault lies in this stage") && !text.contains("times the limit"), "{text}");
}

#[test]
fn options_that_cannot_be_read_are_named() {
    let bench = bench("limits-options");
    for (extra, words) in [
        (["--change", "q^^3=1"], vec!["--change q^^3=1: exponent", "whole number"]),
        (["--change", "viscosity=1"], vec!["--change viscosity=1", "unknown term \"viscosity\""]),
        (["--change", "q^3"], vec!["no \"=\"", "--change TERM=VALUE"]),
        (["--change", "q^3=much"], vec!["must be a number"]),
        (["--change", "dead_zone_stiffness=2"], vec!["inner parameters", "give the model this term"]),
        (["--change", "hysteresis=2"], vec!["--change hysteresis=2: \"hysteresis\" depends on more"]),
        (["--change", "inertia=0"], vec!["error: --change inertia=0: ", "no positive inertia"]),
        (["--noise", "F=0.1"], vec!["--noise F=0.1", "no sensor \"F\""]),
        (["--noise", "q=0"], vec!["--noise q=0", "positive"]),
        (["--false-alarm-interval", "0"], vec!["--false-alarm-interval", "positive"]),
    ] {
        bench.refused(&limits(&extra), &words);
    }
    let twice = ["--change", "q=4", "--change", "linear_stiffness=5"];
    bench.refused(&limits(&twice), &["--change linear_stiffness=5", "q is given twice"]);
}

#[test]
fn records_and_models_without_limits_are_refused() {
    let bench = Bench::new("limits-records");
    bench.write("free.csv", &plain("t,q", 400));
    bench.write("memory.toml", &format!("{MODEL}hysteresis = \"fit\"\n"));
    bench.refused(&["limits", "free.csv", "--model", "memory.toml"], &["memory.toml", "hysteresis"]);
    bench.refused(&["limits", "free.csv", "--model", "model.toml", "--noise", "qd=1"], &["free.csv has no qd"]);
    bench.refused(&["limits", "absent.csv", "--model", "model.toml"], &["absent.csv"]);
}

#[test]
fn free_motion_has_limits_with_its_inertia_as_the_scale() {
    let bench = Bench::new("limits-free");
    let motion = |t: f64| (-0.1 * t).exp() * (2.0 * t).cos() + 1e-3 * (7919.0 * t).sin();
    let rows: String = (0..1500).map(|k| f64::from(k) * 0.01).map(|t| format!("{t},{}\n", motion(t))).collect();
    bench.write("free.csv", &format!("t,q\n{rows}"));
    bench.write("model.toml", "[terms]\ninertia = \"fit\"\nqd = \"fit\"\nq = \"fit\"\n");
    let report = bench.json(&["limits", "free.csv", "--model", "model.toml", "--json"]);
    assert!(report["coefficient_std"]["qdd"].is_null(), "{report:#}");
    assert!(report["coefficient_std"]["q"].as_f64().is_some_and(|std| std > 0.0 && std < 0.1), "{report:#}");
}

#[test]
fn identify_states_its_std_in_limits() {
    let bench = bench("limits-identify");
    let arguments = ["identify", "record.csv@0:15", "--model", "model.toml", "--hold", "zero"];
    let report = bench.json(&[&arguments[..], &["--json"]].concat());
    let stage = &report["stages"][0];
    for term in ["qdd", "qd", "q", "q^3"] {
        let ratio = number(&stage["limit"]["std_to_limit"], term);
        let least = number(&stage["limit"]["coefficient_std"], term);
        assert!((0.9..2.0).contains(&ratio), "{term}: {ratio}");
        assert!((number(&stage["std"], term) / least / ratio - 1.0).abs() < 1e-12);
    }
    assert_eq!(stage["limit"]["explained"], true);
    let text = String::from_utf8(bench.run(&arguments).stdout).unwrap();
    assert_eq!(text.matches(" times the limit)").count(), 4, "{text}");
}

/// A free decay whose stiffness doubles at 6 s.
const DECAY: &str = "terms = [\"qdd\", \"qd\", \"q\", \"q^3\"]\nduration = 6.2\ninitial = { q = 2.5, qd = 0.0 }\n\
                     noise = { q = 0.01, qd = 0.01 }\nexcitation = { kind = \"none\" }\n\
                     [[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.05, 4.0, 2.0]\n\
                     [[stage]]\nstart = 6.0\ncoefficients = [1.0, 0.05, 8.0, 2.0]\n";

#[test]
fn a_stage_of_which_only_the_inertia_is_known_has_no_limit() {
    let bench = Bench::new("limits-nothing-known");
    bench.write("decay.toml", DECAY);
    bench.json(&["simulate", "decay.toml", "-o", "decay.csv", "--json"]);
    for inertia in ["\"fit\"", "1.0"] {
        bench.write("model.toml", &MODEL.replacen("\"fit\"", inertia, 1));
        let arguments = ["identify", "decay.csv@0:6.1", "--model", "model.toml", "--hold", "zero", "--json"];
        let stages = &bench.json(&arguments)["stages"];
        assert!(stages[0]["limit"].is_object() && stages[1]["limit"].is_null(), "{stages:#}");
        assert!(stages[0]["law"].is_string() && stages[1]["law"].is_null(), "{stages:#}");
    }
}

#[test]
fn units_are_a_column_and_the_limit_another() {
    let bench = Bench::new("limits-columns");
    bench.write("decay.toml", DECAY);
    bench.json(&["simulate", "decay.toml", "-o", "decay.csv", "--json"]);
    let text = bench.run(&["identify", "decay.csv@0:4", "--model", "model.toml", "--hold", "zero"]).stdout;
    let text = String::from_utf8(text).unwrap();
    let column = |line: &str| line.find('(').map(|at| line[..at].chars().count());
    let limits: Vec<_> = text.lines().filter(|line| line.ends_with("times the limit)")).map(column).collect();
    assert!(limits.len() == 3 && limits.iter().all(|column| *column == limits[0]), "{text}");
    assert!(text.contains("  qdd          1\n"), "a number that is held has no std: {text}");
}

#[test]
fn a_record_without_noise_is_compared_with_no_limit() {
    let bench = Bench::new("limits-noiseless");
    bench.write("decay.toml", &DECAY.replace("q = 0.01, qd = 0.01", "q = 0.0, qd = 0.0"));
    bench.json(&["simulate", "decay.toml", "-o", "decay.csv", "--json"]);
    let output = bench.run(&["identify", "decay.csv@0:4", "--model", "model.toml", "--hold", "zero"]);
    let (text, message) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(text.contains("q̈") && !text.contains("limit"), "{text}");
    assert!(message.contains("hardly any sensor noise"), "{message}");
}

#[test]
fn a_change_that_no_record_shows_is_said_in_one_sentence() {
    let bench = bench("limits-unseen");
    let text = String::from_utf8(bench.run(&limits(&["--change", "q=5.2300001"])).stdout).unwrap();
    let switch = text.lines().find(|line| line.starts_with("switch")).unwrap();
    assert!(switch.ends_with("not seen within this record, wherever in its first half it comes"), "{switch}");
}
