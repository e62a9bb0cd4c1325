//! The trace of a run: every output of the identifier after every sample, under the names that the FMU gives them.

use super::error::CommandError;
use super::output::{Table, Target};
use crate::identify::{Identifier, Outputs};
use crate::law::{Model, Term};

/// A CSV file that begins with `t`. Flags are 0 and 1, a status its number in the FMU, what is not known 1e30.
pub(super) struct Trace {
    table: Table,
    terms: Vec<Term>,
    row: Vec<f64>,
    failed: Option<CommandError>,
}

impl Trace {
    /// Creates the file with its header.
    pub(super) fn create(target: &Target, model: &Model) -> Result<Trace, CommandError> {
        let terms: Vec<Term> = model.terms.iter().map(|entry| entry.term).collect();
        let outputs = Outputs::describe(&terms).into_iter().map(|output| output.name);
        let header: Vec<String> = std::iter::once("t".to_string()).chain(outputs).collect();
        Ok(Trace { table: Table::create(target, &header)?, terms, row: Vec::with_capacity(header.len()), failed: None })
    }

    /// Writes the outputs after the sample at t. The first failure ends the writing and is kept for [`Trace::finish`].
    pub(super) fn push(&mut self, t: f64, identifier: &Identifier) {
        let outputs = Outputs::new(&self.terms, identifier);
        self.row.clear();
        self.row.push(t);
        self.row.extend(outputs.values(identifier).map(|value| value.number()));
        if self.failed.is_none() {
            self.failed = self.table.push(&self.row).err();
        }
    }

    /// Closes the file.
    ///
    /// # Errors
    /// The first failure to write.
    pub(super) fn finish(self) -> Result<(), CommandError> {
        self.failed.map_or(Ok(()), Err)?;
        self.table.finish()
    }
}
