//! Identification of hysteresis.
pub mod operator;
