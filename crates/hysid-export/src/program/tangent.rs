//! The slope of the output by the first argument, as a program of its own.
//!
//! Each statement that depends on the argument gets a second one, which computes its derivative (forward mode of
//! automatic differentiation). The state before the step does not depend on the argument.
//!
//! At a kink the derivative is that of the branch which the step takes, so it is one-sided; that of a magnitude is 0
//! at 0. Where the input rests, stops count as sticking.

use std::collections::{BTreeMap, BTreeSet};

use crate::program::expression::{Binary, Real, RealVariable, Truth, Unary};
use crate::program::{Array, Declaration, Program, Statement, Storage, Whole};

/// The program with one more output: the derivative of the first output by the first argument.
pub fn with_tangent(program: &Program) -> Program {
    let active = Active::of(program);
    let mut tangent = program.clone();
    let outputs = program.declaration(program.outputs).storage.len();
    tangent.arrays[program.outputs.0].storage = Storage::Output(outputs + 1);
    let mut derivative =
        TangentNames { variables: BTreeMap::new(), arrays: BTreeMap::new(), reals: program.reals };
    for &Array(index) in &active.arrays {
        let Declaration { name, storage } = &program.arrays[index];
        if Array(index) == program.arguments {
            continue;
        }
        derivative.arrays.insert(Array(index), Array(tangent.arrays.len()));
        let storage = Storage::Scratch(storage.len());
        tangent.arrays.push(Declaration { name: format!("{name}_slope"), storage });
    }
    for &variable in &active.variables {
        derivative.variables.insert(variable, RealVariable(derivative.reals));
        derivative.reals += 1;
    }
    let mut body = Vec::new();
    for (array, slope) in &derivative.arrays {
        // Only what was there before the step has no derivative; scratch is written before it is read.
        if !matches!(program.declaration(*array).storage, Storage::Scratch(_)) {
            let index = crate::program::expression::WholeVariable(tangent.wholes);
            tangent.wholes += 1;
            let clear = Statement::Set(*slope, Whole::Variable(index), Real::Constant(0.0));
            let length = program.declaration(*array).storage.len();
            body.push(Statement::Each(index, Whole::Constant(0), Whole::from(length), vec![clear]));
        }
    }
    body.extend(derivative.block(program, &program.body));
    let slope =
        derivative.arrays.get(&program.outputs).map_or(Real::Constant(0.0), |slope| slope.at(0_usize));
    body.push(Statement::Set(program.outputs, Whole::from(outputs), slope));
    tangent.body = body;
    tangent.reals = derivative.reals;
    tangent
}

/// Variables and arrays that depend on the first argument.
#[derive(Default)]
struct Active {
    variables: BTreeSet<RealVariable>,
    arrays: BTreeSet<Array>,
}

impl Active {
    fn of(program: &Program) -> Self {
        let mut active = Self::default();
        active.arrays.insert(program.arguments);
        loop {
            let before = (active.variables.len(), active.arrays.len());
            active.take(&program.body);
            if before == (active.variables.len(), active.arrays.len()) {
                return active;
            }
        }
    }

    fn take(&mut self, statements: &[Statement]) {
        for statement in statements {
            match statement {
                Statement::Let(variable, value) | Statement::Assign(variable, value)
                    if self.depends(value) =>
                {
                    self.variables.insert(*variable);
                }
                Statement::Set(array, _, value) if self.depends(value) => {
                    self.arrays.insert(*array);
                }
                Statement::Each(_, _, _, body) | Statement::While(_, body) | Statement::ForSlope(body) => {
                    self.take(body);
                }
                Statement::If(_, yes, no) => {
                    self.take(yes);
                    self.take(no);
                }
                _ => {}
            }
        }
    }

    fn depends(&self, value: &Real) -> bool {
        match value {
            Real::Constant(_) | Real::OfWhole(_) => false,
            Real::Unary(Unary::Ceiling | Unary::PowerOfTwo | Unary::Detached, _) => false,
            Real::Variable(variable) => self.variables.contains(variable),
            // Of the arguments, only the first.
            Real::Element(array @ Array(0), index) => {
                self.arrays.contains(array) && **index == Whole::Constant(0)
            }
            Real::Element(array, _) => self.arrays.contains(array),
            Real::Unary(_, a) => self.depends(a),
            Real::Binary(_, a, b) | Real::Choice(_, a, b) => self.depends(a) || self.depends(b),
            Real::Fused(a, b, c) => [a, b, c].into_iter().any(|part| self.depends(part)),
        }
    }
}

/// The variables and arrays that have the derivatives.
struct TangentNames {
    variables: BTreeMap<RealVariable, RealVariable>,
    arrays: BTreeMap<Array, Array>,
    reals: usize,
}

impl TangentNames {
    /// A block with the derivatives; each stands before what it is the derivative of, whose old values it needs.
    fn block(&self, program: &Program, statements: &[Statement]) -> Vec<Statement> {
        let mut block = Vec::new();
        for statement in statements {
            match statement {
                Statement::Let(variable, value) => {
                    if let Some(&slope) = self.variables.get(variable) {
                        block.push(Statement::Let(slope, or_zero(self.of(program, value))));
                    }
                    block.push(statement.clone());
                }
                Statement::Assign(variable, value) => {
                    if let Some(&slope) = self.variables.get(variable) {
                        block.push(Statement::Assign(slope, or_zero(self.of(program, value))));
                    }
                    block.push(statement.clone());
                }
                Statement::Set(array, index, value) => {
                    if let Some(&slope) = self.arrays.get(array) {
                        let value = or_zero(self.of(program, value));
                        block.push(Statement::Set(slope, index.clone(), value));
                    }
                    block.push(statement.clone());
                }
                Statement::Each(variable, first, last, body) => {
                    let body = self.block(program, body);
                    block.push(Statement::Each(*variable, first.clone(), last.clone(), body));
                }
                Statement::While(condition, body) => {
                    block.push(Statement::While(condition.clone(), self.block(program, body)));
                }
                Statement::If(condition, yes, no) => {
                    let (yes, no) = (self.block(program, yes), self.block(program, no));
                    block.push(Statement::If(condition.clone(), yes, no));
                }
                Statement::ForSlope(body) => block.extend(self.block(program, body)),
                Statement::Remark(_) | Statement::LetWhole(..) | Statement::AssignWhole(..) => {
                    block.push(statement.clone());
                }
            }
        }
        block
    }

    /// The derivative; `None` for 0.
    fn of(&self, program: &Program, value: &Real) -> Option<Real> {
        match value {
            Real::Constant(_) | Real::OfWhole(_) => None,
            Real::Variable(variable) => self.variables.get(variable).map(|&slope| slope.into()),
            Real::Element(array, index) if *array == program.arguments => {
                (**index == Whole::Constant(0)).then_some(Real::Constant(1.0))
            }
            Real::Element(array, index) => self.arrays.get(array).map(|slope| slope.at((**index).clone())),
            Real::Unary(Unary::Detached, _) => None,
            Real::Unary(function, a) => self.of(program, a).and_then(|slope| of_unary(*function, a, slope)),
            Real::Binary(function, a, b) => {
                of_binary(*function, (a, self.of(program, a)), (b, self.of(program, b)))
            }
            Real::Fused(a, b, c) => {
                let product = of_binary(Binary::Product, (a, self.of(program, a)), (b, self.of(program, b)));
                sum(product, self.of(program, c))
            }
            Real::Choice(condition, yes, no) => match (self.of(program, yes), self.of(program, no)) {
                (None, None) => None,
                (yes, no) => Some(Truth::clone(condition).choose(or_zero(yes), or_zero(no))),
            },
        }
    }
}

fn or_zero(slope: Option<Real>) -> Real {
    slope.unwrap_or(Real::Constant(0.0))
}

fn sum(first: Option<Real>, second: Option<Real>) -> Option<Real> {
    match (first, second) {
        (Some(first), Some(second)) => Some(first + second),
        (first, second) => first.or(second),
    }
}

fn of_unary(function: Unary, a: &Real, slope: Real) -> Option<Real> {
    match function {
        Unary::Negative => Some(-slope),
        Unary::Magnitude => Some(a.above(0.0).choose(&slope, a.below(0.0).choose(-&slope, 0.0))),
        Unary::SquareRoot => Some(a.above(0.0).choose(slope / (2.0 * a.sqrt()), 0.0)),
        Unary::Exp | Unary::ExpMinusOne => Some(a.exp() * slope),
        Unary::Ln => Some(slope / a),
        Unary::LnOnePlus => Some(slope / (1.0 + a)),
        Unary::Tanh => Some((1.0 - a.tanh() * a.tanh()) * slope),
        Unary::InverseSinh => Some(slope / (1.0 + a * a).sqrt()),
        Unary::Ceiling | Unary::PowerOfTwo | Unary::Detached => None,
    }
}

fn of_binary(
    function: Binary,
    (a, slope_a): (&Real, Option<Real>),
    (b, slope_b): (&Real, Option<Real>),
) -> Option<Real> {
    match function {
        Binary::Sum => sum(slope_a, slope_b),
        Binary::Difference => sum(slope_a, slope_b.map(|slope| -slope)),
        Binary::Product => sum(slope_a.map(|slope| slope * b), slope_b.map(|slope| a * slope)),
        Binary::Quotient => sum(slope_a.map(|slope| slope / b), slope_b.map(|slope| -(a / b * slope / b))),
        Binary::Power => {
            // At 0 an infinite slope counts as 0.
            let of_base = slope_a.map(|slope| a.above(0.0).choose(b * a.powf(b - 1.0) * slope, 0.0));
            let of_exponent = slope_b.map(|slope| a.above(0.0).choose(a.ln() * a.powf(b) * slope, 0.0));
            sum(of_base, of_exponent)
        }
        Binary::Hypotenuse => {
            let share = |of: &Real| a.hypot(b).above(0.0).choose(of / a.hypot(b), 0.0);
            sum(slope_a.map(|slope| share(a) * slope), slope_b.map(|slope| share(b) * slope))
        }
        Binary::CopySign => slope_a.map(|slope| a.signum() * b.signum() * slope),
    }
}
