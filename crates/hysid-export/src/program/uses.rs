//! What programs read, and the functions that they use.

use std::collections::BTreeSet;

use crate::program::expression::{Binary, Real, RealVariable, Truth, Unary, Whole, WholeVariable};
use crate::program::{Array, Program, Statement, every};

/// What the expressions of programs contain.
#[derive(Default)]
pub(crate) struct Uses {
    pub reals: BTreeSet<RealVariable>,
    pub wholes: BTreeSet<WholeVariable>,
    pub arrays: BTreeSet<Array>,
    pub unary: BTreeSet<Unary>,
    pub binary: BTreeSet<Binary>,
    /// [`Real::Fused`]
    pub fused: bool,
    pub infinity: bool,
}

impl Uses {
    /// Those of all these programs, without what only their slopes need.
    pub fn of(programs: &[&Program]) -> Self {
        let mut uses = Self::default();
        for program in programs {
            every(&program.body, &mut |statement| uses.statement(statement));
        }
        uses
    }

    pub fn of_real(value: &Real) -> Self {
        let mut uses = Self::default();
        uses.real(value);
        uses
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Remark(_) | Statement::ForSlope(_) => {}
            Statement::Let(_, value) | Statement::Assign(_, value) => self.real(value),
            Statement::LetWhole(_, value) | Statement::AssignWhole(_, value) => self.whole(value),
            Statement::Set(_, index, value) => {
                self.whole(index);
                self.real(value);
            }
            Statement::Each(_, first, last, _) => {
                self.whole(first);
                self.whole(last);
            }
            Statement::While(condition, _) | Statement::If(condition, ..) => self.truth(condition),
        }
    }

    fn real(&mut self, value: &Real) {
        match value {
            Real::Constant(value) => self.infinity |= value.is_infinite(),
            Real::Variable(variable) => drop(self.reals.insert(*variable)),
            Real::Element(array, index) => {
                self.arrays.insert(*array);
                self.whole(index);
            }
            Real::OfWhole(value) => self.whole(value),
            Real::Unary(function, a) => {
                self.unary.insert(*function);
                self.real(a);
            }
            Real::Binary(function, a, b) => {
                self.binary.insert(*function);
                self.real(a);
                self.real(b);
            }
            Real::Fused(a, b, c) => {
                self.fused = true;
                [a, b, c].into_iter().for_each(|part| self.real(part));
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
            Whole::Constant(_) => {}
            Whole::Variable(variable) => drop(self.wholes.insert(*variable)),
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
