//! A directory to run the binary in, and records to feed it.

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

/// A Duffing model of the default columns.
pub const MODEL: &str = "[terms]\ninertia = \"fit\"\nqd = \"fit\"\nq = \"fit\"\n\"q^3\" = \"fit\"\n";

/// A directory of its own for each test, removed at its end.
pub struct Bench(pub PathBuf);

impl Bench {
    pub fn new(name: &str) -> Bench {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("command-line-{name}"));
        // a run that was ended may have left it
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        let bench = Bench(path);
        bench.write("model.toml", MODEL);
        bench
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }

    pub fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_switchid")).args(arguments).current_dir(&self.0).output().unwrap()
    }

    pub fn identify(&self, arguments: &[&str]) -> Output {
        self.run(&[&["identify", "--model", "model.toml"], arguments].concat())
    }

    /// Exit status 2, nothing on stdout, and a message that holds every one of the words.
    pub fn refused(&self, arguments: &[&str], words: &[&str]) {
        let output = self.run(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(output.stdout.is_empty());
        for word in words {
            assert!(message.contains(word), "no `{word}` in: {message}");
        }
    }

    pub fn identify_refuses(&self, data: &str, words: &[&str]) {
        self.refused(&["identify", data, "--model", "model.toml"], words);
    }

    pub fn json(&self, arguments: &[&str]) -> Value {
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

/// A record of `count` samples under this header; `change` may alter the cells of a line (counted from 1, header
/// included).
pub fn csv(header: &str, count: usize, change: impl Fn(usize, &mut Vec<String>)) -> String {
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

pub fn plain(header: &str, count: usize) -> String {
    csv(header, count, |_, _| {})
}

/// Cells of a record of a Duffing oscillator under its header, 12 s at 1 kHz, one law throughout.
pub fn duffing(bench: &Bench) -> Vec<Vec<String>> {
    let plant = "terms = [\"qdd\", \"qd\", \"q\", \"q^3\"]\nduration = 12.0\nseed = 7\n\
                 initial = { q = 0.5, qd = 0.0 }\nnoise = { q = 0.01, qd = 0.01 }\nexcitation = { kind = \"sine\" }\n\
                 [[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.3, 4.0, 2.0]\namplitude = 2.0\nomega = 1.5\n";
    bench.write("plant.toml", plant);
    bench.json(&["simulate", "plant.toml", "-o", "plant.csv", "--force", "--json"]);
    let text = std::fs::read_to_string(bench.0.join("plant.csv")).unwrap();
    text.lines().map(|line| line.split(',').map(String::from).collect()).collect()
}

/// Writes such a record with cells that `change` alters by the number of their sample.
pub fn write_changed(bench: &Bench, name: &str, lines: &[Vec<String>], change: impl Fn(usize, &mut [String])) {
    let mut lines = lines.to_vec();
    lines[1..].iter_mut().enumerate().for_each(|(index, cells)| change(index, cells));
    bench.write(name, &lines.iter().map(|cells| cells.join(",") + "\n").collect::<String>());
}
