//! Errors of the library.

use std::borrow::Cow;
use std::fmt;

use crate::significant::Significant;

/// Result of the library's fallible functions.
pub type Result<T> = std::result::Result<T, Error>;

/// An error of the library. Its text states what is wrong and what helps.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each has its fields")]
pub enum Error {
    /// A record cannot be used as it is.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A column of a measured motion cannot be used.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// The model was not trained on this record.
    #[error(
        "record {0:?} is not among those that the model was fitted to: intervals of parameters need the training data"
    )]
    NotTrainedOn(String),
    /// An option of a fit that cannot be used.
    #[error(transparent)]
    Option(#[from] OptionError),
    #[error("{what} `{}` is unknown: choose one of {}", one_line(.name), .known.join(", "))]
    UnknownName {
        /// Kind of thing that the name is of, such as "model".
        what: &'static str,
        name: String,
        known: Vec<&'static str>,
    },
    /// A parameter of a law that is not finite or out of bounds.
    #[error(
        "{law}: {symbol} ({meaning}) is {:.6}, and must be from {:.6} to {:.6}",
        Significant(*value), Significant(*low), Significant(*high)
    )]
    Parameter { law: &'static str, symbol: String, meaning: &'static str, value: f64, low: f64, high: f64 },
    /// Parts of a model, or arguments of an element, that cannot be used together.
    #[error("{}", one_line(.0))]
    Parts(String),
    /// A model that takes one input, and data with several.
    #[error("{model} takes one input, not {found}: use xpnn+, or choose one input")]
    SeveralInputs { model: &'static str, found: usize },
    /// A model that cannot be fitted without the rate of its input.
    #[error("{0} needs the rate of the input: there are no time stamps to compute it from")]
    RateNeeded(&'static str),
    /// A model that cannot be fitted without the time of each sample.
    #[error("{0} needs the time of each row, and the data have no time stamps")]
    TimeNeeded(&'static str),
    /// A sample that a model cannot take.
    #[error(transparent)]
    Sample(#[from] SampleError),
    /// A bound of an inverse that cannot be used, or a row that it cannot take.
    #[error(transparent)]
    Inverse(#[from] InverseError),
    /// A model that cannot be fitted with weights of rows.
    #[error(
        "{model} takes no weights of rows: use one of {}, or blank the outputs of rows that are not to count",
        .takers.join(", ")
    )]
    Weights { model: &'static str, takers: Vec<&'static str> },
    /// Options of `auto` that leave no model to try.
    #[error("these options leave no candidate: remove one of them")]
    NoCandidate,
    /// Data that cannot be divided into two folds.
    #[error("too few data to hold any out: at least two records, or one of {rows} rows, are needed")]
    TooFewForFolds { rows: usize },
    /// A data set without records.
    #[error("a data set needs at least one record")]
    NoRecords,
    /// A model without a band of errors.
    #[error(
        "this model of {0} has no prediction band: a fit of `auto` calibrates one, if there are enough data \
         to hold some out; a simulation without a band is possible"
    )]
    NoBand(&'static str),
    /// A probability that no band is calibrated for.
    #[error("a band of {probability}: choose a probability from {least} to {most}")]
    Probability { probability: f64, least: f64, most: f64 },
    /// A state that another model has found.
    #[error("the state was found by another model: find it with this one")]
    StateOfOtherModel,
    /// A number of data sets of ten that no band is made for.
    #[error("a band for {0} of ten data sets: choose 5 to 9 of ten")]
    DataSetsOfTen(usize),
    /// A model file that cannot be used.
    #[error("{}", one_line(.0))]
    ModelFile(String),
    /// A checkpoint that cannot be used.
    #[error("{}", one_line(.0))]
    Checkpoint(String),
    /// More memory than is available.
    #[error(
        "this needs about {:.1} GB of memory, most of it for {taken_by}, and {:.1} GB are available: {advice}",
        .needed / 1e9,
        .available / 1e9
    )]
    Memory {
        /// Bytes needed, as estimated.
        needed: f64,
        available: f64,
        taken_by: String,
        advice: &'static str,
    },
    /// The observer stopped the fit before there was a model.
    #[error(
        "stopped before there was a first model: allow more time, or choose a smaller model or fewer rows"
    )]
    Stopped,
}

/// Largest magnitude of a value of a record; beyond it the square of a scaled value could overflow.
pub const LARGEST_VALUE: f64 = 1e100;

/// Most turning points of a lead-in: a model runs along them before the first row of each record.
pub const MOST_TURNS: usize = 1_000;

/// Shortest memory of [`Stepper::adapt`](crate::model::Stepper::adapt) in rows.
pub const FEWEST_ADAPTATION_ROWS: usize = 10;

/// A defect of a record, with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct DataError {
    /// Name of the record.
    pub record: String,
    /// Row within the record, counted from 0; `None` if the whole record is meant.
    pub row: Option<usize>,
    /// The column meant; `None` if no single one.
    pub channel: Option<Channel>,
    /// Problem of the data.
    pub problem: DataProblem,
}

/// A column of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Time stamps.
    Time,
    /// An input, counted from 0.
    Input(usize),
    /// The given rate of the first input.
    Rate,
    /// The output.
    Output,
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Channel::Time => write!(f, "time"),
            Channel::Input(0) => write!(f, "input"),
            Channel::Input(n) => write!(f, "input {}", n + 1),
            Channel::Rate => write!(f, "rate"),
            Channel::Output => write!(f, "output"),
        }
    }
}

/// Problem of a record.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each has its fields")]
pub enum DataProblem {
    /// No rows at all.
    #[error("has no rows")]
    Empty,
    /// A column of another length than the first input.
    #[error("has {found} values where the first input has {expected}")]
    Length { expected: usize, found: usize },
    /// A weight of a row that cannot be used.
    #[error("has the weight {found}: a finite number above 0 is needed")]
    Weight { found: f64 },
    /// A column of another length than the displacement.
    #[error("has {found} values where the displacement has {expected}")]
    LengthOf { expected: usize, found: usize },
    /// Fewer rows than the window of a filter has.
    #[error(
        "has {}: at least {needed} rows are needed, the window of the filter that differentiates it",
        if *.found == 1 { "1 row".to_string() } else { format!("{} rows", .found) }
    )]
    TooFewForWindow { found: usize, needed: usize },
    /// NaN or infinity where a number is needed.
    #[error("{0} is not a finite number")]
    NotFinite(f64),
    /// A magnitude beyond [`LARGEST_VALUE`].
    #[error("{0:e} is too large: at most {LARGEST_VALUE:e} in magnitude (choose another unit)")]
    TooLarge(f64),
    /// Time does not increase.
    #[error(
        "time {now} does not come after {before} (sort the rows, or name the records in a column `record`)"
    )]
    TimeNotIncreasing { before: f64, now: f64 },
    /// A rate that overflows because a time step is too short.
    #[error("the rate here is {0:.2e}: the time step is too small (is the time column right?)")]
    RateTooLarge(f64),
    /// A rate needs time stamps, and there are none.
    #[error("there is no time column to compute the rate from")]
    NoTime,
    /// The model needs time and there is none.
    #[error("there is no time column, and the model needs one")]
    NoTimeForModel,
    /// The given rate is missing.
    #[error("the measured rate is missing (the model was trained with one)")]
    NoGivenRate,
    /// A turning point before the first row that is not a usable number.
    #[error("the lead-in has the value {0}: finite numbers of at most {LARGEST_VALUE:e} are needed")]
    LeadIn(f64),
    /// Ranges of an input and the output that no slope can have.
    #[error(
        "has a range of {:.2}, and the output one of {:.2}: their ratio must be from 1e-50 to 1e50 (choose other units)",
        Significant(*input), Significant(*output)
    )]
    Ranges { input: f64, output: f64 },
    /// A lead-in with more turning points than [`MOST_TURNS`].
    #[error("the lead-in has {0} turning points: at most {MOST_TURNS} are possible")]
    LongLeadIn(usize),
    /// The number of inputs is not what it must be.
    #[error("has {found} inputs where {expected} are expected")]
    Inputs { expected: usize, found: usize },
    /// The input has one value throughout.
    #[error("is constant ({}): there is nothing to identify", Significant(*.0))]
    ConstantInput(f64),
    /// The input goes one way only.
    #[error("never turns: one branch does not determine the parameters of {0} (measure a whole loop)")]
    NeverTurns(&'static str),
    /// The output has no part that is a magnetisation.
    #[error(
        "has no part that rises with the field and saturates on both sides of 0, as a magnetisation does (is the sign of \
         one of them reversed, or is the input not measured from 0?)"
    )]
    NoMagnetisation,
    /// The output has one value throughout.
    #[error("is constant ({}): there is nothing to identify", Significant(*.0))]
    ConstantOutput(f64),
    /// The output is blank throughout.
    #[error("is blank in every row: there is nothing to compare with")]
    NothingToScore,
    /// The output is blank in every row after the known beginning.
    #[error("is blank after the known beginning: there is nothing to compare with")]
    NothingAfterBeginning,
    /// The output is blank in the known beginning of a record.
    #[error("is blank in the first {0} rows, from which the state is to be found")]
    NothingKnown(usize),
    /// An output is blank between others, where it becomes an input.
    #[error("is blank here: the output is the input of an inverse, which needs a value in every row")]
    BlankWithin,
    /// Too few rows with an output for a test of the residual.
    #[error("has only {found} rows with an output: tests of the residual need at least {needed}")]
    TooFewForTests { found: usize, needed: usize },
    /// Too few rows with an output after the warm-up.
    #[error(
        "has only {found} rows with an output after a warm-up of {warm_up} rows: at least {needed} are needed to identify a \
         model (shorten the warm-up)"
    )]
    LongWarmUp { warm_up: usize, found: usize, needed: usize },
    /// Too few rows with an output.
    #[error("has only {found} rows with an output: at least {needed} are needed to identify a model")]
    TooFewRows { found: usize, needed: usize },
}

impl DataProblem {
    /// True for a problem of a column in all records, which is reported with the first of them.
    pub fn is_of_whole_column(&self) -> bool {
        matches!(
            self,
            Self::ConstantInput(_)
                | Self::ConstantOutput(_)
                | Self::NothingToScore
                | Self::NothingAfterBeginning
                | Self::LongWarmUp { .. }
                | Self::Ranges { .. }
                | Self::NeverTurns(_)
                | Self::NoMagnetisation
        )
    }
}

impl fmt::Display for DataError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "record \"{}\"", one_line(&self.record))?;
        if let Some(row) = self.row {
            write!(f, ", row {}", row + 1)?;
        }
        if let Some(channel) = self.channel {
            write!(f, ", {channel}")?;
        }
        write!(f, ": {}", self.problem)
    }
}

impl std::error::Error for DataError {}

/// A defect in the measured motion of a mass, with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionError {
    /// Place of the record, counted from 0.
    pub record: usize,
    /// Row within the record, counted from 0; `None` if the whole record is meant.
    pub row: Option<usize>,
    /// The column meant.
    pub column: MotionColumn,
    /// Problem of the row or column.
    pub problem: DataProblem,
}

/// A column of the measured motion of a mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say all")]
pub enum MotionColumn {
    Time,
    Displacement,
    Velocity,
    Acceleration,
    BaseAcceleration,
    AppliedForce,
}

impl MotionColumn {
    /// Names the column, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::BaseAcceleration => "base acceleration",
            Self::AppliedForce => "applied force",
        }
    }
}

impl fmt::Display for MotionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "record {}", self.record + 1)?;
        if let Some(row) = self.row {
            write!(f, ", row {}", row + 1)?;
        }
        write!(f, ", {}: {}", self.column.name(), self.problem)
    }
}

impl std::error::Error for MotionError {}

/// A sample that a model cannot take.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each has its fields")]
pub enum SampleError {
    /// Another number of inputs than the model has.
    #[error("{found} inputs where the model has {expected}")]
    Inputs { expected: usize, found: usize },
    /// A time stamp that does not come after the last sample's.
    #[error("time {0} does not come after the last sample's")]
    Time(f64),
    /// No time, or one that is not a finite number, where it is needed.
    #[error("the time of the sample is missing or not finite, and {needed_by} needs it")]
    NoTime {
        /// Part of the model that needs time, in words.
        needed_by: &'static str,
    },
    /// NaN or infinity.
    #[error("an input or its rate is {0}, not a finite number")]
    NotFinite(f64),
    /// A magnitude beyond [`LARGEST_VALUE`].
    #[error("an input or its rate is {0:e}, which is too large: at most {LARGEST_VALUE:e} in magnitude")]
    TooLarge(f64),
    /// A wanted output of NaN or infinity.
    #[error("the wanted output is {0}, not a finite number")]
    Wanted(f64),
    /// A measured output of NaN or infinity.
    #[error("the measured output is {0}, not a finite number")]
    Measured(f64),
    /// A measured output where no sample is committed.
    #[error(
        "there is no committed sample that this output was measured at: make a step, or commit the trial, first"
    )]
    NotCommitted,
    /// Rows of memory of an adaptation.
    #[error("a memory of {0} rows: at least {FEWEST_ADAPTATION_ROWS} are needed")]
    AdaptationRows(usize),
}

/// A bound of an [`Inverse`](crate::model::Inverse) that cannot be used, or a row that it cannot take.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each has its fields")]
pub enum InverseError {
    /// Limits of the input.
    #[error("the limits of the input are {0} and {1}: they must be finite, and the first the lower one")]
    Limits(f64, f64),
    /// Largest rate of the input.
    #[error("the largest rate of the input is {0}: it must be positive and finite")]
    Slew(f64),
    /// Time by which the wanted output is ahead.
    #[error("the preview is {0}: it must be 0 or positive, and finite")]
    Preview(f64),
    /// A row that the model cannot take.
    #[error("row {}: {problem}", .row + 1)]
    Row {
        /// The row, counted from 0.
        row: usize,
        problem: SampleError,
    },
    /// A column of another length than the wanted outputs.
    #[error("a column of {length} values for {rows} wanted outputs")]
    Length { rows: usize, length: usize },
    /// Time stamps are needed, and there are none.
    #[error("there are no time stamps, and the model, its slew limit or its preview needs them")]
    NoTime,
}

/// An option of a fit that cannot be used.
#[derive(Debug, Clone, PartialEq)]
pub struct OptionError {
    /// The name of the option, in words joined by underscores.
    pub option: String,
    /// Problem of the value.
    pub problem: OptionProblem,
}

/// Problem of an option of a fit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each has its fields")]
pub enum OptionProblem {
    /// The option is unknown; these are the known names.
    Unknown(Vec<&'static str>),
    /// It cannot have this value.
    Value {
        /// The value, as JSON.
        value: String,
        /// Valid values, in words.
        needed: String,
    },
}

impl OptionError {
    /// An error for an option with an invalid value; `needed` states in words which values are valid.
    pub fn value(option: impl Into<String>, value: impl ToString, needed: impl Into<String>) -> Self {
        let problem = OptionProblem::Value { value: value.to_string(), needed: needed.into() };
        Self { option: option.into(), problem }
    }

    /// An error for an unknown name of an option.
    pub fn unknown(option: impl Into<String>, known: Vec<&'static str>) -> Self {
        Self { option: option.into(), problem: OptionProblem::Unknown(known) }
    }
}

impl fmt::Display for OptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let option = one_line(&self.option);
        match &self.problem {
            OptionProblem::Unknown(known) => {
                write!(f, "there is no option `{option}`: the options are {}", known.join(", "))
            }
            OptionProblem::Value { value, needed } => write!(f, "{option} {}: {needed}", one_line(value)),
        }
    }
}

impl std::error::Error for OptionError {}

/// The text with visible signs in the place of control characters, which names in files may have.
fn one_line(text: &str) -> Cow<'_, str> {
    escaped(text, is_hidden)
}

/// True for control and format characters, separators of lines, characters without width, and non-characters.
pub fn is_hidden(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}')
        || matches!(letter, '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fdd0}'..='\u{fdef}' | '\u{fff9}'..='\u{fffb}')
        || matches!(letter, '\u{e0000}'..='\u{e007f}')
        || u32::from(letter) & 0xfffe == 0xfffe
}

/// The text with visible signs, such as `\n` and `\x1b`, in the place of the letters that are hidden.
pub fn escaped(text: &str, is_hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_hidden) {
        return text.into();
    }
    let mut shown = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            plain if !is_hidden(plain) => shown.push(plain),
            '\n' => shown.push_str("\\n"),
            '\r' => shown.push_str("\\r"),
            '\t' => shown.push_str("\\t"),
            '\0'..='\x7f' => shown.push_str(&format!("\\x{:02x}", letter as u32)),
            hidden => shown.extend(hidden.escape_unicode()),
        }
    }
    shown.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_one_line_whatever_the_names() {
        let error = "xp\n\x1b".parse::<crate::options::ModelName>().unwrap_err().to_string();
        assert!(error.starts_with("model `xp\\n\\x1b` is unknown"), "{error}");
        let problem = DataProblem::Empty;
        let record = "a\u{9b}b".to_string();
        let error = DataError { record, row: None, channel: None, problem }.to_string();
        assert_eq!(error, "record \"a\\u{9b}b\": has no rows");
    }
}
