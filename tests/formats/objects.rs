//! MATLAB's tables, timetables and time series in MAT files of both formats: files made by tests/data/objects/make.py.

use super::{COUNT, expect, model, refuses};
use switchid::data::{Opened, open_recording};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/objects");
const FORMATS: [&str; 2] = ["v7", "v73"];

fn open(name: &str, columns: &str) -> Opened {
    open_recording(&format!("{FOLDER}/{name}.mat"), &model(columns)).unwrap()
}

#[test]
fn columns_of_timetables_tables_and_time_series_are_found_without_a_word() {
    for format in FORMATS {
        for name in ["durations", "table", "stamped", "uniform"] {
            let opened = open(&format!("{name}_{format}"), "");
            assert_eq!(opened.recording.count(), COUNT, "{name}_{format}");
            expect(&opened, 0, 1.0);
        }
    }
}

/// Dates are kept in milliseconds since 1970, so to a quarter of a microsecond where their small parts are not written.
#[test]
fn dates_are_times_from_the_first() {
    for format in FORMATS {
        let opened = open(&format!("dates_{format}"), "");
        let recording = &opened.recording;
        assert!((0..COUNT).all(|index| (recording.sample(index).t - super::t(index)).abs() < 3e-7));
        assert!((0..COUNT).all(|index| recording.sample(index).q == super::q(index)));
    }
}

#[test]
fn a_rate_in_place_of_times_and_units_are_taken() {
    for format in FORMATS {
        let opened = open(&format!("rate_{format}"), "");
        assert_eq!(opened.columns[1], "q = variable \"q [mm]\" in mm");
        // The file holds q in mm, written as 1000 q.
        let recording = &opened.recording;
        assert_eq!(recording.sample(COUNT - 1).t, super::t(COUNT - 1));
        assert!((0..COUNT).all(|index| (recording.sample(index).q - super::q(index)).abs() < 1e-12));
    }
}

#[test]
fn columns_of_objects_go_by_their_names() {
    for format in FORMATS {
        let file = format!("{FOLDER}/durations_{format}.mat");
        expect(&open(&format!("durations_{format}"), "t = \"Time\"\nq = \"q\"\nqd = \"qd\"\nF = \"F\""), 0, 1.0);
        refuses(&file, "q = \"way\"", &["no variable \"way\"", "\"Time\"", "\"qd\""]);
    }
}

/// Whatever bytes are changed, there is an answer or an error.
#[test]
fn damaged_objects_are_read_or_refused_never_a_crash() {
    for name in ["durations_v7", "uniform_v7", "dates_v73"] {
        let whole = std::fs::read(format!("{FOLDER}/{name}.mat")).unwrap();
        for at in (0..whole.len()).step_by(whole.len() / 200) {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x5a;
            let bench = super::Bench::of(&bytes);
            let _ = open_recording(&bench.path().display().to_string(), &model(""));
        }
        for length in (0..whole.len()).step_by(whole.len() / 50) {
            let bench = super::Bench::of(&whole[..length]);
            assert!(open_recording(&bench.path().display().to_string(), &model("")).is_err(), "{name} {length}");
        }
    }
}
