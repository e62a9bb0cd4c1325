//! MAT of version 5: files written here, after MathWorks' "MAT-File Format".

use super::{Bench, COUNT, excitation, expect, q, qd, signal, t};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

const DOUBLE: u32 = 9;

/// An element padded to 8 bytes, in the form of the format's small elements where it fits.
fn element(kind: u32, content: &[u8]) -> Vec<u8> {
    let size = content.len() as u32;
    let mut bytes = if (1..=4).contains(&size) {
        (kind | size << 16).to_le_bytes().to_vec()
    } else {
        [kind.to_le_bytes(), size.to_le_bytes()].concat()
    };
    bytes.extend(content);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn words(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn matrix(class: u32, shape: [u32; 2], name: &str, rest: &[Vec<u8>]) -> Vec<u8> {
    let head = [element(6, &words(&[class, 0])), element(5, &words(&shape)), element(1, name.as_bytes())];
    element(14, &[&head[..], rest].concat().concat())
}

fn numbers(name: &str, shape: [u32; 2], values: &[f64]) -> Vec<u8> {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    matrix(6, shape, name, &[element(DOUBLE, &bytes)])
}

fn vector(name: &str, of: fn(usize) -> f64) -> Vec<u8> {
    numbers(name, [1, COUNT as u32], &signal(of))
}

/// Whole numbers in doubles are stored in the shortest type that holds them.
fn short(name: &str, of: fn(usize) -> f64) -> Vec<u8> {
    let bytes: Vec<u8> = signal(of).iter().map(|value| (*value as i8).to_le_bytes()[0]).collect();
    matrix(6, [COUNT as u32, 1], name, &[element(1, &bytes)])
}

fn file(variables: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file".to_vec();
    bytes.resize(124, b' ');
    bytes.extend(b"\x00\x01IM");
    bytes.extend(variables.concat());
    bytes
}

fn compressed(variable: &[u8]) -> Vec<u8> {
    let mut packer = ZlibEncoder::new(Vec::new(), Compression::default());
    packer.write_all(variable).unwrap();
    let packed = packer.finish().unwrap();
    [words(&[15, packed.len() as u32]), packed].concat()
}

fn structure(name: &str, fields: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let names: Vec<u8> = fields
        .iter()
        .flat_map(|(name, _)| {
            let mut name = name.as_bytes().to_vec();
            name.resize(16, 0);
            name
        })
        .collect();
    let mut rest = vec![element(5, &words(&[16])), element(1, &names)];
    rest.extend(fields.iter().map(|(_, field)| field.clone()));
    matrix(2, [1, 1], name, &rest)
}

fn plain() -> Vec<Vec<u8>> {
    vec![vector("t", t), short("q_mm", q), vector("qd", qd), short("F", excitation)]
}

#[test]
fn vectors_are_columns_packed_or_not() {
    let packed: Vec<Vec<u8>> = plain().iter().map(|variable| compressed(variable)).collect();
    for variables in [plain(), packed] {
        let opened = Bench::of(&file(&variables)).open("");
        assert_eq!(opened.recording.count(), COUNT);
        expect(&opened, 0, 1e-3);
        assert_eq!(opened.columns[1], "q = variable \"q_mm\" in mm");
    }
}

#[test]
fn fields_of_a_structure_are_columns() {
    let fields = [("t", vector("", t)), ("q", short("", q)), ("qd", vector("", qd)), ("F", short("", excitation))];
    expect(&Bench::of(&file(&[structure("run", &fields)])).open(""), 0, 1.0);
    let two = [structure("run", &fields), structure("other", &fields)];
    let columns = "t = \"run.t\"\nq = \"other.q\"\nqd = \"run.qd\"\nF = \"run.F\"";
    expect(&Bench::of(&file(&two)).open(columns), 0, 1.0);
}

#[test]
fn a_sample_time_or_rate_serves_in_place_of_times() {
    for (name, value) in [("fs", 128.0), ("dt", 1.0 / 128.0), ("Ts", 1.0 / 128.0), ("dt_ms", 1e3 / 128.0)] {
        let mut variables = plain();
        variables[0] = numbers(name, [1, 1], &[value]);
        let opened = Bench::of(&file(&variables)).open("");
        expect(&opened, 0, 1e-3);
        let said = if name == "fs" { "(samples per second)" } else { "(distance of two samples)" };
        assert!(opened.columns[0].contains(said), "{}", opened.columns[0]);
    }
    for (values, found) in [(&[0.0][..], "is 0"), (&[f64::NAN], "is NaN"), (&[1.0, 2.0], "is 2 numbers")] {
        let mut variables = plain();
        variables[0] = numbers("fs", [1, values.len() as u32], values);
        Bench::of(&file(&variables)).refuses("", &["\"fs\"", found, "one positive number"]);
    }
    Bench::of(&file(&plain()[1..])).refuses("", &["no variable \"t\"", "dt or Ts", "fs", "\"q_mm\""]);
}

#[test]
fn what_is_no_signal_is_named() {
    let part: Vec<u8> = signal(q).iter().flat_map(|value| value.to_le_bytes()).collect();
    let complex = matrix(0x0806, [1, COUNT as u32], "q", &[element(DOUBLE, &part), element(DOUBLE, &part)]);
    let text = matrix(4, [1, 3], "q", &[element(4, b"r\0u\0n\0")]);
    for (variable, words) in [
        (complex, "complex"),
        (text, "text"),
        (matrix(1, [1, 1], "q", &[numbers("", [1, 1], &[0.0])]), "a cell array"),
        (matrix(2, [1, 2], "q", &[]), "a structure"),
        (numbers("q", [3, 20], &signal(q)), "a 3 × 20 array"),
        (numbers("q", [0, 0], &[]), "empty"),
    ] {
        let mut variables = plain();
        variables[1] = variable;
        Bench::of(&file(&variables)).refuses("", &["variable \"q\"", words, "vector of real numbers"]);
    }
}

#[test]
fn bad_samples_are_named() {
    let with = |place: usize, values: Vec<f64>| {
        let mut variables = plain();
        let name = ["t", "q", "qd", "F"][place];
        variables[place] = numbers(name, [1, values.len() as u32], &values);
        Bench::of(&file(&variables))
    };
    let changed = |of: fn(usize) -> f64, value: f64| {
        let mut values = signal(of);
        values[6] = value;
        values
    };
    let missing = with(2, changed(qd, f64::NAN)).stream().recording;
    assert_eq!((missing.count(), missing.incomplete()[0].t), (COUNT - 1, t(6)));
    with(2, changed(qd, f64::NAN)).refuses("", &["sample 7", "\"qd\" is NaN", "delete the sample"]);
    with(3, changed(excitation, f64::INFINITY)).refuses("", &["sample 7", "\"F\" is inf"]);
    with(0, changed(t, t(5))).refuses("", &["sample 7", "does not increase", "sample 6"]);
    with(2, signal(qd)[1..].to_vec()).refuses("", &["\"qd\" has 59 values", "\"q_mm\" has 60"]);
    with(1, vec![0.25; COUNT]).refuses("", &["variable \"q\" is 0.25 in every sample"]);
}

#[test]
fn a_file_that_breaks_off_is_refused_wherever_it_does() {
    let whole = file(&plain());
    for length in 1..whole.len() {
        let model = super::model("");
        let bench = Bench::of(&whole[..length]);
        let found = switchid::data::open_recording(&bench.path().display().to_string(), &model);
        assert!(found.is_err(), "{length} of {} bytes", whole.len());
    }
    let mut torn = file(&[compressed(&plain()[0])]);
    let middle = torn.len() / 2 + 70;
    torn[middle] ^= 0xff;
    Bench::of(&torn).refuses("", &["damaged"]);
}
