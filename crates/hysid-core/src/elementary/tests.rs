//! Tests of elementary functions: laws, values of high precision, and a checksum of many results.

mod bits;
mod laws;
mod values;

use super::*;

type Function = fn(f64) -> f64;

/// All functions of one number.
const FUNCTIONS: [(&str, Function); 9] = [
    ("exp", exp),
    ("exp_m1", exp_m1),
    ("ln", ln),
    ("ln_1p", ln_1p),
    ("tanh", tanh),
    ("sinh", sinh),
    ("asinh", asinh),
    ("sin", sin),
    ("cos", cos),
];
