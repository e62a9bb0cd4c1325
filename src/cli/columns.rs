//! `--columns NAME=COLUMN`: which column is which, without a line in a model file.

use super::error::CommandError;
use crate::law::{Columns, Model};
use clap::Args;

/// Columns by name or position.
#[derive(Args, Clone, Default)]
pub(super) struct ColumnArguments {
    /// Which column is which: q="Weg [mm]", q=2 (its position, from 1), t=1000Hz (a rate in place of times); t, q, qd
    /// or F; repeatable, goes before the model's [columns]
    #[arg(long, value_name = "NAME=COLUMN")]
    columns: Vec<String>,
}

impl ColumnArguments {
    /// What was named, as it was written.
    #[cfg(feature = "pictures")]
    pub(super) fn named(&self) -> &[String] {
        &self.columns
    }

    /// Puts them into a model.
    ///
    /// # Errors
    /// What is no `NAME=COLUMN`, and a name that is given twice.
    pub(super) fn apply(&self, model: &mut Model) -> Result<(), CommandError> {
        let mut named = Columns::default();
        for text in &self.columns {
            let refused = |reason: &str| CommandError::Named {
                option: "columns",
                text: text.clone(),
                reason: reason.into(),
                example: "--columns NAME=COLUMN, as in --columns q=\"Weg [mm]\" or --columns q=2, once for each of t, q, qd, F",
            };
            let (name, column) = text.split_once('=').ok_or_else(|| refused("there is no \"=\""))?;
            let slot = match name.trim() {
                "t" => &mut named.t,
                "q" => &mut named.q,
                "qd" => &mut named.qd,
                "F" => &mut named.excitation,
                other => return Err(refused(&format!("\"{other}\" is none of t, q, qd, F"))),
            };
            if column.trim().is_empty() {
                return Err(refused("there is no column behind the \"=\""));
            }
            if slot.replace(column.trim().to_string()).is_some() {
                return Err(refused(&format!("{} is given twice", name.trim())));
            }
        }
        let is_silent = model.columns.guesses();
        let columns = &mut model.columns;
        let pairs = [
            (&mut columns.t, named.t),
            (&mut columns.q, named.q),
            (&mut columns.qd, named.qd),
            (&mut columns.excitation, named.excitation),
        ];
        for (slot, named) in pairs {
            *slot = named.or(slot.take());
        }
        // What one option names is no word on the other columns, unless the model has one.
        columns.rest_is_guessed = is_silent && !self.columns.is_empty();
        Ok(())
    }
}
