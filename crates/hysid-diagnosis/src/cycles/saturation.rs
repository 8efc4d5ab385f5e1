//! Saturation of a magnet with a slope under it: the law of approach to saturation, fitted to the outer parts of the loops.
//!
//! ```text
//! M = ± M_s (1 - b/H²) + χ H + M_0
//! ```

use hysid_core::data::record::Record;
use hysid_core::elementary::{hypot, square};

use super::least_squares::fit;
use super::path::range;
use super::record_figure::{RecordFigure, record_figures};

/// The outer part of the input, as a share of half its swing.
const OUTER: f64 = 0.7;

/// Largest difference of the two ends of the input, as a share of its swing.
const SYMMETRIC: f64 = 0.1;

/// Largest deviation of a saturation, as a share of it.
const UNSURE: f64 = 0.02;

/// Largest share of the saturation that is missing at the ends of the input.
const MISSING: f64 = 0.1;

record_figures! {
    SATURATION: "saturation_output", "saturation", "M_s", Output, "B. D. Cullity, C. D. Graham, Introduction to Magnetic Materials, 2009, section 9.17";
    SLOPE: "high_field_slope", "high-field slope", "χ", Stiffness, "B. D. Cullity, C. D. Graham, Introduction to Magnetic Materials, 2009, section 9.17";
}

/// Saturation and slope at high field of a record.
pub(super) fn figures(record: &Record) -> Vec<RecordFigure> {
    let whose = (record.name(), "");
    let absent = |why: &str| vec![RecordFigure::new(whose, SATURATION, None).with_note(why)];
    let (x, y) = (&*record.inputs()[0], record.output());
    let (low, high) = range(x);
    let (swing, middle) = (high - low, 0.5 * (low + high));
    if middle.abs() > SYMMETRIC * swing {
        return absent("the input does not go equally far to both sides of 0");
    }
    let half = 0.5 * swing;
    let outer: Vec<(f64, f64)> = x
        .iter()
        .zip(y)
        .filter(|(x, y)| x.abs() >= OUTER * half && !y.is_nan())
        .map(|(x, y)| (x / half, *y))
        .collect();
    let outputs: Vec<f64> = outer.iter().map(|(_, y)| *y).collect();
    // The coefficient of 1/|H| in place of 1/H² shows how much the law decides.
    let law = |power: fn(f64) -> f64| {
        let rows: Vec<[f64; 4]> =
            outer.iter().map(|(h, _)| [h.signum(), -h.signum() / power(*h), *h, 1.0]).collect();
        fit(&rows, &outputs)
    };
    let Some((found, other)) = law(square).zip(law(f64::abs)) else {
        return absent("too few rows in the outer 30 % of the input");
    };
    let ([saturation, missing, slope, _], [alternative, _, other_slope, _]) =
        (found.coefficients, other.coefficients);
    let deviation = hypot(found.deviations[0], 0.5 * (saturation - alternative));
    let is_near = missing.abs() <= MISSING * saturation;
    if !(saturation > 0.0 && deviation <= UNSURE * saturation && is_near) {
        return absent("the output still rises too much in the outer 30 % of the input for an estimate");
    }
    let slope_deviation = hypot(found.deviations[2], 0.5 * (slope - other_slope));
    vec![
        RecordFigure::new(whose, SATURATION, saturation).with_deviation(deviation),
        RecordFigure::new(whose, SLOPE, slope / half).with_deviation(slope_deviation / half),
    ]
}
