//! Runs a program, number by number, as the source code of a target does.
//!
//! Numbers of single precision are held in double precision, which has them all.

use std::cell::Cell;

use hysid_core::elementary::{asinh, exp, exp_m1, hypot, ln, ln_1p, powf, tanh};
use hysid_core::simd::product_and_sum;

use crate::program::expression::{Binary, Real, Truth, Unary, Whole};
use crate::program::{Array, Precision, Program, Statement, Storage};

/// A program with its state.
#[derive(Debug, Clone)]
pub struct Machine<'p> {
    program: &'p Program,
    arrays: Vec<Vec<f64>>,
    reals: Vec<f64>,
    wholes: Vec<i64>,
    operations: Cell<u64>,
}

impl<'p> Machine<'p> {
    /// A machine before its first step.
    pub fn new(program: &'p Program) -> Self {
        let initial = |storage: &Storage| match storage {
            Storage::Constant(values) | Storage::State(values) => values.clone(),
            Storage::Scratch(length) | Storage::Argument(length) | Storage::Output(length) => {
                vec![0.0; *length]
            }
        };
        Self {
            program,
            arrays: program.arrays.iter().map(|array| initial(&array.storage)).collect(),
            reals: vec![0.0; program.reals],
            wholes: vec![0; program.wholes],
            operations: Cell::new(0),
        }
    }

    /// Takes a step with these arguments, and returns the outputs.
    ///
    /// # Panics
    /// An index outside an array, which is an error of the program.
    pub fn step(&mut self, arguments: &[f64]) -> &[f64] {
        for (to, argument) in self.arrays[self.program.arguments.0].iter_mut().zip(arguments) {
            *to = rounded(self.program.precision, *argument);
        }
        self.run(&self.program.body);
        &self.arrays[self.program.outputs.0]
    }

    /// Operations with real numbers in all steps so far: sums, products, quotients, functions. Comparisons are not counted.
    pub fn operations(&self) -> u64 {
        self.operations.get()
    }

    fn count(&self) {
        self.operations.set(self.operations.get() + 1);
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
                Statement::Remark(_) | Statement::ForSlope(_) => {}
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
        let precision = self.program.precision;
        match value {
            Real::Constant(value) => rounded(precision, *value),
            Real::Variable(variable) => self.reals[variable.0],
            Real::Element(array, index) => rounded(precision, self.arrays[array.0][self.index(index)]),
            Real::Unary(function, a) => {
                self.count();
                let a = self.real(a);
                match precision {
                    Precision::Double => unary(*function, a),
                    Precision::Single => f64::from(unary_single(*function, a as f32)),
                }
            }
            Real::Binary(function, a, b) => {
                self.count();
                let (a, b) = (self.real(a), self.real(b));
                match precision {
                    Precision::Double => binary(*function, a, b),
                    Precision::Single => f64::from(binary(*function, a, b) as f32),
                }
            }
            Real::Fused(a, b, c) => {
                self.count();
                self.count();
                let [a, b, c] = [a, b, c].map(|part| self.real(part));
                match precision {
                    Precision::Double => product_and_sum(a, b, c),
                    Precision::Single => f64::from(a as f32 * b as f32 + c as f32),
                }
            }
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
            Truth::Real(comparison, a, b) => comparison.holds(self.real(a), self.real(b)),
            Truth::Whole(comparison, a, b) => comparison.holds(self.whole(a), self.whole(b)),
            Truth::And(a, b) => self.holds(a) && self.holds(b),
            Truth::Or(a, b) => self.holds(a) || self.holds(b),
            Truth::Not(a) => !self.holds(a),
        }
    }
}

fn rounded(precision: Precision, value: f64) -> f64 {
    match precision {
        Precision::Double => value,
        Precision::Single => f64::from(Precision::single(value)),
    }
}

fn unary(function: Unary, a: f64) -> f64 {
    match function {
        Unary::Detached => a,
        Unary::Negative => -a,
        Unary::Magnitude => a.abs(),
        Unary::SquareRoot => a.sqrt(),
        Unary::Exp => exp(a),
        Unary::ExpMinusOne => exp_m1(a),
        Unary::Ln => ln(a),
        Unary::LnOnePlus => ln_1p(a),
        Unary::Tanh => tanh(a),
        Unary::InverseSinh => asinh(a),
        Unary::Ceiling => a.ceil(),
        Unary::PowerOfTwo => f64::from_bits((a + Precision::Double.rounding()).to_bits() << 52),
    }
}

fn binary(function: Binary, a: f64, b: f64) -> f64 {
    match function {
        Binary::Sum => a + b,
        Binary::Difference => a - b,
        Binary::Product => a * b,
        Binary::Quotient => a / b,
        Binary::Power => powf(a, b),
        Binary::CopySign => a.copysign(b),
        Binary::Hypotenuse => hypot(a, b),
    }
}

/// In single precision: the function in double precision, rounded. Operations and roots are then rounded once.
fn unary_single(function: Unary, a: f32) -> f32 {
    match function {
        Unary::PowerOfTwo => f32::from_bits((a + Precision::Single.rounding() as f32).to_bits() << 23),
        _ => unary(function, a.into()) as f32,
    }
}
