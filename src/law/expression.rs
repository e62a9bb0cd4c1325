//! A user's own effect: a formula in `q, qd, F, t` with named inner parameters.
//!
//! Functions: abs, sign (signum), sqrt, exp, ln (log), sin, cos, tan, atan, sinh, cosh, tanh, min(a, b), max(a, b); the
//! constant pi; every other name is an inner parameter. A power of a negative base needs a whole exponent:
//! `abs(qd)^0.5`.

use super::formula::{Binary, FormulaError, Instruction, STACK, Unary, VARIABLES, parse};
use super::own::Own;
use serde::{Deserialize, Serialize};

/// A named formula with values of its inner parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Expression {
    name: String,
    text: String,
    parameters: Vec<String>,
    values: Vec<f64>,
    program: Vec<Instruction>,
}

impl Expression {
    /// The value of an inner parameter until it is set.
    pub const START: f64 = 1.0;

    /// Reads a formula; its inner parameters start at [`Expression::START`].
    ///
    /// # Errors
    /// [`FormulaError`] with the position at fault.
    pub fn parse(name: &str, text: &str) -> Result<Expression, FormulaError> {
        let (program, parameters) = parse(text)?;
        let values = vec![Expression::START; parameters.len()];
        Ok(Expression { name: name.into(), text: text.into(), parameters, values, program })
    }

    /// The user's name for it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The formula as written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Names of the inner parameters, in the order in which the formula has them.
    pub fn parameters(&self) -> &[String] {
        &self.parameters
    }

    /// Values of the inner parameters, in that order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Sets the inner parameters, in that order; those without a value stay.
    pub fn set(&mut self, values: &[f64]) {
        self.values.iter_mut().zip(values).for_each(|(own, value)| *own = *value);
    }

    /// Whether the formula has the variable `q`, `qd`, `F` or `t`.
    pub fn uses(&self, variable: &str) -> bool {
        let named = |instruction: &Instruction| match instruction {
            Instruction::Variable(index) => VARIABLES[usize::from(*index)] == variable,
            _ => false,
        };
        self.program.iter().any(named)
    }

    /// The value at (q, q̇, F, t); not finite where the formula has none.
    pub fn value(&self, q: f64, qd: f64, excitation: f64, t: f64) -> f64 {
        self.run([q, qd, excitation, t].map(Number::of), &self.values).value
    }

    /// The same with the inner parameters of a term that stands for it.
    pub fn value_of(&self, own: &Own, q: f64, qd: f64, excitation: f64, t: f64) -> f64 {
        self.run([q, qd, excitation, t].map(Number::of), &own.inner()).value
    }

    /// (∂/∂q, ∂/∂q̇) at (q, q̇, F); one-sided where the formula has a kink, 0 at the jump of a sign, NaN where it
    /// depends on time.
    pub fn gradient(&self, q: f64, qd: f64, excitation: f64) -> (f64, f64) {
        self.slopes(q, qd, excitation, &self.values)
    }

    /// The same with the inner parameters of a term that stands for it.
    pub fn gradient_of(&self, own: &Own, q: f64, qd: f64, excitation: f64) -> (f64, f64) {
        self.slopes(q, qd, excitation, &own.inner())
    }

    fn slopes(&self, q: f64, qd: f64, excitation: f64, inner: &[f64]) -> (f64, f64) {
        let along = |value: f64, slopes: [f64; 2]| Number { value, slopes };
        let variables =
            [along(q, [1.0, 0.0]), along(qd, [0.0, 1.0]), Number::of(excitation), along(f64::NAN, [f64::NAN; 2])];
        self.run(variables, inner).slopes.into()
    }

    #[inline]
    fn run(&self, variables: [Number; 4], inner: &[f64]) -> Number {
        let mut stack = [Number::of(0.0); STACK + 1];
        let mut top = 0;
        for instruction in &self.program {
            match instruction {
                Instruction::Number(number) => (stack[top], top) = (Number::of(*number), top + 1),
                Instruction::Variable(index) => (stack[top], top) = (variables[usize::from(*index)], top + 1),
                Instruction::Parameter(index) => {
                    (stack[top], top) =
                        (Number::of(inner.get(usize::from(*index)).copied().unwrap_or(f64::NAN)), top + 1)
                }
                Instruction::Unary(function) => stack[top - 1] = unary(*function, stack[top - 1]),
                Instruction::Binary(function) => {
                    top -= 1;
                    stack[top - 1] = binary(*function, stack[top - 1], stack[top]);
                }
            }
        }
        stack[0]
    }
}

/// A value and its derivatives by q and q̇: forward differentiation.
#[derive(Clone, Copy, Debug)]
struct Number {
    value: f64,
    slopes: [f64; 2],
}

impl Number {
    const fn of(value: f64) -> Number {
        Number { value, slopes: [0.0; 2] }
    }

    /// A function's value here, with its derivative.
    fn through(self, value: f64, derivative: f64) -> Number {
        Number { value, slopes: self.slopes.map(|slope| chained(derivative, slope)) }
    }

    /// The same of two numbers.
    fn with(self, other: Number, value: f64, [by_self, by_other]: [f64; 2]) -> Number {
        let slope = |place: usize| chained(by_self, self.slopes[place]) + chained(by_other, other.slopes[place]);
        Number { value, slopes: [slope(0), slope(1)] }
    }
}

/// A derivative times a slope; what does not move has no slope, however steep the function is there.
fn chained(derivative: f64, slope: f64) -> f64 {
    if slope == 0.0 { 0.0 } else { derivative * slope }
}

fn unary(function: Unary, number: Number) -> Number {
    let x = number.value;
    let sign = super::pointwise::sign;
    let (value, derivative) = match function {
        Unary::Negative => (-x, -1.0),
        Unary::Abs => (x.abs(), sign(x)),
        Unary::Sign => (sign(x), 0.0),
        Unary::Sqrt => (x.sqrt(), 0.5 / x.sqrt()),
        Unary::Exp => (x.exp(), x.exp()),
        Unary::Ln => (x.ln(), x.recip()),
        Unary::Sin => (x.sin(), x.cos()),
        Unary::Cos => (x.cos(), -x.sin()),
        Unary::Tan => (x.tan(), 1.0 + x.tan().powi(2)),
        Unary::Atan => (x.atan(), (1.0 + x * x).recip()),
        Unary::Sinh => (x.sinh(), x.cosh()),
        Unary::Cosh => (x.cosh(), x.sinh()),
        Unary::Tanh => (x.tanh(), 1.0 - x.tanh().powi(2)),
    };
    number.through(value, derivative)
}

fn binary(function: Binary, first: Number, second: Number) -> Number {
    let (a, b) = (first.value, second.value);
    match function {
        Binary::Add => first.with(second, a + b, [1.0, 1.0]),
        Binary::Subtract => first.with(second, a - b, [1.0, -1.0]),
        Binary::Multiply => first.with(second, a * b, [b, a]),
        Binary::Divide => first.with(second, a / b, [b.recip(), -a / (b * b)]),
        Binary::Power => first.with(second, a.powf(b), [b * a.powf(b - 1.0), a.powf(b) * a.ln()]),
        Binary::Min => first.with(second, a.min(b), if a <= b { [1.0, 0.0] } else { [0.0, 1.0] }),
        Binary::Max => first.with(second, a.max(b), if a >= b { [1.0, 0.0] } else { [0.0, 1.0] }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        Expression::parse("x", text).unwrap().value(0.7, -1.2, 0.4, 3.0)
    }

    #[test]
    fn formulas_have_the_values_of_algebra() {
        let (q, qd, excitation, t) = (0.7_f64, -1.2_f64, 0.4_f64, 3.0_f64);
        for (text, expected) in [
            ("-q^2", -(q * q)),
            ("2^3^2", 512.0),
            ("2^-1*q", 0.5 * q),
            ("q - qd - F", q - qd - excitation),
            ("q/qd/F*t", q / qd / excitation * t),
            (" ( q + qd ) * -t ", (q + qd) * -t),
            ("abs(qd)^0.5*qd", qd.abs().sqrt() * qd),
            ("max(q, qd) + min(q,qd)/2", q + qd / 2.0),
            ("sign(qd)*(1 - exp(-abs(qd)/0.1))", -(1.0 - (-12.0_f64).exp())),
            ("signum(q-q) + cos(pi*t)", -1.0),
            ("1.5e-1 + .5 + 2E2", 200.65),
            ("--q", q),
            ("tanh(sinh(q)) + ln(exp(q))", q.sinh().tanh() + q),
        ] {
            let found = value(text);
            assert!((found - expected).abs() < 1e-12, "{text}: {found} against {expected}");
        }
    }

    #[test]
    fn gradients_are_those_of_the_values() {
        let eps = 1e-6;
        for text in [
            "abs(qd)^1.5*sign(qd)*q",
            "max(q, qd)^2 - min(q, 0.1)/(1 + qd^2)",
            "tanh(3*q)*exp(-abs(qd)/0.4) + sqrt(q^2 + 1)",
            "sin(q)*cos(qd)*F + tan(q/2) + atan(qd) + ln(2 + q) + sinh(q)*cosh(qd)",
            "2^q - -qd^3 + q^0*pi",
        ] {
            let own = Expression::parse("x", text).unwrap();
            for (q, qd) in [(0.7, -1.2), (-0.4, 0.3), (0.2, 0.9)] {
                let (by_q, by_qd) = own.gradient(q, qd, 0.4);
                let at = |q: f64, qd: f64| own.value(q, qd, 0.4, f64::NAN);
                let differences = [at(q + eps, qd) - at(q - eps, qd), at(q, qd + eps) - at(q, qd - eps)];
                for (slope, difference) in [by_q, by_qd].into_iter().zip(differences) {
                    assert!((slope - difference / (2.0 * eps)).abs() < 1e-7, "{text} at {q}, {qd}: {slope}");
                }
            }
        }
        let drag = Expression::parse("x", "abs(qd)^1.5*sign(qd)").unwrap();
        assert_eq!(drag.gradient(0.3, 0.0, 0.0), (0.0, 0.0));
        assert!(Expression::parse("x", "q*t").unwrap().gradient(1.0, 1.0, 1.0).0.is_nan());
    }

    #[test]
    fn other_names_are_parameters_in_their_order() {
        let mut drag = Expression::parse("drag", "b*abs(qd/v)^0.5*qd + b").unwrap();
        assert_eq!(drag.parameters(), ["b", "v"]);
        drag.set(&[2.0, 0.25]);
        assert_eq!(drag.value(0.0, 1.0, 0.0, 0.0), 6.0);
        assert!(drag.uses("qd") && !drag.uses("t") && !drag.uses("q"));
    }

    #[test]
    fn mistakes_are_refused_at_their_position() {
        for (text, position, named) in [
            ("", 1, "the end"),
            ("q +", 4, "the end"),
            ("q * * 2", 5, "\"*\""),
            ("abs(q", 6, "\")\""),
            ("q)", 2, "an operator"),
            ("1 + foo(q)", 5, "\"foo\" is no function"),
            ("max(q)", 6, "second value"),
            ("1.2.3*q", 1, "1.2.3"),
            ("q² + 1", 2, "\"²\""),
            ("2 q", 3, "an operator"),
        ] {
            let message = Expression::parse("x", text).unwrap_err().to_string();
            assert!(
                message.starts_with(&format!("at position {position}:")) && message.contains(named),
                "{text}: {message}"
            );
        }
        for deep in ["(".repeat(5000), "-".repeat(5000), "1+(".repeat(40), "q^".repeat(5000)] {
            assert!(Expression::parse("x", &deep).is_err());
        }
    }
}
