//! Properties of hysteresis that a test, or the equations of a model, can decide.

use std::fmt;

use serde::Serialize;

/// A property that hysteresis may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Property {
    /// There is a loop at any speed of the input, however low.
    StaticHysteresis,
    /// Loops are clockwise, `∮ y dx > 0`, as those of friction are.
    Orientation,
    /// The output depends on the speed of the input.
    RateDependence,
    /// A closed excursion of the input has no effect on the later output (return-point memory).
    WipingOut,
    /// Minor loops between the same inputs have the same shape.
    Congruency,
    /// All branches are the same curve, magnified.
    Masing,
    /// A branch turned by half a turn is the opposite branch.
    OddSymmetry,
    /// The slope of the output is small at the ends of the input range.
    Saturation,
    /// Loops shrink when they are repeated.
    Deterioration,
    /// After a period of the input the output has its earlier value.
    LoopClosure,
    /// The force at the tips of cycles falls with the amplitude, or from cycle to cycle. Of measured forces only.
    StrengthLoss,
    /// Near zero load the stiffness is low, and grows again on the way to the tip. Only measured forces are tested.
    Pinching,
    /// After any past, each output that can be reached in one step belongs to one input. Of models only.
    Invertible,
}

impl Property {
    /// The properties of data and of models, in the order in which they are reported. [`Property::Invertible`], of models
    /// only, follows them, and [`Property::StrengthLoss`] and [`Property::Pinching`] of measured members.
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
            Self::StrengthLoss => "strength-loss",
            Self::Pinching => "pinching",
            Self::Invertible => "invertible",
        }
    }
}

impl fmt::Display for Property {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
