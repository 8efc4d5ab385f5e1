//! The properties of hysteresis that a test, or the equations of a model, can decide: theory.md section 10.

use std::fmt;

use serde::Serialize;

/// A property that hysteresis may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Property {
    /// There is a loop however slowly the input goes.
    StaticHysteresis,
    /// Loops are passed clockwise, `∮ y dx > 0`, as those of friction are.
    Orientation,
    /// The speed of the input matters.
    RateDependence,
    /// A closed excursion of the input leaves no trace (return-point memory).
    WipingOut,
    /// Minor loops between the same inputs have the same shape.
    Congruency,
    /// All branches are the same curve, magnified.
    Masing,
    /// A branch turned by half a turn is the opposite branch.
    OddSymmetry,
    /// The output hardly grows at the ends of the input.
    Saturation,
    /// Loops shrink when they are repeated.
    Deterioration,
    /// A period of the input brings the output back to where it was.
    LoopClosure,
}

impl Property {
    /// All properties, in the order in which they are reported.
    pub const ALL: [Self; 10] = [
        Self::StaticHysteresis,
        Self::Orientation,
        Self::RateDependence,
        Self::WipingOut,
        Self::Congruency,
        Self::Masing,
        Self::OddSymmetry,
        Self::Saturation,
        Self::Deterioration,
        Self::LoopClosure,
    ];

    /// Its name, in words joined by hyphens.
    pub fn name(self) -> &'static str {
        match self {
            Self::StaticHysteresis => "static-hysteresis",
            Self::Orientation => "orientation",
            Self::RateDependence => "rate-dependence",
            Self::WipingOut => "wiping-out",
            Self::Congruency => "congruency",
            Self::Masing => "masing",
            Self::OddSymmetry => "odd-symmetry",
            Self::Saturation => "saturation",
            Self::Deterioration => "deterioration",
            Self::LoopClosure => "loop-closure",
        }
    }
}

impl fmt::Display for Property {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
