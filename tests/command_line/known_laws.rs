//! Laws that one run saves and another recognises, in `identify` and in an FMU's resources.

use super::bench::{Bench, plain};
use switchid::identify::SavedLaws;

const PLANT: &str = "terms = [\"qdd\", \"qd\", \"q\", \"q^3\"]\nduration = 8.0\ninitial = { q = 0.5, qd = 0.0 }\n\
                     noise = { q = 0.01, qd = 0.01 }\nexcitation = { kind = \"sine\" }\n";
const STAGE: &str = "[[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.3, 4.0, 2.0]\namplitude = 2.0\nomega = 1.5\n";
const MODEL: &str = "name = \"Duffing\"\n[terms]\nqdd = \"fit\"\nqd = \"fit\"\nq = \"fit\"\n\"q^3\" = \"fit\"\n";

/// Two records of one plant, and its laws as the first of them tells.
fn bench(name: &str) -> Bench {
    let bench = Bench::new(name);
    bench.write("model.toml", MODEL);
    for seed in [1, 2] {
        bench.write("plant.toml", &format!("{PLANT}seed = {seed}\n{STAGE}"));
        bench.json(&["simulate", "plant.toml", "-o", &format!("{seed}.csv"), "--json"]);
    }
    let saved = bench.json(&identify(&["1.csv", "--save-laws", "laws.toml"]));
    assert_eq!(saved["stages"][0]["law_number"], 1);
    assert_eq!(saved["stages"][0]["recognised"], false);
    bench
}

fn identify<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    let head = ["identify", "--model", "model.toml", "--hold", "zero", "--json"];
    head.into_iter().chain(arguments.iter().copied()).collect()
}

#[test]
fn a_saved_law_is_recognised_in_another_record() {
    let bench = bench("known_laws");
    let alone = bench.json(&identify(&["2.csv"]));
    let knowing = bench.json(&identify(&["2.csv", "--known-laws", "laws.toml"]));
    let identified = |found: &serde_json::Value| found["stages"][0]["identified"].as_f64().unwrap();
    assert!(identified(&knowing) < 0.5 * identified(&alone), "{} {}", identified(&knowing), identified(&alone));
    assert_eq!((&knowing["stages"][0]["law_number"], &knowing["stages"][0]["recognised"]), (&1.into(), &true.into()));
}

#[test]
fn laws_that_there_are_none_of_are_missed_aloud() {
    let bench = Bench::new("known_laws_none");
    bench.write("short.csv", &plain("t,q,qd,F", 40));
    let output = bench.identify(&["short.csv", "--save-laws", "laws.toml"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && bench.0.join("laws.toml").exists());
    assert!(message.contains("warning: laws.toml: no law was saved"), "{message}");
}

#[test]
fn laws_of_another_model_are_refused_by_file_and_term() {
    let bench = bench("known_laws_foreign");
    bench.write("model.toml", &MODEL.replace("\"q^3\" = \"fit\"\n", ""));
    bench.write("libswitchid_fmu_identifier.so", "identifier's binary");
    let known = ["--known-laws", "laws.toml"];
    let fmu = ["fmu", "--model", "model.toml", "-o", "X.fmu", "--binaries", "."];
    for arguments in [identify(&[&["2.csv"], &known[..]].concat()), [&fmu[..], &known[..]].concat()] {
        bench.refused(&arguments, &["laws.toml: law 1 has the term q^3"]);
    }
}

#[test]
fn an_fmu_carries_the_known_laws() {
    let bench = bench("known_laws_fmu");
    bench.write("libswitchid_fmu_identifier.so", "identifier's binary");
    let arguments = ["fmu", "--model", "model.toml", "--known-laws", "laws.toml", "-o", "X.fmu", "--binaries", "."];
    bench.json(&[&arguments[..], &["--json"]].concat());
    let file = std::fs::File::open(bench.0.join("X.fmu")).unwrap();
    let mut archive = zip::ZipArchive::new(file).unwrap();
    let packed = std::io::read_to_string(archive.by_name("resources/laws.toml").unwrap()).unwrap();
    let saved = std::fs::read_to_string(bench.0.join("laws.toml")).unwrap();
    assert_eq!(SavedLaws::from_toml(&packed), SavedLaws::from_toml(&saved));
}
