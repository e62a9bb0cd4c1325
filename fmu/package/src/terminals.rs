//! `terminalsAndIcons.xml`: which variables belong on one line of a diagram, and what the block looks like.

use crate::xml::{Attributes, Xml, element, empty};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::io;
use switchid_fmu_slave::{Causality, Description};

/// What measures, or is measured: displacement, velocity, excitation.
const SIGNALS: [&str; 3] = ["q", "qd", "F"];

/// The XML. Inputs among q, q̇ and F make a terminal on the left, outputs among them one on the right, an excitation
/// from outside one below.
///
/// # Errors
/// Only what writing to memory can raise.
pub fn terminals(description: &Description) -> io::Result<String> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    element(&mut xml, "fmiTerminalsAndIcons", vec![("fmiVersion", "3.0".into())], |xml| {
        element(xml, "GraphicalRepresentation", vec![], |xml| {
            let scaled =
                [corners([-100, -100], [100, 100]), vec![("suggestedScalingFactorTo_mm", "0.1".into())]].concat();
            empty(xml, "CoordinateSystem", scaled)?;
            empty(xml, "Icon", corners([-100, -100], [100, 100]))
        })?;
        element(xml, "Terminals", vec![], |xml| {
            write_terminal(xml, "sensors", &signals(description, Causality::Input), [-100, 0])?;
            write_terminal(xml, "plant", &signals(description, Causality::Output), [100, 0])?;
            let driven = description.position("excitation.F").map(|_| "excitation.F");
            write_terminal(xml, "drive", driven.as_slice(), [0, -100])
        })
    })?;
    String::from_utf8(xml.into_inner()).map(|text| text + "\n").map_err(io::Error::other)
}

fn signals(description: &Description, causality: Causality) -> Vec<&'static str> {
    let is = |signal: &str| description.variables.iter().any(|own| own.name == signal && own.causality == causality);
    SIGNALS.into_iter().filter(|signal| is(signal)).collect()
}

fn write_terminal(xml: &mut Xml, name: &str, members: &[&str], [x, y]: [i32; 2]) -> io::Result<()> {
    if members.is_empty() {
        return Ok(());
    }
    element(xml, "Terminal", vec![("name", name.into()), ("matchingRule", "bus".into())], |xml| {
        members.iter().try_for_each(|member| {
            let named = member.rsplit('.').next().unwrap_or(member);
            let variable = [("variableName", *member), ("memberName", named), ("variableKind", "signal")];
            empty(xml, "TerminalMemberVariable", variable.map(|(key, value)| (key, value.into())).into())
        })?;
        let icon = [vec![("iconBaseName", "icon".into())], corners([x - 10, y - 10], [x + 10, y + 10])].concat();
        empty(xml, "TerminalGraphicalRepresentation", icon)
    })
}

fn corners([x1, y1]: [i32; 2], [x2, y2]: [i32; 2]) -> Attributes {
    [("x1", x1), ("y1", y1), ("x2", x2), ("y2", y2)].map(|(name, value)| (name, value.to_string())).into()
}
