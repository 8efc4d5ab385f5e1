//! Figures of a whole record: one type for all fields, shown in one way by all faces.

use serde::Serialize;

use super::figure::FigureQuantity;
use crate::distribution::t_quantile;

/// Confidence of intervals.
const CONFIDENCE: f64 = 0.95;

/// Definition of a figure of a record.
#[derive(Debug, PartialEq, Serialize)]
pub struct RecordFigureKind {
    /// Its name in tables, in JSON and in Python.
    pub name: &'static str,
    /// Name of the figure, in a few words.
    #[serde(skip)]
    pub label: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// Quantity whose unit it has.
    #[serde(skip)]
    pub quantity: FigureQuantity,
    /// Standard or publication that defines it.
    pub source: &'static str,
}

/// A figure of a record, or of a part of it such as one side of its backbone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordFigure {
    /// Name of the record; empty if it is of all records.
    pub record: String,
    /// Part of the record that it is of; empty for the whole.
    pub of: String,
    /// Definition.
    #[serde(flatten)]
    pub kind: &'static RecordFigureKind,
    /// Its value; `None` if the data do not give it, and `note` says why.
    pub value: Option<f64>,
    /// Standard deviation of the value, where it is estimated.
    pub deviation: Option<f64>,
    /// Ends of its 95 % interval, where it is estimated.
    pub interval: Option<(f64, f64)>,
    /// Why it is missing or to be read with care.
    pub note: Option<String>,
}

impl RecordFigure {
    /// A figure without deviation and note.
    pub(super) fn new(
        (record, of): (&str, &str),
        kind: &'static RecordFigureKind,
        value: impl Into<Option<f64>>,
    ) -> Self {
        let value = value.into().filter(|value| value.is_finite());
        Self {
            record: record.into(),
            of: of.into(),
            kind,
            value,
            deviation: None,
            interval: None,
            note: None,
        }
    }

    pub(super) fn with_deviation(self, deviation: f64) -> Self {
        let deviation = Some(deviation).filter(|deviation| deviation.is_finite());
        Self { deviation, ..self }
    }

    /// With the 95 % interval of Student's t.
    pub(super) fn with_interval(self, deviation: f64, degrees: f64) -> Self {
        let reach = t_quantile(1.0 - CONFIDENCE, degrees) * deviation;
        let interval = self.value.filter(|_| reach.is_finite()).map(|value| (value - reach, value + reach));
        Self { interval, ..self.with_deviation(deviation) }
    }

    pub(super) fn with_note(self, note: impl Into<String>) -> Self {
        Self { note: Some(note.into()), ..self }
    }
}

macro_rules! record_figures {
    ($($constant:ident: $name:literal, $label:literal, $symbol:literal, $quantity:ident, $source:literal;)*) => {
        $(pub(super) const $constant: &$crate::cycles::RecordFigureKind = &$crate::cycles::RecordFigureKind {
            name: $name,
            label: $label,
            symbol: $symbol,
            quantity: $crate::cycles::FigureQuantity::$quantity,
            source: $source,
        };)*
    };
}
pub(super) use record_figures;
