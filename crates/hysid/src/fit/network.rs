//! Identification of networks.
//!
//! [`fit`] does all of it: it scales the data, trains several random networks by the chosen trainer,
//! cross-validates some of them, and trains the best few on all data. [`resume`] continues a fit from a
//! [`Checkpoint`].
//!
//! ```text
//! F(θ) = min_c [ ½ ‖Φ(θ) c - y‖²/N + ½ λ ‖c‖² ] + ½ κ ‖θ‖²_w               theory.md (3.1)
//! ```
//!
//! All trainers minimize `F`. `θ` are the parameters found by search, `c` the output weights (by least
//! squares, for each `θ`), `Φ` the terms of the output, one row for each of the `N` scored samples, `y` the
//! scaled measured output, `λ` and `κ` the penalties
//! ([`Regularisation`](crate::options::network::Regularisation)).

mod curvature;
mod encoding;
mod fitting;
mod memory_need;
pub mod objective;
mod run;
mod soundness;

pub(crate) use memory_need::memory_need;

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::initial_state::StateRequest;
use crate::fit::progress::{Checkpoint, Fitted, Observer};
use crate::law::facts::Origin;
use crate::model::input_transform::TransformedData;
use crate::options::network::FitOptions;
use fitting::Fitting;

/// Identifies a network.
///
/// `observer` is called after every epoch. If it returns `Break`, the fit ends with the best model so far,
/// and with [`Stopped`](crate::termination::Termination::Stopped) as the reason. It is also called during
/// long epochs, so that a fit stops soon; the results of an incomplete epoch are discarded. The result
/// depends on data, options and seed only, not on the number of threads.
///
/// # Errors
/// Data from which no model can be identified, invalid options, or a stop before there was a model.
pub fn fit(data: &Dataset, options: &FitOptions, observer: &mut Observer<'_>) -> Result<Fitted> {
    let begun = wanted_of(options).of(data, observer)?;
    let data = begun.as_ref();
    let seen = TransformedData::of(data, &options.shaping, options.rate, Origin::OfData)?;
    Fitting::new(data, &seen, options.clone())?.run(observer)
}

fn wanted_of(options: &FitOptions) -> StateRequest {
    let FitOptions { shaping, rate, seed, .. } = *options;
    StateRequest { state: shaping.initial_state, origin: Origin::OfData, rate, seed }
}

/// Resumes a fit of the same data. The result is the same to the last bit as without the interruption.
///
/// # Errors
/// A checkpoint of other data, or one that is inconsistent.
pub fn resume(data: &Dataset, checkpoint: Checkpoint, observer: &mut Observer<'_>) -> Result<Fitted> {
    let begun = wanted_of(checkpoint.options()).of(data, observer)?;
    let data = begun.as_ref();
    let (options, state) = checkpoint.for_data(data)?;
    let seen = TransformedData::of(data, &options.shaping, options.rate, Origin::OfData)?;
    Fitting::new(data, &seen, options)?.from(state)?.run(observer)
}
