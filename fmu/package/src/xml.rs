//! `modelDescription.xml` of FMI 2.0, in the order of its schema.

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use sha2::{Digest, Sha256};
use std::f64::consts::PI;
use std::io;
use switchid_fmu_slave::{Category, Causality, Description, Enumeration, Kind, Unit, Variability, Variable};

pub(crate) type Xml = Writer<Vec<u8>>;
pub(crate) type Attributes = Vec<(&'static str, String)>;

/// The XML and its GUID, which is the hash of the XML without it and of the resources that the binary reads.
///
/// # Errors
/// Only what writing to memory can raise.
pub fn model_description(description: &Description, resources: &[(String, Vec<u8>)]) -> io::Result<(String, String)> {
    let mut hash = Sha256::new();
    hash.update(write(description, "")?);
    for (name, content) in resources {
        hash.update(name);
        hash.update(content);
    }
    let guid = guid_text(&hash.finalize());
    Ok((write(description, &guid)?, guid))
}

fn guid_text(hash: &[u8]) -> String {
    let hex: String = hash.iter().take(16).map(|byte| format!("{byte:02x}")).collect();
    [&hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..]].join("-")
}

fn write(description: &Description, guid: &str) -> io::Result<String> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    element(&mut xml, "fmiModelDescription", head(description, guid), |xml| {
        if description.model_exchange {
            empty(xml, "ModelExchange", equations(description))?;
        }
        empty(xml, "CoSimulation", capabilities(description))?;
        write_units(xml, &description.units)?;
        write_enumerations(xml, &description.enumerations)?;
        write_log_categories(xml)?;
        empty(xml, "DefaultExperiment", experiment(description))?;
        element(xml, "ModelVariables", vec![], |xml| write_variables(xml, description))?;
        element(xml, "ModelStructure", vec![], |xml| write_structure(xml, description))
    })?;
    String::from_utf8(xml.into_inner()).map(|text| text + "\n").map_err(io::Error::other)
}

pub(crate) fn element(
    xml: &mut Xml,
    name: &str,
    attributes: Attributes,
    content: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    let attributes = attributes.iter().map(|(name, value)| (*name, value.as_str()));
    xml.create_element(name).with_attributes(attributes).write_inner_content(content)?;
    Ok(())
}

pub(crate) fn empty(xml: &mut Xml, name: &str, attributes: Attributes) -> io::Result<()> {
    let attributes = attributes.iter().map(|(name, value)| (*name, value.as_str()));
    xml.create_element(name).with_attributes(attributes).write_empty()?;
    Ok(())
}

fn head(description: &Description, guid: &str) -> Attributes {
    vec![
        ("fmiVersion", "2.0".into()),
        ("modelName", description.name.clone()),
        ("guid", guid.into()),
        ("description", description.description.clone()),
        ("version", description.version.clone()),
        ("license", "MIT OR Apache-2.0".into()),
        ("generationTool", format!("switchid {}", description.version)),
        ("variableNamingConvention", "structured".into()),
        ("numberOfEventIndicators", "0".into()),
    ]
}

fn capabilities(description: &Description) -> Attributes {
    let flag = |name, value: bool| (name, value.to_string());
    vec![
        ("modelIdentifier", description.name.clone()),
        flag("needsExecutionTool", false),
        flag("canHandleVariableCommunicationStepSize", true),
        flag("canInterpolateInputs", false),
        ("maxOutputDerivativeOrder", "0".into()),
        flag("canRunAsynchronuously", false),
        flag("canBeInstantiatedOnlyOncePerProcess", false),
        flag("canNotUseMemoryManagementFunctions", true),
        flag("canGetAndSetFMUstate", true),
        flag("canSerializeFMUstate", true),
        flag("providesDirectionalDerivative", false),
    ]
}

/// What a host may do that integrates it.
fn equations(description: &Description) -> Attributes {
    let flag = |name, value: bool| (name, value.to_string());
    vec![
        ("modelIdentifier", description.name.clone()),
        flag("needsExecutionTool", false),
        flag("completedIntegratorStepNotNeeded", true),
        flag("canBeInstantiatedOnlyOncePerProcess", false),
        flag("canNotUseMemoryManagementFunctions", true),
        flag("canGetAndSetFMUstate", true),
        flag("canSerializeFMUstate", true),
        flag("providesDirectionalDerivative", false),
    ]
}

fn experiment(description: &Description) -> Attributes {
    vec![
        ("startTime", number(0.0)),
        ("stopTime", number(description.default_duration)),
        ("stepSize", number(description.default_step)),
    ]
}

fn number(value: f64) -> String {
    format!("{value:?}")
}

fn write_units(xml: &mut Xml, units: &[Unit]) -> io::Result<()> {
    if units.is_empty() {
        return Ok(());
    }
    element(xml, "UnitDefinitions", vec![], |xml| {
        units.iter().try_for_each(|unit| {
            element(xml, "Unit", vec![("name", unit.name.clone())], |xml| {
                empty(xml, "BaseUnit", base_unit(unit))?;
                display_units(&unit.name).iter().try_for_each(|(name, factor)| {
                    empty(xml, "DisplayUnit", vec![("name", (*name).into()), ("factor", number(*factor))])
                })
            })
        })
    })
}

/// What else a quantity may be shown in: name, and how many of it one unit is.
fn display_units(unit: &str) -> &'static [(&'static str, f64)] {
    match unit {
        "s" => &[("ms", 1e3), ("min", 1.0 / 60.0)],
        "rad/s" => &[("Hz", 0.5 / PI), ("rpm", 30.0 / PI)],
        "m" => &[("mm", 1e3), ("µm", 1e6)],
        "m/s" => &[("mm/s", 1e3)],
        "N" => &[("kN", 1e-3)],
        _ => &[],
    }
}

fn base_unit(unit: &Unit) -> Attributes {
    let exponents = ["kg", "m", "s", "A", "rad"].into_iter().zip(unit.exponents);
    exponents.filter(|(_, exponent)| *exponent != 0).map(|(name, exponent)| (name, exponent.to_string())).collect()
}

fn write_enumerations(xml: &mut Xml, enumerations: &[Enumeration]) -> io::Result<()> {
    if enumerations.is_empty() {
        return Ok(());
    }
    element(xml, "TypeDefinitions", vec![], |xml| {
        enumerations.iter().try_for_each(|enumeration| write_enumeration(xml, enumeration))
    })
}

fn write_enumeration(xml: &mut Xml, enumeration: &Enumeration) -> io::Result<()> {
    element(xml, "SimpleType", vec![("name", enumeration.name.clone())], |xml| {
        element(xml, "Enumeration", vec![], |xml| {
            enumeration.items.iter().zip(1..).try_for_each(|((name, text), value): (_, i32)| {
                let attributes =
                    vec![("name", name.clone()), ("value", value.to_string()), ("description", text.clone())];
                empty(xml, "Item", attributes)
            })
        })
    })
}

fn write_log_categories(xml: &mut Xml) -> io::Result<()> {
    element(xml, "LogCategories", vec![], |xml| {
        Category::ALL.iter().try_for_each(|(_, name, text)| {
            empty(xml, "Category", vec![("name", (*name).into()), ("description", (*text).into())])
        })
    })
}

fn write_variables(xml: &mut Xml, description: &Description) -> io::Result<()> {
    description.variables.iter().enumerate().try_for_each(|(reference, variable)| {
        element(xml, "ScalarVariable", scalar_variable(reference, variable), |xml| {
            let (name, attributes) = type_element(description, variable);
            empty(xml, name, attributes)
        })
    })
}

fn scalar_variable(reference: usize, variable: &Variable) -> Attributes {
    let (causality, variability, initial) = match (variable.causality, variable.variability) {
        (Causality::Parameter, _) => ("parameter", "fixed", Some("exact")),
        (Causality::Input, Variability::Discrete) => ("input", "discrete", None),
        (Causality::Input, Variability::Continuous) => ("input", "continuous", None),
        (Causality::Output, Variability::Discrete) => ("output", "discrete", Some("calculated")),
        (Causality::Output, Variability::Continuous) => ("output", "continuous", Some("calculated")),
        (Causality::Independent, _) => ("independent", "continuous", None),
        (Causality::Local, Variability::Discrete) => ("local", "discrete", Some("calculated")),
        (Causality::Local, Variability::Continuous) => ("local", "continuous", Some("calculated")),
    };
    let mut attributes = vec![
        ("name", variable.name.clone()),
        ("valueReference", reference.to_string()),
        ("description", variable.description.clone()),
        ("causality", causality.into()),
        ("variability", variability.into()),
    ];
    attributes.extend(initial.map(|initial| ("initial", initial.to_string())));
    attributes
}

fn type_element(description: &Description, variable: &Variable) -> (&'static str, Attributes) {
    let mut attributes = Attributes::new();
    let (name, start) = match &variable.kind {
        Kind::Real { start, min, max, unit } => {
            attributes.extend(unit.clone().map(|unit| ("unit", unit)));
            attributes.extend(min.map(|min| ("min", number(min))));
            attributes.extend(max.map(|max| ("max", number(max))));
            let state = variable.derivative_of.as_deref().and_then(|state| description.position(state));
            attributes.extend(state.map(|position| ("derivative", (position + 1).to_string())));
            attributes.extend(nominal(*start).map(|nominal| ("nominal", number(nominal))));
            ("Real", number(*start))
        }
        Kind::Integer { start, min, max } => {
            attributes.extend(min.map(|min| ("min", min.to_string())));
            attributes.extend(max.map(|max| ("max", max.to_string())));
            ("Integer", start.to_string())
        }
        Kind::Enumeration { of, start } => {
            attributes.push(("declaredType", of.clone()));
            ("Enumeration", start.to_string())
        }
        Kind::Boolean { start } => ("Boolean", start.to_string()),
        Kind::String { start } => ("String", start.clone()),
    };
    if matches!(variable.causality, Causality::Parameter | Causality::Input) {
        attributes.push(("start", start));
    }
    (name, attributes)
}

/// The magnitude of a quantity, where its start value tells it; 1 is FMI's own guess.
fn nominal(start: f64) -> Option<f64> {
    Some(start.abs()).filter(|size| *size > 0.0 && *size < 1e20 && *size != 1.0)
}

/// No output depends on an input at the same instant; indices count from 1. That outputs depend on the time must be
/// said: FMI Library takes a list in which nothing depends on anything for one that says nothing.
fn write_structure(xml: &mut Xml, description: &Description) -> io::Result<()> {
    let time = description.time().map(|place| description.variables[place].name.clone());
    let now = |variable: &Variable| variable.follows.clone();
    let later = |variable: &Variable| variable.follows.iter().chain(&time).cloned().collect();
    let at_first = |variable: &Variable| variable.depends_on.clone();
    let is_output = |variable: &Variable| variable.causality == Causality::Output;
    let is_derivative = |variable: &Variable| variable.derivative_of.is_some();
    write_unknowns(xml, description, "Outputs", is_output, later)?;
    write_unknowns(xml, description, "Derivatives", is_derivative, now)?;
    write_unknowns(xml, description, "InitialUnknowns", |own| is_output(own) || is_derivative(own), at_first)
}

/// A list of those variables that belong to it, each with the variables that it depends on; none where it would be
/// empty.
fn write_unknowns(
    xml: &mut Xml,
    description: &Description,
    list: &str,
    belongs: impl Fn(&Variable) -> bool,
    depends_on: impl Fn(&Variable) -> Vec<String>,
) -> io::Result<()> {
    let unknowns: Vec<(usize, &Variable)> =
        (1..).zip(&description.variables).filter(|(_, variable)| belongs(variable)).collect();
    if unknowns.is_empty() {
        return Ok(());
    }
    element(xml, list, vec![], |xml| {
        unknowns.iter().try_for_each(|(index, own)| unknown(xml, *index, indices(description, &depends_on(own))))
    })
}

fn unknown(xml: &mut Xml, index: usize, dependencies: String) -> io::Result<()> {
    empty(xml, "Unknown", vec![("index", index.to_string()), ("dependencies", dependencies)])
}

fn indices(description: &Description, names: &[String]) -> String {
    let mut positions: Vec<usize> = names.iter().filter_map(|name| description.position(name)).collect();
    positions.sort_unstable();
    positions.iter().map(|position| (position + 1).to_string()).collect::<Vec<_>>().join(" ")
}
