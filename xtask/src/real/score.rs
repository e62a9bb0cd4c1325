//! How answers are scored.

/// Members that a stated tie may have.
pub const LARGEST_TIE: usize = 3;

/// Whether a diagnosis is right: one of the `right` effects, first or in a stated tie of at most [`LARGEST_TIE`];
/// where none is right, nothing claimed. `tie` is the stated tie in which the effect named stands, empty where it
/// stands alone.
pub fn is_right(right: &[String], verdict: &str, effect: Option<&str>, tie: &[String]) -> bool {
    let claims = verdict == "missing" || effect.is_some();
    if right.is_empty() {
        return !claims && !verdict.is_empty();
    }
    let mut named = effect.into_iter().chain(tie.iter().map(String::as_str));
    claims && tie.len() <= LARGEST_TIE && named.any(|id| right.iter().any(|other| other == id))
}

/// The middle value; the mean of the two middle ones of an even number.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let upper = sorted.get(sorted.len() / 2)?;
    let lower = sorted.get((sorted.len() - 1) / 2)?;
    Some(0.5 * (lower + upper))
}

/// The largest value.
pub fn worst(values: &[f64]) -> Option<f64> {
    values.iter().copied().max_by(f64::total_cmp)
}

/// Steps of a staircase that raise the error.
pub fn rises(errors: &[Option<f64>]) -> usize {
    let known: Vec<f64> = errors.iter().flatten().copied().collect();
    known.windows(2).filter(|pair| pair[1] > pair[0]).count()
}

/// Whether a coefficient is known no better than nothing.
pub fn is_unknown(coefficient: f64, std: f64) -> bool {
    std.is_nan() || std > coefficient.abs()
}

/// Whether the reference's coefficients at its two window lengths agree to a tenth; none where it gives one only.
pub fn agree(reference: &[f64]) -> Option<bool> {
    let [short, long] = reference else { return None };
    Some((short - long).abs() <= 0.1 * short.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(list: &str) -> Vec<String> {
        list.split_whitespace().map(String::from).collect()
    }

    #[test]
    fn a_right_effect_first_or_in_a_short_tie_counts() {
        let right = ids("coulomb stribeck");
        assert!(is_right(&right, "missing", Some("coulomb"), &[]));
        assert!(is_right(&right, "missing", Some("dahl"), &ids("dahl stribeck")));
        assert!(!is_right(&right, "missing", Some("dahl"), &[]));
        assert!(!is_right(&right, "missing", Some("dahl"), &ids("dahl drag")));
        assert!(!is_right(&right, "unexplained", None, &[]));
        assert!(!is_right(&right, "adequate", None, &[]));
        let many = ids("coulomb dahl drag stribeck");
        assert!(!is_right(&right, "missing", Some("coulomb"), &many), "a tie of four says nothing");
    }

    #[test]
    fn where_nothing_can_be_told_nothing_may_be_claimed() {
        assert!(is_right(&[], "adequate", None, &[]) && is_right(&[], "unexplained", None, &[]));
        assert!(!is_right(&[], "missing", Some("dahl"), &[]));
        assert!(!is_right(&[], "", None, &[]), "a run without an answer is not right");
    }

    #[test]
    fn ratios_are_summed_up() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0]), Some(2.5));
        assert_eq!(median(&[]), None);
        assert_eq!(worst(&[1.0, 4.0, 2.0]), Some(4.0));
    }

    #[test]
    fn steps_that_raise_the_error_are_counted() {
        assert_eq!(rises(&[Some(0.3), Some(0.7), Some(0.2), Some(0.21)]), 2);
        assert_eq!(rises(&[Some(0.3), None, Some(0.2)]), 0);
        assert_eq!(rises(&[Some(0.3), None, Some(0.4)]), 1);
    }

    #[test]
    fn coefficients_are_scored_by_their_own_std() {
        assert!(is_unknown(-9.0, 823.0) && is_unknown(1.0, f64::NAN));
        assert!(!is_unknown(-9.0, 1.0));
        assert_eq!(agree(&[195.0, 193.0]), Some(true));
        assert_eq!(agree(&[-0.011, -0.016]), Some(false));
        assert_eq!(agree(&[65.3]), None);
    }
}
