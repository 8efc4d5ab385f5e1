//! The twelve properties, by the names that the program gives them.

/// Names in the order of the answers of a law.
pub const PROPERTIES: [&str; 12] = [
    "static-hysteresis",
    "orientation",
    "rate-dependence",
    "wiping-out",
    "congruency",
    "masing",
    "odd-symmetry",
    "saturation",
    "deterioration",
    "loop-closure",
    "strength-loss",
    "pinching",
];

pub const STATIC_HYSTERESIS: usize = 0;
pub const ORIENTATION: usize = 1;
pub const RATE_DEPENDENCE: usize = 2;
pub const WIPING_OUT: usize = 3;
pub const CONGRUENCY: usize = 4;
pub const MASING: usize = 5;
pub const ODD_SYMMETRY: usize = 6;
pub const SATURATION: usize = 7;
pub const DETERIORATION: usize = 8;
pub const LOOP_CLOSURE: usize = 9;
pub const STRENGTH_LOSS: usize = 10;
pub const PINCHING: usize = 11;

/// Properties from here on are told of structural members alone.
pub const OF_MEMBERS: usize = STRENGTH_LOSS;

/// Yes, no, or no clear answer, for each property.
pub type Answers = [Option<bool>; PROPERTIES.len()];
