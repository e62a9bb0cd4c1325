//! `switchid fmu` packs identifiers and plants; the binaries here are stand-ins.

use super::bench::{Bench, MODEL};
use std::collections::BTreeMap;
use std::io::Read;
use switchid::law::Model;
use switchid::simulate::ParametricLaw;

const LAW: &str = "[units]\nq = \"mm\"\nF = \"N\"\n[terms]\ninertia = 2.0\nlinear_damping = 0.3\nq = 4\n\"q^3\" = -1e-7\n\
                   stribeck_friction = { coefficient = 0.7, speed = 0.02 }\n";

fn bench(name: &str) -> Bench {
    let bench = Bench::new(name);
    bench.write("libswitchid_fmu_identifier.so", "identifier's binary");
    bench.write("libswitchid_fmu_plant.so", "plant's binary");
    bench.write("switchid_fmu_plant.dll", "plant's other binary");
    bench.write("law.toml", LAW);
    bench
}

/// Every file of an FMU by its path.
pub fn files(bench: &Bench, name: &str) -> BTreeMap<String, String> {
    let file = std::fs::File::open(bench.0.join(name)).unwrap();
    let mut archive = zip::ZipArchive::new(file).unwrap();
    let count = archive.len();
    let read = |index| {
        let mut entry = archive.by_index(index).unwrap();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).unwrap();
        (entry.name().unwrap().into_owned(), String::from_utf8_lossy(&content).into_owned())
    };
    (0..count).map(read).collect()
}

pub fn variable<'a>(xml: &'a str, name: &str) -> &'a str {
    let start = xml.find(&format!("<ScalarVariable name=\"{name}\" ")).unwrap_or_else(|| panic!("no {name}"));
    xml[start..].split("</ScalarVariable>").next().unwrap()
}

#[test]
fn an_identifier_carries_the_model_and_its_units() {
    let bench = bench("fmu_identifier");
    let law = LAW.replace("linear_damping = 0.3", "linear_damping = \"fit\"");
    bench.write("law.toml", &law);
    let found = bench.json(&["fmu", "--model", "law.toml", "-o", "My-Axis.fmu", "--binaries", ".", "--json"]);
    assert_eq!((found["kind"].as_str(), found["name"].as_str()), (Some("identifier"), Some("My_Axis")));
    let files = files(&bench, "My-Axis.fmu");
    assert_eq!(files["binaries/linux64/My_Axis.so"], "identifier's binary");
    let model = Model::from_toml(&files["resources/model.toml"]).unwrap();
    assert_eq!(model, Model::from_toml(&law).unwrap());
    let xml = &files["modelDescription.xml"];
    for (name, unit) in [("q", "m"), ("qd", "m/s"), ("F", "N"), ("coef.q_3", "N/m³"), ("std.qdd", "kg")] {
        assert!(variable(xml, name).contains(&format!("unit=\"{unit}\"")), "{}", variable(xml, name));
    }
    assert!(xml.contains("<Unit name=\"N\">") && xml.contains("<BaseUnit kg=\"1\" m=\"1\" s=\"-2\"/>"));
}

#[test]
fn a_plant_has_the_numbers_of_the_model() {
    let bench = bench("fmu_plant");
    let found = bench.json(&["fmu", "--model", "law.toml", "-o", "P.fmu", "--plant", "--binaries", ".", "--json"]);
    assert_eq!(found["platforms"], serde_json::json!(["linux64", "win64"]));
    let files = files(&bench, "P.fmu");
    let law = ParametricLaw::from_toml(&files["resources/plant.toml"]).unwrap();
    let starts: Vec<f64> = law.parameters.iter().map(|parameter| parameter.start).collect();
    assert_eq!((law.coefficients(&starts), starts.len()), (vec![2.0, 0.3, 4.0, -1e-7], 4));
    let xml = &files["modelDescription.xml"];
    for (name, start) in [
        ("stage[1].linear_damping", "0.3"),
        ("stage[7].q_3", "-1e-7"),
        ("hidden.stribeck_friction", "0.7"),
        ("hidden.stribeck_friction.speed", "0.02"),
        ("hidden.coulomb_friction", "0.0"),
        ("q0", "0.0"),
    ] {
        assert!(variable(xml, name).contains(&format!("start=\"{start}\"")), "{}", variable(xml, name));
    }
    assert!(variable(xml, "stage[1].q_3").contains("unit=\"N/m³\""));
}

#[test]
fn what_cannot_be_packed_is_refused() {
    let bench = bench("fmu_refused");
    let refused = |model: &str, arguments: &[&str], words: &[&str]| {
        bench.write("model.toml", model);
        let all = [&["fmu", "--model", "model.toml", "-o", "X.fmu"], arguments].concat();
        bench.refused(&all, words);
        assert!(!bench.0.join("X.fmu").exists());
    };
    let here = ["--binaries", "."];
    let plant = ["--plant", "--binaries", "."];
    refused(MODEL, &plant, &["model.toml", "\"inertia\", \"qd\", \"q\", \"q^3\" have none", "improve"]);
    let open = "[terms]\ninertia = 1.0\none_sided_stop = 2.0\n";
    refused(open, &plant, &["gap of \"one_sided_stop\"", "numbers"]);
    refused(open, &here, &["model.toml", "one_sided_stop", "gap"]);
    refused(LAW, &here, &["model.toml", "nothing to identify", "\"fit\" or \"maybe\""]);
    let own = "[terms]\ninertia = 1.0\ntip = 2.0\n[effects.tip]\nexpression = \"a*q\"\n";
    refused(own, &plant, &["a of \"tip\"", "numbers"]);
    refused(
        MODEL,
        &["--binaries", "nowhere"],
        &["nowhere", "cargo build --release -p switchid-fmu-identifier", "--binaries"],
    );
    refused(LAW, &["--plant", "--binaries", "nowhere"], &["cargo build --release -p switchid-fmu-plant"]);
}
