//! Properties that follow from the equations of a law, each with whether every such law has it (theory.md
//! (10.35)).

use crate::property::Property;

/// Return-point memory, and the properties that follow from it.
pub const WIPES_OUT: [(Property, bool); 3] =
    [(Property::WipingOut, true), (Property::Deterioration, false), (Property::LoopClosure, true)];

/// Minor loops between the same inputs have the same shape.
pub const CONGRUENT: (Property, bool) = (Property::Congruency, true);

/// All branches are the same curve, magnified.
pub const MASING: (Property, bool) = (Property::Masing, true);

/// A branch turned by half a turn is the opposite branch.
pub const ODD: (Property, bool) = (Property::OddSymmetry, true);

/// The output does not depend on the speed of the input.
pub const RATE_INDEPENDENT: (Property, bool) = (Property::RateDependence, false);
