//! What the equations of a law decide, theory.md (10.35): a property, and whether every such law has it.

use crate::property::Property;

/// Return-point memory, and what follows from it.
pub const WIPES_OUT: [(Property, bool); 3] =
    [(Property::WipingOut, true), (Property::Deterioration, false), (Property::LoopClosure, true)];

/// Minor loops between the same inputs have the same shape.
pub const CONGRUENT: (Property, bool) = (Property::Congruency, true);

/// All branches are the same curve, magnified.
pub const MASING: (Property, bool) = (Property::Masing, true);

/// A branch turned by half a turn is the opposite branch.
pub const ODD: (Property, bool) = (Property::OddSymmetry, true);

/// The speed of the input does not matter.
pub const RATE_INDEPENDENT: (Property, bool) = (Property::RateDependence, false);
