//! Warnings: each states what was found, why it matters, and what helps.

use std::fmt;

use crate::data::likeness::Likeness;
use crate::significant::Significant;

/// A warning, with its likely cause and a remedy.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each has its fields")]
pub enum Warning {
    /// A record has few turning points, so it contains little information about memory.
    FewTurningPoints { record: String, found: usize },
    /// Inputs or rates lie outside the range of the training data.
    OutsideTrainedRange { name: String, share_percent: f64, trained: (f64, f64), seen: (f64, f64) },
    /// Time steps of one record differ widely.
    UnevenTimeSteps { record: String, shortest: f64, longest: f64 },
    /// The measured output of a record is constant.
    ConstantOutput { record: String, value: f64 },
    /// Two records that are one measurement.
    SameMeasurement {
        /// The record that is a copy or a part.
        copy: String,
        of: String,
        likeness: Likeness,
    },
    /// A test record was used in training.
    TrainedOn { record: String, likeness: Likeness },
    /// The input of a record jumps at random from row to row, as if rows were not in the order of time.
    RowsOutOfOrder { record: String },
    /// A model has more parameters than there are rows to determine them.
    MoreParametersThanRows {
        /// Parameters of the model, or of the largest member of an ensemble.
        parameters: usize,
        rows: usize,
    },
}

impl Warning {
    /// A warning if there are more parameters than rows with an output; otherwise `None`.
    pub fn of_size(parameters: usize, rows: usize) -> Option<Self> {
        (parameters > rows).then_some(Self::MoreParametersThanRows { parameters, rows })
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FewTurningPoints { record, found } => {
                let times = match found {
                    0 => "never turns".to_string(),
                    1 => "turns only once".to_string(),
                    n => format!("turns only {n} times"),
                };
                write!(
                    f,
                    "record \"{record}\": the input {times}, so the data show little of the memory (measure \
                     several cycles of different amplitude)"
                )
            }
            Self::OutsideTrainedRange { name, share_percent, trained, seen } => write!(
                f,
                "{name}: {share_percent:.1} % of the rows are outside the trained range {:.4} to {:.4} (here {:.4} to {:.4}); \
                 the model extrapolates there (train on data that cover the range)",
                Significant(trained.0),
                Significant(trained.1),
                Significant(seen.0),
                Significant(seen.1)
            ),
            Self::UnevenTimeSteps { record, shortest, longest } => write!(
                f,
                "record \"{record}\": time steps vary from {:.3} to {:.3}, so rates are uncertain \
                 (are records joined, or samples missing? name the records, or use no rate)",
                Significant(*shortest),
                Significant(*longest)
            ),
            Self::SameMeasurement { copy, of, likeness } => write!(
                f,
                "record \"{copy}\" is {likeness} record \"{of}\": they count as one measurement and are held out together \
                 (remove one of them: the fit counts the same data twice)"
            ),
            Self::TrainedOn { record, likeness } => write!(
                f,
                "record \"{record}\" is {likeness} what the model was trained on: its error does not \
                 estimate that on unseen data"
            ),
            Self::RowsOutOfOrder { record } => write!(
                f,
                "record \"{record}\": the input jumps at random from row to row: are the rows in the order of time? (a model \
                 with memory needs that order; a shuffled split, such as ShuffleSplit, destroys it)"
            ),
            Self::MoreParametersThanRows { parameters, rows } => write!(
                f,
                "{parameters} parameters are fitted to {rows} rows: the model may overfit (measure more, or \
                 choose a smaller model, such as fewer stops and hidden neurons)"
            ),
            Self::ConstantOutput { record, value } => write!(
                f,
                "record \"{record}\": the output is {} throughout, so it carries no information (was the \
                 sensor connected?)",
                Significant(*value)
            ),
        }
    }
}
