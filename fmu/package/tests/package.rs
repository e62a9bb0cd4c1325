//! The XML, its GUID, the archive.

use std::io::{Cursor, Read};
use switchid::fmu::{DUFFING, FmuError, STAGES, VAN_DER_POL, identifier, plant, plant_of_model};
use switchid::identify::{Outputs, Parameter};
use switchid::law::{Given, Model, Term};
use switchid_fmu_package::{Fmu, LINUX64, PackageError};

fn default_identifier() -> Fmu {
    identifier("SwitchedIdentifier", &Model::cubic_library()).unwrap()
}

#[test]
fn the_xml_at_the_root_is_the_default_identifier_s() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../modelDescription.xml");
    let at_root = std::fs::read_to_string(path).unwrap();
    assert!(at_root == default_identifier().xml(), "modelDescription.xml is stale: run cargo xtask fmu");
}

#[test]
fn the_guid_tells_interfaces_and_resources_apart() {
    let guid = |name: &str, known: f64| {
        let terms = [(Term::Inertia, Given::Known(known)), (Term::power(1, 0), Given::Fit)];
        identifier(name, &Model::of("model", terms)).unwrap().guid().to_string()
    };
    assert_eq!(guid("A", 1.0), guid("A", 1.0));
    assert_ne!(guid("A", 1.0), guid("B", 1.0));
    assert_ne!(guid("A", 1.0), guid("A", 2.0));
}

#[test]
fn every_setting_and_every_output_is_a_variable() {
    let fmu = default_identifier();
    let terms: Vec<Term> = Model::cubic_library().terms.iter().map(|entry| entry.term).collect();
    let parameters = Parameter::ALL.iter().map(|parameter| parameter.name.to_string());
    let outputs = Outputs::describe(&terms).into_iter().map(|output| output.name);
    let others = ["q", "qd", "F", "terms", "method", "hold"].map(String::from);
    for name in parameters.chain(outputs).chain(others) {
        assert_eq!(fmu.xml().matches(&format!("<ScalarVariable name=\"{name}\" ")).count(), 1, "{name}");
    }
}

/// (name, attributes of its type) of every variable, and the indices of the two lists of unknowns.
fn read(xml: &str) -> (Vec<&str>, Vec<usize>, Vec<usize>) {
    let names = xml.split("<ScalarVariable name=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    let indices = |part: &str| {
        part.split("<Unknown index=\"").skip(1).map(|rest| rest.split('"').next().unwrap().parse().unwrap()).collect()
    };
    let outputs = xml.split("<Outputs>").nth(1).unwrap().split("</Outputs>").next().unwrap();
    let initial = xml.split("<InitialUnknowns>").nth(1).unwrap();
    (names, indices(outputs), indices(initial))
}

#[test]
fn structure_counts_from_one_and_names_every_output() {
    for fmu in [default_identifier(), plant(DUFFING).unwrap(), plant(VAN_DER_POL).unwrap()] {
        let (_, outputs, initial) = read(fmu.xml());
        let with = |part: &str| -> Vec<usize> {
            let variables = fmu.xml().split("<ScalarVariable ").skip(1).zip(1..);
            variables.filter(|(variable, _)| variable.contains(part)).map(|(_, index)| index).collect()
        };
        assert_eq!(outputs, with("causality=\"output\""));
        assert_eq!(initial, [outputs, with(" derivative=\"")].concat());
    }
}

#[test]
fn outputs_depend_on_the_time_and_on_no_input() {
    for fmu in [default_identifier(), plant(DUFFING).unwrap()] {
        let (names, outputs, _) = read(fmu.xml());
        let time = names.iter().position(|name| *name == "time").unwrap() + 1;
        let list = fmu.xml().split("<Outputs>").nth(1).unwrap().split("</Outputs>").next().unwrap();
        let depends_on = |unknown: &str| -> Vec<usize> {
            let indices = unknown.split("dependencies=\"").nth(1).unwrap().split('"').next().unwrap();
            indices.split(' ').map(|index| index.parse().unwrap()).collect()
        };
        let unknowns: Vec<Vec<usize>> = list.split("<Unknown ").skip(1).map(depends_on).collect();
        assert_eq!(unknowns.len(), outputs.len());
        let variables: Vec<&str> = fmu.xml().split("<ScalarVariable ").skip(1).collect();
        let is_input = |index: &usize| variables[index - 1].contains("causality=\"input\"");
        assert!(unknowns.iter().all(|own| own.contains(&time) && !own.iter().any(is_input)), "{unknowns:?}");
    }
}

#[test]
fn only_a_plant_without_kinks_can_be_integrated_by_its_host() {
    let smooth = plant(DUFFING).unwrap();
    let (names, ..) = read(smooth.xml());
    let position = |name: &str| names.iter().position(|known| *known == name).unwrap() + 1;
    let [q, qd, force] = ["true.q", "true.qd", "excitation.F"].map(position);
    let derivatives = [("der(true.q)", q, format!("{qd}")), ("der(true.qd)", qd, format!("{force} {q} {qd}"))];
    for (name, state, depends_on) in derivatives {
        let variable = smooth.xml().split("<ScalarVariable ").nth(position(name)).unwrap();
        assert!(variable.contains(&format!("derivative=\"{state}\"")), "{variable}");
        let unknown = format!("<Unknown index=\"{}\" dependencies=\"{depends_on}\"/>", position(name));
        assert!(smooth.xml().contains(&unknown), "{unknown}");
    }
    let rough = Model::from_toml("[terms]\nqdd = 1.0\nq = 4.0\ncoulomb_friction = 0.2\n").unwrap();
    let rough = plant_of_model("Rough", &rough).unwrap();
    for (fmu, can) in [(smooth, true), (rough, false), (default_identifier(), false)] {
        assert_eq!(fmu.xml().contains("<ModelExchange "), can);
        assert_eq!(fmu.xml().contains("<Derivatives>"), can);
    }
}

#[test]
fn initial_dependencies_point_at_their_parameters() {
    let fmu = plant(VAN_DER_POL).unwrap();
    let (names, ..) = read(fmu.xml());
    let position = |name: &str| names.iter().position(|known| *known == name).unwrap() + 1;
    let (alpha, a) = (position("stage[1].alpha"), position("stage[1].a"));
    let unknown = format!("<Unknown index=\"{}\" dependencies=\"{alpha} {a}\"/>", position("true.coef.qd"));
    assert!(fmu.xml().contains(&unknown), "{unknown}");
}

#[test]
fn a_plant_has_sixteen_stages() {
    let fmu = plant(DUFFING).unwrap();
    assert_eq!(STAGES, 16);
    assert!(fmu.xml().contains("name=\"stage[16].k3\""));
    assert!(!fmu.xml().contains("stage[17]") && !fmu.xml().contains("stage[0]"));
}

#[test]
fn the_archive_holds_what_importers_look_for_and_is_reproducible() {
    let archive = || plant(DUFFING).unwrap().with_binary(LINUX64, b"binary".to_vec()).to_bytes().unwrap();
    assert_eq!(archive(), archive());
    let mut zip = zip::ZipArchive::new(Cursor::new(archive())).unwrap();
    let names: Vec<String> = zip.file_names().map(|name| name.unwrap().into_owned()).collect();
    for path in [
        "modelDescription.xml",
        "binaries/linux64/Duffing.so",
        "resources/interface.json",
        "resources/plant.toml",
        "documentation/index.html",
        "documentation/licenses/LICENSE-MIT",
        "documentation/licenses/LICENSE-APACHE",
        "documentation/licenses/third-party.txt",
        "model.png",
        "terminalsAndIcons/icon.png",
        "terminalsAndIcons/terminalsAndIcons.xml",
    ] {
        assert!(names.iter().any(|name| name == path), "{path} is not among {names:?}");
    }
    let mut xml = String::new();
    zip.by_name("modelDescription.xml").unwrap().read_to_string(&mut xml).unwrap();
    assert_eq!(xml, plant(DUFFING).unwrap().xml());
}

#[test]
fn text_in_the_xml_is_escaped() {
    let law = DUFFING.replace("Cubic stiffness", "k3 < 0 & \\\"soft\\\"");
    assert!(plant(&law).unwrap().xml().contains("k3 &lt; 0 &amp; &quot;soft&quot; in stage 1"));
}

#[test]
fn what_cannot_be_packed_is_refused() {
    let refused = identifier("no name", &Model::cubic_library());
    assert!(matches!(refused, Err(FmuError::Package(PackageError::Name { .. }))));
    let numbers = Model::of("m", [(Term::Inertia, Given::Known(1.0)), (Term::power(1, 0), Given::Known(2.0))]);
    assert!(matches!(identifier("A", &numbers), Err(FmuError::Model(_))));
    assert!(matches!(plant("name = 1"), Err(FmuError::Law(_))));
}
