//! The binary as a user meets it: bad input is refused with its place, good input gives one JSON document.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const MODEL: &str = "[terms]\ninertia = \"fit\"\nqd = \"fit\"\nq = \"fit\"\n\"q^3\" = \"fit\"\n";

/// A directory of its own for each test, removed at its end.
struct Bench(PathBuf);

impl Bench {
    fn new(name: &str) -> Bench {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("command-line-{name}"));
        std::fs::create_dir_all(&path).unwrap();
        let bench = Bench(path);
        bench.write("model.toml", MODEL);
        bench
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_switchid")).args(arguments).current_dir(&self.0).output().unwrap()
    }

    fn identify(&self, arguments: &[&str]) -> Output {
        self.run(&[&["identify", "--model", "model.toml"], arguments].concat())
    }

    /// Exit status 2, nothing on stdout, and a message that holds every one of the words.
    fn refused(&self, arguments: &[&str], words: &[&str]) {
        let output = self.run(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(output.stdout.is_empty());
        for word in words {
            assert!(message.contains(word), "no `{word}` in: {message}");
        }
    }

    fn identify_refuses(&self, data: &str, words: &[&str]) {
        self.refused(&["identify", data, "--model", "model.toml"], words);
    }

    fn json(&self, arguments: &[&str]) -> Value {
        let output = self.run(arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A record of `count` samples under this header; `change` may alter the cells of a line (counted from 1, header included).
fn csv(header: &str, count: usize, change: impl Fn(usize, &mut Vec<String>)) -> String {
    let columns = header.split(',').count();
    let mut text = format!("{header}\n");
    for index in 0..count {
        let t = index as f64 * 0.01;
        let values = [t, (2.0 * t).sin(), 2.0 * (2.0 * t).cos(), (1.3 * t).sin()];
        let mut cells: Vec<String> = values[..columns].iter().map(f64::to_string).collect();
        change(index + 2, &mut cells);
        text += &(cells.join(",") + "\n");
    }
    text
}

fn plain(header: &str, count: usize) -> String {
    csv(header, count, |_, _| {})
}

#[test]
fn bad_cells_are_named_by_line_and_column() {
    let bench = Bench::new("cells");
    let cases: [(&str, &str, &[&str]); 5] = [
        ("text", "abc", &["line 7", "\"qd\"", "abc"]),
        ("nan", "NaN", &["line 7", "\"qd\"", "NaN"]),
        ("infinite", "1e999", &["line 7", "\"qd\"", "1e999"]),
        ("empty", "", &["line 7", "\"qd\"", "empty"]),
        ("comma", "0;5", &["line 7", "\"qd\"", "0;5"]),
    ];
    for (name, cell, words) in cases {
        let file = format!("{name}.csv");
        let change = |line, cells: &mut Vec<String>| {
            if line == 7 {
                cells[2] = cell.into();
            }
        };
        bench.write(&file, &csv("t,q,qd,F", 50, change));
        bench.identify_refuses(&file, &[&[file.as_str(), "delete the line"], words].concat());
    }
}

#[test]
fn ragged_rows_and_bad_times_are_named_by_line() {
    let bench = Bench::new("rows");
    bench.write(
        "short.csv",
        &csv("t,q,qd,F", 50, |line, cells| {
            if line == 9 {
                cells.truncate(3)
            }
        }),
    );
    bench.identify_refuses("short.csv", &["short.csv: line 9", "3 cells under 4 columns"]);
    bench.write(
        "back.csv",
        &csv("t,q,qd,F", 50, |line, cells| {
            if line == 12 {
                cells[0] = "0.05".into()
            }
        }),
    );
    bench.identify_refuses("back.csv", &["back.csv: line 12", "does not increase", "0.05 s", "0.09 s on line 11"]);
    bench.write(
        "twice.csv",
        &csv("t,q,qd,F", 50, |line, cells| {
            if line == 12 {
                cells[0] = "0.09".into()
            }
        }),
    );
    bench.identify_refuses("twice.csv", &["line 12", "does not increase"]);
    let blank = plain("t,q,qd,F", 50).replacen('\n', "\n\n\n", 1).replace("0.4,", "0.4x,");
    bench.write("blank.csv", &blank);
    bench.identify_refuses("blank.csv", &["line 44", "0.4x"]);
}

#[test]
fn files_with_nothing_in_them_are_refused() {
    let bench = Bench::new("nothing");
    bench.identify_refuses("absent.csv", &["absent.csv", "cannot be read"]);
    bench.write("empty.csv", " \n");
    bench.identify_refuses("empty.csv", &["empty.csv", "empty", "header"]);
    bench.write("header.csv", "t,q,qd,F\n");
    bench.identify_refuses("header.csv", &["header.csv", "0 samples are too few"]);
    bench.write("two.csv", &plain("t,q,qd,F", 2));
    bench.identify_refuses("two.csv", &["two.csv", "2 samples are too few"]);
    std::fs::write(bench.0.join("binary.csv"), [0xff, 0xfe, 0x00, 0x80]).unwrap();
    bench.identify_refuses("binary.csv", &["binary.csv", "cannot be read"]);
}

#[test]
fn missing_columns_are_named_with_those_there_are() {
    let bench = Bench::new("columns");
    bench.write("untimed.csv", &plain("time,q,qd,F", 50));
    bench.identify_refuses(
        "untimed.csv",
        &["untimed.csv: line 1", "\"t\"", "\"time\", \"q\", \"qd\", \"F\"", "[columns] t"],
    );
    bench.write("still.csv", &plain("t,x,v,F", 50));
    bench.identify_refuses("still.csv", &["no column \"q\" or \"qd\"", "\"x\"", "[columns] q"]);
    bench.write("model.toml", &format!("[columns]\nq = \"position\"\n{MODEL}"));
    bench.write("unnamed.csv", &plain("t,q,qd,F", 50));
    bench.identify_refuses("unnamed.csv", &["unnamed.csv: line 1", "\"position\"", "the columns are \"t\""]);
    bench.write("twice.csv", &plain("t,position,qd,position", 50));
    bench.identify_refuses("twice.csv", &["several columns", "\"position\", \"position\""]);
    bench.write("model.toml", &format!("{MODEL}\"F*q\" = \"fit\"\n"));
    bench.write("free.csv", &plain("t,q,qd", 50));
    bench.identify_refuses("free.csv", &["F*q", "needs the excitation"]);
}

#[test]
fn units_that_contradict_or_are_unknown_are_refused() {
    let bench = Bench::new("units");
    let cases: [(&str, &[&str]); 7] = [
        ("t,q [furlong],qd,F", &["\"q [furlong]\"", "unknown unit \"furlong\"", "mm"]),
        ("t,q [N],qd,F", &["\"q [N]\"", "N is a unit of force", "displacement"]),
        ("t,q,qd [mm],F", &["\"qd [mm]\"", "mm is a unit of length", "velocity"]),
        ("t,q,qd,F (m/s)", &["\"F (m/s)\"", "m/s is a unit of speed", "excitation"]),
        ("t [m],q,qd,F", &["\"t [m]\"", "m is a unit of length", "time"]),
        ("t,q,qd,F_s", &["\"F_s\"", "s is a unit of time"]),
        ("t,q [rad],qd [m/s],F", &["\"qd [m/s]\"", "speed", "angle", "not the rate"]),
    ];
    for (header, words) in cases {
        bench.write("units.csv", &plain(header, 50));
        bench.identify_refuses("units.csv", &[&["units.csv: line 1"], words].concat());
    }
}

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
fn a_motion_that_stands_still_determines_nothing() {
    let bench = Bench::new("constant");
    bench.write("constant.csv", &csv("t,q,qd,F", 50, |_, cells| cells[1] = "0.25".into()));
    bench.identify_refuses("constant.csv", &["constant.csv", "\"q\" is 0.25 in every line"]);
    bench.write("still.csv", &csv("t,q,qd,F", 50, |_, cells| cells[2] = "0".into()));
    bench.identify_refuses("still.csv", &["\"qd\" is 0 in every line"]);
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
fn a_gap_is_said_and_nothing_crosses_it() {
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
    let stages = report["stages"].as_array().unwrap();
    assert!(stages.iter().any(|stage| stage["end"] == 2.98));
    assert!(stages.iter().any(|stage| stage["start"] == 7.99 && stage["detected"].is_null()));
}

#[test]
fn sections_are_read_and_bad_ones_refused() {
    let bench = Bench::new("sections");
    let bad_outside = |line: usize, cells: &mut Vec<String>| {
        if line == 3 {
            cells[1] = "NaN".into()
        }
    };
    bench.write("data.csv", &csv("t,q,qd,F", 500, bad_outside));
    let report = bench.json(&["identify", "data.csv@1:3", "--model", "model.toml", "--json"]);
    assert_eq!(report["stages"][0]["start"], 1.0);
    assert_eq!(report["stages"].as_array().unwrap().last().unwrap()["end"], 2.99);
    bench.identify_refuses("data.csv@:2", &["line 3", "\"q\"", "NaN"]);
    bench.identify_refuses("data.csv@3:1", &["data.csv@3:1", "no section"]);
    bench.identify_refuses("data.csv@a:1", &["\"a:1\"", "no section"]);
    bench.identify_refuses("data.csv@70:90", &["0 samples are too few", "runs from 0 s to 4.99 s"]);
}

#[test]
fn models_are_refused_with_file_and_key() {
    let bench = Bench::new("models");
    bench.write("data.csv", &plain("t,q,qd,F", 50));
    let cases = [
        ("[terms]\ninertia = \"fit\"\nq4 = \"fit\"\n", vec!["\"q4\"", "unknown term", "cubic_stiffness"]),
        ("[terms]\ninertia = \"fit\"\nq = \"fitted\"\n", vec!["\"q\"", "fitted", "maybe"]),
        ("[terms]\nq = \"fit\"\n", vec!["no inertia"]),
        ("[terms\n", vec!["line 1", "column"]),
        ("[columns]\nx = \"a\"\n[terms]\ninertia = \"fit\"\n", vec!["line 2", "`x`"]),
    ];
    for (text, words) in cases {
        bench.write("model.toml", text);
        bench.identify_refuses("data.csv", &[&["model.toml"], words.as_slice()].concat());
    }
    bench.refused(&["identify", "data.csv", "--model", "absent.toml"], &["absent.toml", "cannot be read"]);
}

#[test]
fn bad_usage_is_refused() {
    let bench = Bench::new("usage");
    bench.write("data.csv", &plain("t,q,qd,F", 500));
    bench.refused(&["identify", "data.csv"], &["--model"]);
    bench.refused(&["identify", "data.csv", "--model", "model.toml", "--hold", "cubic"], &["--hold", "band_limited"]);
    bench.refused(
        &["identify", "data.csv", "--model", "model.toml", "--false-alarm-interval", "0"],
        &["--false-alarm-interval 0", "positive"],
    );
    bench.refused(&["simulate", "nothing", "-o", "x.csv"], &["nothing", "duffing-sine"]);
    bench.refused(&["simulate", "duffing-sine", "-o", "no/such/x.csv"], &["no/such/x.csv", "cannot be written"]);
    bench.refused(&["simulate", "duffing-sine", "--noise=-1", "-o", "x.csv"], &["--noise -1"]);
    bench.write("plant.toml", "terms = [\"qdd\"]\nduration = 1.0\n[[stage]]\nstart = 0.5\ncoefficients = [1.0]\n");
    bench.refused(&["simulate", "plant.toml", "-o", "x.csv"], &["plant.toml", "stage 1 starts at 0.5"]);
    assert!(!Path::new(&bench.0.join("x.csv")).exists());
}

#[test]
fn every_command_shows_an_example() {
    let bench = Bench::new("help");
    for command in ["identify", "simulate"] {
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
