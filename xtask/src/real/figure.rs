//! Figures with a floor: what is measured, what must be reached, and what is aimed at.

use super::table::{NONE, table};
use serde::Serialize;

/// A figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// What it is.
    pub name: String,
    /// As measured; none where nothing could be measured.
    pub value: Option<f64>,
    /// What must be reached; none: the figure is only shown.
    pub floor: Option<Bound>,
    /// What is aimed at.
    pub aim: Option<f64>,
}

/// A bound of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// The figure may not be above it.
    AtMost(f64),
    /// The figure may not be below it.
    AtLeast(f64),
}

impl Figure {
    /// A figure that may not be above its floor.
    pub fn at_most(name: &str, value: Option<f64>, floor: f64, aim: f64) -> Figure {
        Figure { name: name.into(), value, floor: Some(Bound::AtMost(floor)), aim: Some(aim) }
    }

    /// A figure that may not be below its floor.
    pub fn at_least(name: &str, value: Option<f64>, floor: f64, aim: f64) -> Figure {
        Figure { name: name.into(), value, floor: Some(Bound::AtLeast(floor)), aim: Some(aim) }
    }

    /// A figure without a floor.
    pub fn shown(name: &str, value: Option<f64>) -> Figure {
        Figure { name: name.into(), value, floor: None, aim: None }
    }

    /// Whether the floor is missed; a figure that could not be measured misses it.
    pub fn is_missed(&self) -> bool {
        let value = self.value.filter(|value| !value.is_nan());
        match (self.floor, value) {
            (None, _) => false,
            (Some(_), None) => true,
            (Some(Bound::AtMost(floor)), Some(value)) => value > floor,
            (Some(Bound::AtLeast(floor)), Some(value)) => value < floor,
        }
    }
}

/// The figures as a table.
pub fn figures(figures: &[Figure]) -> String {
    let number = |value: Option<f64>| {
        value.map_or(NONE.into(), |value| {
            format!("{:.4}", value).trim_end_matches('0').trim_end_matches('.').to_string()
        })
    };
    let row = |figure: &Figure| {
        let floor = match figure.floor {
            None => NONE.into(),
            Some(Bound::AtMost(floor)) => format!("≤ {}", number(Some(floor))),
            Some(Bound::AtLeast(floor)) => format!("≥ {}", number(Some(floor))),
        };
        let verdict = match figure.floor {
            None => "",
            Some(_) if figure.is_missed() => "missed",
            Some(_) => "reached",
        };
        vec![figure.name.clone(), number(figure.value), floor, number(figure.aim), verdict.into()]
    };
    table("figure | measured | floor | aim | ", &figures.iter().map(row).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_floor_is_missed_from_its_own_side() {
        assert!(Figure::at_most("x", Some(1.2), 1.15, 1.0).is_missed());
        assert!(!Figure::at_most("x", Some(1.15), 1.15, 1.0).is_missed());
        assert!(Figure::at_least("x", Some(10.0), 11.0, 12.0).is_missed());
        assert!(!Figure::at_least("x", Some(11.0), 11.0, 12.0).is_missed());
        assert!(Figure::at_least("x", None, 11.0, 12.0).is_missed(), "nothing measured is nothing reached");
        assert!(Figure::at_most("x", Some(f64::NAN), 1.0, 1.0).is_missed());
        assert!(!Figure::shown("x", None).is_missed());
    }

    #[test]
    fn figures_show_their_bounds() {
        let text = figures(&[Figure::at_most("x", Some(0.0447), 0.0447, 0.042), Figure::shown("y", Some(3.0))]);
        assert!(text.contains("| x | 0.0447 | ≤ 0.0447 | 0.042 | reached |"), "{text}");
        assert!(text.contains("| y | 3 | – | – |  |"), "{text}");
    }
}
