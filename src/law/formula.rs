//! Reading a formula in `q, qd, F, t` and named parameters into a program for a stack.
//!
//! `sum = product {± product}`, `product = signed {× ÷ signed}`, `signed = [−] power`, `power = atom [^ signed]`, so
//! that `-q^2` is −(q²) and `2^3^2` is 2^(3²).

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Values that a program may have on its stack at once: what a formula of 24 open operands needs, in an array without
/// allocation.
pub(super) const STACK: usize = 24;

/// The most inner parameters of an expression: more than any record determines beside the coefficients.
const MAX_PARAMETERS: usize = super::own::Own::MAX_INNER;

/// How deep parentheses, signs and powers may nest, so that no text overflows the parser's recursion.
const NESTING: usize = 60;

/// What a formula may name besides its parameters.
pub(super) const VARIABLES: [&str; 4] = ["q", "qd", "F", "t"];

/// A function of one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Unary {
    Negative,
    Abs,
    Sign,
    Sqrt,
    Exp,
    Ln,
    Sin,
    Cos,
    Tan,
    Atan,
    Sinh,
    Cosh,
    Tanh,
}

/// A function of two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
}

/// One instruction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Instruction {
    Number(f64),
    Variable(u8),
    Parameter(u8),
    Unary(Unary),
    Binary(Binary),
}

const UNARY: [(&str, Unary); 14] = [
    ("abs", Unary::Abs),
    ("sign", Unary::Sign),
    ("signum", Unary::Sign),
    ("sqrt", Unary::Sqrt),
    ("exp", Unary::Exp),
    ("ln", Unary::Ln),
    ("log", Unary::Ln),
    ("sin", Unary::Sin),
    ("cos", Unary::Cos),
    ("tan", Unary::Tan),
    ("atan", Unary::Atan),
    ("sinh", Unary::Sinh),
    ("cosh", Unary::Cosh),
    ("tanh", Unary::Tanh),
];

const BINARY: [(&str, Binary); 2] = [("min", Binary::Min), ("max", Binary::Max)];

/// Why a formula is refused; positions count characters from 1.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FormulaError {
    /// Something else should stand there.
    #[error("at position {position}: expected {expected}, found {found}")]
    Expected {
        /// Where.
        position: usize,
        /// What should stand there.
        expected: &'static str,
        /// What stands there.
        found: String,
    },
    /// A name in front of parentheses that is no function.
    #[error("at position {position}: \"{name}\" is no function: there are {}", known_functions())]
    Function {
        /// Where.
        position: usize,
        /// The name.
        name: String,
    },
    /// Parentheses, powers or operands nested too deep, or too many parameters.
    #[error(
        "at position {position}: the formula is too large: at most 6 parameters, 24 open operands, 60 levels of nesting"
    )]
    TooLarge {
        /// Where.
        position: usize,
    },
}

fn known_functions() -> String {
    UNARY.iter().map(|(name, _)| *name).chain(BINARY.iter().map(|(name, _)| *name)).collect::<Vec<_>>().join(", ")
}

/// A formula's program and the names of its parameters, in the order in which they occur.
pub(super) fn parse(text: &str) -> Result<(Vec<Instruction>, Vec<String>), FormulaError> {
    let characters: Vec<char> = text.chars().collect();
    let mut parser =
        Parser { characters: &characters, at: 0, program: Vec::new(), parameters: Vec::new(), stack: 0, nesting: 0 };
    parser.sum()?;
    match parser.peek() {
        None => Ok((parser.program, parser.parameters)),
        Some(_) => Err(parser.expected("an operator or the end")),
    }
}

struct Parser<'a> {
    characters: &'a [char],
    at: usize,
    program: Vec<Instruction>,
    parameters: Vec<String>,
    stack: usize,
    nesting: usize,
}

impl Parser<'_> {
    /// The next character that is no space.
    fn peek(&mut self) -> Option<char> {
        while self.characters.get(self.at).is_some_and(|letter| letter.is_whitespace()) {
            self.at += 1;
        }
        self.characters.get(self.at).copied()
    }

    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        self.at += usize::from(found);
        found
    }

    fn expected(&mut self, expected: &'static str) -> FormulaError {
        let found = self.peek().map_or("the end".into(), |letter| format!("\"{letter}\""));
        FormulaError::Expected { position: self.at + 1, expected, found }
    }

    fn too_large(&self) -> FormulaError {
        FormulaError::TooLarge { position: self.at + 1 }
    }

    fn push(&mut self, instruction: Instruction) -> Result<(), FormulaError> {
        match instruction {
            Instruction::Binary(_) => self.stack -= 1,
            Instruction::Unary(_) => {}
            _ => self.stack += 1,
        }
        self.program.push(instruction);
        if self.stack > STACK { Err(self.too_large()) } else { Ok(()) }
    }

    fn sum(&mut self) -> Result<(), FormulaError> {
        self.product()?;
        loop {
            let operation = match self.peek() {
                Some('+') => Binary::Add,
                Some('-') => Binary::Subtract,
                _ => return Ok(()),
            };
            self.at += 1;
            self.product()?;
            self.push(Instruction::Binary(operation))?;
        }
    }

    fn product(&mut self) -> Result<(), FormulaError> {
        self.signed()?;
        loop {
            let operation = match self.peek() {
                Some('*') => Binary::Multiply,
                Some('/') => Binary::Divide,
                _ => return Ok(()),
            };
            self.at += 1;
            self.signed()?;
            self.push(Instruction::Binary(operation))?;
        }
    }

    fn signed(&mut self) -> Result<(), FormulaError> {
        self.nesting += 1;
        if self.nesting > NESTING {
            return Err(self.too_large());
        }
        if self.take('-') {
            self.signed()?;
            self.push(Instruction::Unary(Unary::Negative))?;
        } else {
            self.take('+');
            self.power()?;
        }
        self.nesting -= 1;
        Ok(())
    }

    fn power(&mut self) -> Result<(), FormulaError> {
        self.atom()?;
        if self.take('^') {
            self.signed()?;
            self.push(Instruction::Binary(Binary::Power))?;
        }
        Ok(())
    }

    fn atom(&mut self) -> Result<(), FormulaError> {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                self.sum()?;
                self.close()
            }
            Some(letter) if letter.is_ascii_digit() || letter == '.' => self.number(),
            Some(letter) if letter.is_ascii_alphabetic() => self.name(),
            _ => Err(self.expected("a number, a name or \"(\"")),
        }
    }

    fn close(&mut self) -> Result<(), FormulaError> {
        if self.take(')') { Ok(()) } else { Err(self.expected("\")\"")) }
    }

    fn number(&mut self) -> Result<(), FormulaError> {
        let start = self.at;
        self.digits();
        if matches!(self.characters.get(self.at), Some('e' | 'E')) {
            let sign = usize::from(matches!(self.characters.get(self.at + 1), Some('+' | '-')));
            if self.characters.get(self.at + 1 + sign).is_some_and(char::is_ascii_digit) {
                self.at += 1 + sign;
                self.digits();
            }
        }
        let text: String = self.characters[start..self.at].iter().collect();
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => self.push(Instruction::Number(value)),
            _ => Err(FormulaError::Expected { position: start + 1, expected: "a finite number", found: text }),
        }
    }

    fn digits(&mut self) {
        let counts = |letter: &char| letter.is_ascii_digit() || *letter == '.';
        while self.characters.get(self.at).is_some_and(counts) {
            self.at += 1;
        }
    }

    fn name(&mut self) -> Result<(), FormulaError> {
        let start = self.at;
        while self.characters.get(self.at).is_some_and(|letter| letter.is_ascii_alphanumeric() || *letter == '_') {
            self.at += 1;
        }
        let name: String = self.characters[start..self.at].iter().collect();
        if self.take('(') {
            return self.call(&name, start + 1);
        }
        let instruction = match VARIABLES.iter().position(|variable| *variable == name) {
            Some(index) => Instruction::Variable(index as u8),
            None if name == "pi" => Instruction::Number(std::f64::consts::PI),
            None => Instruction::Parameter(self.parameter(name)?),
        };
        self.push(instruction)
    }

    fn parameter(&mut self, name: String) -> Result<u8, FormulaError> {
        let known = self.parameters.iter().position(|parameter| *parameter == name);
        let index = known.unwrap_or(self.parameters.len());
        if index == self.parameters.len() {
            self.parameters.push(name);
        }
        if index < MAX_PARAMETERS { Ok(index as u8) } else { Err(self.too_large()) }
    }

    fn call(&mut self, name: &str, position: usize) -> Result<(), FormulaError> {
        self.sum()?;
        if let Some((_, function)) = UNARY.iter().find(|(known, _)| *known == name) {
            self.close()?;
            return self.push(Instruction::Unary(*function));
        }
        let Some((_, function)) = BINARY.iter().find(|(known, _)| *known == name) else {
            return Err(FormulaError::Function { position, name: name.into() });
        };
        if !self.take(',') {
            return Err(self.expected("\",\" and a second value"));
        }
        self.sum()?;
        self.close()?;
        self.push(Instruction::Binary(*function))
    }
}
