//! Every instruction set of the machine simulates a cell to the same bits, and so is its Gram matrix.

use super::cell::{Cell, CellShape, Input};
use super::*;
use crate::elementary::exp;
use crate::random::uniform;
use crate::stop_check::StopCheck;

const SHAPE: CellShape = CellShape {
    channels: 2,
    stops: 5,
    states: 3,
    neurons: 13,
    has_time: true,
    has_acceleration: false,
    direct: 0,
    modulators: 0,
    is_odd: false,
};

/// With everything that is optional.
const FULL: CellShape = CellShape { has_acceleration: true, direct: 1, modulators: 2, is_odd: true, ..SHAPE };

/// Numbers from -1 to 1.
fn numbers(seed: u64, count: usize) -> Vec<f64> {
    (0..count as u64).map(|k| 2.0 * uniform(seed << 32 | k) - 1.0).collect()
}

fn cell(shape: CellShape) -> Cell {
    let positive = |seed: u64| numbers(seed, shape.states).iter().map(|ln| exp(*ln)).collect();
    Cell {
        stops: numbers(1, shape.channels * shape.stops).iter().map(|w| 3.0 * w).collect(),
        hidden: numbers(2, shape.inputs() * shape.neurons),
        targets: numbers(3, shape.states * shape.neurons),
        rate_gains: numbers(4, shape.states),
        initial: numbers(5, shape.states),
        path_leaks: positive(6),
        relaxation_times: positive(7),
        output: numbers(8, shape.terms()),
        acceleration_scale: shape.has_acceleration.then_some(0.7),
        direct_inputs: shape.direct,
        layer_modulation: numbers(13, shape.modulators * shape.neurons),
        target_modulation: numbers(14, shape.modulators * shape.states),
        is_odd: shape.is_odd,
    }
}

fn inputs(rows: usize) -> Vec<Input> {
    let columns = [numbers(9, rows), numbers(10, rows), numbers(11, rows)];
    let input = |k: usize| Input {
        x: columns[0][k],
        from_origin: 2.0 * columns[0][k],
        rate: columns[1][k],
        step: columns[2][k].abs(),
    };
    (0..rows).map(input).collect()
}

struct CellOutputs<'a>(&'a Cell, &'a [Input], &'a [f64]);

impl WithSimd for CellOutputs<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let Self(cell, inputs, further) = self;
        let width = further.len() / inputs.len();
        let mut memory = cell.memory();
        let mut outputs = Vec::with_capacity(inputs.len());
        for (row, &input) in inputs.iter().enumerate() {
            let further = &further[row * width..][..width];
            outputs.push(CellStep { cell, memory: &mut memory, input, further }.with_simd(simd));
        }
        outputs
    }
}

#[test]
fn simulations_and_gram_matrices_are_equal() {
    for shape in [SHAPE, FULL] {
        let (cell, inputs) = (cell(shape), inputs(600));
        let further = numbers(15, inputs.len() * (shape.direct + shape.modulators));
        assert_eq!(cell.shape(), shape);
        let outputs = simd::run_with_all(|| CellOutputs(&cell, &inputs, &further));
        assert!(outputs[0].iter().all(|y| y.is_finite()));
        assert!(outputs.iter().all(|y| *y == outputs[0]));

        let targets = [numbers(12, inputs.len())];
        let run = sensitivities::CellRun {
            cell: &cell,
            drives: &[inputs],
            further: &[further],
            initial: &[],
            targets: &targets,
            with_jacobian: true,
            stop: StopCheck::never(),
        };
        let grams = run.grams_of_all();
        assert!(grams[0].iter().all(|entry| entry.is_finite()));
        assert!(grams.iter().all(|gram| *gram == grams[0]));
    }
}
