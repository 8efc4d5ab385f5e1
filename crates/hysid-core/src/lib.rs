//! Hysteresis models that run: measured records, the operators of hysteresis, the family of networks, the classical
//! laws, and the model file. The crate `hysid` finds models; this one is what they need to simulate.
//!
//! No input or output, no clock, no threads, no random numbers, no unsafe code. Each room uses only those before it:
//! [`data`], [`operator`], [`network`], [`law`], [`options`], [`model`].

pub mod data;
pub mod error;
pub mod law;
pub mod linear_algebra;
pub mod model;
pub mod network;
pub mod operator;
pub mod options;
pub mod property;
pub mod random;
pub mod significant;
pub mod simd;
pub mod stop_check;
pub mod termination;

pub use error::{Error, Result};
