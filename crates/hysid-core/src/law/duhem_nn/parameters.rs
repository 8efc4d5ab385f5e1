//! The parameters found by search, as one flat vector.

use std::ops::Range;

use super::cell::{Cell, CellShape};
use crate::elementary::exp;

/// Positions of the parameters of a cell in the flat vector.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellLayout {
    /// The numbers of the parts.
    pub shape: CellShape,
    /// `b` and `A`, as [`Cell::hidden`].
    pub hidden: Range<usize>,
    /// `α`, as [`Cell::layer_modulation`].
    pub layer_modulation: Range<usize>,
    /// `β`, as [`Cell::target_modulation`].
    pub target_modulation: Range<usize>,
    /// `W`, as [`Cell::targets`].
    pub targets: Range<usize>,
    /// `q`; empty without a rate.
    pub rate_gains: Range<usize>,
    /// `s` before the first sample.
    pub initial: Range<usize>,
    /// `ln c`.
    pub ln_path_leaks: Range<usize>,
    /// `ln τ`; empty without time.
    pub ln_relaxation_times: Range<usize>,
    /// Weights of the stops, as [`Cell::stops`].
    pub stops: Range<usize>,
}

impl CellLayout {
    /// The layout of a shape.
    pub fn new(shape: CellShape) -> Self {
        let mut end = 0;
        let mut next = |length: usize| {
            let start = end;
            end += length;
            start..end
        };
        Self {
            shape,
            hidden: next(shape.inputs() * shape.neurons),
            layer_modulation: next(shape.modulators * shape.neurons),
            target_modulation: next(shape.modulators * shape.states),
            targets: next(shape.states * shape.neurons),
            rate_gains: next(if shape.channels == 2 { shape.states } else { 0 }),
            initial: next(shape.states),
            ln_path_leaks: next(shape.states),
            ln_relaxation_times: next(if shape.has_time { shape.states } else { 0 }),
            stops: next(shape.channels * shape.stops),
        }
    }

    /// Number of parameters.
    pub fn count(&self) -> usize {
        self.stops.end
    }

    /// True for a parameter with weight decay; not for `ln c`, `ln τ` and weights of stops, which may be large.
    pub fn has_decay(&self, index: usize) -> bool {
        index < self.ln_path_leaks.start
    }

    /// The cell with these parameters and output weights; its acceleration has a scale of 1.
    pub fn cell(&self, parameters: &[f64], output: Vec<f64>) -> Cell {
        let part = |range: &Range<usize>| parameters[range.clone()].to_vec();
        let exponentials =
            |range: &Range<usize>| parameters[range.clone()].iter().copied().map(exp).collect();
        Cell {
            stops: part(&self.stops),
            hidden: part(&self.hidden),
            targets: part(&self.targets),
            rate_gains: part(&self.rate_gains),
            initial: part(&self.initial),
            path_leaks: exponentials(&self.ln_path_leaks),
            relaxation_times: exponentials(&self.ln_relaxation_times),
            output,
            acceleration_scale: self.shape.has_acceleration.then_some(1.0),
            direct_inputs: self.shape.direct,
            layer_modulation: part(&self.layer_modulation),
            target_modulation: part(&self.target_modulation),
            is_odd: self.shape.is_odd,
        }
    }
}
