//! Peak memory of an identification, estimated before it begins.
//!
//! Only large parts are counted: matrices as wide as the number of parameters or features, states of many
//! starts, and copies of the data. The estimates are within a factor of three of measured values; the tests
//! check this.

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::options::classical::ClassicalOptions;

const NUMBER: f64 = 8.0;

/// Rows that a search compares with the measured output, at most.
const ROWS_OF_A_SEARCH: f64 = 5000.0;

/// Largest number of searched parameters of a law without operators and neurons, about.
const MOST_PARAMETERS_OF_A_LAW: usize = 40;

pub(crate) const FEWER_ROWS: &str = "fit to fewer rows";
pub(crate) const FEWER_OPERATORS: &str = "choose fewer operators";

/// Peak memory of an identification, without that of the data themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct MemoryNeed {
    /// Peak memory in bytes.
    pub bytes: f64,
    /// Largest part of it, in words.
    pub taken_by: String,
    /// How to reduce it, in words.
    pub advice: &'static str,
}

impl MemoryNeed {
    /// Checks that the need is not beyond the `available` bytes.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn check(&self, available: f64) -> Result<()> {
        if self.bytes <= available {
            return Ok(());
        }
        let Self { bytes: needed, taken_by, advice } = self.clone();
        Err(Error::Memory { needed, available, taken_by, advice })
    }

    /// Of a number of floating-point numbers.
    pub(crate) fn of(numbers: f64, taken_by: impl Into<String>, advice: &'static str) -> Self {
        Self { bytes: NUMBER * numbers, taken_by: taken_by.into(), advice }
    }

    /// Of a number of floating-point numbers, with the part that takes most of it.
    pub(crate) fn largest_of<const N: usize>(total: f64, parts: [(f64, String, &'static str); N]) -> Self {
        let largest = parts.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let (_, taken_by, advice) = largest.expect("there are parts");
        Self::of(total, taken_by, advice)
    }

    /// With this many floating-point numbers more.
    pub(crate) fn and(self, numbers: f64) -> Self {
        Self { bytes: self.bytes + NUMBER * numbers, ..self }
    }

    /// Its part as floating-point numbers, in words, and how to reduce it.
    pub(crate) fn part(self) -> (f64, String, &'static str) {
        (self.bytes / NUMBER, self.taken_by, self.advice)
    }
}

/// Numbers in a data set.
pub(crate) fn numbers(data: &Dataset) -> f64 {
    let columns =
        data.names().inputs.len() + 1 + usize::from(data.has_time()) + usize::from(data.has_given_rate());
    data.rows() as f64 * columns as f64
}

/// What the memory of a fit of a law depends on, apart from its options.
pub struct LawFitSize {
    pub rows: f64,
    pub scored: f64,
    pub threads: f64,
    /// Numbers in copies of the data.
    pub copies: f64,
    folds: f64,
}

impl LawFitSize {
    pub fn of(data: &Dataset, threads: usize) -> Self {
        let (rows, scored, threads) = (data.rows() as f64, data.scored() as f64, threads as f64);
        let folds = if data.records().len() < 10 { 5.0 } else { 10.0 };
        Self { rows, scored, threads, copies: 2.0 * numbers(data) + 6.0 * rows, folds }
    }

    /// The part of the copies, in words.
    pub fn part_of_copies(&self) -> (f64, String, &'static str) {
        (self.copies, format!("{} rows", self.rows), FEWER_ROWS)
    }

    /// The need of least squares: sums of each fold and of all, and on each thread those less a fold with what is
    /// solved for.
    pub fn of_least_squares(&self, features: f64, operators: usize) -> MemoryNeed {
        let sums = (self.folds + 1.0 + 5.0 * self.threads) * features * features;
        let taken_by = format!("sums over {operators} operators");
        MemoryNeed::largest_of(sums + self.copies, [(sums, taken_by, FEWER_OPERATORS), self.part_of_copies()])
    }

    /// The need of a search from several starts.
    pub fn of_search(&self, options: &ClassicalOptions) -> MemoryNeed {
        let starts = options.starts() as f64;
        let compared = self.scored.min(ROWS_OF_A_SEARCH);
        let variables = options.operators().max(options.hidden() * 5).max(MOST_PARAMETERS_OF_A_LAW) as f64;
        let residuals = (starts + 3.0 * variables * self.threads) * compared + 24.0 * starts * 20.0;
        let taken_by = format!("residuals of {starts} starts");
        MemoryNeed::largest_of(
            residuals + self.copies,
            [(residuals, taken_by, "choose fewer starts"), self.part_of_copies()],
        )
    }
}
