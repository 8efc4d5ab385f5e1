//! The inverse of a model in an export: its bounds, and what its steps must give.

mod vectors;

use hysid_core::error::{Error as CoreError, InverseError};
use hysid_core::model::{MOST_TRIALS, Model};

use crate::description::{Argument, Description};
use crate::error::Error;
use crate::options::InverseOptions;
use crate::program::Precision;
use crate::vectors::Action;

pub(crate) use vectors::InverseVector;

// The parts of the search in `target/c/inverse.c.txt`, which is written by hand.
const _: () = assert!(MOST_TRIALS == 2 + 2 * (1 + 24 + 33 + 40 + 3 * 60) + 2);

/// Units in the last place of single precision at which a search ends.
const SINGLE_UNITS: f64 = 8.0;

/// The inverse of a model in an export.
pub(crate) struct ExportedInverse {
    pub limits: (f64, f64),
    /// Largest change of the input in a unit of time.
    pub slew: Option<f64>,
    /// Largest rate of the training data, for a model with a rate.
    pub trained_rate: Option<f64>,
    /// Deviation of the output at which a search ends.
    pub tolerance: f64,
    /// Deviation that counts as reached where no number between two inputs is left, as a multiple of the tolerance.
    pub accepted: f64,
    pub arguments: Vec<Argument>,
    /// Test vectors of its steps.
    pub vectors: Vec<InverseVector>,
}

impl ExportedInverse {
    /// The inverse of a model with this description.
    ///
    /// # Errors
    /// Bounds that cannot be used, also after they are rounded to the precision; a rate that is an argument.
    pub fn of(
        model: &Model,
        options: InverseOptions,
        description: &Description,
        precision: Precision,
    ) -> Result<Self, Error> {
        if description.arguments.contains(&Argument::Rate) {
            return Err(Error::InverseRate);
        }
        let rounded = |value: f64| match precision {
            Precision::Double => value,
            Precision::Single => Precision::single(value).into(),
        };
        let (low, high) = options.limits.unwrap_or(model.trained_ranges().inputs[0]);
        let limits = (rounded(low), rounded(high));
        let slew = options.slew.map(rounded);
        let mut inverse = model.inverse().by_search().limits(limits.0, limits.1).map_err(refused)?;
        if let Some(slew) = slew {
            inverse = inverse.slew(slew).map_err(refused)?;
        }
        let (tolerance, accepted) = match precision {
            Precision::Double => (inverse.tolerance(), 1e3),
            Precision::Single => (single_tolerance(model, limits).max(inverse.tolerance()), 10.0),
        };
        let mut arguments = description.arguments[1..].to_vec();
        if slew.is_some() && !arguments.contains(&Argument::TimeStep) {
            arguments.push(Argument::TimeStep);
        }
        let vectors = vectors::vectors(model, inverse, &arguments);
        let trained_rate = model.inverse().trained_rate().map(rounded);
        Ok(Self { limits, slew, trained_rate, tolerance, accepted, arguments, vectors })
    }

    pub fn argument_names(&self) -> Vec<String> {
        self.arguments.iter().map(|argument| argument.name()).collect()
    }

    pub fn vectors_csv(&self) -> String {
        let names: String = self.argument_names().iter().map(|name| format!("{name},")).collect();
        let rows = self.vectors.iter().map(|vector| {
            let arguments: Vec<String> = match vector.action {
                Action::Step => vector.arguments.iter().map(|value| format!("{value:?}")).collect(),
                _ => vec![String::new(); self.arguments.len() + 1],
            };
            let given = vector.given.map_or(",,".to_string(), |given| {
                format!("{:?},{:?},{}", given.input, given.output, given.reach.word())
            });
            format!("{},{},{given}\n", vector.action.name(), arguments.join(","))
        });
        format!("action,wanted,{names}input,output,reach\n") + &rows.collect::<String>()
    }
}

/// Eight units in the last place of the largest output, or of the largest input by the average slope.
fn single_tolerance(model: &Model, limits: (f64, f64)) -> f64 {
    let (low, high) = model.trained_ranges().output;
    let (least, most) = model.trained_ranges().inputs[0];
    let slope = (high - low) / (most - least);
    let of_input = slope * limits.0.abs().max(limits.1.abs());
    SINGLE_UNITS * f64::from(f32::EPSILON) * of_input.max(low.abs()).max(high.abs())
}

fn refused(error: CoreError) -> Error {
    match error {
        CoreError::Inverse(InverseError::Slew(_)) => Error::Slew(error.to_string()),
        error => Error::Limits(error.to_string()),
    }
}
