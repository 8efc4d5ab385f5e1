//! Variables, arrays and functions that programs use.

use std::collections::BTreeSet;

use crate::program::expression::{AnyExpression, Binary, Real, RealVariable, Unary, Whole, WholeVariable};
use crate::program::{Array, Program, Statement, every};

/// Variables, arrays and operations in the expressions of programs.
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
        uses.take(AnyExpression::Real(value));
        uses
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Remark(_) | Statement::ForSlope(_) => {}
            Statement::Let(_, value) | Statement::Assign(_, value) => self.take(AnyExpression::Real(value)),
            Statement::LetWhole(_, value) | Statement::AssignWhole(_, value) => {
                self.take(AnyExpression::Whole(value))
            }
            Statement::Set(_, index, value) => {
                self.take(AnyExpression::Whole(index));
                self.take(AnyExpression::Real(value));
            }
            Statement::Each(_, first, last, _) => {
                self.take(AnyExpression::Whole(first));
                self.take(AnyExpression::Whole(last));
            }
            Statement::While(condition, _) | Statement::If(condition, ..) => {
                self.take(AnyExpression::Truth(condition));
            }
        }
    }

    fn take(&mut self, part: AnyExpression<'_>) {
        match part {
            AnyExpression::Real(Real::Constant(value)) => self.infinity |= value.is_infinite(),
            AnyExpression::Real(Real::Variable(variable)) => drop(self.reals.insert(*variable)),
            AnyExpression::Real(Real::Element(array, _)) => drop(self.arrays.insert(*array)),
            AnyExpression::Real(Real::Unary(function, _)) => drop(self.unary.insert(*function)),
            AnyExpression::Real(Real::Binary(function, ..)) => drop(self.binary.insert(*function)),
            AnyExpression::Real(Real::Fused(..)) => self.fused = true,
            AnyExpression::Whole(Whole::Variable(variable)) => drop(self.wholes.insert(*variable)),
            _ => {}
        }
        part.parts().into_iter().for_each(|part| self.take(part));
    }
}
