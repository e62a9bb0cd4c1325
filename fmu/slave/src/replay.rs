//! Steps an unpacked FMU and prints every real output bit by bit, to be compared between platforms:
//! `switchid-fmu-replay FOLDER LIBRARY STEPS [NAME=VALUE]..`; inputs are a slow sine, a cosine and a faster sine.

use std::error::Error;
use std::path::Path;
use switchid_fmu_slave::host::{Functions, Instance, Request};
use switchid_fmu_slave::{Causality, Interface, Kind};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, library, steps, set @ ..] = arguments.as_slice() else {
        return Err("usage: switchid-fmu-replay FOLDER LIBRARY STEPS [NAME=VALUE]..".into());
    };
    let resources = Path::new(folder).join("resources");
    let interface: Interface = serde_json::from_slice(&std::fs::read(resources.join("interface.json"))?)?;
    let location = format!("file:///{}", resources.display().to_string().replace('\\', "/"));
    let functions = Functions::load(Path::new(library))?;
    let request = Request { co_simulation: true, guid: &interface.guid, location: Some(&location), logging: true };
    let instance = Instance::new(functions, &request).map_err(|said| format!("{said:?}"))?;
    for pair in set {
        apply(&interface, &instance, pair)?;
    }
    done(&instance, instance.initialize(0.0))?;
    run(&interface, &instance, steps.parse()?)
}

fn apply(interface: &Interface, instance: &Instance, pair: &str) -> Result<(), Box<dyn Error>> {
    let (name, value) = pair.split_once('=').ok_or("NAME=VALUE")?;
    let place = interface.description.position(name).ok_or("no such variable")?;
    let reference = place as u32;
    let status = match interface.description.variables[place].kind {
        Kind::Real { .. } => instance.set_reals(&[reference], &[value.parse()?]),
        Kind::String { .. } => instance.set_text(reference, value),
        Kind::Boolean { .. } => instance.set_boolean(reference, value.parse()?),
        _ => instance.set_integer(reference, value.parse()?),
    };
    done(instance, status)
}

fn run(interface: &Interface, instance: &Instance, steps: u32) -> Result<(), Box<dyn Error>> {
    let variables = || interface.description.variables.iter().zip(0_u32..);
    let is_real = |kind: &Kind| matches!(kind, Kind::Real { .. });
    let of = |causality| {
        let own = variables().filter(move |(own, _)| own.causality == causality && is_real(&own.kind));
        own.map(|(_, reference)| reference).collect::<Vec<u32>>()
    };
    let (inputs, outputs) = (of(Causality::Input), of(Causality::Output));
    for step in 0..steps {
        let t = f64::from(step) * 1e-3;
        let waves = [t.sin(), t.cos(), 0.3 * (2.5 * t).sin()];
        done(instance, instance.set_reals(&inputs, &waves[..inputs.len().min(3)]))?;
        done(instance, instance.step(t, 1e-3))?;
    }
    let values = instance.reals(&outputs).map_err(|status| format!("status {status}"))?;
    for (reference, value) in outputs.iter().zip(values) {
        let name = &interface.description.variables[*reference as usize].name;
        println!("{name} {:016x} {value:e}", value.to_bits());
    }
    Ok(())
}

fn done(instance: &Instance, status: u32) -> Result<(), Box<dyn Error>> {
    if status == 0 { Ok(()) } else { Err(format!("status {status}: {:?}", instance.messages()).into()) }
}
