//! Habits of the command line: files, standard output, errors as JSON, pictures by their extension.

use super::bench::{Bench, csv, plain};
use serde_json::Value;

fn text(bench: &Bench, file: &str) -> String {
    std::fs::read_to_string(bench.0.join(file)).unwrap()
}

#[test]
fn nothing_that_exists_is_overwritten_unasked() {
    let bench = Bench::new("unasked");
    bench.write("data.csv", &plain("t,q,qd,F", 500));
    let files = ["x.csv", "x.truth.json", "x.svg", "x.toml", "x.fmu"];
    files.iter().for_each(|file| bench.write(file, "mine"));
    let data = ["data.csv", "--model", "model.toml"];
    let cases: [(&[&str], &[&str]); 9] = [
        (&["simulate", "duffing-sine"], &["-o", "x.csv"]),
        (&["simulate", "duffing-sine"], &["-o", "x.truth"]),
        (&["identify"], &["--trace", "x.csv"]),
        (&["identify"], &["--save-laws", "x.toml"]),
        (&["identify"], &["--picture", "x.svg"]),
        (&["compare"], &["--picture", "x.svg"]),
        (&["diagnose"], &["--picture", "x.svg"]),
        (&["limits"], &["--picture", "x.svg"]),
        (&["improve"], &["-o", "x.toml"]),
    ];
    for (command, option) in cases {
        let input = if command.len() > 1 { &[][..] } else { &data[..] };
        bench.refused(&[command, input, option].concat(), &["exists already", option[0], "--force"]);
    }
    bench.refused(&["fmu", "--model", "model.toml", "-o", "x.fmu"], &["exists already"]);
    bench.refused(&["check", "data.csv", "--picture", "x.svg"], &["exists already"]);
    assert!(files.iter().all(|file| text(&bench, file) == "mine"));
    let forced = bench.run(&["check", "data.csv", "--picture", "x.svg", "--force"]);
    assert!(forced.status.success() && text(&bench, "x.svg").starts_with("<svg"));
}

#[test]
fn no_two_outputs_go_to_one_file() {
    let bench = Bench::new("one");
    bench.write("data.csv", &plain("t,q,qd,F", 500));
    let identify = ["identify", "data.csv", "--model", "model.toml", "--trace", "out.csv"];
    bench.refused(
        &[&identify[..], &["--save-laws", "./out.csv"]].concat(),
        &["--save-laws ./out.csv is the file of --trace"],
    );
    let improve = ["improve", "data.csv", "--model", "model.toml", "-o", "x.svg", "--picture", "x.svg"];
    bench.refused(&improve, &["--picture x.svg is the file of -o"]);
    assert!(!bench.0.join("out.csv").exists());
}

#[test]
fn a_dash_is_standard_output() {
    let bench = Bench::new("dash");
    let record = String::from_utf8(bench.run(&["simulate", "duffing-sine", "-o", "-"]).stdout).unwrap();
    assert!(record.starts_with("t,q,qd,F\n") && record.lines().count() > 1000);
    bench.refused(&["simulate", "duffing-sine", "-o", "-", "--json"], &["standard output", "--json"]);
    assert!(!bench.0.join("-").exists());
}

#[test]
fn errors_are_json_where_json_is_asked_for() {
    let bench = Bench::new("json-errors");
    for (arguments, word) in [
        (&["identify", "none.csv", "--model", "model.toml", "--json"][..], "none.csv"),
        (&["identify", "none.csv", "--json"], "--model"),
    ] {
        let output = bench.run(arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(output.stdout.is_empty());
        let said = String::from_utf8(output.stderr).unwrap();
        let report: Value = serde_json::from_str(said.lines().last().unwrap()).unwrap();
        assert!(report["error"].as_str().unwrap().contains(word), "{report}");
        assert_eq!(report["exit_status"], 2);
    }
}

#[test]
fn the_extension_says_how_a_picture_is_drawn() {
    let bench = Bench::new("extensions");
    bench.write("data.csv", &plain("t,q,qd,F", 500));
    for wrong in ["x.jpg", "x", "-", "x.pdf"] {
        bench.refused(&["check", "data.csv", "--picture", wrong], &["OUT.svg, OUT.png or OUT.html"]);
    }
    for (file, head) in [("x.svg", &b"<svg"[..]), ("x.png", b"\x89PNG"), ("x.html", b"<!DOCTYPE html>")] {
        assert!(bench.run(&["check", "data.csv", "--picture", file]).status.success());
        let bytes = std::fs::read(bench.0.join(file)).unwrap();
        assert!(bytes.starts_with(head) && bytes.len() > 5000, "{file}");
    }
    let page = text(&bench, "x.html");
    assert!(page.contains("Plotly.newPlot") && !page.contains("<script src"));
}

#[test]
fn every_command_draws_what_it_found() {
    let bench = Bench::new("drawn");
    bench.json(&["simulate", "duffing-sine", "--noise", "0.01", "-o", "all.csv", "--json"]);
    let data = ["all.csv@0:8", "--model", "model.toml"];
    for command in ["identify", "compare", "diagnose", "limits"] {
        let file = format!("{command}.svg");
        let output = bench.run(&[&[command], &data[..], &["--picture", &file]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(text(&bench, &file).contains("</svg>"), "{command}");
    }
    let output = bench.run(&[&["report"], &data[..], &["-o", "page.html"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = text(&bench, "page.html");
    for word in ["Plotly.newPlot", "switchid report all.csv@0:8 --model model.toml", "how wrong:", "<sup>", "stage 1"] {
        assert!(page.contains(word), "no {word}");
    }
    assert!(page.len() < 8_000_000, "{}", page.len());
}

#[test]
fn completion_and_manual_know_every_command() {
    let bench = Bench::new("manual");
    for arguments in [&["completions", "bash"][..], &["completions", "zsh"], &["completions", "fish"], &["manual"]] {
        let output = bench.run(arguments);
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success() && text.contains("diagnose") && text.contains("picture"), "{arguments:?}");
    }
}

#[test]
fn faults_are_counted_and_told_once() {
    let bench = Bench::new("counted");
    for (file, cell) in [("block.csv", "NaN"), ("text.csv", "abc")] {
        let change = |line, cells: &mut Vec<String>| {
            if (100..300).contains(&line) {
                cells[1] = cell.into();
            }
        };
        bench.write(file, &csv("t,q,qd,F", 500, change));
        let words = ["line 100", cell, "199 more lines", "line 299"];
        bench.refused(&["compare", file, "--model", "model.toml"], &words);
    }
    bench.identify_refuses("text.csv", &["line 100", "abc", "199 more lines", "line 299"]);
}
