//! Leaves out of a program what its outputs and its state do not depend on.

use std::collections::BTreeSet;

use crate::program::uses::Uses;
use crate::program::{Array, Program, Statement, Storage, every};

/// The program without values that are never read, and without what only its slope needs. All its arrays stay declared.
pub fn without_unused(program: &Program) -> Program {
    let mut program = program.clone();
    loop {
        let body = kept(&Uses::of(&[&program]), &program, &program.body);
        if body == program.body {
            return program;
        }
        program.body = body;
    }
}

pub fn used_arrays(program: &Program) -> BTreeSet<Array> {
    let mut arrays = Uses::of(&[program]).arrays;
    every(&program.body, &mut |statement| {
        if let Statement::Set(array, ..) = statement {
            arrays.insert(*array);
        }
    });
    arrays
}

fn kept(uses: &Uses, program: &Program, statements: &[Statement]) -> Vec<Statement> {
    let is_needed = |array: Array| {
        let is_scratch = matches!(program.declaration(array).storage, Storage::Scratch(_));
        !is_scratch || uses.arrays.contains(&array)
    };
    let mut all = Vec::with_capacity(statements.len());
    for statement in statements {
        match statement {
            Statement::Let(variable, _) | Statement::Assign(variable, _)
                if !uses.reals.contains(variable) => {}
            Statement::LetWhole(variable, _) | Statement::AssignWhole(variable, _)
                if !uses.wholes.contains(variable) => {}
            Statement::Set(array, ..) if !is_needed(*array) => {}
            Statement::Each(variable, first, last, body) => {
                let body = kept(uses, program, body);
                if !body.is_empty() {
                    all.push(Statement::Each(*variable, first.clone(), last.clone(), body));
                }
            }
            Statement::While(condition, body) => {
                all.push(Statement::While(condition.clone(), kept(uses, program, body)));
            }
            Statement::If(condition, yes, no) => {
                let (yes, no) = (kept(uses, program, yes), kept(uses, program, no));
                if !(yes.is_empty() && no.is_empty()) {
                    all.push(Statement::If(condition.clone(), yes, no));
                }
            }
            Statement::ForSlope(_) => {}
            other => all.push(other.clone()),
        }
    }
    all
}
