//! Names of stored columns: variables, fields of structures, channels of groups; and which shapes are signals.

use super::arrays::Unfit;

/// A variable's name, with the structure that it is a field of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Name {
    pub(super) structure: Option<String>,
    pub(super) own: String,
}

impl Name {
    /// A variable of its own.
    pub(super) fn of(own: &str) -> Name {
        Name { structure: None, own: own.into() }
    }

    /// A field.
    pub(super) fn field(structure: &str, own: &str) -> Name {
        Name { structure: Some(structure.into()), own: own.into() }
    }
}

/// The headers of these variables. A field of the only structure goes by its own name, unless a variable has that too;
/// else it is `structure.field`.
pub(super) fn headers(names: &[Name]) -> Vec<String> {
    let only = names.iter().find_map(|name| name.structure.as_ref());
    let alone = names.iter().all(|name| name.structure.is_none() || name.structure.as_ref() == only);
    let taken = |own: &str| names.iter().any(|name| name.structure.is_none() && name.own == own);
    let header = |name: &Name| match &name.structure {
        Some(structure) if !alone || taken(&name.own) => format!("{structure}.{}", name.own),
        _ => name.own.clone(),
    };
    names.iter().map(header).collect()
}

/// Whether an array of that shape is a vector: at most one extent other than 1, and not empty.
pub(super) fn check_vector(shape: &[usize]) -> Result<(), Unfit> {
    if shape.contains(&0) {
        return Err(Unfit::Is("empty".into()));
    }
    if shape.iter().filter(|extent| **extent > 1).count() <= 1 {
        return Ok(());
    }
    let extents: Vec<String> = shape.iter().map(ToString::to_string).collect();
    Err(Unfit::Is(format!("a {} array", extents.join(" × "))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_of_the_only_structure_go_by_their_own_names() {
        let (t, q) = (Name::field("run", "t"), Name::field("run", "q"));
        assert_eq!(headers(&[t.clone(), q.clone(), Name::of("fs")]), ["t", "q", "fs"]);
        assert_eq!(headers(&[t.clone(), q.clone(), Name::of("q")]), ["t", "run.q", "q"]);
        assert_eq!(headers(&[t, q, Name::field("other", "q")]), ["run.t", "run.q", "other.q"]);
    }

    #[test]
    fn only_vectors_are_signals() {
        for vector in [&[1, 7][..], &[7, 1], &[7], &[1, 1], &[]] {
            assert_eq!(check_vector(vector), Ok(()), "{vector:?}");
        }
        assert_eq!(check_vector(&[3, 7]), Err(Unfit::Is("a 3 × 7 array".into())));
        assert_eq!(check_vector(&[0, 0]), Err(Unfit::Is("empty".into())));
    }
}
