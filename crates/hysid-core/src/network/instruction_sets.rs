//! Every instruction set of the machine simulates a network to the same bits, and so are its derivatives.

use super::*;
use crate::random::uniform;
use crate::stop_check::StopCheck;

/// Two records of a network with all parts and three groups of stops, of which one is not full.
struct SimdCase {
    network: Network,
    drives: [NetworkDrive; 2],
    targets: [Vec<f64>; 2],
}

impl SimdCase {
    fn new() -> Self {
        let architecture = Architecture::new(
            Family::XpnnPlus,
            Sizes { stops: 19, hidden: 11, relaxation: 2 },
            2,
            true,
            true,
        )
        .unwrap();
        let number = |k: u64| 2.0 * uniform(k) - 1.0;
        let numbers = |seed: u64, count: usize| (0..count as u64).map(move |k| number(seed << 32 | k));
        let mut parameters: Vec<f64> =
            numbers(1, architecture.searched_parameters()).map(|p| 2.0 * p).collect();
        ParameterLayout::new(architecture).clamp(&mut parameters);
        let output = numbers(2, architecture.output_weights()).collect();
        let drive = |seed: u64, rows: usize| NetworkDrive {
            channels: (0..3).map(|c| numbers(seed + c, rows).map(|u| 3.0 * u).collect()).collect(),
            steps: numbers(seed + 3, rows).map(f64::abs).collect(),
        };
        let target = |seed: u64, rows: usize| -> Vec<f64> {
            let blank = |(row, y): (usize, f64)| if row % 7 == 3 { f64::NAN } else { y };
            numbers(seed, rows).enumerate().map(blank).collect()
        };
        Self {
            network: Network::new(architecture, parameters, output).unwrap(),
            drives: [drive(10, 700), drive(20, 41)],
            targets: [target(30, 700), target(40, 41)],
        }
    }

    fn columns(&self) -> JacobianColumns<'_> {
        JacobianColumns {
            architecture: &self.network.architecture,
            parameters: &self.network.parameters,
            output: Some(&self.network.output),
        }
    }
}

/// The first record in one run, and then once more sample by sample.
struct NetworkOutputs<'a>(&'a SimdCase);

impl WithSimd for NetworkOutputs<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let drive = &self.0.drives[0];
        let mut simulator = self.0.network.simulator();
        let u: Vec<&[f64]> = drive.channels.iter().map(Vec::as_slice).collect();
        let mut y = vec![0.0; drive.len()];
        NetworkRun { simulator: &mut simulator, u: &u, steps: &drive.steps, y: &mut y }.with_simd(simd);
        for (row, &step) in drive.steps.iter().enumerate() {
            let u: Vec<f64> = drive.channels.iter().map(|channel| channel[row]).collect();
            y.push(NetworkStep { simulator: &mut simulator, u: &u, step }.with_simd(simd));
        }
        y
    }
}

/// Asserts that all rows of numbers have the same bits and are finite.
fn must_be_equal(of_all: &[Vec<f64>]) {
    let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<u64>>();
    assert!(of_all[0].iter().all(|number| number.is_finite()));
    assert!(of_all.iter().all(|numbers| bits(numbers) == bits(&of_all[0])));
}

#[test]
fn simulations_are_equal() {
    let case = SimdCase::new();
    must_be_equal(&simd::run_with_all(|| NetworkOutputs(&case)));
}

#[test]
fn gram_matrices_are_equal() {
    let case = SimdCase::new();
    let columns = case.columns();
    let grams = simd::run_with_all(|| GramOverRecords {
        columns,
        drives: &case.drives,
        targets: &case.targets,
        stop: StopCheck::never(),
    });
    let n = columns.count();
    let numbers = grams.iter().map(|gram| (0..n * n).map(|k| gram.at(k / n, k % n)).collect::<Vec<f64>>());
    must_be_equal(&numbers.collect::<Vec<_>>());
}

#[test]
fn jacobians_are_equal() {
    let case = SimdCase::new();
    let jacobians = simd::run_with_all(|| RowsOverRecords {
        columns: case.columns(),
        first: 0,
        drives: &case.drives,
        targets: &case.targets,
        stop: StopCheck::never(),
    });
    must_be_equal(&jacobians.iter().map(|columns| columns.concat()).collect::<Vec<_>>());
}

#[test]
fn gradients_are_equal() {
    let case = SimdCase::new();
    must_be_equal(&simd::run_with_all(|| GradientOverRecords {
        architecture: &case.network.architecture,
        parameters: &case.network.parameters,
        output: &case.network.output,
        drives: &case.drives,
        targets: &case.targets,
        stop: StopCheck::never(),
    }));
}
