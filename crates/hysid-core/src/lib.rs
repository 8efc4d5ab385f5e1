//! Hysteresis models that run: measured records, the operators of hysteresis, the family of networks, the
//! classical laws, and the model file.
//!
//! The crate `hysid` fits models to data; this one simulates them. To run a model file, read it with
//! [`Model::from_json`](model::Model::from_json) and simulate with [`Model::run`](model::Model::run) or
//! [`Model::stepper`](model::Model::stepper).
//!
//! The crate has no input or output, no clock, no threads, no random numbers and no unsafe code. Each of
//! these modules uses only those before it: [`elementary`], [`data`], [`operator`], [`network`], [`law`],
//! [`options`], [`model`].
//!
//! `theory.md (1.5)` on these pages is the number of an equation in `docs/theory.md` of the repository.

mod conversions;
pub mod data;
pub mod elementary;
pub mod error;
pub mod law;
pub mod linear_algebra;
pub mod model;
mod named;
pub mod network;
pub mod operator;
pub mod options;
pub mod property;
pub mod random;
pub mod significant;
pub mod simd;
pub mod stop_check;
pub mod termination;
pub mod words;

pub use error::{Error, Result};
