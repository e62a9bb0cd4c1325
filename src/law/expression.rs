//! A user's own effect: a formula in `q, qd, F, t` with named inner parameters.
//!
//! Functions: abs, sign (signum), sqrt, exp, ln (log), sin, cos, tan, atan, sinh, cosh, tanh, min(a, b), max(a, b); the constant pi; every
//! other name is an inner parameter. A power of a negative base needs a whole exponent: `abs(qd)^0.5`.

use super::formula::{Binary, FormulaError, Instruction, STACK, Unary, VARIABLES, parse};
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
        let variables = [q, qd, excitation, t];
        let mut stack = [0.0; STACK + 1];
        let mut top = 0;
        for instruction in &self.program {
            match instruction {
                Instruction::Number(number) => (stack[top], top) = (*number, top + 1),
                Instruction::Variable(index) => (stack[top], top) = (variables[usize::from(*index)], top + 1),
                Instruction::Parameter(index) => (stack[top], top) = (self.values[usize::from(*index)], top + 1),
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

fn unary(function: Unary, x: f64) -> f64 {
    match function {
        Unary::Negative => -x,
        Unary::Abs => x.abs(),
        Unary::Sign => super::pointwise::sign(x),
        Unary::Sqrt => x.sqrt(),
        Unary::Exp => x.exp(),
        Unary::Ln => x.ln(),
        Unary::Sin => x.sin(),
        Unary::Cos => x.cos(),
        Unary::Tan => x.tan(),
        Unary::Atan => x.atan(),
        Unary::Sinh => x.sinh(),
        Unary::Cosh => x.cosh(),
        Unary::Tanh => x.tanh(),
    }
}

fn binary(function: Binary, a: f64, b: f64) -> f64 {
    match function {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        Binary::Power => a.powf(b),
        Binary::Min => a.min(b),
        Binary::Max => a.max(b),
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
