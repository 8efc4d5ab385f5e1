//! Every instruction set of the machine simulates a model to the same bits, and so is its Gram matrix.

use super::tests::{SHAPE, drive, in_motion, model, samples};
use super::*;

struct DynamicsOutputs<'a>(&'a Dynamics, &'a [Sample]);

impl WithSimd for DynamicsOutputs<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let Self(dynamics, samples) = self;
        let mut motion = dynamics.virgin();
        let mut outputs = Vec::with_capacity(samples.len());
        for &sample in samples {
            outputs.push(DynamicsStep { dynamics, motion: &mut motion, sample }.with_simd(simd));
        }
        outputs
    }
}

#[test]
fn simulations_and_gram_matrices_are_equal() {
    let dynamics = model(8, 2, 2, SHAPE, 0.5);
    let drives = [drive(2, 100, 0.1), drive(3, 30, 0.2)];
    let samples = samples(&drives[0]);
    let outputs = simd::run_with_all(|| DynamicsOutputs(&dynamics, &samples));
    assert!(outputs[0].iter().all(|y| y.is_finite()));
    assert!(outputs.iter().all(|y| *y == outputs[0]));

    let layout = DynamicsLayout::new(DynamicsForm::StateSpace, 2, 2, SHAPE);
    let grams = in_motion(&dynamics, &drives, &[]).grams_of_all(&layout);
    assert!(grams[0].iter().all(|entry| entry.is_finite()));
    assert!(grams.iter().all(|gram| *gram == grams[0]));
}
