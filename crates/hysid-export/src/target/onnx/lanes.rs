//! Which loops can be computed for all numbers at once.

use crate::program::expression::{AnyExpression, Binary, Real, RealVariable, Whole, WholeVariable};
use crate::program::uses::Uses;
use crate::program::{Array, Statement};

/// True if no pass of the loop needs what another one wrote, but for sums: each array that is written is only read where
/// the same pass writes it.
pub(super) fn are_independent(variable: WholeVariable, body: &[Statement]) -> bool {
    let mut lanes =
        Lanes { steps: vec![variable], own: Vec::new(), varying: Vec::new(), written: Vec::new() };
    body.iter().all(|statement| lanes.takes(statement))
        && body.iter().all(|statement| lanes.reads_only_its_own(statement))
        && sums_are_apart(body)
}

/// True if what is summed up is not read in the loop but by its sum.
fn sums_are_apart(body: &[Statement]) -> bool {
    let sums = body.iter().filter_map(|statement| match statement {
        Statement::Assign(variable, _) => Some(*variable),
        _ => None,
    });
    let sums: Vec<RealVariable> = sums.collect();
    let is_distinct = |sum: &RealVariable| sums.iter().filter(|other| *other == sum).count() == 1;
    let reads = |statement: &Statement, sum: RealVariable| match statement {
        Statement::Assign(variable, _) if *variable == sum => false,
        Statement::Let(_, value) | Statement::Assign(_, value) | Statement::Set(_, _, value) => {
            mentions(value, sum)
        }
        _ => false,
    };
    sums.iter().all(|sum| is_distinct(sum) && !body.iter().any(|statement| reads(statement, *sum)))
}

/// Addend of a sum: `E` of `v + E` or `E + v`, and `a * b` of `a * b + v`.
pub(super) fn addend(variable: RealVariable, value: &Real) -> Option<Real> {
    let is_it = |value: &Real| *value == Real::Variable(variable);
    match value {
        Real::Binary(Binary::Sum, a, b) if is_it(a) && !mentions(b, variable) => Some((**b).clone()),
        Real::Binary(Binary::Sum, a, b) if is_it(b) && !mentions(a, variable) => Some((**a).clone()),
        Real::Fused(a, b, c) if is_it(c) && !mentions(a, variable) && !mentions(b, variable) => {
            Some(Real::Binary(Binary::Product, a.clone(), b.clone()))
        }
        _ => None,
    }
}

struct Lanes {
    /// Whole variables that rise with the loop's by a fixed step: places that differ from pass to pass.
    steps: Vec<WholeVariable>,
    own: Vec<RealVariable>,
    /// Those of them that differ from pass to pass.
    varying: Vec<RealVariable>,
    /// Arrays with the place that a pass writes.
    written: Vec<(Array, Whole)>,
}

impl Lanes {
    fn takes(&mut self, statement: &Statement) -> bool {
        match statement {
            Statement::Remark(_) => true,
            Statement::Let(variable, value) => {
                self.own.push(*variable);
                if self.varies(value) {
                    self.varying.push(*variable);
                }
                true
            }
            Statement::LetWhole(variable, value) => {
                let steps = self.is_step(value);
                if steps {
                    self.steps.push(*variable);
                }
                steps
            }
            Statement::Set(array, index, _) => {
                let is_first = self.written.iter().all(|(other, _)| other != array);
                self.written.push((*array, index.clone()));
                is_first && self.is_step(index)
            }
            Statement::Assign(variable, value) => {
                let is_sum = addend(*variable, value).is_some_and(|addend| self.varies(&addend));
                is_sum && !self.own.contains(variable)
            }
            _ => false,
        }
    }

    /// True for a whole number that differs from pass to pass.
    fn is_step(&self, value: &Whole) -> bool {
        match value {
            Whole::Variable(variable) => self.steps.contains(variable),
            Whole::Sum(a, b) => self.is_step(a) && self.is_fixed(b) || self.is_fixed(a) && self.is_step(b),
            _ => false,
        }
    }

    fn is_fixed(&self, value: &Whole) -> bool {
        match value {
            Whole::Constant(_) => true,
            Whole::Variable(variable) => !self.steps.contains(variable),
            Whole::Sum(a, b) | Whole::Difference(a, b) | Whole::Product(a, b) => {
                self.is_fixed(a) && self.is_fixed(b)
            }
            Whole::OfReal(_) => false,
        }
    }

    /// True if a value contains something of the pass.
    fn varies(&self, value: &Real) -> bool {
        match value {
            Real::Constant(_) => false,
            Real::Variable(variable) => self.varying.contains(variable),
            Real::Element(_, index) | Real::OfWhole(index) => !self.is_fixed(index),
            Real::Unary(_, a) => self.varies(a),
            Real::Binary(_, a, b) | Real::Choice(_, a, b) => self.varies(a) || self.varies(b),
            Real::Fused(a, b, c) => [a, b, c].into_iter().any(|part| self.varies(part)),
        }
    }

    fn reads_only_its_own(&self, statement: &Statement) -> bool {
        match statement {
            Statement::Let(_, value) | Statement::Assign(_, value) | Statement::Set(_, _, value) => {
                self.reads_own(AnyExpression::Real(value))
            }
            _ => true,
        }
    }

    /// True if each element of an array that a pass writes is the one that this pass writes.
    fn reads_own(&self, part: AnyExpression<'_>) -> bool {
        let is_own = match part {
            AnyExpression::Real(Real::Element(array, index)) => {
                self.written.iter().all(|(written, place)| written != array || place == &**index)
            }
            _ => true,
        };
        is_own && part.parts().into_iter().all(|part| self.reads_own(part))
    }
}

fn mentions(value: &Real, variable: RealVariable) -> bool {
    Uses::of_real(value).reals.contains(&variable)
}
