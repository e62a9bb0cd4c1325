//! Plant and identifier, as `cargo xtask fmu` packed them, stepped together through the `fmi` crate.

use fmi::fmi2::import::Fmi2Import;
use fmi::fmi2::instance::{CoSimulation, Common, InstanceCS};
use fmi::traits::FmiImport;
use std::ffi::CString;

fn import(name: &str) -> Fmi2Import {
    let path = format!("{}/../../target/fmu/{name}.fmu", env!("CARGO_MANIFEST_DIR"));
    fmi::import::from_path(&path).unwrap_or_else(|error| panic!("{path}: {error}: run cargo xtask fmu first"))
}

fn reference(import: &Fmi2Import, name: &str) -> u32 {
    let variables = &import.model_description().model_variables.variables;
    variables.iter().find(|variable| variable.name == name).unwrap_or_else(|| panic!("no {name}")).value_reference
}

fn references(import: &Fmi2Import, names: &[&str]) -> Vec<u32> {
    names.iter().map(|name| reference(import, name)).collect()
}

fn initialise(instance: &mut InstanceCS) {
    instance.setup_experiment(None, 0.0, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
}

fn together(plant_name: &str) {
    let (plant_import, identifier_import) = (import(plant_name), import("SwitchedIdentifier"));
    let mut plant = plant_import.instantiate_cs("plant", false, true).unwrap();
    let mut identifier = identifier_import.instantiate_cs("identifier", false, true).unwrap();
    assert_eq!((identifier.get_version(), identifier.get_types_platform()), ("2.0", "default"));
    let terms = CString::new("qdd qd q q^3 q^2*qd").unwrap();
    identifier.set_string(&[reference(&identifier_import, "terms")], &[terms]).unwrap();
    initialise(&mut plant);
    initialise(&mut identifier);
    let (ports_out, ports_in) =
        (references(&plant_import, &["q", "qd", "F"]), references(&identifier_import, &["q", "qd", "F"]));
    let mut values = [f64::NAN; 3];
    for k in 0..1000 {
        let t = f64::from(k) * 1e-3;
        plant.get_real(&ports_out, &mut values).unwrap();
        identifier.set_real(&ports_in, &values).unwrap();
        plant.do_step(t, 1e-3, true).unwrap();
        identifier.do_step(t, 1e-3, true).unwrap();
    }
    assert!(values.iter().all(|value| value.is_finite()) && values[0] != 0.5, "{values:?}");
    let mut last_time = [f64::NAN];
    identifier.get_real(&references(&identifier_import, &["coef.qdd"]), &mut last_time).unwrap();
    assert!(last_time[0].is_finite());
    assert!((identifier.last_successful_time().unwrap() - 1.0).abs() < 1e-9);
    plant.terminate().unwrap();
    identifier.terminate().unwrap();
}

#[test]
fn duffing_and_identifier_step_together() {
    together("Duffing");
}

#[test]
fn van_der_pol_and_identifier_step_together() {
    together("VanDerPol");
}

#[test]
fn a_fixed_parameter_is_refused_while_running() {
    let import = import("Duffing");
    let mut plant = import.instantiate_cs("plant", false, true).unwrap();
    initialise(&mut plant);
    let mass = references(&import, &["stage[1].m"]);
    assert!(plant.set_real(&mass, &[2.0]).is_err());
    plant.reset().unwrap();
    assert!(plant.set_real(&mass, &[2.0]).is_ok());
}
