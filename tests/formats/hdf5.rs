//! MAT 7.3: a file made by tests/data/make_recording_v73.py.

use super::{Bench, COUNT, expect, model, q, refuses};
use switchid::data::open_recording;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/recording_v73.mat");
const COLUMNS: &str = "t = \"time\"\nq = \"position\"\nqd = \"speed\"";

#[test]
fn variables_are_columns() {
    let opened = open_recording(FILE, &model(COLUMNS)).unwrap();
    assert_eq!(opened.recording.count(), COUNT);
    expect(&opened, 0, 1e-3);
    assert_eq!(opened.columns[1], "q = variable \"position_mm\" in mm");
}

#[test]
fn sections_and_fields_are_found() {
    let section = open_recording(&format!("{FILE}@0.125:0.25"), &model(COLUMNS)).unwrap();
    assert_eq!(section.recording.count(), 16);
    expect(&section, 16, 1e-3);
    let field = open_recording(FILE, &model("t = \"time\"\nq = \"position\"")).unwrap();
    assert_eq!(field.recording.sample(8).q, q(8) * 1e-3);
    assert_eq!(field.recording.sample(8).qd, 2.0);
}

#[test]
fn what_is_no_signal_is_named() {
    for (variable, words) in
        [("note", "text"), ("grid", "3 × 4"), ("wave", "complex"), ("none", "empty"), ("absent", "the variables are")]
    {
        let columns = format!("t = \"time\"\nq = \"{variable}\"");
        refuses(FILE, &columns, &[&format!("\"{variable}\""), words]);
    }
    refuses(FILE, "t = \"time\"\nq = \"none\"", &["\"none\" is empty"]);
    refuses(FILE, "t = \"tick\"", &["no variable \"tick\"", "\"position_mm\"", "[columns] t"]);
    let guessed = open_recording(FILE, &model("")).unwrap().guessed.unwrap();
    assert!(guessed.contains("q = \"position_mm\" (by its name)"), "{guessed}");
}

#[test]
fn a_file_that_breaks_off_is_refused() {
    let whole = std::fs::read(FILE).unwrap();
    for length in [520, 700, whole.len() / 2] {
        Bench::of(&whole[..length]).refuses(COLUMNS, &["damaged", "again"]);
    }
}
