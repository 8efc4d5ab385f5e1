//! Every instruction set of the machine simulates a cell to the same bits, and so is its Gram matrix.

use super::cell::{Cell, CellShape, Input};
use super::*;
use crate::elementary::exp;
use crate::random::uniform;
use crate::stop_check::StopCheck;

const SHAPE: CellShape = CellShape { channels: 2, stops: 5, states: 3, neurons: 13, has_time: true };

/// Numbers from -1 to 1.
fn numbers(seed: u64, count: usize) -> Vec<f64> {
    (0..count as u64).map(|k| 2.0 * uniform(seed << 32 | k) - 1.0).collect()
}

fn cell() -> Cell {
    let positive = |seed: u64| numbers(seed, SHAPE.states).iter().map(|ln| exp(*ln)).collect();
    Cell {
        stops: numbers(1, SHAPE.channels * SHAPE.stops).iter().map(|w| 3.0 * w).collect(),
        hidden: numbers(2, SHAPE.inputs() * SHAPE.neurons),
        targets: numbers(3, SHAPE.states * SHAPE.neurons),
        rate_gains: numbers(4, SHAPE.states),
        initial: numbers(5, SHAPE.states),
        path_leaks: positive(6),
        relaxation_times: positive(7),
        output: numbers(8, SHAPE.terms()),
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

struct CellOutputs<'a>(&'a Cell, &'a [Input]);

impl WithSimd for CellOutputs<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let Self(cell, inputs) = self;
        let mut memory = cell.memory();
        let mut outputs = Vec::with_capacity(inputs.len());
        for &input in inputs {
            outputs.push(CellStep { cell, memory: &mut memory, input }.with_simd(simd));
        }
        outputs
    }
}

#[test]
fn simulations_and_gram_matrices_are_equal() {
    let (cell, inputs) = (cell(), inputs(600));
    assert_eq!(cell.shape(), SHAPE);
    let outputs = simd::run_with_all(|| CellOutputs(&cell, &inputs));
    assert!(outputs[0].iter().all(|y| y.is_finite()));
    assert!(outputs.iter().all(|y| *y == outputs[0]));

    let targets = [numbers(12, inputs.len())];
    let run = sensitivities::CellRun {
        cell: &cell,
        drives: &[inputs],
        targets: &targets,
        with_jacobian: true,
        stop: StopCheck::never(),
    };
    let grams = run.grams_of_all();
    assert!(grams[0].iter().all(|entry| entry.is_finite()));
    assert!(grams.iter().all(|gram| *gram == grams[0]));
}
