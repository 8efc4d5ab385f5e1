//! Identification of any model by its name: a network, a classical model, or `auto`.

pub mod auto;
pub(crate) mod initial_state;
pub mod intervals;
pub mod law;
mod memory_need;
pub mod network;
mod one_model;
pub mod progress;
mod random_start;
pub(crate) mod sums;
mod validate;

use crate::data::FEWEST_ROWS;
use crate::data::record::Dataset;
use crate::error::{Channel, DataProblem, Result};
use crate::fit::progress::{Fitted, Observer};
use crate::options::FitSpec;

pub use memory_need::{MemoryNeed, memory_need};
pub use validate::cross_validate;

/// Identifies a model. The observer is as in [`network::fit`]; it is called after every round of the search
/// of a classical model, or at intervals if there is no search, and then without a checkpoint.
///
/// # Errors
/// Data from which no model can be identified, invalid options, or a stop before there was a model.
pub fn identify(data: &Dataset, request: &FitSpec, observer: &mut Observer<'_>) -> Result<Fitted> {
    check_warm_up(data, request)?;
    match request {
        FitSpec::Auto(options) => auto::fit(data, options, observer),
        FitSpec::Network(_) | FitSpec::Classical(_) => one_model::identify(data, request, observer),
    }
}

/// Checks that a warm-up leaves enough to train on.
fn check_warm_up(data: &Dataset, request: &FitSpec) -> Result<()> {
    let warm_up = match request {
        FitSpec::Network(options) => options.shaping.warm_up,
        FitSpec::Auto(options) => options.warm_up.unwrap_or(0),
        FitSpec::Classical(options) => options.shaping.warm_up,
    };
    if warm_up == 0 || data.scored() < FEWEST_ROWS {
        return Ok(());
    }
    let after = data.records().iter().flat_map(|record| record.output().iter().skip(warm_up));
    let found = after.filter(|y| !y.is_nan()).count();
    let problem = DataProblem::LongWarmUp { warm_up, found, needed: FEWEST_ROWS };
    match found < FEWEST_ROWS {
        true => Err(data.records()[0].defect(None, Some(Channel::Output), problem)),
        false => Ok(()),
    }
}
