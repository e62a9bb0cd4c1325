//! `switchid limits`: what any method could reach on a recording.

mod asked;
mod force;
mod found;
mod motion;
mod report;

pub(super) use asked::Arguments;

use super::error::CommandError;
use super::input::Input;
use super::output;
use super::progress::Waiting;
use asked::Asked;

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let data = std::slice::from_ref(&arguments.data);
    let input = Input::open(data, &arguments.model)?;
    let asked = Asked::read(arguments, &input.model)?;
    let found = Waiting::on("looking for the limits", || match input.model.is_force_law() {
        true => force::limits(&input, &asked),
        false => motion::limits(&input, &asked),
    })?;
    found.warnings.iter().for_each(|warning| output::complain("warning", warning));
    if arguments.json { output::print_json(&report::Report::of(&found)) } else { output::print(&report::text(&found)) }
}
