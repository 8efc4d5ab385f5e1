//! Leaves out of a program what its outputs and its state do not depend on.

use std::collections::BTreeSet;

use crate::program::expression::{Real, RealVariable, Truth, Whole, WholeVariable};
use crate::program::{Array, Program, Statement, Storage};

/// The program without values that are never read, and without what only its slope needs. All its arrays stay declared.
pub fn without_unused(program: &Program) -> Program {
    let mut program = program.clone();
    loop {
        let read = Read::of(&program);
        let body = read.kept(&program, &program.body);
        if body == program.body {
            return program;
        }
        program.body = body;
    }
}

/// The arrays that occur in a program.
pub fn used_arrays(program: &Program) -> BTreeSet<Array> {
    let mut read = Read::of(program);
    read.written(&program.body);
    read.arrays
}

/// What is read somewhere.
#[derive(Default)]
struct Read {
    reals: BTreeSet<RealVariable>,
    wholes: BTreeSet<WholeVariable>,
    arrays: BTreeSet<Array>,
}

impl Read {
    fn of(program: &Program) -> Self {
        let mut read = Self::default();
        read.statements(&program.body);
        read
    }

    fn statements(&mut self, statements: &[Statement]) {
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
                    self.statements(body);
                }
                Statement::While(condition, body) => {
                    self.truth(condition);
                    self.statements(body);
                }
                Statement::If(condition, yes, no) => {
                    self.truth(condition);
                    self.statements(yes);
                    self.statements(no);
                }
            }
        }
    }

    fn real(&mut self, value: &Real) {
        match value {
            Real::Constant(_) => {}
            Real::Variable(variable) => {
                self.reals.insert(*variable);
            }
            Real::Element(array, index) => {
                self.arrays.insert(*array);
                self.whole(index);
            }
            Real::Unary(_, a) => self.real(a),
            Real::Binary(_, a, b) => {
                self.real(a);
                self.real(b);
            }
            Real::Choice(condition, yes, no) => {
                self.truth(condition);
                self.real(yes);
                self.real(no);
            }
            Real::OfWhole(value) => self.whole(value),
        }
    }

    fn whole(&mut self, value: &Whole) {
        match value {
            Whole::Constant(_) => {}
            Whole::Variable(variable) => {
                self.wholes.insert(*variable);
            }
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

    /// Adds the arrays that are written.
    fn written(&mut self, statements: &[Statement]) {
        for statement in statements {
            match statement {
                Statement::Set(array, ..) => {
                    self.arrays.insert(*array);
                }
                Statement::Each(_, _, _, body) | Statement::While(_, body) => self.written(body),
                Statement::If(_, yes, no) => {
                    self.written(yes);
                    self.written(no);
                }
                _ => {}
            }
        }
    }

    fn kept(&self, program: &Program, statements: &[Statement]) -> Vec<Statement> {
        let mut kept = Vec::with_capacity(statements.len());
        for statement in statements {
            match statement {
                Statement::Let(variable, _) | Statement::Assign(variable, _)
                    if !self.reals.contains(variable) => {}
                Statement::LetWhole(variable, _) | Statement::AssignWhole(variable, _)
                    if !self.wholes.contains(variable) => {}
                Statement::Set(array, ..) if !self.needs(program, *array) => {}
                Statement::Each(variable, first, last, body) => {
                    let body = self.kept(program, body);
                    if !body.is_empty() {
                        kept.push(Statement::Each(*variable, first.clone(), last.clone(), body));
                    }
                }
                Statement::While(condition, body) => {
                    kept.push(Statement::While(condition.clone(), self.kept(program, body)));
                }
                Statement::If(condition, yes, no) => {
                    let (yes, no) = (self.kept(program, yes), self.kept(program, no));
                    if !(yes.is_empty() && no.is_empty()) {
                        kept.push(Statement::If(condition.clone(), yes, no));
                    }
                }
                Statement::ForSlope(_) => {}
                other => kept.push(other.clone()),
            }
        }
        kept
    }

    fn needs(&self, program: &Program, array: Array) -> bool {
        let is_scratch = matches!(program.declaration(array).storage, Storage::Scratch(_));
        !is_scratch || self.arrays.contains(&array)
    }
}
