//! Writes the statements of a program in a language of blocks, loops and infix operators.

use std::collections::BTreeSet;

use crate::program::expression::{Binary, Real, RealVariable, Relation, Truth, Unary, Whole};
use crate::program::{Array, Declaration, Program, Statement, every};

/// How strongly the outermost operation of an expression binds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Binding {
    Choice,
    Or,
    And,
    Comparison,
    Sum,
    Product,
    Sign,
    Atom,
}

/// How a language writes what differs between languages.
pub(crate) trait Language {
    const SYNTAX: Syntax;
    fn number(&self, value: f64) -> String;
    /// An element of an array with this index, which counts from 0. A constant index of an argument is its number.
    fn element(&self, declaration: &Declaration, index: &str) -> String;
    /// A function of one number, by its name, which is empty for the number itself; `None` for the sign.
    fn unary(&self, function: Unary) -> Option<&'static str>;
    /// A function of two numbers; `None` for an infix operator. A quotient by a constant has its operator in any case.
    fn binary(&self, function: Binary) -> Option<&'static str>;
    /// A product and a sum in one rounding; `None` for two operators.
    fn fused(&self) -> Option<&'static str> {
        None
    }
}

/// How a language writes what is the same for all its programs.
pub(crate) struct Syntax {
    /// Of a condition and two numbers.
    pub choice: fn(&str, &str, &str) -> (String, Binding),
    /// Both conditions, one or both, the opposite.
    pub logic: [&'static str; 3],
    /// A real number as a whole one, as an atom.
    pub to_whole: fn(&str) -> String,
    /// A whole number as a real one, as an atom.
    pub to_real: fn(&str) -> String,
    /// Of a variable, its value, and whether it stays as it is.
    pub declare: fn(&str, &str, bool) -> String,
    pub declare_whole: fn(&str, &str) -> String,
    pub assign: fn(&str, &str) -> String,
    pub remark: fn(&str) -> String,
    /// First line of a loop over numbers, of a variable, the first number, and the one behind the last.
    pub each: fn(&str, &str, &str) -> String,
    pub while_true: fn(&str) -> String,
    pub when: fn(&str) -> String,
    /// Line between the two blocks of a branch.
    pub otherwise: &'static str,
    /// Last line of a block; `None` if indentation ends it.
    pub end: Option<&'static str>,
}

pub(crate) struct Printer<'a, L> {
    language: &'a L,
    program: &'a Program,
    assigned: BTreeSet<RealVariable>,
}

impl<'a, L: Language> Printer<'a, L> {
    pub fn new(language: &'a L, program: &'a Program) -> Self {
        let mut assigned = BTreeSet::new();
        every(&program.body, &mut |statement| {
            if let Statement::Assign(variable, _) = statement {
                assigned.insert(*variable);
            }
        });
        Self { language, program, assigned }
    }

    /// The body of the program, indented by a number of levels.
    pub fn body(&self, depth: usize) -> String {
        let mut text = String::new();
        self.block(&self.program.body, depth, &mut text);
        text
    }

    fn block(&self, statements: &[Statement], depth: usize, text: &mut String) {
        let syntax = L::SYNTAX;
        let indent = "    ".repeat(depth);
        let line = |text: &mut String, content: &str| {
            *text += &indent;
            *text += content;
            text.push('\n');
        };
        for statement in statements {
            match statement {
                Statement::Remark(remark) => line(text, &(syntax.remark)(remark)),
                Statement::ForSlope(_) => {}
                Statement::Let(variable, value) => {
                    let value = self.real(value, Binding::Choice);
                    let is_constant = !self.assigned.contains(variable);
                    line(text, &(syntax.declare)(&format!("v{}", variable.0), &value, is_constant));
                }
                Statement::Assign(variable, value) => {
                    let value = self.real(value, Binding::Choice);
                    line(text, &(syntax.assign)(&format!("v{}", variable.0), &value));
                }
                Statement::LetWhole(variable, value) => {
                    let value = self.whole(value, Binding::Sum);
                    line(text, &(syntax.declare_whole)(&format!("k{}", variable.0), &value));
                }
                Statement::AssignWhole(variable, value) => {
                    let value = self.whole(value, Binding::Sum);
                    line(text, &(syntax.assign)(&format!("k{}", variable.0), &value));
                }
                Statement::Set(array, index, value) => {
                    let value = self.real(value, Binding::Choice);
                    line(text, &(syntax.assign)(&self.element(*array, index), &value));
                }
                Statement::Each(variable, first, last, body) => {
                    let (first, last) = (self.whole(first, Binding::Sum), self.whole(last, Binding::Sum));
                    line(text, &(syntax.each)(&format!("k{}", variable.0), &first, &last));
                    self.block(body, depth + 1, text);
                    syntax.end.into_iter().for_each(|end| line(text, end));
                }
                Statement::While(condition, body) => {
                    line(text, &(syntax.while_true)(&self.truth(condition, Binding::Choice)));
                    self.block(body, depth + 1, text);
                    syntax.end.into_iter().for_each(|end| line(text, end));
                }
                Statement::If(condition, yes, no) => {
                    let (condition, yes, no) = match yes.is_empty() {
                        false => (condition.clone(), yes, no),
                        true => (condition.clone().negated(), no, yes),
                    };
                    line(text, &(syntax.when)(&self.truth(&condition, Binding::Choice)));
                    self.block(yes, depth + 1, text);
                    if !no.is_empty() {
                        line(text, syntax.otherwise);
                        self.block(no, depth + 1, text);
                    }
                    syntax.end.into_iter().for_each(|end| line(text, end));
                }
            }
        }
    }

    fn element(&self, array: Array, index: &Whole) -> String {
        self.language.element(self.program.declaration(array), &self.whole(index, Binding::Sum))
    }

    /// An expression, in parentheses if it binds more weakly than what stands around it.
    fn real(&self, value: &Real, around: Binding) -> String {
        let language = self.language;
        let (text, binding) = match value {
            // The sign of a number binds as an operation.
            Real::Constant(value) if value.is_sign_negative() => (language.number(*value), Binding::Sign),
            Real::Constant(value) => (language.number(*value), Binding::Atom),
            Real::Variable(variable) => (format!("v{}", variable.0), Binding::Atom),
            Real::Element(array, index) => (self.element(*array, index), Binding::Atom),
            Real::Unary(function, a) => match language.unary(*function) {
                None => (format!("-{}", self.real(a, Binding::Atom)), Binding::Sign),
                Some(name) => (format!("{name}({})", self.real(a, Binding::Choice)), Binding::Atom),
            },
            Real::Binary(Binary::Quotient, a, b) if matches!(**b, Real::Constant(b) if b != 0.0) => {
                self.infix(Binary::Quotient, a, b)
            }
            Real::Binary(function, a, b) => match language.binary(*function) {
                None => self.infix(*function, a, b),
                Some(name) => {
                    let (a, b) = (self.real(a, Binding::Choice), self.real(b, Binding::Choice));
                    (format!("{name}({a}, {b})"), Binding::Atom)
                }
            },
            Real::Fused(a, b, c) => match language.fused() {
                None => {
                    let (a, b) = (self.real(a, Binding::Product), self.real(b, Binding::Sign));
                    (format!("{a} * {b} + {}", self.real(c, Binding::Product)), Binding::Sum)
                }
                Some(name) => {
                    let [a, b, c] = [a, b, c].map(|part| self.real(part, Binding::Choice));
                    (format!("{name}({a}, {b}, {c})"), Binding::Atom)
                }
            },
            Real::Choice(condition, yes, no) => {
                let condition = self.truth(condition, Binding::Or);
                let (yes, no) = (self.real(yes, Binding::Or), self.real(no, Binding::Or));
                (L::SYNTAX.choice)(&condition, &yes, &no)
            }
            Real::OfWhole(value) => ((L::SYNTAX.to_real)(&self.whole(value, Binding::Atom)), Binding::Atom),
        };
        bracketed(text, binding, around)
    }

    fn infix(&self, function: Binary, a: &Real, b: &Real) -> (String, Binding) {
        let (sign, binding, above) = match function {
            Binary::Sum => ("+", Binding::Sum, Binding::Product),
            Binary::Difference => ("-", Binding::Sum, Binding::Product),
            Binary::Product => ("*", Binding::Product, Binding::Sign),
            _ => ("/", Binding::Product, Binding::Sign),
        };
        (format!("{} {sign} {}", self.real(a, binding), self.real(b, above)), binding)
    }

    fn whole(&self, value: &Whole, around: Binding) -> String {
        let infix = |sign: &str, a: &Whole, b: &Whole, binding: Binding, above: Binding| {
            (format!("{} {sign} {}", self.whole(a, binding), self.whole(b, above)), binding)
        };
        let (text, binding) = match value {
            Whole::Constant(value) => {
                (value.to_string(), if *value < 0 { Binding::Sign } else { Binding::Atom })
            }
            Whole::Variable(variable) => (format!("k{}", variable.0), Binding::Atom),
            Whole::Sum(a, b) => infix("+", a, b, Binding::Sum, Binding::Product),
            Whole::Difference(a, b) => infix("-", a, b, Binding::Sum, Binding::Product),
            Whole::Product(a, b) => infix("*", a, b, Binding::Product, Binding::Sign),
            Whole::OfReal(value) => ((L::SYNTAX.to_whole)(&self.real(value, Binding::Atom)), Binding::Atom),
        };
        bracketed(text, binding, around)
    }

    fn truth(&self, condition: &Truth, around: Binding) -> String {
        let [and, or, not] = L::SYNTAX.logic;
        let (text, binding) = match condition {
            Truth::Real(comparison, a, b) => {
                let (a, b) = (self.real(a, Binding::Sum), self.real(b, Binding::Sum));
                (format!("{a} {} {b}", sign(*comparison)), Binding::Comparison)
            }
            Truth::Whole(comparison, a, b) => {
                let (a, b) = (self.whole(a, Binding::Sum), self.whole(b, Binding::Sum));
                (format!("{a} {} {b}", sign(*comparison)), Binding::Comparison)
            }
            Truth::And(a, b) => (
                format!("{} {and} {}", self.truth(a, Binding::And), self.truth(b, Binding::And)),
                Binding::And,
            ),
            Truth::Or(a, b) => {
                // In parentheses, because C compilers warn of `a && b || c`.
                let (a, b) = (self.truth(a, Binding::Comparison), self.truth(b, Binding::Comparison));
                (format!("{a} {or} {b}"), Binding::Or)
            }
            Truth::Not(a) => (format!("{not}({})", self.truth(a, Binding::Choice)), Binding::Sign),
        };
        bracketed(text, binding, around)
    }
}

fn sign(comparison: Relation) -> &'static str {
    match comparison {
        Relation::Below => "<",
        Relation::AtMost => "<=",
        Relation::Equal => "==",
    }
}

fn bracketed(text: String, binding: Binding, around: Binding) -> String {
    if binding < around { format!("({text})") } else { text }
}

/// Numbers with commas, some in a line, each line indented.
pub(crate) fn rows_of_numbers(language: &impl Language, values: &[f64], indent: &str) -> String {
    const IN_A_LINE: usize = 4;
    let numbers: Vec<String> = values.iter().map(|value| language.number(*value)).collect();
    let lines: Vec<String> =
        numbers.chunks(IN_A_LINE).map(|line| format!("{indent}{}", line.join(", "))).collect();
    lines.join(",\n")
}
