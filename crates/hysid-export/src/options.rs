//! Options of an export.

use hysid_core::model::BandLevel;

use crate::description::RateSource;
use crate::program::Precision;

/// Options of an export.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// An identifier, with which all names of the export begin.
    pub name: String,
    /// Precision of the arithmetic.
    pub precision: Precision,
    /// How a model that needs the rate gets it.
    pub rate: RateSource,
    /// Also compute half the width of the prediction band with this content.
    pub band: Option<BandLevel>,
    /// Version of a Functional Mock-up Unit.
    pub fmi: FmiVersion,
    /// Also export the inverse of the model, with these bounds of its input.
    pub inverse: Option<InverseOptions>,
    /// Facts about the source that the model itself does not have, as they are to be shown: its file, the date.
    pub source: Vec<(String, String)>,
}

impl Options {
    /// Double precision and backward differences.
    pub fn named(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            precision: Precision::default(),
            rate: RateSource::default(),
            band: None,
            fmi: FmiVersion::default(),
            inverse: None,
            source: Vec::new(),
        }
    }
}

/// Bounds of the input that an inverse gives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InverseOptions {
    /// Lowest and highest input, in its unit, in place of the trained range.
    pub limits: Option<(f64, f64)>,
    /// Largest change of the input in a unit of time. The first sample is free.
    pub slew: Option<f64>,
}

/// Version of the Functional Mock-up Interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FmiVersion {
    /// FMI 3.0
    #[default]
    Three,
    /// FMI 2.0
    Two,
}

impl FmiVersion {
    /// `3.0` or `2.0`.
    pub fn number(self) -> &'static str {
        match self {
            Self::Three => "3.0",
            Self::Two => "2.0",
        }
    }

    pub(crate) fn source(self) -> &'static str {
        match self {
            Self::Three => "fmi3.c",
            Self::Two => "fmi2.c",
        }
    }
}
