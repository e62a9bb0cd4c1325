//! Looking at a recording: `check`, `init`, `--columns`, and what every command says of it.

use super::bench::{Bench, duffing, write_changed};
use serde_json::Value;

/// A recording of 4000 samples of a motion with a little noise; `fault` changes a sample.
fn record(header: &str, fault: impl Fn(usize, &mut [f64; 4])) -> String {
    let mut text = format!("{header}\n");
    let mut seed = 1_u64;
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / (1_u64 << 31) as f64 - 0.5
    };
    for index in 0..4000 {
        let t = index as f64 * 0.005;
        let (slow, fast) = (2.0_f64, 5.3_f64);
        let q = (slow * t).sin() + 0.4 * (fast * t).sin() + 2e-3 * noise();
        let qd = slow * (slow * t).cos() + 0.4 * fast * (fast * t).cos() + 4e-3 * noise();
        let mut row = [t, q, qd, 3.0 * (slow * t + 0.3).sin() + (fast * t).cos()];
        fault(index, &mut row);
        text += &(row.map(|value| format!("{value:.7e}")).join(",") + "\n");
    }
    text
}

fn kinds(bench: &Bench, text: &str) -> Vec<String> {
    bench.write("looked.csv", text);
    let report = bench.json(&["check", "looked.csv", "--json"]);
    let kind = |finding: &Value| {
        assert!(finding["sentence"].as_str().unwrap().len() > 10);
        format!("{} {}", finding["channel"].as_str().unwrap(), finding["kind"].as_str().unwrap())
    };
    report["findings"].as_array().unwrap().iter().map(kind).collect()
}

#[test]
fn a_clean_recording_is_not_remarked_on() {
    let bench = Bench::new("clean");
    assert!(kinds(&bench, &record("t,q,qd,F", |_, _| {})).is_empty());
    let report = bench.json(&["check", "looked.csv", "--json"]);
    assert!((report["rate"].as_f64().unwrap() - 200.0).abs() < 1e-6);
    assert!(["zero", "linear", "band_limited"].contains(&report["hold"].as_str().unwrap()));
    bench.json(&["simulate", "duffing-sine", "--noise", "0.01", "-o", "duffing.csv", "--json"]);
    let report = bench.json(&["check", "duffing.csv", "--json"]);
    assert_eq!(report["findings"].as_array().unwrap().len(), 0, "{report}");
}

#[test]
fn each_fault_of_a_sensor_is_named() {
    let bench = Bench::new("faults");
    type Fault = fn(usize, &mut [f64; 4]);
    let cases: [(&str, Fault); 15] = [
        ("q wild", |index, row| {
            if index == 1000 {
                row[1] = 1e6
            }
        }),
        ("q wild", |index, row| {
            if index == 1000 {
                row[1] = 1e100
            }
        }),
        ("qd drift", |_, row| row[1] += 0.05 * row[0]),
        ("qd wild", |index, row| {
            if index % 500 == 77 {
                row[2] += 0.5
            }
        }),
        ("qd sign", |_, row| row[2] = -row[2]),
        ("qd scale", |_, row| row[1] *= 1000.0),
        ("qd late", |_, row| {
            let t = row[0] - 0.05;
            row[2] = 2.0 * (2.0 * t).cos() + 0.4 * 5.3 * (5.3 * t).cos() + 1e-3 * (row[2] * 1e4).sin();
        }),
        ("qd foreign", |_, row| row[2] = (9.1 * row[0]).sin() + 0.01 * (row[1] * 1e4).sin()),
        // an acceleration in the place of q: its slope is −ω² q̇, no turned q̇
        ("qd foreign", |_, row| {
            let t = row[0];
            row[1] = -4.0 * (2.0 * t).sin() - 0.4 * 5.3 * 5.3 * (5.3 * t).sin() + 1e-2 * (row[1] * 1e4).sin();
        }),
        ("q stuck", |index, row| {
            if (1000..1300).contains(&index) {
                row[1] = 0.125
            }
        }),
        ("F clipped", |_, row| row[3] = row[3].clamp(-2.0, 2.0)),
        ("q coarse", |_, row| row[1] = (row[1] * 20.0).round() / 20.0),
        ("q offset", |_, row| row[1] += 50.0),
        ("t lost", |index, row| {
            if index >= 2000 {
                row[0] += 0.015
            }
        }),
        ("t uneven", |index, row| row[0] += if index % 2 == 0 { 0.0008 } else { 0.0 }),
    ];
    for (expected, fault) in cases {
        let found = kinds(&bench, &record("t,q,qd,F", fault));
        assert!(found.iter().any(|kind| kind == expected), "{expected}: {found:?}");
        // what is wrong with one channel accuses no other one
        let foreign = found.iter().any(|kind| kind == "qd foreign" || kind == "qd sign") && !expected.starts_with("qd");
        assert!(!foreign, "{expected}: {found:?}");
    }
}

/// What the rate is to the motion, and q̇ to q, is told by the readings that count.
#[test]
fn a_few_bad_readings_accuse_neither_rate_nor_channels() {
    let bench = Bench::new("bad-few");
    for (channel, wild) in [(1, "q wild"), (2, "qd wild")] {
        for (length, at) in [1, 5, 20].into_iter().flat_map(|length| [0, 1, 5, 30, 2000, 3960].map(|at| (length, at))) {
            let found = kinds(
                &bench,
                &record("t,q,qd,F", |index, row| {
                    if (at..at + length).contains(&index) {
                        row[channel] = 1e9;
                    }
                }),
            );
            // at the very beginning no reading before tells what is one
            let expected = if at < 2 { vec![] } else { vec![wild.to_string()] };
            assert_eq!(found, expected, "{length} of {channel} at {at}");
        }
    }
}

#[test]
fn a_channel_that_is_read_less_often_does_not_make_the_motion_fast() {
    let bench = Bench::new("read-less");
    let text = record("t,q,qd,F", |_, _| {});
    let cells: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    for (column, every) in [(1, 2), (1, 5), (2, 2)] {
        let held = |(index, row): (usize, &Vec<&str>)| {
            let mut row = row.clone();
            row[column] = cells[1 + index / every * every][column];
            row.join(",") + "\n"
        };
        let text = "t,q,qd,F\n".to_string() + &cells[1..].iter().enumerate().map(held).collect::<String>();
        let found = kinds(&bench, &text);
        assert!(!found.iter().any(|kind| ["t slow", "qd foreign"].contains(&kind.as_str())), "{every}: {found:?}");
        let held: Vec<&String> = found.iter().filter(|kind| kind.ends_with(" held")).collect();
        assert_eq!(held, [if column == 1 { "q held" } else { "qd held" }], "{every}: {found:?}");
    }
    // one in 60 of its samples: a period of the faster motion has four
    let few: String = cells.iter().step_by(60).map(|row| row.join(",") + "\n").collect();
    let found = kinds(&bench, &few.replacen(&cells[0].join(","), "t,q,qd,F", 1));
    assert!(found.iter().any(|kind| kind == "t slow"), "{found:?}");
}

#[test]
fn identify_notes_a_bad_reading_as_nothing_but_that() {
    let bench = Bench::new("noted");
    let lines = duffing(&bench);
    for (name, channel, length) in [("qd", 2, 1), ("q", 1, 1), ("qd", 2, 5), ("q", 1, 5)] {
        write_changed(&bench, "bad.csv", &lines, |index, cells| {
            if (6000..6000 + length).contains(&index) {
                cells[channel] = "1e9".into();
            }
        });
        let said = String::from_utf8(bench.identify(&["bad.csv@3:9"]).stderr).unwrap();
        let notes: Vec<&str> = said.lines().filter(|line| line.contains("note:")).collect();
        assert!(notes.len() == 1 && notes[0].contains(&format!(": {name}: ")), "{length} of {name}: {said}");
        assert!(notes[0].contains("far off"), "{said}");
    }
}

#[test]
fn every_command_says_what_is_conspicuous() {
    let bench = Bench::new("said");
    bench.write("turned.csv", &record("t,q,qd,F", |_, row| row[2] = -row[2]));
    for command in ["identify", "compare", "limits", "diagnose"] {
        let output = bench.run(&[command, "turned.csv", "--model", "model.toml"]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains("note: turned.csv: qd: has the sign of"), "{command}: {said}");
    }
}

#[test]
fn columns_are_named_on_the_command_line() {
    let bench = Bench::new("named");
    let text = record("t,q,qd,F", |_, row| row[1] *= 1e3).replacen("t,q,qd,F", "Zeit;Weg [mm];v;Kraft", 1);
    bench.write("odd.csv", &text.replace(',', ";"));
    let named = ["--columns", "q=Weg", "--columns", "F=4", "--columns", "t=200Hz", "--columns", "qd=v"];
    let report = bench.json(&[&["check", "odd.csv", "--json"], &named[..]].concat());
    let columns: Vec<&str> = report["columns"].as_array().unwrap().iter().map(|line| line.as_str().unwrap()).collect();
    assert_eq!(columns[1], "q = column \"Weg [mm]\" in mm");
    assert!(columns[0].contains("200 Hz") && columns[3].contains("Kraft"), "{columns:?}");
    assert_eq!(report["findings"].as_array().unwrap().len(), 0, "{report}");
    bench.json(&[&["identify", "odd.csv", "--model", "model.toml", "--json"], &named[..]].concat());
    for (wrong, words) in [
        (vec!["q"], vec!["--columns q", "no \"=\""]),
        (vec!["x=1"], vec!["\"x\" is none of"]),
        (vec!["q=2", "--columns", "q=3"], vec!["given twice"]),
        (vec!["q="], vec!["no column behind"]),
        (vec!["q=Winkel"], vec!["\"Winkel\"", "the columns are", "--columns q="]),
        (vec!["q=9"], vec!["\"9\""]),
    ] {
        bench.refused(&[&["check", "odd.csv", "--columns"], &wrong[..]].concat(), &words);
    }
}

#[test]
fn init_writes_a_model_that_identify_takes() {
    let bench = Bench::new("init");
    let text = record("Time [ms],Position [mm],Velocity [mm/s],Force [N]", |_, row| {
        *row = [1e3 * row[0], 1e3 * row[1], 1e3 * row[2], row[3]];
    });
    bench.write("axis.csv", &text);
    let output = bench.run(&["init", "axis.csv", "-o", "axis.toml"]);
    assert!(output.status.success() && output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let model = std::fs::read_to_string(bench.0.join("axis.toml")).unwrap();
    for line in
        ["name = \"axis\"", "q = \"Position [mm]\" # guessed by its name; in mm", "hold = \"", "inertia = \"fit\""]
    {
        assert!(model.contains(line), "no `{line}` in:\n{model}");
    }
    let found = bench.json(&["identify", "axis.csv", "--model", "axis.toml", "--json"]);
    assert_eq!(found["stages"].as_array().unwrap().len(), 1);
    let text = String::from_utf8(bench.run(&["init", "axis.csv"]).stdout).unwrap();
    assert_eq!(text, model);
    bench.refused(&["init", "axis.csv", "-o", "axis.toml"], &["axis.toml: exists already", "--force"]);
}

#[test]
fn the_catalogue_is_listed() {
    let bench = Bench::new("catalogue");
    let report = bench.json(&["effects", "--json"]);
    let effects = report["effects"].as_array().unwrap();
    let stribeck = effects.iter().find(|effect| effect["id"] == "stribeck_friction").unwrap();
    assert_eq!(stribeck["inner"][0]["name"], "speed");
    assert_eq!((stribeck["sign"].as_str(), stribeck["unit"].as_str()), (Some("positive"), Some("N")));
    assert!(effects.len() >= 20 && effects.iter().all(|effect| !effect["equation"].as_str().unwrap().is_empty()));
    bench.refused(&["effects", "coulomb_frictoin"], &["did you mean coulomb_friction"]);
}
