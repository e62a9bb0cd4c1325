//! A place of failure in words.

use super::locate::{Bounds, Fail, Over};
use crate::law::Units;
use crate::law::numerals::digits;

/// A magnitude's region that begins at this part of its upper end begins at zero, but for where the plant stands still.
const NEAR_ZERO: f64 = 0.1;

/// Share of the motion's frequency by which a band may miss a multiple of it.
const NEAR: f64 = 0.15;

impl Fail {
    /// One plain sentence; `source` names its recording where there are several, `period` is the displacement's, s.
    pub fn sentence(&self, source: Option<&str>, period: f64, units: &Units) -> String {
        let share = (100.0 * self.share).round();
        let spent = (100.0 * self.time_share).round().max(1.0);
        let (place, reason) = (self.place(units), self.reason(period));
        let of = if self.over == Over::Frequency { "of the force" } else { "of the time" };
        let where_from =
            source.filter(|_| self.recording.is_some()).map_or_else(String::new, |name| format!(" of {name}"));
        format!("{share} % of the error lies {place}{where_from} ({spent} % {of}): {reason}")
    }

    fn place(&self, units: &Units) -> String {
        match self.over {
            Over::Time => self.bounds.time(),
            Over::Frequency => self.bounds.band(),
            Over::PhasePlane => {
                let [q, qd] = [(Over::Displacement, self.bounds), (Over::Velocity, self.velocity)];
                format!("{} and {}", q.1.text(q.0, units), qd.1.text(qd.0, units))
            }
            over => self.bounds.text(over, units),
        }
    }

    fn reason(&self, period: f64) -> String {
        let Bounds { lower, upper } = match self.over {
            Over::Speed | Over::Excursion | Over::Amplitude => self.bounds.reaching_zero(),
            _ => self.bounds,
        };
        let three = |low: &str, high: &str, middle: &str| match (lower, upper) {
            (None, Some(_)) => low.to_string(),
            (Some(_), None) => high.to_string(),
            _ => middle.to_string(),
        };
        match self.over {
            Over::Time => three("at the beginning", "towards the end", "in one interval of time"),
            Over::Displacement => three("on the negative side", "on the positive side", "at one position"),
            Over::Excursion => three("near the middle position", "at large excursions to both sides", "off the middle"),
            Over::Velocity => self.direction(),
            Over::Speed => three("around velocity reversals", "at high speed", "at medium speed"),
            Over::Amplitude => three(
                "while the vibration is small",
                "while the vibration is large",
                "while the vibration has medium amplitude",
            ),
            Over::Frequency => self.multiple(period),
            Over::PhasePlane => "in one corner of the phase plane".into(),
        }
    }

    fn direction(&self) -> String {
        match (self.bounds.lower, self.bounds.upper) {
            (Some(lower), _) if lower >= 0.0 => "while moving in the positive direction".into(),
            (_, Some(upper)) if upper <= 0.0 => "while moving in the negative direction".into(),
            (Some(_), Some(_)) => "around velocity reversals".into(),
            _ => "more in one direction than in the other".into(),
        }
    }

    /// Which multiple of the motion's frequency lies in the band.
    fn multiple(&self, period: f64) -> String {
        let frequency = period.recip();
        let (lower, upper) = (self.bounds.lower.unwrap_or(0.0), self.bounds.upper.unwrap_or(f64::INFINITY));
        let inside = |multiple: f64| lower < (multiple + NEAR) * frequency && (multiple - NEAR) * frequency < upper;
        let shown = digits(frequency, 3);
        match () {
            () if self.bounds.upper.is_none() => "at the high frequencies".into(),
            () if inside(1.0) => format!("around the frequency of the motion, {shown} Hz"),
            () if upper < frequency => format!("slower than the motion, which is near {shown} Hz"),
            () if inside(2.0) => format!("around twice the frequency of the motion, {shown} Hz"),
            () if inside(3.0) => format!("around three times the frequency of the motion, {shown} Hz"),
            () => format!("faster than the motion, which is near {shown} Hz"),
        }
    }
}

impl Over {
    fn symbol(self) -> &'static str {
        match self {
            Over::Time => "t",
            Over::Displacement | Over::PhasePlane => "q",
            Over::Excursion => "|q − mean|",
            Over::Velocity => "q̇",
            Over::Speed => "|q̇|",
            Over::Amplitude => "amplitude",
            Over::Frequency => "frequency",
        }
    }

    /// Its unit with a space before it; nothing where it is not known.
    fn unit(self, units: &Units) -> String {
        let unit = match self {
            Over::Velocity | Over::Speed => units.velocity(),
            _ => units.displacement(),
        };
        unit.filter(|unit| unit.symbol != "1").map_or_else(String::new, |unit| format!(" {}", unit.symbol))
    }
}

impl Bounds {
    fn reaching_zero(self) -> Bounds {
        let near_zero = |lower: &f64| self.upper.is_some_and(|upper| *lower < NEAR_ZERO * upper);
        Bounds { lower: self.lower.filter(|lower| !near_zero(lower)), ..self }
    }

    pub(super) fn text(self, over: Over, units: &Units) -> String {
        let (name, unit) = (over.symbol(), over.unit(units));
        match (self.lower.map(shown), self.upper.map(shown)) {
            (None, Some(upper)) => format!("within {name} < {upper}{unit}"),
            (Some(lower), None) => format!("at {name} > {lower}{unit}"),
            (Some(lower), Some(upper)) => format!("within {lower}{unit} < {name} < {upper}{unit}"),
            (None, None) => format!("at every {name}"),
        }
    }

    fn time(self) -> String {
        match (self.lower.map(shown), self.upper.map(shown)) {
            (None, Some(upper)) => format!("before t = {upper} s"),
            (Some(lower), None) => format!("after t = {lower} s"),
            (Some(lower), Some(upper)) => format!("between t = {lower} s and {upper} s"),
            (None, None) => "at every time".into(),
        }
    }

    fn band(self) -> String {
        match (self.lower.map(shown), self.upper.map(shown)) {
            (None, Some(upper)) => format!("below {upper} Hz"),
            (Some(lower), None) => format!("above {lower} Hz"),
            (Some(lower), Some(upper)) => format!("between {lower} and {upper} Hz"),
            (None, None) => "at every frequency".into(),
        }
    }
}

/// A bound: three significant digits.
fn shown(value: f64) -> String {
    digits(value, 3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::ColumnUnits;

    #[test]
    fn a_sentence_says_what_its_bounds_are_measured_in() {
        let fail = Fail {
            over: Over::Speed,
            bounds: Bounds { lower: None, upper: Some(0.02) },
            velocity: Bounds::default(),
            recording: None,
            share: 0.63,
            time_share: 0.1,
            evidence: 9.0,
        };
        let written = ColumnUnits { q: Some("mm".into()), excitation: Some("N".into()), ..ColumnUnits::default() };
        let sentence = "63 % of the error lies within |q̇| < 0.0200 m/s (10 % of the time): around velocity reversals";
        assert_eq!(fail.sentence(None, 1.0, &written.units()), sentence);
        assert_eq!(fail.sentence(None, 1.0, &Units::default()), sentence.replace(" m/s", ""));
        let but_for_rest = Bounds { lower: Some(0.001), ..fail.bounds };
        assert_eq!(Fail { bounds: but_for_rest, ..fail }.reason(1.0), "around velocity reversals");
        let medium = Bounds { lower: Some(0.01), ..fail.bounds };
        assert_eq!(Fail { bounds: medium, ..fail }.reason(1.0), "at medium speed");
    }
}
