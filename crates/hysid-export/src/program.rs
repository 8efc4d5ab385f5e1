//! The description of a model between its file and the source code of a target: one step as a program.
//!
//! A program has arrays of numbers and statements. Constants never change; the state is what a model stores between
//! two steps; scratch is what one step needs. A step reads its arguments from an array, advances the state, and leaves
//! the outputs in another.
//!
//! A target writes the statements in its language, each in one line or one loop. [`interpreter`] runs them here, for
//! tests and for test vectors, and [`tangent`] derives the program of the slope `dy/dx`.

pub(crate) mod choices;
pub(crate) mod expression;
pub mod interpreter;
pub mod tangent;
pub(crate) mod unused;
pub(crate) mod uses;

use expression::{Real, RealVariable, Truth, Whole, WholeVariable};

/// Name of an array: its number in the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Array(pub(crate) usize);

impl Array {
    pub fn at(self, index: impl Into<Whole>) -> Real {
        Real::Element(self, Box::new(index.into()))
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Storage {
    /// Numbers that never change.
    Constant(Vec<f64>),
    /// Memory kept from one step to the next, with the values before the first.
    State(Vec<f64>),
    /// Scratch space of one step. Its content before the step means nothing.
    Scratch(usize),
    /// Arguments of a step.
    Argument(usize),
    /// Results of a step.
    Output(usize),
}

impl Storage {
    pub fn len(&self) -> usize {
        match self {
            Self::Constant(values) | Self::State(values) => values.len(),
            Self::Scratch(length) | Self::Argument(length) | Self::Output(length) => *length,
        }
    }
}

/// An array with its name and what it is for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Declaration {
    /// An identifier, unique in the program.
    pub name: String,
    pub storage: Storage,
}

/// One thing that a step does.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Statement {
    /// A remark for the reader of the source code.
    Remark(String),
    /// Gives a variable a value. Its first occurrence declares it, in the innermost block around it.
    Let(RealVariable, Real),
    Assign(RealVariable, Real),
    LetWhole(WholeVariable, Whole),
    AssignWhole(WholeVariable, Whole),
    Set(Array, Whole, Real),
    /// Runs the block with the variable at each number from the first on, and below the last.
    Each(WholeVariable, Whole, Whole, Vec<Statement>),
    While(Truth, Vec<Statement>),
    If(Truth, Vec<Statement>, Vec<Statement>),
    /// Runs the block only where the slope is computed. It changes derivatives, and no value that is read behind it.
    ForSlope(Vec<Statement>),
}

/// Looks at each statement, and then at those of the blocks in it; blocks for the slope alone are left out.
pub(crate) fn every(statements: &[Statement], look: &mut impl FnMut(&Statement)) {
    for statement in statements {
        look(statement);
        match statement {
            Statement::Each(_, _, _, body) | Statement::While(_, body) => every(body, look),
            Statement::If(_, yes, no) => {
                every(yes, look);
                every(no, look);
            }
            _ => {}
        }
    }
}

/// Precision of all real numbers of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// Double precision, `f64`.
    #[default]
    Double,
    /// Single precision, `f32`.
    Single,
}

impl Precision {
    /// `f64` or `f32`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Double => "f64",
            Self::Single => "f32",
        }
    }

    /// Adding this leaves no digits behind the point: the low bits of the sum are a whole number plus the bias of
    /// exponents.
    pub(crate) fn rounding(self) -> f64 {
        match self {
            Self::Double => 6_755_399_441_055_744.0 + 1023.0,
            Self::Single => 12_582_912.0 + 127.0,
        }
    }

    /// A constant in single precision. A finite one that is too large becomes the largest.
    pub(crate) fn single(value: f64) -> f32 {
        let rounded = value as f32;
        if value.is_finite() { rounded.clamp(f32::MIN, f32::MAX) } else { rounded }
    }
}

/// One step of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    pub(crate) precision: Precision,
    pub(crate) arrays: Vec<Declaration>,
    /// The arguments, whose first is the input that a tangent refers to.
    pub(crate) arguments: Array,
    /// The outputs, the first of which is that of the model.
    pub(crate) outputs: Array,
    pub(crate) body: Vec<Statement>,
    pub(crate) reals: usize,
    pub(crate) wholes: usize,
}

impl Program {
    pub(crate) fn declaration(&self, array: Array) -> &Declaration {
        &self.arrays[array.0]
    }

    /// All arrays of the state, with their initial values.
    pub(crate) fn states(&self) -> impl Iterator<Item = (Array, &str, &[f64])> {
        self.arrays.iter().enumerate().filter_map(|(index, declaration)| match &declaration.storage {
            Storage::State(values) => Some((Array(index), declaration.name.as_str(), values.as_slice())),
            _ => None,
        })
    }

    pub(crate) fn state_len(&self) -> usize {
        self.states().map(|(_, _, values)| values.len()).sum()
    }

    pub(crate) fn constants_len(&self) -> usize {
        let constants = self.arrays.iter().filter(|array| matches!(array.storage, Storage::Constant(_)));
        constants.map(|array| array.storage.len()).sum()
    }
}

/// Writes a program, statement by statement.
#[derive(Debug)]
pub(crate) struct Builder {
    program: Program,
    /// Statements of the blocks that are open, outermost first.
    blocks: Vec<Vec<Statement>>,
}

impl Builder {
    /// An empty program with these numbers of arguments and outputs.
    pub fn new(arguments: usize, outputs: usize, precision: Precision) -> Self {
        let mut builder = Self {
            program: Program {
                precision,
                arrays: Vec::new(),
                arguments: Array(0),
                outputs: Array(1),
                body: Vec::new(),
                reals: 0,
                wholes: 0,
            },
            blocks: vec![Vec::new()],
        };
        builder.program.arguments = builder.array("argument", Storage::Argument(arguments));
        builder.program.outputs = builder.array("output", Storage::Output(outputs));
        builder
    }

    pub fn precision(&self) -> Precision {
        self.program.precision
    }

    pub fn finish(mut self) -> Program {
        self.program.body = self.blocks.pop().unwrap_or_default();
        self.program
    }

    fn array(&mut self, name: &str, storage: Storage) -> Array {
        let taken = |name: &str| self.program.arrays.iter().any(|array| array.name == name);
        let mut unique = name.to_string();
        let mut number = 2;
        while taken(&unique) {
            unique = format!("{name}_{number}");
            number += 1;
        }
        self.program.arrays.push(Declaration { name: unique, storage });
        Array(self.program.arrays.len() - 1)
    }

    /// An array of constants. A number is added to a name that is taken.
    pub fn constants(&mut self, name: &str, values: Vec<f64>) -> Array {
        self.array(name, Storage::Constant(values))
    }

    /// An array of the state, with its values before the first step.
    pub fn state(&mut self, name: &str, initial: Vec<f64>) -> Array {
        self.array(name, Storage::State(initial))
    }

    /// An array that one step needs.
    pub fn scratch(&mut self, name: &str, length: usize) -> Array {
        self.array(name, Storage::Scratch(length))
    }

    pub fn argument(&self, index: usize) -> Real {
        self.program.arguments.at(index)
    }

    fn add(&mut self, statement: Statement) {
        if let Some(block) = self.blocks.last_mut() {
            block.push(statement);
        }
    }

    fn block(&mut self, write: impl FnOnce(&mut Self)) -> Vec<Statement> {
        self.blocks.push(Vec::new());
        write(self);
        self.blocks.pop().unwrap_or_default()
    }

    pub fn remark(&mut self, text: impl Into<String>) {
        self.add(Statement::Remark(text.into()));
    }

    /// Computes a value once, and returns the variable that has it.
    pub fn value(&mut self, value: impl Into<Real>) -> Real {
        self.variable(value).into()
    }

    pub fn variable(&mut self, value: impl Into<Real>) -> RealVariable {
        let variable = RealVariable(self.program.reals);
        self.program.reals += 1;
        self.add(Statement::Let(variable, value.into()));
        variable
    }

    pub fn assign(&mut self, variable: RealVariable, value: impl Into<Real>) {
        self.add(Statement::Assign(variable, value.into()));
    }

    /// A whole number of the state within bounds: a state that was restored may have any number there, also none.
    pub fn counter(&mut self, array: Array, index: impl Into<Whole>, low: f64, high: f64) -> WholeVariable {
        let kept = self.value(array.at(index));
        let kept = self.value(kept.above(low).choose(&kept, low));
        let kept = self.value(kept.min(high));
        self.whole_variable(kept.to_whole())
    }

    pub fn whole_variable(&mut self, value: impl Into<Whole>) -> WholeVariable {
        let variable = self.next_whole();
        self.add(Statement::LetWhole(variable, value.into()));
        variable
    }

    pub fn assign_whole(&mut self, variable: WholeVariable, value: impl Into<Whole>) {
        self.add(Statement::AssignWhole(variable, value.into()));
    }

    fn next_whole(&mut self) -> WholeVariable {
        let variable = WholeVariable(self.program.wholes);
        self.program.wholes += 1;
        variable
    }

    pub fn set(&mut self, array: Array, index: impl Into<Whole>, value: impl Into<Real>) {
        self.add(Statement::Set(array, index.into(), value.into()));
    }

    pub fn output(&mut self, index: usize, value: impl Into<Real>) {
        self.set(self.program.outputs, index, value);
    }

    /// Runs a block for each number from `first` on and below `last`.
    pub fn each(
        &mut self,
        first: impl Into<Whole>,
        last: impl Into<Whole>,
        write: impl FnOnce(&mut Self, Whole),
    ) {
        let variable = self.next_whole();
        let body = self.block(|builder| write(builder, variable.into()));
        self.add(Statement::Each(variable, first.into(), last.into(), body));
    }

    pub fn while_true(&mut self, condition: Truth, write: impl FnOnce(&mut Self)) {
        let body = self.block(write);
        self.add(Statement::While(condition, body));
    }

    /// Runs a block only where the slope is computed: it must leave all values that are read behind it as they are. It
    /// is for loops that iterate until values fit, which need not have made their derivatives fit.
    pub fn for_slope(&mut self, write: impl FnOnce(&mut Self)) {
        let body = self.block(write);
        self.add(Statement::ForSlope(body));
    }

    pub fn when(&mut self, condition: Truth, write: impl FnOnce(&mut Self)) {
        self.when_else(condition, write, |_| {});
    }

    pub fn when_else(&mut self, condition: Truth, yes: impl FnOnce(&mut Self), no: impl FnOnce(&mut Self)) {
        let (yes, no) = (self.block(yes), self.block(no));
        self.add(Statement::If(condition, yes, no));
    }
}
