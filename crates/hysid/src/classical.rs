//! The classical models of hysteresis: those the paper describes, compares with or generates data from.
//!
//! Each is a law with a few parameters in the user's units and the field's symbols, one a file, equation
//! on top; its state is apart from it. They are fitted from the same records as the networks and run in
//! the same ways.

pub mod series;

use serde::{Deserialize, Serialize};

/// What a law is told of one more sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The input.
    pub x: f64,
    /// Its rate; 0 for a law that does not ask for it.
    pub rate: f64,
    /// Time since the sample before; 0 at the first of a record.
    pub step: f64,
}

/// What every classical model can do.
pub trait Law {
    /// What it knows of the past.
    type State: Clone + std::fmt::Debug;

    /// The state before the first sample of a record.
    fn virgin(&self) -> Self::State;

    /// Takes one more sample and gives the output.
    fn step(&self, state: &mut Self::State, sample: Sample) -> f64;

    /// Its parameters, in the field's symbols.
    fn parameters(&self) -> Vec<Parameter>;
}

/// A parameter of a law.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// The field's symbol, such as `r_3`.
    pub symbol: String,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// Its value, in the user's units.
    pub value: f64,
    /// Smallest and largest value it may have.
    pub bounds: (f64, f64),
    /// Its unit.
    pub unit: Dimension,
}

/// A unit as a product of powers of the data's units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Dimension {
    /// Power of the input's unit.
    pub input: i32,
    /// Power of the output's unit.
    pub output: i32,
    /// Power of the unit of time.
    pub time: i32,
}

impl Dimension {
    /// A pure number.
    pub const NONE: Self = Self { input: 0, output: 0, time: 0 };
    /// As the input.
    pub const INPUT: Self = Self { input: 1, output: 0, time: 0 };
    /// As the output.
    pub const OUTPUT: Self = Self { input: 0, output: 1, time: 0 };
    /// Output for input, as a stiffness.
    pub const SLOPE: Self = Self { input: -1, output: 1, time: 0 };
}
