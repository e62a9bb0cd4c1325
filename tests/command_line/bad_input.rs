//! Every bad input has an error that names the place, exit status 2, and nothing on stdout.

use super::bench::{Bench, MODEL, csv, plain};
use std::path::Path;

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
        let words = [&[file.as_str(), "delete the line"], words].concat();
        bench.refused(&["diagnose", &file, "--model", "model.toml"], &words);
        // readings that are missing are no fault of a stream
        if !["nan", "empty"].contains(&name) {
            bench.identify_refuses(&file, &words);
        }
    }
}

#[test]
fn what_is_no_file_says_where_it_was_looked_for() {
    let bench = Bench::new("nowhere");
    bench.identify_refuses("nowhere.csv", &["nowhere.csv: cannot be read", "from the folder in which"]);
    std::fs::create_dir_all(bench.0.join("folder.csv")).unwrap();
    bench.identify_refuses("folder.csv", &["folder.csv: cannot be read", "name a file in it"]);
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
    bench.write("untimed.csv", &plain("tick,q,qd,F", 50));
    bench.identify_refuses(
        "untimed.csv",
        &["untimed.csv: line 1", "\"t\"", "\"tick\", \"q\", \"qd\", \"F\"", "--columns t=", "[columns] t"],
    );
    bench.write("still.csv", &plain("t,a,b,F", 50));
    bench.identify_refuses("still.csv", &["no column \"q\" or \"qd\"", "\"a\"", "--columns q=", "[columns] q"]);
    bench.write("model.toml", &format!("[columns]\nq = \"position\"\n{MODEL}"));
    bench.write("unnamed.csv", &plain("t,q,qd,F", 50));
    bench.identify_refuses("unnamed.csv", &["unnamed.csv: line 1", "\"position\"", "the columns are \"t\""]);
    bench.write("model.toml", &format!("[columns]\nq = \"qd\"\n{MODEL}"));
    bench.write("shared.csv", &plain("t,q,qd,F", 50));
    bench.identify_refuses("shared.csv", &["shared.csv: line 1", "\"qd\" is taken for q and for qd", "[columns]"]);
    bench.write("model.toml", &format!("[columns]\nq = \"position\"\n{MODEL}"));
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
fn a_motion_that_stands_still_determines_nothing() {
    let bench = Bench::new("constant");
    bench.write("constant.csv", &csv("t,q,qd,F", 50, |_, cells| cells[1] = "0.25".into()));
    bench.identify_refuses("constant.csv", &["constant.csv", "\"q\" is 0.25 in every line"]);
    bench.write("still.csv", &csv("t,q,qd,F", 50, |_, cells| cells[2] = "0".into()));
    bench.identify_refuses("still.csv", &["\"qd\" is 0 in every line"]);
}

#[test]
fn models_are_refused_with_file_and_key() {
    let bench = Bench::new("models");
    bench.write("data.csv", &plain("t,q,qd,F", 50));
    let cases = [
        ("[terms]\ninertia = \"fit\"\nq4 = \"fit\"\n", vec!["\"q4\"", "unknown term", "cubic_stiffness"]),
        ("[terms]\ninertia = \"fit\"\nq = \"fitted\"\n", vec!["\"q\"", "fitted", "maybe"]),
        ("[terms]\nq = \"fit\"\n\"F*q\" = \"fit\"\n", vec!["\"F*q\"", "F = law(q, qd)", "inertia"]),
        ("[terms]\nq = \"fit\"\nposition_dependent_inertia = \"fit\"\n", vec!["no inertia"]),
        (
            "[terms]\nq = \"fit\"\nhysteresis = { coefficient = \"fit\", yield_displacement = 0.1, share = 0.6, exponent = 2.0 }\n",
            vec!["\"hysteresis\" cannot be identified sample by sample", "needs the past"],
        ),
        ("[terms]\ninertia = -1.0\nq = \"fit\"\n", vec!["[terms]: \"inertia\" = -1", "positive"]),
        ("[terms]\nqdd = 0\nq = \"fit\"\n", vec!["[terms]: \"qdd\" = 0", "positive"]),
        ("[terms]\ninertia = \"fit\"\nF = \"maybe\"\n", vec!["\"F\"", "F = F", "inertia as a number"]),
        ("[terms\n", vec!["line 1", "column"]),
        (
            "[terms]\ninertia = 1.0\nq = 4\n",
            vec!["nothing to identify: every coefficient is known;", "\"fit\" or \"maybe\""],
        ),
        ("[columns]\nx = \"a\"\n[terms]\ninertia = \"fit\"\n", vec!["line 2", "`x`"]),
    ];
    for (text, words) in cases {
        bench.write("model.toml", text);
        bench.identify_refuses("data.csv", &[&["model.toml"], words.as_slice()].concat());
    }
    bench.write("model.toml", "[terms]\ninertia = \"fit\"\nq = 4\n");
    bench.write("free.csv", &plain("t,q,qd", 50));
    bench.identify_refuses("free.csv", &["model.toml: [terms]: nothing to identify", "in free motion the inertia too"]);
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
    bench.refused(&["simulate", "duffing-sine", "--noise", "-1", "-o", "x.csv"], &["--noise -1", "0 or a positive"]);
    bench.refused(
        &["identify", "data.csv", "--model", "model.toml", "--false-alarm-interval", "-1"],
        &["--false-alarm-interval -1", "positive"],
    );
    bench.write("plant.toml", "terms = [\"qdd\"]\nduration = 1.0\n[[stage]]\nstart = 0.5\ncoefficients = [1.0]\n");
    bench.refused(&["simulate", "plant.toml", "-o", "x.csv"], &["plant.toml", "stage 1 starts at 0.5"]);
    assert!(!Path::new(&bench.0.join("x.csv")).exists());
}

#[test]
fn what_no_record_can_give_is_refused() {
    let bench = Bench::new("cannot");
    bench.write("data.csv", &plain("t,q,qd,F", 500));
    for window in ["6", "0.001"] {
        bench.refused(
            &["compare", "data.csv", "--model", "model.toml", "--window", window],
            &[&format!("--window {window}"), "four samples", "half of the record"],
        );
    }
    bench.refused(&["simulate", "duffing-sine", "--seed", "-1", "-o", "x.csv"], &["--seed", "-1"]);
    bench.write("shaken.csv", &plain("t,a [m/s^2],qd,F", 500));
    bench.refused(
        &["check", "shaken.csv", "--columns", "q=a"],
        &["line 1", "\"a [m/s^2]\" is an acceleration", "integrate"],
    );
    bench.write("twice.toml", &format!("{MODEL}q = 2.0\n"));
    bench.refused(&["identify", "data.csv", "--model", "twice.toml"], &["twice.toml", "line 6", "duplicate"]);
}

#[test]
fn single_huge_readings_are_named_and_survived() {
    let bench = Bench::new("huge");
    for (huge, words) in [
        ("1e6", ["far off its neighbours", "6.98 s"]),
        ("1e308", ["line 700", "no sensor"]),
        ("-1e308", ["line 700", "no sensor"]),
    ] {
        bench.write(
            "huge.csv",
            &csv("t,q,qd,F", 2000, |line, cells| {
                if line == 700 {
                    cells[1] = huge.into();
                }
            }),
        );
        for command in ["identify", "compare", "diagnose", "limits"] {
            let output = bench.run(&[command, "huge.csv", "--model", "model.toml"]);
            let said = String::from_utf8(output.stderr).unwrap();
            assert!(matches!(output.status.code(), Some(0 | 2)), "{command} {huge}: {said}");
            assert!(words.iter().all(|word| said.contains(word)), "{command} {huge}: {said}");
            assert!(!said.contains("is noise to"), "{command} {huge}: {said}");
        }
    }
}

#[test]
fn what_a_command_reads_is_not_overwritten() {
    let bench = Bench::new("inputs");
    let data = plain("t,q,qd,F", 500);
    bench.write("data.csv", &data);
    bench.write("laws.toml", "");
    let plant = "terms = [\"qdd\"]\nduration = 1.0\n[[stage]]\nstart = 0.0\ncoefficients = [1.0]\n";
    bench.write("plant.toml", plant);
    let identify = ["identify", "data.csv@0:4", "--model", "model.toml", "--known-laws", "laws.toml"];
    bench.write("model.svg", MODEL);
    let improve = ["improve", "data.csv", "--model", "model.svg", "-o", "better.toml", "--force", "--picture"];
    let cases: [(&[&str], &[&str], &str); 7] = [
        (&identify, &["--save-laws", "./data.csv"], "--save-laws ./data.csv would overwrite data.csv"),
        (&identify, &["--trace", "model.toml"], "--trace model.toml would overwrite model.toml"),
        (&identify, &["--save-laws", "laws.toml"], "--save-laws laws.toml would overwrite laws.toml"),
        (&["simulate", "plant.toml"], &["-o", "plant.toml"], "-o plant.toml would overwrite plant.toml"),
        (&["fmu", "--model", "model.toml"], &["-o", "model.toml"], "-o model.toml would overwrite model.toml"),
        (&improve, &["model.svg"], "--picture model.svg would overwrite model.svg"),
        (
            &["add", "coulomb_friction", "--model", "model.toml", "--data", "data.csv", "--force"],
            &["-o", "data.csv"],
            "-o data.csv would overwrite data.csv",
        ),
    ];
    for (command, target, message) in cases {
        bench.refused(&[command, target].concat(), &[message, "name another file"]);
    }
    for (file, text) in [("data.csv", data.as_str()), ("model.toml", MODEL), ("plant.toml", plant), ("laws.toml", "")] {
        assert_eq!(std::fs::read_to_string(bench.0.join(file)).unwrap(), text);
    }
    bench.refused(&[&identify[..4], &["--save-laws", "no/laws.toml"]].concat(), &["no/laws.toml", "no folder no"]);
}
