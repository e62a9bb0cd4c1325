//! Terms in a file, by their canonical names: for serde's `with`.

use crate::law::{Term, TermError};
use serde::{Deserialize, Deserializer, Serializer, de::Error};

pub(super) fn serialize<S: Serializer>(terms: &[Term], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(terms.iter().map(|term| term.name()))
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Term>, D::Error> {
    let names = Vec::<String>::deserialize(deserializer)?;
    let terms: Result<Vec<Term>, TermError> = names.iter().map(|name| Term::parse(name)).collect();
    terms.map_err(D::Error::custom)
}
