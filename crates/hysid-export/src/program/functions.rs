//! The functions that programs use.

use std::collections::BTreeSet;

use crate::program::expression::{Binary, Real, Truth, Unary, Whole};
use crate::program::{Program, Statement};

/// The functions that programs use.
#[derive(Debug, Default)]
pub struct Functions {
    /// Of one number.
    pub unary: BTreeSet<Unary>,
    /// Of two numbers.
    pub binary: BTreeSet<Binary>,
    /// There is an infinite constant.
    pub infinity: bool,
}

impl Functions {
    /// Those of all these programs.
    pub fn of(programs: &[&Program]) -> Self {
        let mut functions = Self::default();
        programs.iter().for_each(|program| functions.block(&program.body));
        functions
    }

    fn block(&mut self, statements: &[Statement]) {
        for statement in statements {
            match statement {
                Statement::Remark(_) | Statement::ForSlope(_) => {}
                Statement::Let(_, value) | Statement::Assign(_, value) => self.real(value),
                Statement::LetWhole(_, value) | Statement::AssignWhole(_, value) => self.whole(value),
                Statement::Set(_, index, value) => {
                    self.whole(index);
                    self.real(value);
                }
                Statement::Each(_, first, last, body) => {
                    self.whole(first);
                    self.whole(last);
                    self.block(body);
                }
                Statement::While(condition, body) => {
                    self.truth(condition);
                    self.block(body);
                }
                Statement::If(condition, yes, no) => {
                    self.truth(condition);
                    self.block(yes);
                    self.block(no);
                }
            }
        }
    }

    fn real(&mut self, value: &Real) {
        match value {
            Real::Constant(value) => self.infinity |= value.is_infinite(),
            Real::Variable(_) => {}
            Real::Element(_, index) | Real::OfWhole(index) => self.whole(index),
            Real::Unary(function, a) => {
                self.unary.insert(*function);
                self.real(a);
            }
            Real::Binary(function, a, b) => {
                self.binary.insert(*function);
                self.real(a);
                self.real(b);
            }
            Real::Choice(condition, yes, no) => {
                self.truth(condition);
                self.real(yes);
                self.real(no);
            }
        }
    }

    fn whole(&mut self, value: &Whole) {
        match value {
            Whole::Constant(_) | Whole::Variable(_) => {}
            Whole::Sum(a, b) | Whole::Difference(a, b) | Whole::Product(a, b) => {
                self.whole(a);
                self.whole(b);
            }
            Whole::OfReal(value) => self.real(value),
        }
    }

    fn truth(&mut self, condition: &Truth) {
        match condition {
            Truth::Real(_, a, b) => {
                self.real(a);
                self.real(b);
            }
            Truth::Whole(_, a, b) => {
                self.whole(a);
                self.whole(b);
            }
            Truth::And(a, b) | Truth::Or(a, b) => {
                self.truth(a);
                self.truth(b);
            }
            Truth::Not(a) => self.truth(a),
        }
    }
}
