//! What programs read, and the functions that they use.

use std::collections::BTreeSet;

use crate::program::expression::{Binary, Part, Real, RealVariable, Unary, Whole, WholeVariable};
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
        uses.take(Part::Real(value));
        uses
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Remark(_) | Statement::ForSlope(_) => {}
            Statement::Let(_, value) | Statement::Assign(_, value) => self.take(Part::Real(value)),
            Statement::LetWhole(_, value) | Statement::AssignWhole(_, value) => self.take(Part::Whole(value)),
            Statement::Set(_, index, value) => {
                self.take(Part::Whole(index));
                self.take(Part::Real(value));
            }
            Statement::Each(_, first, last, _) => {
                self.take(Part::Whole(first));
                self.take(Part::Whole(last));
            }
            Statement::While(condition, _) | Statement::If(condition, ..) => {
                self.take(Part::Truth(condition));
            }
        }
    }

    fn take(&mut self, part: Part<'_>) {
        match part {
            Part::Real(Real::Constant(value)) => self.infinity |= value.is_infinite(),
            Part::Real(Real::Variable(variable)) => drop(self.reals.insert(*variable)),
            Part::Real(Real::Element(array, _)) => drop(self.arrays.insert(*array)),
            Part::Real(Real::Unary(function, _)) => drop(self.unary.insert(*function)),
            Part::Real(Real::Binary(function, ..)) => drop(self.binary.insert(*function)),
            Part::Real(Real::Fused(..)) => self.fused = true,
            Part::Whole(Whole::Variable(variable)) => drop(self.wholes.insert(*variable)),
            _ => {}
        }
        part.parts().into_iter().for_each(|part| self.take(part));
    }
}
