//! Turns choices inside expressions into statements, for languages that have no such expression.

use crate::program::expression::{Real, RealVariable, Truth, Whole, fused};
use crate::program::{Program, Statement};

/// The program without [`Real::Choice`].
pub fn without_choices(program: &Program) -> Program {
    let mut lowered = program.clone();
    let mut next = FreeVariables { reals: program.reals };
    lowered.body = next.block(&program.body);
    lowered.reals = next.reals;
    lowered
}

struct FreeVariables {
    reals: usize,
}

impl FreeVariables {
    fn block(&mut self, statements: &[Statement]) -> Vec<Statement> {
        let mut block = Vec::with_capacity(statements.len());
        for statement in statements {
            let lowered = match statement {
                Statement::Let(variable, value) => Statement::Let(*variable, self.real(value, &mut block)),
                Statement::Assign(variable, value) => {
                    Statement::Assign(*variable, self.real(value, &mut block))
                }
                Statement::LetWhole(variable, value) => {
                    Statement::LetWhole(*variable, self.whole(value, &mut block))
                }
                Statement::AssignWhole(variable, value) => {
                    Statement::AssignWhole(*variable, self.whole(value, &mut block))
                }
                Statement::Set(array, index, value) => {
                    let index = self.whole(index, &mut block);
                    Statement::Set(*array, index, self.real(value, &mut block))
                }
                Statement::Each(variable, first, last, body) => {
                    let (first, last) = (self.whole(first, &mut block), self.whole(last, &mut block));
                    Statement::Each(*variable, first, last, self.block(body))
                }
                Statement::While(condition, body) => self.repeated(condition, body, &mut block),
                Statement::If(condition, yes, no) => {
                    let condition = self.truth(condition, &mut block);
                    Statement::If(condition, self.block(yes), self.block(no))
                }
                Statement::Remark(_) | Statement::ForSlope(_) => statement.clone(),
            };
            block.push(lowered);
        }
        block
    }

    /// A loop; its condition is computed in the body if it has choices.
    fn repeated(&mut self, condition: &Truth, body: &[Statement], before: &mut Vec<Statement>) -> Statement {
        let mut first = Vec::new();
        let lowered = self.truth(condition, &mut first);
        if first.is_empty() {
            return Statement::While(lowered, self.block(body));
        }
        let goes_on = RealVariable(self.reals);
        self.reals += 1;
        before.push(Statement::Let(goes_on, Real::Constant(1.0)));
        let stop = vec![Statement::Assign(goes_on, Real::Constant(0.0))];
        first.push(Statement::If(lowered, self.block(body), stop));
        Statement::While(Real::from(goes_on).above(0.0), first)
    }

    fn real(&mut self, value: &Real, before: &mut Vec<Statement>) -> Real {
        match value {
            Real::Constant(_) | Real::Variable(_) => value.clone(),
            Real::Element(array, index) => Real::Element(*array, Box::new(self.whole(index, before))),
            Real::Unary(function, a) => Real::Unary(*function, Box::new(self.real(a, before))),
            Real::Binary(function, a, b) => {
                let a = self.real(a, before);
                Real::Binary(*function, Box::new(a), Box::new(self.real(b, before)))
            }
            Real::Fused(a, b, c) => {
                let [a, b, c] = [a, b, c].map(|part| self.real(part, before));
                fused(a, b, c)
            }
            Real::Choice(condition, yes, no) => {
                let condition = self.truth(condition, before);
                let variable = RealVariable(self.reals);
                self.reals += 1;
                let (mut first, mut second) = (Vec::new(), Vec::new());
                let yes = self.real(yes, &mut first);
                first.push(Statement::Assign(variable, yes));
                let no = self.real(no, &mut second);
                second.push(Statement::Assign(variable, no));
                before.push(Statement::Let(variable, Real::Constant(0.0)));
                before.push(Statement::If(condition, first, second));
                variable.into()
            }
            Real::OfWhole(value) => Real::OfWhole(Box::new(self.whole(value, before))),
        }
    }

    fn whole(&mut self, value: &Whole, before: &mut Vec<Statement>) -> Whole {
        match value {
            Whole::Constant(_) | Whole::Variable(_) => value.clone(),
            Whole::Sum(a, b) => self.whole(a, before) + self.whole(b, before),
            Whole::Difference(a, b) => self.whole(a, before) - self.whole(b, before),
            Whole::Product(a, b) => self.whole(a, before) * self.whole(b, before),
            Whole::OfReal(value) => Whole::OfReal(Box::new(self.real(value, before))),
        }
    }

    /// A condition; one without choices stays as it is, so that what it guards is not computed beforehand.
    fn truth(&mut self, condition: &Truth, before: &mut Vec<Statement>) -> Truth {
        match condition {
            Truth::Real(comparison, a, b) => {
                let a = self.real(a, before);
                Truth::Real(*comparison, Box::new(a), Box::new(self.real(b, before)))
            }
            Truth::Whole(comparison, a, b) => {
                let a = self.whole(a, before);
                Truth::Whole(*comparison, Box::new(a), Box::new(self.whole(b, before)))
            }
            Truth::And(a, b) => self.truth(a, before).and(self.truth(b, before)),
            Truth::Or(a, b) => self.truth(a, before).or(self.truth(b, before)),
            Truth::Not(a) => self.truth(a, before).negated(),
        }
    }
}
