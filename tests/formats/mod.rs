//! Recordings in MAT and Parquet files mean the same as in CSV, and errors name the variable and the sample.

mod hdf5;
mod mat5;
mod mdf;
mod objects;
mod parquet;

use std::path::{Path, PathBuf};
use switchid::data::{Opened, open_recording, open_stream};
use switchid::law::Model;

/// How many samples the files of these tests hold.
const COUNT: usize = 60;

/// The signals of these tests: exact in every format.
fn t(index: usize) -> f64 {
    index as f64 / 128.0
}

fn q(index: usize) -> f64 {
    (index * index % 31) as f64
}

fn qd(index: usize) -> f64 {
    (index % 3) as f64 * 0.5
}

fn excitation(index: usize) -> f64 {
    (index % 5) as f64 - 2.0
}

fn signal(of: fn(usize) -> f64) -> Vec<f64> {
    (0..COUNT).map(of).collect()
}

fn model(columns: &str) -> Model {
    let terms = "[terms]\ninertia = \"fit\"\n\"F*q\" = \"fit\"\n";
    Model::from_toml(&format!("[columns]\n{columns}\n{terms}")).unwrap()
}

/// A folder with one file in it.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn of(content: &[u8]) -> Bench {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("run.bin"), content).unwrap();
        Bench { folder }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("run.bin")
    }

    fn open(&self, columns: &str) -> Opened {
        open_recording(&self.path().display().to_string(), &model(columns)).unwrap()
    }

    /// As a stream has it: readings may be missing.
    fn stream(&self) -> Opened {
        open_stream(&self.path().display().to_string(), &model("")).unwrap()
    }

    fn refuses(&self, columns: &str, words: &[&str]) {
        refuses(&self.path().display().to_string(), columns, words);
    }
}

fn refuses(data: &str, columns: &str, words: &[&str]) {
    let error = open_recording(data, &model(columns)).expect_err(&format!("{words:?}")).to_string();
    let name = Path::new(data).file_name().unwrap().to_str().unwrap();
    let name = name.split('@').next().unwrap();
    for word in [&[name], words].concat() {
        assert!(error.contains(word), "\"{word}\" is not in: {error}");
    }
}

/// Every sample is what the signals say; q with its factor to SI.
fn expect(opened: &Opened, first: usize, q_factor: f64) {
    let recording = &opened.recording;
    for index in 0..recording.count() {
        let (sample, at) = (recording.sample(index), first + index);
        assert_eq!(sample.t, t(at));
        assert_eq!(sample.q, q(at) * q_factor);
        assert_eq!(sample.qd, qd(at));
        assert_eq!(sample.excitation, excitation(at));
    }
}

#[test]
fn foreign_files_are_refused() {
    Bench::of(b"PK\x03\x04\xff\xfe").refuses("", &["cannot be read", "nor Parquet", "-v7"]);
    Bench::of(b"PAR1 and no more").refuses("", &["Parquet", "damaged"]);
    Bench::of(b"MATLAB 5.0 MAT-file").refuses("", &["MAT (version 5)", "breaks off"]);
    Bench::of(b"MATLAB 7.3 MAT-file").refuses("", &["MAT 7.3", "damaged"]);
}
