//! Units that a recording's header or a model may name, and what they are in SI.

use serde::{Deserialize, Serialize};

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Quantity {
    /// s.
    Time,
    /// m.
    Length,
    /// rad.
    Angle,
    /// C.
    Charge,
    /// V.
    Voltage,
    /// m/s.
    Speed,
    /// rad/s.
    AngularSpeed,
    /// A.
    Current,
    /// V/s.
    VoltageRate,
    /// N.
    Force,
    /// Nm.
    Torque,
    /// 1.
    Number,
}

impl Quantity {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Time => "time",
            Quantity::Length => "length",
            Quantity::Angle => "angle",
            Quantity::Charge => "charge",
            Quantity::Voltage => "voltage",
            Quantity::Speed => "speed",
            Quantity::AngularSpeed => "angular speed",
            Quantity::Current => "current",
            Quantity::VoltageRate => "rate of voltage",
            Quantity::Force => "force",
            Quantity::Torque => "torque",
            Quantity::Number => "pure number",
        }
    }

    /// What its rate of change measures.
    pub fn rate(self) -> Option<Quantity> {
        match self {
            Quantity::Length => Some(Quantity::Speed),
            Quantity::Angle => Some(Quantity::AngularSpeed),
            Quantity::Charge => Some(Quantity::Current),
            Quantity::Voltage => Some(Quantity::VoltageRate),
            Quantity::Number => Some(Quantity::Number),
            _ => None,
        }
    }

    /// What it is the rate of change of.
    pub fn integral(self) -> Option<Quantity> {
        let all = [Quantity::Length, Quantity::Angle, Quantity::Charge, Quantity::Voltage, Quantity::Number];
        all.into_iter().find(|quantity| quantity.rate() == Some(self))
    }

    /// Its SI unit; empty for a pure number.
    pub fn symbol(self) -> &'static str {
        let units = UNITS.iter().filter(|unit| unit.quantity == self && unit.factor == 1.0);
        units.map(|unit| unit.name).next().filter(|name| *name != "1").unwrap_or_default()
    }

    /// Exponents of kg, m, s, A, rad in its SI unit.
    pub fn exponents(self) -> [i8; 5] {
        match self {
            Quantity::Time => [0, 0, 1, 0, 0],
            Quantity::Length => [0, 1, 0, 0, 0],
            Quantity::Angle => [0, 0, 0, 0, 1],
            Quantity::Charge => [0, 0, 1, 1, 0],
            Quantity::Voltage => [1, 2, -3, -1, 0],
            Quantity::Speed => [0, 1, -1, 0, 0],
            Quantity::AngularSpeed => [0, 0, -1, 0, 1],
            Quantity::Current => [0, 0, 0, 1, 0],
            Quantity::VoltageRate => [1, 2, -4, -1, 0],
            Quantity::Force => [1, 1, -2, 0, 0],
            Quantity::Torque => [1, 2, -2, 0, 0],
            Quantity::Number => [0; 5],
        }
    }
}

/// A unit: what it measures, and how many SI units it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Its spelling.
    pub name: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// SI units per unit.
    pub factor: f64,
}

const fn unit(name: &'static str, quantity: Quantity, factor: f64) -> Unit {
    Unit { name, quantity, factor }
}

/// One degree, rad.
const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// One revolution, rad.
const TURN: f64 = 2.0 * std::f64::consts::PI;

const UNITS: [Unit; 51] = [
    unit("s", Quantity::Time, 1.0),
    unit("ms", Quantity::Time, 1e-3),
    unit("us", Quantity::Time, 1e-6),
    unit("ns", Quantity::Time, 1e-9),
    unit("min", Quantity::Time, 60.0),
    unit("h", Quantity::Time, 3600.0),
    unit("m", Quantity::Length, 1.0),
    unit("cm", Quantity::Length, 1e-2),
    unit("mm", Quantity::Length, 1e-3),
    unit("um", Quantity::Length, 1e-6),
    unit("nm", Quantity::Length, 1e-9),
    unit("in", Quantity::Length, 0.0254),
    unit("ft", Quantity::Length, 0.3048),
    unit("rad", Quantity::Angle, 1.0),
    unit("mrad", Quantity::Angle, 1e-3),
    unit("deg", Quantity::Angle, DEGREE),
    unit("rev", Quantity::Angle, TURN),
    unit("C", Quantity::Charge, 1.0),
    unit("mC", Quantity::Charge, 1e-3),
    unit("uC", Quantity::Charge, 1e-6),
    unit("As", Quantity::Charge, 1.0),
    unit("V", Quantity::Voltage, 1.0),
    unit("mV", Quantity::Voltage, 1e-3),
    unit("uV", Quantity::Voltage, 1e-6),
    unit("kV", Quantity::Voltage, 1e3),
    unit("m/s", Quantity::Speed, 1.0),
    unit("cm/s", Quantity::Speed, 1e-2),
    unit("mm/s", Quantity::Speed, 1e-3),
    unit("um/s", Quantity::Speed, 1e-6),
    unit("in/s", Quantity::Speed, 0.0254),
    unit("ft/s", Quantity::Speed, 0.3048),
    unit("km/h", Quantity::Speed, 1.0 / 3.6),
    unit("rad/s", Quantity::AngularSpeed, 1.0),
    unit("mrad/s", Quantity::AngularSpeed, 1e-3),
    unit("deg/s", Quantity::AngularSpeed, DEGREE),
    unit("rpm", Quantity::AngularSpeed, TURN / 60.0),
    unit("A", Quantity::Current, 1.0),
    unit("mA", Quantity::Current, 1e-3),
    unit("uA", Quantity::Current, 1e-6),
    unit("V/s", Quantity::VoltageRate, 1.0),
    unit("mV/s", Quantity::VoltageRate, 1e-3),
    unit("N", Quantity::Force, 1.0),
    unit("mN", Quantity::Force, 1e-3),
    unit("uN", Quantity::Force, 1e-6),
    unit("kN", Quantity::Force, 1e3),
    unit("MN", Quantity::Force, 1e6),
    unit("lbf", Quantity::Force, 4.448_221_615_260_5),
    unit("Nm", Quantity::Torque, 1.0),
    unit("mNm", Quantity::Torque, 1e-3),
    unit("1", Quantity::Number, 1.0),
    unit("-", Quantity::Number, 1.0),
];

impl Unit {
    /// Whether it is another unit, whatever the spelling.
    pub fn is_not(self, other: Unit) -> bool {
        self.quantity != other.quantity || self.factor != other.factor
    }

    /// The unit of that spelling: `mm/s`, `mm s^-1`, `mm_per_s`, `N m`, `N·m`, `µm`, `°`.
    pub fn parse(text: &str) -> Option<Unit> {
        let plain = text.trim().replace(['µ', 'μ'], "u").replace('°', "deg");
        let plain = plain.replace("_per_", "/").replace(" per ", "/").replace(" s^-1", "/s").replace("*s^-1", "/s");
        let plain: String = plain.chars().filter(|c| !matches!(c, ' ' | '·' | '*' | '.')).collect();
        UNITS.into_iter().find(|unit| unit.name == plain)
    }
}

/// What a column may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// t.
    Time,
    /// q.
    Displacement,
    /// q̇.
    Velocity,
    /// F.
    Excitation,
}

impl Channel {
    /// Every channel, in the order t, q, qd, F.
    pub const ALL: [Channel; 4] = [Channel::Time, Channel::Displacement, Channel::Velocity, Channel::Excitation];

    /// Its name in model files, which is its column's default name.
    pub fn name(self) -> &'static str {
        match self {
            Channel::Time => "t",
            Channel::Displacement => "q",
            Channel::Velocity => "qd",
            Channel::Excitation => "F",
        }
    }

    /// What it is, in words.
    pub fn meaning(self) -> &'static str {
        match self {
            Channel::Time => "a time",
            Channel::Displacement => "a displacement (length, angle, charge or raw voltage)",
            Channel::Velocity => "a velocity (speed, angular speed, current or rate of a voltage)",
            Channel::Excitation => "an excitation (force, torque or voltage)",
        }
    }

    /// Whether it may measure that.
    pub fn accepts(self, quantity: Quantity) -> bool {
        use Quantity as Q;
        match self {
            Channel::Time => quantity == Q::Time,
            Channel::Displacement => matches!(quantity, Q::Length | Q::Angle | Q::Charge | Q::Voltage | Q::Number),
            Channel::Velocity => {
                matches!(quantity, Q::Speed | Q::AngularSpeed | Q::Current | Q::VoltageRate | Q::Number)
            }
            Channel::Excitation => matches!(quantity, Q::Force | Q::Torque | Q::Voltage | Q::Number),
        }
    }

    /// The units it may have, for a message.
    pub fn known_units(self) -> String {
        let names = UNITS.iter().filter(|unit| self.accepts(unit.quantity)).map(|unit| unit.name);
        names.collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_one_unit_agree() {
        let spellings = ["mm/s", "mm s^-1", "mm_per_s", " mm / s ", "mm per s"];
        for text in spellings {
            let unit = Unit::parse(text).unwrap();
            assert_eq!((unit.quantity, unit.factor), (Quantity::Speed, 1e-3), "{text}");
        }
        assert_eq!(Unit::parse("N m"), Unit::parse("N·m"));
        assert_eq!(Unit::parse("µm").unwrap().factor, 1e-6);
        assert_eq!(Unit::parse("°").unwrap().factor, DEGREE);
        assert_eq!(Unit::parse("furlong"), None);
        assert_ne!(Unit::parse("mN"), Unit::parse("MN"));
    }

    #[test]
    fn rates_and_integrals_are_inverse() {
        for quantity in UNITS.map(|unit| unit.quantity) {
            let rate = quantity.rate();
            assert!(rate.is_none_or(|rate| rate.integral() == Some(quantity)), "{quantity:?}");
            let mut exponents = quantity.exponents();
            exponents[2] -= 1;
            assert!(rate.is_none_or(|rate| rate == Quantity::Number || rate.exponents() == exponents), "{quantity:?}");
        }
    }

    #[test]
    fn every_unit_serves_a_channel() {
        for unit in UNITS {
            assert!(Channel::ALL.iter().any(|channel| channel.accepts(unit.quantity)), "{}", unit.name);
        }
    }
}
