//! First-order reversal curves in words.

use hysid::diagnosis::reversal_curves::{ReversalCurves, ReversalNode};

use super::Cycles;

/// Number of curves, smoothing and largest density in a sentence without full stop.
/// `number` writes a number.
pub fn summary(cycles: &Cycles, curves: &ReversalCurves, number: impl Fn(f64) -> String) -> String {
    let whose = if cycles.of_model { " of the model" } else { "" };
    let direction = if curves.rising { "rising" } else { "falling" };
    let chosen = if curves.smoothing_is_chosen { "chosen by the noise" } else { "as asked for" };
    let q = &cycles.quantities;
    let with_unit = |value: f64, column: &str| hysid_document::unit::with(&number(value), column);
    let largest = largest(curves).map_or_else(String::new, |node| {
        format!(
            "; the largest density is {} at the reversal input {} and the input {}",
            with_unit(node.density.unwrap_or_default(), &q.as_density("density")),
            number(node.reversal_input),
            number(node.input)
        )
    });
    format!(
        "{} {direction} first-order reversal curves{whose}, {} apart, that end at {}; smoothing factor {} ({chosen}){largest}",
        curves.curves.len(),
        with_unit(curves.step, &q.input),
        with_unit(curves.end, &q.input),
        curves.smoothing_factor,
    )
}

fn largest(curves: &ReversalCurves) -> Option<&ReversalNode> {
    let known = curves.nodes.iter().filter(|node| node.density.is_some());
    known.max_by(|a, b| a.density.unwrap_or(0.0).total_cmp(&b.density.unwrap_or(0.0)))
}
