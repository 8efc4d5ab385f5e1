//! Identification of hysteresis: fits a small, stable simulation model to measured input and output.
//!
//! ```
//! use hysid::{Dataset, Fit, Model};
//! use hysid::operator::{Operator, Stop};
//!
//! # fn main() -> hysid::Result<()> {
//! // A spring beside a friction slider, driven by a growing oscillation.
//! let x: Vec<f64> = (0..600).map(|k| 0.01 * k as f64 * (0.1 * k as f64).sin()).collect();
//! let slider = Stop::new(1.0)?.run(&x);
//! let y: Vec<f64> = x.iter().zip(slider).map(|(x, slider)| 0.2 * x + slider).collect();
//!
//! let data = Dataset::from_slices(&x, &y)?;
//! let model = Fit::new().model("prandtl-ishlinskii").run(&data)?;
//! let errors = model.evaluate(&data)?;
//! assert!(errors.nrmse_std_percent.unwrap() < 2.0);
//!
//! let simulated = model.run(&x)?;
//! assert_eq!(simulated.len(), x.len());
//! assert_eq!(Model::from_json(&model.to_json())?, model);
//! # Ok(())
//! # }
//! ```
//!
//! [`fit`](fit()) takes the defaults: it cross-validates networks and classical models and combines the best.
//! [`Fit`] chooses a model, options, a time limit and an observer; [`validate`] estimates the error on new
//! data; [`diagnose`] determines the properties of the hysteresis in the data.
//! [`Model::stepper`] runs a model sample by sample, as a controller does.
//!
//! The library does no input or output, keeps no global state and has no unsafe code; only
//! [`Fit::time_limit`] reads a clock. Each of these modules uses only those before it: [`data`] holds
//! measured records, [`operator`] the operators with memory, [`law`] the classical models, [`options`] the
//! options of a fit, [`model`] the fitted model, [`validation`] the folds,
//! [`mod@fit`] the identification, [`plan`] what to measure next.
//! [`mod@restoring_force`] computes the force of an element from the motion of a mass. [`diagnosis`] finds properties of hysteresis, and [`specimens`] generates
//! synthetic data.
//!
//! `theory.md (1.5)` on these pages is the number of an equation in `docs/theory.md` of the repository.

mod builder;
pub mod fit;
#[doc(hidden)]
pub mod optimise;
pub mod plan;
pub mod restoring_force;
mod thread_pool;
mod time_limit;
pub mod validation;

pub use builder::Fit;
pub use hysid_core::data::record::{Dataset, Record};
pub use hysid_core::model::Model;
pub use hysid_core::{Error, Result};
#[doc(no_inline)]
pub use hysid_core::{data, error, law, model, operator, options};
pub(crate) use hysid_core::{linear_algebra, network, property, significant, stop_check, termination};
#[doc(no_inline)]
pub use hysid_diagnosis as diagnosis;
#[doc(no_inline)]
pub use hysid_specimens as specimens;
pub use restoring_force::restoring_force;
#[doc(hidden)]
pub use thread_pool::{MOST_THREADS, thread_pool};
#[doc(hidden)]
pub use time_limit::time_limit;

/// Fits a model to data with the defaults: cross-validates networks and classical models and combines the
/// best.
///
/// # Errors
/// Data from which no model can be identified, such as a constant input or output.
pub fn fit(data: &Dataset) -> Result<Model> {
    Fit::new().run(data)
}

/// Cross-validates the default fit: estimates its error on new data. [`Fit::validate`] does so for any other.
///
/// # Errors
/// As [`fit`](fit()), and data too few for two folds.
pub fn validate(data: &Dataset) -> Result<validation::CrossValidation> {
    Fit::new().validate(data)
}

/// Diagnoses the hysteresis in the data: ten properties, each with a verdict and its evidence.
///
/// # Errors
/// A constant input or output, or too few rows.
pub fn diagnose(data: &Dataset) -> Result<diagnosis::Diagnosis> {
    diagnosis::Diagnosis::of(data, &diagnosis::DiagnosisOptions::default())
}

/// The examples of the README, compiled and run by the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
