//! Runs a program, number by number, as the source code of a target does in double precision.

use crate::program::expression::{Binary, Comparison, Real, Truth, Unary, Whole};
use crate::program::{Array, Program, Statement, Storage};

/// Adding this and subtracting it rounds to a whole number; the low bits of the sum are that number plus the exponent
/// bias 1023.
const ROUND: f64 = 6_755_399_441_055_744.0 + 1023.0;

/// A program with its state.
#[derive(Debug, Clone)]
pub struct Machine<'p> {
    program: &'p Program,
    arrays: Vec<Vec<f64>>,
    reals: Vec<f64>,
    wholes: Vec<i64>,
}

impl<'p> Machine<'p> {
    /// A machine before its first step.
    pub fn new(program: &'p Program) -> Self {
        let initial = |storage: &Storage| match storage {
            Storage::Constant(values) | Storage::State(values) => values.clone(),
            Storage::Scratch(length) | Storage::Argument(length) | Storage::Output(length) => vec![0.0; *length],
        };
        Self {
            program,
            arrays: program.arrays.iter().map(|array| initial(&array.storage)).collect(),
            reals: vec![0.0; program.reals],
            wholes: vec![0; program.wholes],
        }
    }

    /// Takes a step with these arguments, and returns the outputs.
    ///
    /// # Panics
    /// Another number of arguments than the program has; an index outside an array, which is an error of the program.
    pub fn step(&mut self, arguments: &[f64]) -> &[f64] {
        self.arrays[self.program.arguments.0].copy_from_slice(arguments);
        self.run(&self.program.body);
        &self.arrays[self.program.outputs.0]
    }

    /// All numbers of the state, array by array.
    pub fn state(&self) -> Vec<f64> {
        self.program.states().flat_map(|(array, _, _)| self.arrays[array.0].iter().copied()).collect()
    }

    /// Replaces the state by one of the same program.
    ///
    /// # Panics
    /// A state of another length.
    pub fn set_state(&mut self, state: &[f64]) {
        let mut rest = state;
        for (Array(index), _, initial) in self.program.states() {
            let (here, behind) = rest.split_at(initial.len());
            self.arrays[index].copy_from_slice(here);
            rest = behind;
        }
        assert!(rest.is_empty(), "a state of this program");
    }

    fn run(&mut self, statements: &[Statement]) {
        for statement in statements {
            match statement {
                Statement::Remark(_) => {}
                Statement::Let(variable, value) | Statement::Assign(variable, value) => {
                    self.reals[variable.0] = self.real(value);
                }
                Statement::LetWhole(variable, value) | Statement::AssignWhole(variable, value) => {
                    self.wholes[variable.0] = self.whole(value);
                }
                Statement::Set(array, index, value) => {
                    let index = self.index(index);
                    self.arrays[array.0][index] = self.real(value);
                }
                Statement::Each(variable, first, last, body) => {
                    let (first, last) = (self.whole(first), self.whole(last));
                    for number in first..last {
                        self.wholes[variable.0] = number;
                        self.run(body);
                    }
                }
                Statement::While(condition, body) => {
                    while self.holds(condition) {
                        self.run(body);
                    }
                }
                Statement::If(condition, yes, no) => self.run(if self.holds(condition) { yes } else { no }),
            }
        }
    }

    fn index(&self, index: &Whole) -> usize {
        usize::try_from(self.whole(index)).expect("an index is not negative")
    }

    fn real(&self, value: &Real) -> f64 {
        match value {
            Real::Constant(value) => *value,
            Real::Variable(variable) => self.reals[variable.0],
            Real::Element(array, index) => self.arrays[array.0][self.index(index)],
            Real::Unary(function, a) => unary(*function, self.real(a)),
            Real::Binary(function, a, b) => binary(*function, self.real(a), self.real(b)),
            Real::Choice(condition, yes, no) => self.real(if self.holds(condition) { yes } else { no }),
            Real::OfWhole(value) => self.whole(value) as f64,
        }
    }

    fn whole(&self, value: &Whole) -> i64 {
        match value {
            Whole::Constant(value) => *value,
            Whole::Variable(variable) => self.wholes[variable.0],
            Whole::Sum(a, b) => self.whole(a) + self.whole(b),
            Whole::Difference(a, b) => self.whole(a) - self.whole(b),
            Whole::Product(a, b) => self.whole(a) * self.whole(b),
            Whole::OfReal(value) => self.real(value) as i64,
        }
    }

    fn holds(&self, condition: &Truth) -> bool {
        match condition {
            Truth::Real(comparison, a, b) => {
                let (a, b) = (self.real(a), self.real(b));
                match comparison {
                    Comparison::Below => a < b,
                    Comparison::AtMost => a <= b,
                    Comparison::Equal => a == b,
                }
            }
            Truth::Whole(comparison, a, b) => {
                let (a, b) = (self.whole(a), self.whole(b));
                match comparison {
                    Comparison::Below => a < b,
                    Comparison::AtMost => a <= b,
                    Comparison::Equal => a == b,
                }
            }
            Truth::And(a, b) => self.holds(a) && self.holds(b),
            Truth::Or(a, b) => self.holds(a) || self.holds(b),
            Truth::Not(a) => !self.holds(a),
        }
    }
}

fn unary(function: Unary, a: f64) -> f64 {
    match function {
        Unary::Negative => -a,
        Unary::Magnitude => a.abs(),
        Unary::SquareRoot => a.sqrt(),
        Unary::Exp => a.exp(),
        Unary::ExpMinusOne => a.exp_m1(),
        Unary::Ln => a.ln(),
        Unary::LnOnePlus => a.ln_1p(),
        Unary::Tanh => a.tanh(),
        Unary::InverseSinh => a.asinh(),
        Unary::Ceiling => a.ceil(),
        Unary::Rounded => (a + ROUND) - ROUND,
        Unary::PowerOfTwo => f64::from_bits((a + ROUND).to_bits() << 52),
    }
}

fn binary(function: Binary, a: f64, b: f64) -> f64 {
    match function {
        Binary::Sum => a + b,
        Binary::Difference => a - b,
        Binary::Product => a * b,
        Binary::Quotient => a / b,
        Binary::Power => a.powf(b),
        Binary::CopySign => a.copysign(b),
        Binary::Hypotenuse => a.hypot(b),
    }
}
