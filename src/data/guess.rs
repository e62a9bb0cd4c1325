//! Which column may be which quantity where nobody says so: by its name, its unit, or its numbers.

use crate::law::{Channel, Columns};

/// Names that columns of that quantity go by, lower case.
fn names(channel: Channel) -> &'static [&'static str] {
    match channel {
        Channel::Time => &[
            "t",
            "time",
            "zeit",
            "timestamp",
            "time stamp",
            "datetime",
            "date time",
            "date/time",
            "elapsed",
            "elapsed time",
            "elapsed_time",
            "seconds",
            "sec",
            "x_value",
            "x-value",
            "temps",
            "tempo",
            "uhrzeit",
            "zeitstempel",
        ],
        Channel::Displacement => &[
            "q",
            "x",
            "pos",
            "position",
            "displacement",
            "disp",
            "deflection",
            "weg",
            "auslenkung",
            "verschiebung",
            "angle",
            "theta",
            "phi",
            "winkel",
            "charge",
            "ladung",
            "déplacement",
            "deplacement",
            "stroke",
            "output",
        ],
        Channel::Velocity => &[
            "qd",
            "qdot",
            "q_dot",
            "dq",
            "v",
            "vel",
            "velocity",
            "speed",
            "xdot",
            "xd",
            "dx",
            "geschwindigkeit",
            "omega",
            "vitesse",
            "angular velocity",
            "winkelgeschwindigkeit",
            "drehzahl",
        ],
        Channel::Excitation => &[
            "f",
            "force",
            "kraft",
            "load",
            "excitation",
            "anregung",
            "torque",
            "moment",
            "drehmoment",
            "input",
            "u",
            "effort",
            "motor force",
            "motor torque",
            "tau",
        ],
    }
}

/// Whether a column of that name, without its unit, is likely to hold the quantity.
pub(super) fn is_named(channel: Channel, name: &str) -> bool {
    names(channel).contains(&name.trim().to_lowercase().as_str())
}

/// Correlation of a column with another one's rate from which it is its derivative.
const ALIKE: f64 = 0.9;

/// Columns without names, told apart by their numbers: time increases, a velocity is the derivative of a displacement,
/// and what is left is the excitation. None where that does not tell.
pub(super) fn by_content(columns: &[Vec<f64>]) -> Option<Columns> {
    let name = |index: usize| Some((index + 1).to_string());
    let rises = |values: &[f64]| values.len() > 2 && values.windows(2).all(|pair| pair[1] > pair[0]);
    let time = columns.iter().position(|values| rises(values))?;
    // readings may be missing, but not most of them
    let moving = |values: &[f64]| {
        let numbers = || values.iter().filter(|value| value.is_finite());
        2 * numbers().count() > values.len() && numbers().any(|value| numbers().next() != Some(value))
    };
    let others: Vec<usize> = (0..columns.len()).filter(|index| *index != time && moving(&columns[*index])).collect();
    let named = Columns { t: name(time), ..Columns::default() };
    if let [only] = others[..] {
        return Some(Columns { q: name(only), ..named });
    }
    let pairs = others.iter().flat_map(|q| others.iter().filter(move |qd| *qd != q).map(move |qd| (*q, *qd)));
    let alike = pairs.map(|(q, qd)| (likeness(&columns[time], &columns[q], &columns[qd]), q, qd));
    let (_, q, qd) = alike.filter(|(likeness, ..)| *likeness > ALIKE).max_by(|a, b| a.0.total_cmp(&b.0))?;
    let mut left = others.iter().filter(|index| **index != q && **index != qd);
    let excitation = left.next().copied();
    left.next().is_none().then(|| Columns { q: name(q), qd: name(qd), excitation: excitation.and_then(name), ..named })
}

/// Correlation of the central differences of q with q̇.
fn likeness(t: &[f64], q: &[f64], qd: &[f64]) -> f64 {
    let count = t.len().min(q.len()).min(qd.len());
    let pairs = (1..count.saturating_sub(1)).map(|at| ((q[at + 1] - q[at - 1]) / (t[at + 1] - t[at - 1]), qd[at]));
    let [mut xy, mut xx, mut yy] = [0.0; 3];
    for (x, y) in pairs.filter(|(x, y)| x.is_finite() && y.is_finite()) {
        xy += x * y;
        xx += x * x;
        yy += y * y;
    }
    xy / (xx * yy).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_without_names_are_told_by_their_numbers() {
        let of = |f: fn(f64) -> f64| (0..500).map(|n| f(0.01 * f64::from(n))).collect::<Vec<f64>>();
        let [t, q, qd, force] =
            [of(|t| t), of(|t| (3.0 * t).sin()), of(|t| 3.0 * (3.0 * t).cos()), of(|t| (7.0 * t).cos())];
        let found = by_content(&[t.clone(), force.clone(), qd.clone(), q.clone()]).unwrap();
        assert_eq!(found.t.as_deref(), Some("1"));
        assert_eq!(
            (found.q.as_deref(), found.qd.as_deref(), found.excitation.as_deref()),
            (Some("4"), Some("3"), Some("2"))
        );
        let mut lacking = q.clone();
        lacking[100..300].fill(f64::NAN);
        let found = by_content(&[t.clone(), force.clone(), qd, lacking]).unwrap();
        assert_eq!([found.q, found.qd, found.excitation], ["4", "3", "2"].map(|name| Some(name.to_string())));
        assert_eq!(by_content(&[t, q, force]), None);
    }
}
