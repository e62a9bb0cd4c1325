//! Readings that a sensor did not give: `identify` goes on without them and says so, every other command refuses them.

use super::bench::{Bench, csv, duffing, write_changed as write};
use serde_json::Value;

/// First sample without a reading of q, and how many there are.
const HOLE: (usize, usize) = (6000, 200);

fn in_hole(index: usize) -> bool {
    (HOLE.0..HOLE.0 + HOLE.1).contains(&index)
}

fn hole(index: usize, cells: &mut [String]) {
    if in_hole(index) {
        cells[1].clear();
    }
}

#[test]
fn identify_says_which_readings_are_missing_and_goes_on() {
    let bench = Bench::new("missing");
    let lines = duffing(&bench);
    write(&bench, "hole.csv", &lines, hole);
    let output = bench.identify(&["hole.csv", "--json", "--trace", "trace.csv", "--picture", "hole.svg"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{message}");
    assert!(message.contains("q: has no value in 200 of 12001 samples, the first at 6 s"), "{message}");
    let text = String::from_utf8(output.stdout).unwrap();
    let found: Value = serde_json::from_str(&text).unwrap();
    let sensors = found["sensors"].as_array().unwrap();
    assert_eq!((sensors.len(), &sensors[0]["channel"], &sensors[0]["kind"]), (1, &"q".into(), &"missing".into()));
    let [start, end] = ["start", "end"].map(|key| sensors[0][key].as_f64().unwrap());
    assert!((6.0..6.003).contains(&start) && (end - 6.2).abs() < 1e-9, "{sensors:?}");
    let stages = found["stages"].as_array().unwrap();
    assert_eq!((stages.len(), &stages[0]["valid"], &stages[0]["detected"]), (1, &true.into(), &Value::Null));
    assert_eq!((&found["skipped"], &found["gaps"]), (&HOLE.1.into(), &Value::Array(Vec::new())));
    let trace = std::fs::read_to_string(bench.0.join("trace.csv")).unwrap();
    assert_eq!(trace.lines().count(), lines.len());
    let picture = std::fs::read_to_string(bench.0.join("hole.svg")).unwrap();
    assert!([text, trace, picture].iter().all(|text| !text.contains("NaN")));
}

#[test]
fn scattered_holes_leave_the_law_what_it_is() {
    let bench = Bench::new("scattered");
    let lines = duffing(&bench);
    write(&bench, "scattered.csv", &lines, |index, cells| match index {
        0..150 => cells[1..].iter_mut().for_each(String::clear),
        _ if index % 100 == 3 => cells[3] = "NaN".into(),
        _ if index % 100 == 50 => cells[2] = "nan".into(),
        _ => hole(index, cells),
    });
    let found = bench.json(&["identify", "scattered.csv", "--model", "model.toml", "--json"]);
    let stage = &found["stages"][0];
    assert_eq!((&stage["valid"], &stage["start"]), (&true.into(), &0.0.into()), "{found:#}");
    assert_eq!(found["stages"].as_array().unwrap().len(), 1);
    for (term, truth) in [("qdd", 1.0), ("qd", 0.3), ("q", 4.0), ("q^3", 2.0)] {
        let [value, std] = ["coefficients", "std"].map(|key| stage[key][term].as_f64().unwrap());
        assert!((value - truth).abs() < 4.0 * std && std < 0.01, "{term}: {value} ± {std}");
    }
    let text = String::from_utf8(bench.identify(&["scattered.csv"]).stdout).unwrap();
    assert!(text.contains("12001 samples from 0 s to 12 s, 583 of them without all readings"), "{text}");
}

#[test]
fn laws_that_give_f_and_the_published_procedure_bear_it_too() {
    let bench = Bench::new("missing-others");
    write(&bench, "hole.csv", &duffing(&bench), hole);
    bench.write("force.toml", "[terms]\nqd = \"fit\"\nq = \"fit\"\n");
    for arguments in [&["force.toml"][..], &["model.toml", "--method", "publication"]] {
        let found = bench.json(&[&["identify", "hole.csv", "--json", "--model"], arguments].concat());
        let sensors = found["sensors"].as_array().unwrap();
        assert_eq!((sensors.len(), &sensors[0]["channel"], &sensors[0]["end"]), (1, &"q".into(), &6.2.into()));
        assert_eq!(found["stages"].as_array().unwrap().last().unwrap()["end"], 12.0);
    }
}

#[test]
fn every_other_command_refuses_what_is_missing_and_says_what_mends_it() {
    let bench = Bench::new("missing-refused");
    bench.write(
        "hole.csv",
        &csv("t,q,qd,F", 50, |line, cells| {
            if line > 40 {
                cells[1].clear();
            }
        }),
    );
    let words = ["hole.csv: line 41", "\"q\" is empty", "fill in the value", "`switchid identify`", "10 more lines"];
    for command in ["diagnose", "compare", "check", "limits"] {
        bench.refused(&[command, "hole.csv", "--model", "model.toml"], &words);
    }
    bench.refused(&["report", "hole.csv", "--model", "model.toml", "-o", "page.html"], &words);
}

#[test]
fn what_is_missing_is_neither_a_time_nor_a_whole_column() {
    let bench = Bench::new("missing-limits");
    let write = |name: &str, change: fn(usize, &mut Vec<String>)| bench.write(name, &csv("t,q,qd,F", 50, change));
    write("time.csv", |line, cells| {
        if line == 7 {
            cells[0].clear();
        }
    });
    bench.identify_refuses("time.csv", &["line 7", "\"t\" is empty", "fill in the value or delete the line"]);
    write("column.csv", |_, cells| cells[2].clear());
    bench.identify_refuses("column.csv", &["column \"qd\" has no value at all", "map another column to qd"]);
    write("turns.csv", |line, cells| cells[1 + line % 2].clear());
    bench.identify_refuses("turns.csv", &["of 50 samples 0 have a reading of every channel", "resample"]);
    // what is no number, or one that no sensor reads, is a fault of the file
    for cell in ["abc", "inf", "1e200"] {
        bench.write(
            "wrong.csv",
            &csv("t,q,qd,F", 50, |line, cells| {
                if line == 9 {
                    cells[2] = cell.into();
                }
            }),
        );
        bench.identify_refuses("wrong.csv", &["line 9", "\"qd\"", cell, "correct it"]);
    }
}
