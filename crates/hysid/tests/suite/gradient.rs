//! Derivatives against difference quotients of the whole simulation, and the gradient of the
//! objective against those of its value.

use hysid_core::elementary::{ln, powi, sin, square};

use crate::scaffold::*;

/// Turning points at random, five samples between, no two alike.
fn path(rows: usize, generator: &mut Generator) -> Vec<f64> {
    let mut turning = between(generator, 0.2, 0.9);
    let mut x = Vec::new();
    while x.len() < rows {
        let to = between(generator, -1.0, 1.0);
        x.extend((0..5).map(|k| turning + (to - turning) * k as f64 / 5.0));
        turning = to;
    }
    x.truncate(rows);
    x
}

fn random_drive(a: &Architecture, rows: usize, generator: &mut Generator) -> NetworkDrive {
    let channels = (0..a.channels()).map(|_| path(rows, generator)).collect();
    let steps = (0..rows).map(|k| if k == 0 { 0.0 } else { between(generator, 0.02, 0.4) });
    NetworkDrive { channels, steps: if a.relaxation > 0 { steps.collect() } else { Vec::new() } }
}

fn random_parameters(layout: &ParameterLayout, ln_beta: f64, generator: &mut Generator) -> Vec<f64> {
    (0..layout.len())
        .map(|k| {
            if layout.ln_beta.contains(&k) {
                ln_beta + between(generator, -0.5, 0.5)
            } else if layout.ln_tau.contains(&k) {
                between(generator, -2.0, 2.0)
            } else if layout.stop_weights.contains(&k) {
                between(generator, -4.0, 4.0)
            } else {
                between(generator, -0.7, 0.7)
            }
        })
        .collect()
}

pub fn run(network: &Network, drive: &NetworkDrive) -> Vec<f64> {
    let u: Vec<&[f64]> = drive.channels.iter().map(Vec::as_slice).collect();
    let mut y = vec![0.0; drive.len()];
    network.simulator().run(&u, &drive.steps, &mut y);
    y
}

fn with(network: &Network, index: usize, change: f64) -> Network {
    let mut parameters = network.parameters().to_vec();
    parameters[index] += change;
    Network::new(*network.architecture(), parameters, network.output().to_vec()).unwrap()
}

/// `(y(θ + up) - y(θ - down)) / (up + down)`.
fn quotient(network: &Network, drive: &NetworkDrive, index: usize, up: f64, down: f64) -> Vec<f64> {
    let (above, below) = (run(&with(network, index, up), drive), run(&with(network, index, -down), drive));
    above.iter().zip(&below).map(|(a, b)| (a - b) / (up + down)).collect()
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

#[test]
fn the_jacobian_is_that_of_the_whole_simulation() {
    let mut generator = Generator::seed_from_u64(1);
    let (mut columns, mut vivid) = (0, 0);
    for family in Family::ALL {
        let inputs: &[usize] = if family.takes_further_inputs() { &[1, 3] } else { &[1] };
        for &inputs in inputs {
            for (stops, hidden, ln_beta) in [(1, 1, 5.0), (9, 3, 4.0), (5, 2, 2.0)] {
                let sizes = Sizes { stops, hidden, relaxation: 2 };
                let a = Architecture::new(family, sizes, inputs, true, true).unwrap();
                let layout = ParameterLayout::new(a);
                let parameters = random_parameters(&layout, ln_beta, &mut generator);
                let output = (0..a.output_weights()).map(|_| between(&mut generator, -1.0, 1.0)).collect();
                let network = Network::new(a, parameters, output).unwrap();
                let drive = random_drive(&a, 150, &mut generator);
                let linearised = network.linearise(&drive);
                let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
                assert!(same(&linearised.output, &run(&network, &drive)));
                assert_eq!(linearised.jacobian.len(), layout.len());

                let largest = linearised.jacobian.iter().map(|column| norm(column)).fold(0.0, f64::max);
                for (k, column) in linearised.jacobian.iter().enumerate() {
                    let expected = quotient(&network, &drive, k, 1e-6, 1e-6);
                    // A column that is 0 (a stop that never slips has no use for its β) has no norm.
                    let tolerance = 1e-6 * norm(&expected) + 1e-9 * largest;
                    let error = distance(column, &expected);
                    assert!(error < tolerance, "{}: {error} in {}", layout.names()[k], norm(&expected));
                    columns += 1;
                    vivid += usize::from(norm(&expected) > 1e-3 * largest);
                }
            }
        }
    }
    assert!(columns > 300 && vivid > 9 * columns / 10, "{vivid} of {columns}");
}

/// Inputs for which a stop behind the weight 1 (of the first channel) exactly touches its threshold.
#[test]
fn at_a_kink_the_derivative_is_one_of_the_two() {
    let paths: [&[f64]; 6] = [
        // touches +1 from virgin, and goes back
        &[0.0, 0.5, 1.0, 0.75, -0.25, -0.5],
        // begins at the threshold
        &[1.0, 0.25, 0.5, -0.5, -0.75],
        // slips up, then touches the lower threshold
        &[0.0, 2.0, 0.0, 0.25, 0.5],
        // stays at the threshold
        &[0.0, -1.0, -1.0, -1.0, 0.5],
        // touches both
        &[0.0, 1.0, -1.0, 1.0, 0.0],
        // touches and then slips on
        &[0.0, 1.0, 1.5, 0.25],
    ];
    let mut kinks = 0;
    for family in [Family::Pnn, Family::Gpnn] {
        let sizes = Sizes { stops: 1, hidden: 0, relaxation: 0 };
        let a = Architecture::new(family, sizes, 1, false, false).unwrap();
        for path in paths {
            for weight in [1.0, -1.0] {
                let mut parameters = vec![weight];
                parameters.extend(a.deterioration.then_some(ln(8.0)));
                let network = Network::new(a, parameters, vec![0.25, 1.0]).unwrap();
                let drive = NetworkDrive { channels: vec![path.to_vec()], steps: Vec::new() };
                let slope = network.linearise(&drive).jacobian[0].clone();
                let h = powi(0.5, 26);
                let right = quotient(&network, &drive, 0, h, 0.0);
                let left = quotient(&network, &drive, 0, 0.0, h);
                let near = |side: &[f64]| distance(&slope, side) < 1e-5;
                assert!(near(&left) || near(&right), "{path:?}: {slope:?}, not {left:?} or {right:?}");
                kinks += usize::from(distance(&left, &right) > 0.1);
            }
        }
    }
    assert!(kinks >= 18, "{kinks} paths have a kink");
}

/// Two records with blanks, sampled from something that no network here reproduces.
fn measured(time: bool) -> Dataset {
    let mut generator = Generator::seed_from_u64(3);
    let records = (0..2)
        .map(|r| {
            let rows = [90, 113][r];
            let x = path(rows, &mut generator);
            let z: Vec<f64> = path(rows, &mut generator);
            let y = (0..rows).map(|k| {
                let blank = (20..37).contains(&k) || k % 11 == 3;
                if blank { f64::NAN } else { 3.0 + sin(2.0 * x[k]) + 0.5 * z[k] * z[k] }
            });
            let record = Record::new(format!("r{r}"), vec![x.clone()], y.collect()).unwrap();
            if time {
                record.with_time((0..rows).map(|k| k as f64 + 0.3 * sin(k as f64)).collect()).unwrap()
            } else {
                record
            }
        })
        .collect();
    Dataset::new(ColumnNames::plain(1), records).unwrap()
}

struct Case {
    data: Dataset,
    scaling: Scaling,
    architecture: Architecture,
    options: FitOptions,
    parameters: Vec<f64>,
}

fn case(family: Family, ridge: f64, decay: f64) -> Case {
    let time = family == Family::XpnnPlus;
    let data = measured(time);
    let rate = time.then_some(hysid::data::rate::RateMethod::Central);
    let sizes = Sizes { stops: 3, hidden: 2, relaxation: 2 };
    let architecture = Architecture::new(family, sizes, 1, time, time).unwrap();
    let options =
        FitOptions { model: family, rate, ridge: Some(ridge), decay: Some(decay), ..FitOptions::default() };
    let scaling = Scaling::of(&data, rate).unwrap();
    let parameters =
        random_parameters(&ParameterLayout::new(architecture), 4.0, &mut Generator::seed_from_u64(17));
    Case { data, scaling, architecture, options, parameters }
}

impl Case {
    fn objective(&self) -> Objective<'static> {
        Objective::new(&self.data, &self.scaling, self.architecture, &self.options).unwrap()
    }

    /// Difference quotients of fourth order.
    fn expected_gradient(&self) -> Vec<f64> {
        let objective = self.objective();
        let h = 1e-5;
        let at = |k: usize, steps: f64| {
            let mut parameters = self.parameters.clone();
            parameters[k] += steps * h;
            objective.value(&parameters).objective
        };
        (0..self.parameters.len())
            .map(|k| (8.0 * (at(k, 1.0) - at(k, -1.0)) - (at(k, 2.0) - at(k, -2.0))) / (12.0 * h))
            .collect()
    }

    /// Dense `Φ`, `J`, both by columns, and `r`, over the rows that are scored.
    fn dense(&self, weights: &[f64]) -> (Vec<Vec<f64>>, Vec<Vec<f64>>, Vec<f64>) {
        let network =
            |output: Vec<f64>| Network::new(self.architecture, self.parameters.clone(), output).unwrap();
        let m = weights.len();
        let (mut features, mut jacobian) = (vec![Vec::new(); m], vec![Vec::new(); self.parameters.len()]);
        let mut residual = Vec::new();
        for record in self.data.records() {
            let drive = self.scaling.drive(record, &self.architecture, self.options.rate).unwrap();
            let target = self.scaling.scaled_output(record.output());
            let scored: Vec<usize> = (0..record.len()).filter(|&k| !target[k].is_nan()).collect();
            let keep = |column: &[f64]| scored.iter().map(|&k| column[k]).collect::<Vec<f64>>();
            for (i, feature) in features.iter_mut().enumerate() {
                let unit = (0..m).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
                feature.extend(keep(&run(&network(unit), &drive)));
            }
            let linearised = network(weights.to_vec()).linearise(&drive);
            for (all, column) in jacobian.iter_mut().zip(&linearised.jacobian) {
                all.extend(keep(column));
            }
            residual.extend(scored.iter().map(|&k| linearised.output[k] - target[k]));
        }
        (features, jacobian, residual)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

const FAMILIES: [Family; 4] = [Family::Pnn, Family::PreisachNn, Family::Xpnn, Family::XpnnPlus];

#[test]
fn the_gradient_is_that_of_the_value() {
    for family in FAMILIES {
        for ridge in [0.0, 1e-5, 1e-3] {
            // Without ridge, features of xpnn+ are too nearly dependent to take differences of.
            if ridge == 0.0 && family == Family::XpnnPlus {
                continue;
            }
            for decay in [0.0, 1e-6, 1e-2] {
                let case = case(family, ridge, decay);
                let objective = case.objective();
                let gradient = objective.gradient(&case.parameters, &objective.value(&case.parameters));
                let expected = case.expected_gradient();
                let error = distance(&gradient, &expected) / norm(&expected);
                assert!(error < 1e-5, "{family:?}, ridge {ridge}, decay {decay}: {error}");
                assert!(norm(&expected) > 1e-3);
            }
        }
    }
}

/// The dense sums of theory.md (3.1) and (3.3) over the scored rows alone.
#[test]
fn value_and_gradient_are_sums_over_the_scored_rows() {
    for family in FAMILIES {
        let case = case(family, 1e-3, 1e-2);
        let objective = case.objective();
        let value = objective.value(&case.parameters);
        let weights = value.output_weights();
        let (features, jacobian, residual) = case.dense(weights);
        let n = residual.len() as f64;
        assert_eq!(residual.len(), case.data.scored());
        assert!(case.data.scored() < case.data.rows() - 40);

        let layout = ParameterLayout::new(case.architecture);
        let decayed = |k: usize| if layout.is_weight(k) { case.parameters[k] } else { 0.0 };
        let square: f64 = (0..layout.len()).map(|k| square(decayed(k))).sum();
        let penalty = 0.5 * 1e-3 * dot(&weights[1..], &weights[1..]) + 0.5 * 1e-2 * square;
        let dense = 0.5 * dot(&residual, &residual) / n + penalty;
        assert!((value.objective - dense).abs() < 1e-11 * dense, "{} is not {dense}", value.objective);

        let dense: Vec<f64> =
            jacobian.iter().enumerate().map(|(k, j)| dot(j, &residual) / n + 1e-2 * decayed(k)).collect();
        let gradient = objective.gradient(&case.parameters, &value);
        assert!(distance(&gradient, &dense) < 1e-9 * norm(&dense));

        // theory.md (3.2): the output weights are the best ones.
        for (i, feature) in features.iter().enumerate() {
            let ridge = if i == 0 { 0.0 } else { 1e-3 };
            assert!((dot(feature, &residual) / n + ridge * weights[i]).abs() < 1e-9);
        }
    }
}
