//! Synthetic specimens: materials and devices with hysteresis whose laws are known, to generate
//! records from and to test identification against.
//!
//! Every parameter set says where it comes from: *published*, with its source, or *designed*, chosen
//! by us so that the specimen shows what it is meant to show.

pub mod ferromagnet;

pub use ferromagnet::{Everett, Ferromagnet};
