//! What coefficients are measured in: \[F\] ÷ \[feature\], in SI units.
//!
//! A coefficient times its feature is a force, so its unit is that of the excitation divided by the feature's
//! ([`Term::dimension`]): N/m³ for q³ where q is a length and F a force. In free motion the inertia's coefficient is 1,
//! and the others are relative to it: \[q\]/s² ÷ \[feature\]. Where a unit that it takes is not known, there is none.

use super::dimension::Dimension;
use super::inner::InnerUnit;
use super::term::Term;
use super::unit::{Channel, Quantity, Unit};
use serde::{Deserialize, Serialize};

/// Units that a model names for the columns that it reads, as written; `None` leaves it to the header.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ColumnUnits {
    /// Of time.
    pub t: Option<String>,
    /// Of the displacement.
    pub q: Option<String>,
    /// Of the velocity.
    pub qd: Option<String>,
    /// Of the excitation.
    #[serde(rename = "F")]
    pub excitation: Option<String>,
}

impl ColumnUnits {
    /// The unit of a channel as written.
    pub fn written(&self, channel: Channel) -> Option<&str> {
        match channel {
            Channel::Time => self.t.as_deref(),
            Channel::Displacement => self.q.as_deref(),
            Channel::Velocity => self.qd.as_deref(),
            Channel::Excitation => self.excitation.as_deref(),
        }
    }

    /// The unit of a channel.
    pub fn unit(&self, channel: Channel) -> Option<Unit> {
        self.written(channel).and_then(Unit::parse)
    }

    /// What they say of coefficients under a measured excitation.
    pub fn units(&self) -> Units {
        let quantity = |channel| self.unit(channel).map(|unit| unit.quantity);
        Units::forced(quantity(Channel::Displacement), quantity(Channel::Velocity), quantity(Channel::Excitation))
    }
}

/// What a law's coordinate and its right-hand side measure, where that is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Units {
    coordinate: Option<Quantity>,
    excitation: Option<Quantity>,
    /// Whether coefficients are relative to the inertia.
    free: bool,
}

/// A unit as a product of SI units.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SiUnit {
    /// As it is written, `N s/m`; `1` for a pure number.
    pub symbol: String,
    /// Exponents of kg, m, s, A, rad.
    pub exponents: [i8; 5],
}

impl Units {
    /// Of a law under an excitation. A displacement of unknown unit may follow from its velocity's.
    pub fn forced(displacement: Option<Quantity>, velocity: Option<Quantity>, excitation: Option<Quantity>) -> Units {
        let coordinate = displacement.or(velocity.and_then(Quantity::integral));
        Units { coordinate, excitation, free: false }
    }

    /// Of a law in free motion whose inertia is fixed to 1.
    pub fn free(displacement: Option<Quantity>, velocity: Option<Quantity>) -> Units {
        Units { free: true, ..Units::forced(displacement, velocity, None) }
    }

    /// What both agree on.
    pub fn common(self, other: Units) -> Units {
        if self.free != other.free {
            return Units::default();
        }
        let coordinate = self.coordinate.filter(|_| self.coordinate == other.coordinate);
        let excitation = self.excitation.filter(|_| self.excitation == other.excitation);
        Units { coordinate, excitation, free: self.free }
    }

    /// The unit of q.
    pub fn displacement(&self) -> Option<SiUnit> {
        self.power(Dimension::new(1, 0, 0))
    }

    /// The unit of q̇.
    pub fn velocity(&self) -> Option<SiUnit> {
        let rate = self.coordinate?.rate()?;
        Some(SiUnit { symbol: or_one(rate.symbol().into()), exponents: rate.exponents() })
            .filter(|_| rate != Quantity::Number)
            .or_else(|| self.power(Dimension::new(1, -1, 0)))
    }

    /// The unit of F.
    pub fn excitation(&self) -> Option<SiUnit> {
        self.power(Dimension::new(0, 0, 1))
    }

    /// The unit of an inner parameter.
    pub fn inner(&self, unit: InnerUnit) -> Option<SiUnit> {
        match unit {
            InnerUnit::Coordinate => self.displacement(),
            InnerUnit::Velocity => self.velocity(),
            InnerUnit::Time => self.power(Dimension::new(0, 1, 0)),
            InnerUnit::AngularFrequency => Some(SiUnit { symbol: "rad/s".into(), exponents: [0, 0, -1, 0, 1] }),
            InnerUnit::WaveNumber => self.power(Dimension::new(-1, 0, 0)),
            InnerUnit::Number => None,
        }
    }

    /// The unit of a term's coefficient.
    pub fn coefficient(&self, term: Term) -> Option<SiUnit> {
        let feature = term.dimension()?;
        let force = if self.free { Dimension::new(1, -2, 0) } else { Dimension::new(0, 0, 1) };
        self.power(Dimension {
            coordinate: force.coordinate - feature.coordinate,
            time: force.time - feature.time,
            excitation: force.excitation - feature.excitation,
        })
    }

    /// \[q\]^coordinate s^time \[F\]^excitation.
    fn power(&self, of: Dimension) -> Option<SiUnit> {
        let known = |quantity: Option<Quantity>, power: i8| if power == 0 { Some(Quantity::Number) } else { quantity };
        let coordinate = known(self.coordinate, of.coordinate)?;
        let excitation = known(self.excitation, of.excitation)?;
        let derived = derived(excitation, coordinate, of);
        let mut factors = Vec::new();
        let mut add =
            |quantity: Quantity, power: i8| multiply(&mut factors, quantity.symbol(), quantity.exponents(), power);
        match derived {
            Some((_, time)) => {
                add(excitation, of.excitation - 1);
                add(coordinate, of.coordinate + 1);
                add(Quantity::Time, of.time - time);
            }
            None => {
                add(excitation, of.excitation);
                add(Quantity::Time, of.time);
                add(coordinate, of.coordinate);
            }
        }
        let head = derived.map_or(&[][..], |(head, _)| head).iter().map(|(symbol, exponents, power)| Factor {
            symbol,
            exponents: *exponents,
            power: *power,
        });
        Some(product(&head.chain(factors).collect::<Vec<_>>()))
    }
}

/// The unit of a term's coefficient, as it is written: `N/m³`.
pub fn unit_of(term: Term, units: &Units) -> Option<String> {
    units.coefficient(term).map(|unit| unit.symbol)
}

#[derive(Clone, Copy)]
struct Factor<'a> {
    symbol: &'a str,
    exponents: [i8; 5],
    power: i8,
}

type Named = (&'static str, [i8; 5], i8);

/// Units with a name of their own for \[F\] s^n ÷ \[q\], and that n: kg and kg m² for an inertia, H and Ω.
fn derived(excitation: Quantity, coordinate: Quantity, of: Dimension) -> Option<(&'static [Named], i8)> {
    const KILOGRAM: Named = ("kg", [1, 0, 0, 0, 0], 1);
    if of.excitation < 1 || of.coordinate > -1 {
        return None;
    }
    let units: &'static [Named] = match (excitation, coordinate, of.time) {
        (Quantity::Force, Quantity::Length, 2) => &[KILOGRAM],
        (Quantity::Torque, Quantity::Angle, 2) => &[KILOGRAM, ("m", [0, 1, 0, 0, 0], 2)],
        (Quantity::Voltage, Quantity::Charge, 2) => &[("H", [1, 2, -2, -2, 0], 1)],
        (Quantity::Voltage, Quantity::Charge, 1) => &[("Ω", [1, 2, -3, -2, 0], 1)],
        _ => return None,
    };
    Some((units, of.time))
}

fn multiply<'a>(factors: &mut Vec<Factor<'a>>, symbol: &'a str, exponents: [i8; 5], power: i8) {
    match factors.iter_mut().find(|factor| factor.symbol == symbol) {
        Some(factor) => factor.power += power,
        None if symbol.is_empty() => {}
        None => factors.push(Factor { symbol, exponents, power }),
    }
}

fn product(factors: &[Factor]) -> SiUnit {
    let part = |sign: i8| {
        let chosen = factors.iter().filter(move |factor| factor.power * sign > 0);
        chosen.map(|factor| format!("{}{}", factor.symbol, superscript(factor.power.abs()))).collect::<Vec<_>>()
    };
    let numerator = or_one(part(1).join(" "));
    let symbol = match part(-1).as_slice() {
        [] => numerator,
        [one] => format!("{numerator}/{one}"),
        several => format!("{numerator}/({})", several.join(" ")),
    };
    let mut exponents = [0; 5];
    for factor in factors {
        exponents.iter_mut().zip(factor.exponents).for_each(|(sum, exponent)| *sum += exponent * factor.power);
    }
    SiUnit { symbol, exponents }
}

fn or_one(symbol: String) -> String {
    if symbol.is_empty() { "1".into() } else { symbol }
}

/// The power behind a unit, nothing for 1.
fn superscript(power: i8) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    if power == 1 {
        return String::new();
    }
    power.to_string().bytes().filter_map(|digit| DIGITS.get(usize::from(digit.wrapping_sub(b'0')))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::effect::Effect;

    fn of(displacement: Quantity, excitation: Quantity, terms: &[&str]) -> Vec<String> {
        let units = Units::forced(Some(displacement), None, Some(excitation));
        terms.iter().map(|term| unit_of(Term::parse(term).unwrap(), &units).unwrap()).collect()
    }

    const TERMS: [&str; 6] = ["inertia", "qd", "q", "q^3", "1", "F*q"];

    #[test]
    fn coefficients_have_the_units_of_the_field() {
        use Quantity::{Angle, Charge, Force, Length, Number, Torque, Voltage};
        assert_eq!(of(Length, Force, &TERMS), ["kg", "N s/m", "N/m", "N/m³", "N", "1/m"]);
        assert_eq!(of(Angle, Torque, &TERMS), ["kg m²", "Nm s/rad", "Nm/rad", "Nm/rad³", "Nm", "1/rad"]);
        assert_eq!(of(Charge, Voltage, &TERMS), ["H", "Ω", "V/C", "V/C³", "V", "1/C"]);
        assert_eq!(of(Voltage, Voltage, &TERMS), ["s²", "s", "1", "1/V²", "V", "1/V"]);
        assert_eq!(of(Number, Number, &TERMS), ["s²", "s", "1", "1", "1", "1"]);
        assert_eq!(of(Length, Voltage, &TERMS[..4]), ["V s²/m", "V s/m", "V/m", "V/m³"]);
    }

    #[test]
    fn effects_have_theirs() {
        let terms = [
            "quadratic_damping",
            "cubic_damping",
            "van_der_pol_damping",
            "coulomb_friction",
            "position_dependent_inertia",
            "pendulum_restoring",
            "hysteresis",
            "hidden_resonator",
            "excitation_delay",
            "excitation_gain_nonlinearity",
            "presliding_friction",
            "friction_with_backlash",
            "asymmetric_damping",
            "load_dependent_friction",
            "position_dependent_friction",
            "cogging",
            "relaxation",
            "actuator_lag",
        ];
        assert_eq!(
            of(Quantity::Length, Quantity::Force, &terms),
            [
                "kg/m",
                "N s³/m³",
                "N s/m³",
                "N",
                "kg/m²",
                "N",
                "N/m",
                "kg",
                "1",
                "1/N²",
                "N",
                "N",
                "N s/m",
                "1",
                "N/m²",
                "N",
                "N s/m",
                "1"
            ]
        );
        assert_eq!(of(Quantity::Charge, Quantity::Voltage, &terms[2..3]), ["Ω/C²"]);
    }

    /// Exponents say the same as dimensions: coefficient times feature is the excitation.
    #[test]
    fn exponents_balance() {
        let units = Units::forced(Some(Quantity::Length), None, Some(Quantity::Voltage));
        for term in Effect::ALL.map(Term::Effect).into_iter().chain(TERMS.map(|term| Term::parse(term).unwrap())) {
            let feature = units.power(term.dimension().unwrap()).unwrap().exponents;
            let coefficient = units.coefficient(term).unwrap().exponents;
            let force: Vec<i8> = feature.iter().zip(coefficient).map(|(one, other)| one + other).collect();
            assert_eq!(force, units.excitation().unwrap().exponents, "{term}");
        }
        let electrical = Units::forced(None, Some(Quantity::Current), Some(Quantity::Voltage));
        assert_eq!(electrical.coefficient(Term::Inertia).unwrap().exponents, [1, 2, -2, -2, 0]);
        assert_eq!(electrical.coefficient(Term::power(0, 1)).unwrap().exponents, [1, 2, -3, -2, 0]);
        assert_eq!(electrical.velocity().unwrap().symbol, "A");
    }

    #[test]
    fn free_motion_is_relative_to_the_inertia() {
        let known = Units::free(Some(Quantity::Length), None);
        let unknown = Units::free(None, None);
        let unit = |term: &str, units: &Units| unit_of(Term::parse(term).unwrap(), units);
        assert_eq!(["qdd", "q", "qd"].map(|term| unit(term, &unknown).unwrap()), ["1", "1/s²", "1/s"]);
        assert_eq!(["q^3", "1"].map(|term| unit(term, &known).unwrap()), ["1/(s² m²)", "m/s²"]);
        assert_eq!(unit("q^3", &unknown), None);
    }

    #[test]
    fn what_is_not_known_has_no_unit() {
        let half = Units::forced(Some(Quantity::Length), None, None);
        assert_eq!(unit_of(Term::power(1, 0), &half), None);
        assert_eq!(unit_of(Term::parse("F*q").unwrap(), &half).unwrap(), "1/m");
        assert_eq!(unit_of(Term::Expression(crate::law::own::Own::new(0, "x", false, &[])), &half), None);
        let whole = Units::forced(Some(Quantity::Length), None, Some(Quantity::Force));
        assert_eq!(whole.common(half), half);
        assert_eq!(whole.common(Units::free(Some(Quantity::Length), None)), Units::default());
    }
}
