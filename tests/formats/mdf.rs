//! MDF 4: files made by tests/data/mdf/make.py.

use super::{COUNT, expect, model, refuses};
use switchid::data::{Opened, open_recording};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/mdf");

fn open(name: &str, columns: &str) -> Opened {
    open_recording(&format!("{FOLDER}/{name}.mf4"), &model(columns)).unwrap()
}

#[test]
fn channels_are_columns_with_units_and_conversions() {
    let opened = open("one_group", "");
    assert_eq!(opened.recording.count(), COUNT);
    expect(&opened, 0, 1e-3);
    assert_eq!(opened.columns[1], "q = channel \"q [mm]\" in mm");
}

#[test]
fn groups_on_one_clock_are_one_table() {
    expect(&open("a_group_each", ""), 0, 1.0);
}

#[test]
fn groups_on_clocks_of_their_own_are_told_apart() {
    let file = format!("{FOLDER}/two_clocks.mf4");
    refuses(&file, "", &["\"axis.time [s]\"", "\"slow.time [s]\"", "--columns t="]);
    let columns = "t = \"axis.time\"\nq = \"axis.q\"\nqd = \"axis.qd\"\nF = \"axis.F\"";
    expect(&open("two_clocks", columns), 0, 1.0);
    let mixed = "t = \"axis.time\"\nq = \"axis.q\"\nF = \"slow.temperature\"";
    refuses(&file, mixed, &["\"slow.temperature\"", "6 ", "60"]);
}

/// Whatever bytes are changed, there is an answer or an error.
#[test]
fn damaged_files_are_read_or_refused_never_a_crash() {
    let whole = std::fs::read(format!("{FOLDER}/one_group.mf4")).unwrap();
    for at in (8..whole.len()).step_by(7) {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x5a;
        let bench = super::Bench::of(&bytes);
        let _ = open_recording(&bench.path().display().to_string(), &model(""));
    }
    for length in [64, 200, whole.len() / 2] {
        super::Bench::of(&whole[..length]).refuses("", &["MDF 4", "damaged"]);
    }
}
