//! Identification of hysteresis: from measured input and output to a small, stable model.
//!
//! ```
//! use std::ops::ControlFlow;
//! use hysid::operator::{Operator, Stop};
//! use hysid::data::record::{ColumnNames, Dataset, Record};
//! use hysid::options::network::FitOptions;
//! use hysid::fit::network::fit;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A specimen: an elastic spring beside a friction slider, driven by a growing oscillation.
//! let x: Vec<f64> = (0..600).map(|k| 0.01 * k as f64 * (0.1 * k as f64).sin()).collect();
//! let slider = Stop::new(1.0)?.run(&x);
//! let y: Vec<f64> = x.iter().zip(slider).map(|(x, slider)| 0.2 * x + slider).collect();
//!
//! let record = Record::new("test 1", vec![x], y)?;
//! let data = Dataset::new(ColumnNames::plain(1), vec![record])?;
//! let options = FitOptions { starts: 2, ..FitOptions::default() };
//! let fitted = fit(&data, &options, &mut |_| ControlFlow::Continue(()))?;
//!
//! let errors = fitted.model.evaluate(&data)?;
//! assert!(errors.nrmse_std_percent.unwrap() < 2.0);
//! let file = fitted.model.to_json();
//! assert_eq!(hysid::model::Model::from_json(&file)?, fitted.model);
//! # Ok(())
//! # }
//! ```
//!
//! The library does no input or output, keeps no global state and has no unsafe code. Where to find
//! what, each room using only those before it: [`data`] holds measured records, [`operator`] the elements of memory,
//! [`network`] the family of networks, [`law`] the classical models, [`options`] what can be asked for, [`model`] the
//! result, [`validation`] the folds, [`fit`] identifies; [`diagnosis`] tells what kind of hysteresis it is, and
//! [`plant`] makes data.

pub mod fit;
pub mod optimise;
pub mod validation;

pub(crate) use hysid_core::linear_algebra;
pub use hysid_core::{Error, Result};
pub use hysid_core::{
    data, error, law, model, network, operator, options, significant, simd, stop_check, termination,
};
pub use hysid_diagnosis as diagnosis;
pub use hysid_specimens as plant;

/// The examples of the README, compiled and run by the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
