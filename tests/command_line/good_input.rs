//! What the commands print and write, and what they say about a record that is not quite in order.

use super::bench::{Bench, MODEL, csv, plain};
use serde_json::Value;

#[test]
fn units_of_a_header_are_converted() {
    let bench = Bench::new("convert");
    let scaled = |line: usize, cells: &mut Vec<String>| {
        let scale = |cell: &str, factor: f64| (cell.parse::<f64>().unwrap() * factor).to_string();
        *cells = vec![scale(&cells[0], 1e3), scale(&cells[1], 1e2), cells[2].clone(), cells[3].clone()];
        assert!(line > 1);
    };
    bench.write("model.toml", &format!("[columns]\nF = \"input_V\"\n{MODEL}"));
    bench.write("scaled.csv", &csv("t_ms,q [cm],qd (m/s),input_V", 500, scaled));
    let text = String::from_utf8(bench.identify(&["scaled.csv"]).stdout).unwrap();
    for line in ["from 0 s to 4.99 s", "\"t_ms\" in ms", "\"q [cm]\" in cm", "\"qd (m/s)\" in m/s", "\"input_V\" in V"]
    {
        assert!(text.contains(line), "no `{line}` in {text}");
    }
}

#[test]
fn converted_values_are_si() {
    let bench = Bench::new("si");
    let text = "t [ms],q [cm],qd (km/h),force_kN\n";
    let rows: String = (0..20).map(|n| format!("{},{},{},{}\n", 2 * n, n, 36 * n, n)).collect();
    bench.write("data.csv", &format!("{text}{rows}"));
    let model = format!("[columns]\nF = \"force\"\n{MODEL}");
    let model = switchid::law::Model::from_toml(&model).unwrap();
    let path = bench.0.join("data.csv").display().to_string();
    let sample = switchid::data::open_recording(&path, &model).unwrap().recording.sample(7);
    for (value, expected) in [(sample.t, 0.014), (sample.q, 0.07), (sample.qd, 70.0), (sample.excitation, 7000.0)] {
        assert!((value / expected - 1.0).abs() < 1e-15, "{value} for {expected}");
    }
}

#[test]
fn a_stage_is_valid_whatever_is_held_for_the_next() {
    let bench = Bench::new("held");
    bench.write("model.toml", MODEL);
    bench.json(&["simulate", "duffing-sine", "--noise", "0.001", "-o", "record.csv", "--json"]);
    let found = bench.json(&["identify", "record.csv", "--model", "model.toml", "--json"]);
    let valid: Vec<_> = found["stages"].as_array().unwrap().iter().map(|stage| &stage["valid"]).collect();
    assert_eq!(valid, [true; 5]);
}

#[test]
fn a_record_without_excitation_is_free_motion_and_says_so() {
    let bench = Bench::new("free");
    bench.write("zero.csv", &csv("t,q,qd,F", 500, |_, cells| cells[3] = "0".into()));
    bench.write("absent.csv", &plain("t,q,qd", 500));
    for file in ["zero.csv", "absent.csv"] {
        let output = bench.identify(&[file]);
        assert_eq!(output.status.code(), Some(0));
        let (text, message) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
        assert!(message.contains("no excitation") && message.contains(file), "{message}");
        assert!(!text.contains("= F"), "{text}");
    }
}

#[test]
fn a_gap_is_said_and_the_law_goes_on_after_it() {
    let bench = Bench::new("gap");
    let late = |line: usize, cells: &mut Vec<String>| {
        if line > 300 {
            cells[0] = (cells[0].parse::<f64>().unwrap() + 5.0).to_string();
        }
    };
    bench.write("gap.csv", &csv("t,q,qd,F", 500, late));
    let output = bench.identify(&["gap.csv", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("from 2.98 s to 7.99 s"), "{message}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["gaps"], serde_json::json!([[2.98, 7.99]]));
    // a gap is no switch: the record is one law's, over it too
    assert!(message.contains("laws go on after it"), "{message}");
    assert_eq!(report["stages"].as_array().unwrap().len(), 1, "{report}");
}

#[test]
fn many_gaps_are_one_warning() {
    let bench = Bench::new("gaps");
    let late = |line: usize, cells: &mut Vec<String>| {
        cells[0] = (cells[0].parse::<f64>().unwrap() + (line / 60) as f64).to_string();
    };
    bench.write("gaps.csv", &csv("t,q,qd,F", 500, late));
    let message = String::from_utf8(bench.identify(&["gaps.csv"]).stderr).unwrap();
    assert_eq!(message.matches("no samples from").count(), 2, "{message}");
    assert!(message.contains("gaps.csv: 8 gaps") && message.contains("laws go on"), "{message}");
}

#[test]
fn sections_are_read_and_bad_ones_refused() {
    let bench = Bench::new("sections");
    let bad_outside = |line: usize, cells: &mut Vec<String>| {
        if line == 3 {
            cells[1] = "abc".into()
        }
    };
    bench.write("data.csv", &csv("t,q,qd,F", 500, bad_outside));
    let report = bench.json(&["identify", "data.csv@1:3", "--model", "model.toml", "--json"]);
    assert_eq!(report["stages"][0]["start"], 1.0);
    assert_eq!(report["stages"].as_array().unwrap().last().unwrap()["end"], 2.99);
    bench.identify_refuses("data.csv@:2", &["line 3", "\"q\"", "abc"]);
    bench.identify_refuses("data.csv@3:1", &["data.csv@3:1", "no section"]);
    bench.identify_refuses("data.csv@a:1", &["\"a:1\"", "no section"]);
    bench.identify_refuses("data.csv@70:90", &["0 samples are too few", "runs from 0 s to 4.99 s"]);
}

#[test]
fn every_command_shows_an_example() {
    let bench = Bench::new("help");
    for command in ["add", "compare", "diagnose", "identify", "improve", "simulate"] {
        let help = String::from_utf8(bench.run(&[command, "--help"]).stdout).unwrap();
        assert!(help.contains(&format!("\n  switchid {command} ")), "{help}");
    }
}

#[test]
fn the_scenario_in_the_help_can_be_simulated() {
    let bench = Bench::new("example");
    let help = String::from_utf8(bench.run(&["simulate", "--help"]).stdout).unwrap();
    let example = help.split("A scenario file:\n").nth(1).unwrap();
    bench.write("plant.toml", example);
    let report = bench.json(&["simulate", "plant.toml", "-o", "record.csv", "--json"]);
    assert_eq!(report["samples"], 30_001);
    assert_eq!(report["truth"], "record.truth.json");
    let truth = std::fs::read_to_string(bench.0.join("record.truth.json")).unwrap();
    let truth: Value = serde_json::from_str(&truth).unwrap();
    assert_eq!(truth["hidden"]["dead_zone_stiffness"]["gap"], 0.1);
}

#[test]
fn simulate_writes_a_record_and_its_truth_which_identify_opens() {
    let bench = Bench::new("round-trip");
    let arguments = ["simulate", "van-der-pol-sine", "--seed", "4", "--noise", "0.01", "--json", "-o"];
    let report = bench.json(&[&arguments[..], &["record.csv"]].concat());
    bench.json(&[&arguments[..], &["again.csv"]].concat());
    let read = |name: &str| std::fs::read_to_string(bench.0.join(name)).unwrap();
    assert_eq!(read("record.csv"), read("again.csv"));
    assert!(read("record.csv").starts_with("t,q,qd,F\n0,"));
    let truth: Value = serde_json::from_str(&read("record.truth.json")).unwrap();
    let stages = truth["stages"].as_array().unwrap();
    assert_eq!(truth["switch_times"].as_array().unwrap().len() + 1, stages.len());
    assert_eq!(report["stages"], stages.len());
    assert!(stages.iter().all(|stage| stage["coefficients"]["q^2*qd"].as_f64().unwrap() > 0.0));
    assert_eq!(truth["noise"]["q"], 0.01);
    let found = bench.json(&["identify", "record.csv@0:5", "--model", "model.toml", "--json", "--hold", "zero"]);
    assert_eq!(found["hold"], "zero");
    for key in ["start", "end", "detected", "identified", "law", "coefficients", "std", "unidentifiable"] {
        assert!(found["stages"][0].get(key).is_some(), "no {key}");
    }
    assert!(found["noise"].is_object());
}

#[test]
fn the_trace_has_one_line_per_sample_and_every_output() {
    let bench = Bench::new("trace");
    bench.write("data.csv", &plain("t,q,qd,F", 300));
    let output = bench.identify(&["data.csv", "--trace", "trace.csv", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let trace = std::fs::read_to_string(bench.0.join("trace.csv")).unwrap();
    let lines: Vec<Vec<&str>> = trace.lines().map(|line| line.split(',').collect()).collect();
    assert!(trace.starts_with("t,coef.qdd,coef.qd,coef.q,coef.q_3,std.qdd,"), "{}", lines[0].join(","));
    for name in ["switch.count", "switch.time", "switch.detection_time", "status", "valid", "deviation", "prediction.q"]
    {
        assert!(lines[0].contains(&name), "no {name}");
    }
    assert_eq!(lines.len(), 301);
    let valid = lines[0].iter().position(|name| *name == "valid").unwrap();
    assert!(lines[1..].iter().all(|line| line.len() == lines[0].len() && ["0", "1"].contains(&line[valid])));
    assert_eq!((lines[1][0], lines[300][0]), ("0", "2.99"));
    bench.refused(
        &["identify", "data.csv", "--model", "model.toml", "--trace", "no/such/trace.csv"],
        &["no/such/trace.csv", "cannot be written"],
    );
}

#[test]
fn text_goes_to_stdout_and_names_what_is_not_known() {
    let bench = Bench::new("text");
    bench.write("data.csv", &plain("t,q,F", 20));
    bench.write("model.toml", &format!("hold = \"band_limited\"\n[columns]\nq = \"q\"\nF = \"F\"\n{MODEL}"));
    let output = bench.identify(&["data.csv"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(text.contains("between samples: band_limited (the model's)"), "{text}");
    assert!(text.contains("cannot be determined") && text.contains("not known: qdd, qd, q, q^3"), "{text}");
}

#[test]
fn std_stand_in_one_column_however_long_the_names() {
    let bench = Bench::new("names");
    let [friction, plant] = ["coulomb_friction = \"fit\"", "initial = { q = 0.5, qd = 0.0 }"];
    bench.write("model.toml", &format!("{MODEL}quadratic_damping = \"fit\"\n{friction}\n"));
    let terms = "terms = [\"qdd\", \"qd\", \"q\", \"q^3\", \"coulomb_friction\", \"quadratic_damping\"]";
    let stage = "[[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.3, 4.0, 2.0, 0.1, 0.2]\namplitude = 2.0\nomega = 1.5\n";
    let noise = "noise = { q = 1e-3, qd = 1e-3 }\nexcitation = { kind = \"sine\" }";
    bench.write("plant.toml", &format!("{terms}\nduration = 15.0\n{plant}\n{noise}\n{stage}"));
    assert!(bench.run(&["simulate", "plant.toml", "-o", "data.csv"]).status.success());
    let text = String::from_utf8(bench.identify(&["data.csv"]).stdout).unwrap();
    let lines = text.lines().filter(|line| line.starts_with("  ") && line.contains('±'));
    let columns: Vec<usize> = lines.map(|line| line.chars().take_while(|letter| *letter != '±').count()).collect();
    assert!(columns.len() == 6 && columns.iter().all(|column| *column == columns[0]), "{text}");
}

#[test]
fn other_delimiters_and_byte_order_marks_are_read() {
    let bench = Bench::new("delimiters");
    let text = plain("t,q,qd,F", 50);
    bench.write("semicolon.csv", &text.replace(',', ";"));
    bench.write("tab.csv", &text.replace(',', "\t"));
    bench.write("windows.csv", &format!("\u{feff}{}", text.replace('\n', "\r\n")));
    for file in ["semicolon.csv", "tab.csv", "windows.csv"] {
        assert_eq!(bench.identify(&[file]).status.code(), Some(0), "{file}");
    }
}

#[test]
fn the_hold_is_chosen_for_a_model_of_numbers_too() {
    let bench = Bench::new("numbers");
    bench.write("data.csv", &plain("t,q,qd,F", 500));
    bench.write("model.toml", "[terms]\ninertia = 1.0\nqd = 0.3\nq = 4.0\n");
    assert!(bench.run(&["compare", "data.csv", "--model", "model.toml"]).status.success());
}
