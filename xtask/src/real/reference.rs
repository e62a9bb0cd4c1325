//! What an independent regression says of the records: `reference.toml`, which no estimator sees.

use crate::error::Error;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A record, the model to begin with, and the reference's answers.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Its name in tables.
    pub name: String,
    /// Its file in the directory of recordings.
    pub file: String,
    /// Columns of the file by channel, where they differ.
    #[serde(default)]
    pub columns: toml::Table,
    /// The model's terms.
    pub terms: toml::Table,
    /// T₀, s.
    pub period: f64,
    /// Held-out errors of that model over windows of 0.1, 0.3 and 1 T₀.
    pub errors: [f64; 3],
    /// Held-out errors at 0.3 T₀ with one effect more.
    pub effects: BTreeMap<String, f64>,
    /// The best single effect; none where there is none.
    pub best: Option<Best>,
    /// Held-out error at 0.3 T₀ with a second effect.
    pub then: Option<f64>,
    /// First answers that count as right; none: nothing may be claimed.
    pub right: Vec<String>,
    /// The law with friction, where `identify` is measured on the record.
    pub law: Option<Law>,
}

/// An effect and what it leaves.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Best {
    /// Its id; two ids with a "+" between where the source fits both in one step.
    pub effect: String,
    /// Held-out error at 0.3 T₀.
    pub error: f64,
}

/// Coefficients of the law with friction.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Law {
    /// Whether the reference's law is the model's terms and Coulomb friction, no more and no others.
    pub same_form: bool,
    /// By term, at 0.3 T₀ and, where the source says it, at 1 T₀.
    pub coefficients: BTreeMap<String, Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    record: Vec<Record>,
}

/// Every record.
///
/// # Errors
/// [`Error::Reference`] when the table is not what [`Record`] says.
pub fn records() -> Result<Vec<Record>, Error> {
    let file: File = toml::from_str(include_str!("reference.toml"))?;
    Ok(file.record)
}

impl Record {
    /// The model to begin with, as a file.
    pub fn model(&self) -> String {
        self.model_of(self.terms.clone())
    }

    /// The model to begin with and Coulomb friction, as a file.
    pub fn model_with_friction(&self) -> String {
        let mut terms = self.terms.clone();
        terms.insert("coulomb_friction".into(), "fit".into());
        self.model_of(terms)
    }

    fn model_of(&self, terms: toml::Table) -> String {
        let mut model = toml::Table::new();
        model.insert("columns".into(), self.columns.clone().into());
        model.insert("terms".into(), terms.into());
        model.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twelve_records_have_a_model_and_answers() {
        let records = records().unwrap();
        assert_eq!(records.len(), 12);
        assert_eq!(records.iter().filter(|record| record.law.is_some()).count(), 6);
        let nothing = records.iter().filter(|record| record.right.is_empty()).map(|record| record.name.as_str());
        assert_eq!(nothing.collect::<Vec<_>>(), ["dfki_energy", "pneu_oring_3bar"]);
        for record in &records {
            assert!(record.effects.values().all(|error| *error < record.errors[1]), "{}", record.name);
            assert_eq!(record.best.is_some(), record.then.is_some(), "{}", record.name);
            assert!(record.best.iter().all(|best| best.error < record.errors[1]), "{}", record.name);
            let massless = !record.terms.contains_key("inertia");
            let imposed = ["mr_", "brfd2_", "pneu_"].iter().any(|start| record.name.starts_with(start));
            assert_eq!(massless, imposed, "{}", record.name);
        }
    }

    #[test]
    fn a_model_reads_back_with_friction_beside_its_own_terms() {
        let records = records().unwrap();
        let record = records.iter().find(|record| record.name == "emps_train").unwrap();
        let own: toml::Table = toml::from_str(&record.model()).unwrap();
        assert_eq!(own["columns"]["q"].as_str(), Some("position_m"));
        assert!(own["terms"].get("coulomb_friction").is_none());
        let friction: toml::Table = toml::from_str(&record.model_with_friction()).unwrap();
        assert_eq!(friction["terms"].as_table().unwrap().len(), 4);
        assert_eq!(friction["terms"]["coulomb_friction"].as_str(), Some("fit"));
    }
}
