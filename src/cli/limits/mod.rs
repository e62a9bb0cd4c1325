//! `switchid limits`: what any method could reach on a recording.

mod asked;
mod force;
mod found;
mod motion;
mod report;

pub(super) use asked::Arguments;

use super::error::CommandError;
use super::figures;
use super::input::Input;
use super::output::{self, Targets};
use super::progress::Waiting;
use asked::Asked;

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let data = std::slice::from_ref(&arguments.data);
    let mut inputs = output::files_of(data)?;
    inputs.push(arguments.model.model.clone());
    let picture = arguments.picture.open(&mut Targets::new(inputs, arguments.force))?;
    let input = Input::open(data, &arguments.model)?;
    let asked = Asked::read(arguments, &input.model)?;
    let found = Waiting::on("looking for the limits", || match input.model.is_force_law() {
        true => force::limits(&input, &asked),
        false => motion::limits(&input, &asked),
    })?;
    found.warnings.iter().for_each(|warning| output::complain("warning", warning));
    picture.map_or(Ok(()), |picture| picture.draw(&figures::limits(&report::bars(&found))))?;
    if arguments.json { output::print_json(&report::Report::of(&found)) } else { output::print(&report::text(&found)) }
}
