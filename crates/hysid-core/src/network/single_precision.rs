//! Free run of a network in single precision: faster, because a vector holds twice as many numbers.
//!
//! The equations are those of the [module of networks](crate::network). Two sums that grow with the record stay in
//! double precision: the slips, from block to block, because a small increment would vanish beside a large sum, and the
//! states of the relaxation neurons.
//!
//! As in [`Simulator`](crate::network::Simulator), the lanes of a vector are stops in the memory layer and rows in the
//! readout.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use crate::network::decay::decay;
use crate::network::readout::Readout;
use crate::network::{Layout, Network};
use crate::operator::relaxation;
use crate::simd;

/// Numbers in a vector of 512 bits.
const LANES: usize = 16;

/// Vectors of a block of rows.
const VECTORS: usize = 4;

/// Rows of a block. The slips are added up in double precision at its end.
const BLOCK: usize = LANES * VECTORS;

/// Largest magnitudes of a scaled input and of a weight. No sum of products exceeds the range of single precision.
const LARGEST_INPUT: f64 = 1e9;
const LARGEST_WEIGHT: f64 = 1e15;

type Lanes = [f32; LANES];

/// One quantity over a block of rows. It begins at a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Row([Lanes; VECTORS]);

const EMPTY: Row = Row([[0.0; LANES]; VECTORS]);

/// A network with its memory, which runs in single precision.
///
/// Inputs and outputs are scaled and in double precision, as those of [`Simulator`](crate::network::Simulator). The
/// outputs do not depend, to the last bit, on how a signal is divided into runs.
#[derive(Debug, Clone)]
pub struct SinglePrecisionSimulator {
    groups: Vec<Group>,
    stops: usize,
    linear: Option<Vec<f32>>,
    relaxation: Vec<RelaxationNeuron>,
    neurons: Vec<TanhNeuron>,
    constant: f32,
    direct: Vec<f32>,
    started: bool,
    /// Rows of the present block that are done.
    filled: usize,
    u: Vec<Row>,
    z: Vec<Row>,
}

/// Stops that advance together.
#[derive(Debug, Clone)]
struct Group {
    /// For each channel.
    weights: Vec<Lanes>,
    inverse_beta: Lanes,
    play: Lanes,
    /// Slip up to the present block, and in it.
    slip_before: [f64; LANES],
    slip: Lanes,
}

#[derive(Debug, Clone)]
struct RelaxationNeuron {
    channel: usize,
    inverse_tau: f64,
    stress: f64,
    /// Input of the last row.
    last: f64,
}

#[derive(Debug, Clone)]
struct TanhNeuron {
    bias: f32,
    /// For each memory neuron.
    weights: Vec<f32>,
    output: f32,
}

impl SinglePrecisionSimulator {
    /// A simulator in the virgin state.
    pub(super) fn new(network: &Network) -> Self {
        let (a, parameters) = (network.architecture(), network.parameters());
        let layout = Layout::new(*a);
        let channels = a.channels();
        let weights = &parameters[layout.stop_weights.clone()];
        let ln_beta = &parameters[layout.ln_beta.clone()];
        let group = |first: usize| {
            let lanes = |value: &dyn Fn(usize) -> f64| -> Lanes {
                std::array::from_fn(|l| if first + l < a.stops { rounded(value(first + l)) } else { 0.0 })
            };
            Group {
                weights: (0..channels).map(|c| lanes(&|j| weights[j * channels + c])).collect(),
                inverse_beta: lanes(&|j| ln_beta.get(j).map_or(0.0, |ln_beta| (-ln_beta).exp())),
                play: [0.0; LANES],
                slip_before: [0.0; LANES],
                slip: [0.0; LANES],
            }
        };
        let neuron = |(m, ln_tau): (usize, &f64)| {
            let input = m / a.relaxation;
            let channel = if input == 0 { 0 } else { input + usize::from(a.rate) };
            RelaxationNeuron { channel, inverse_tau: (-ln_tau).exp(), stress: 0.0, last: 0.0 }
        };
        let readout = Readout::new(a, parameters);
        let (constant, of_hidden, direct) = readout.split(network.output());
        let all = |values: &[f64]| values.iter().map(|&value| rounded(value)).collect::<Vec<f32>>();
        Self {
            groups: (0..a.stops).step_by(LANES).map(group).collect(),
            stops: a.stops,
            linear: a.linear.then(|| all(&parameters[layout.linear.clone()])),
            relaxation: parameters[layout.ln_tau.clone()].iter().enumerate().map(neuron).collect(),
            neurons: (of_hidden.iter().enumerate())
                .map(|(i, &output)| {
                    let (bias, weights) = readout.neuron(i);
                    TanhNeuron { bias: rounded(bias), weights: all(weights), output: rounded(output) }
                })
                .collect(),
            constant: rounded(constant),
            direct: all(direct),
            started: false,
            filled: 0,
            u: vec![EMPTY; channels],
            z: vec![EMPTY; a.memory_neurons()],
        }
    }

    /// Returns to the virgin state.
    pub fn reset(&mut self) {
        self.started = false;
        self.filled = 0;
        for group in &mut self.groups {
            (group.play, group.slip_before, group.slip) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        }
        for neuron in &mut self.relaxation {
            (neuron.stress, neuron.last) = (0.0, 0.0);
        }
    }

    /// Simulates the next rows, from the present memory on, as [`Simulator::run`](crate::network::Simulator::run).
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn run(&mut self, u: &[&[f64]], steps: &[f64], y: &mut [f64]) {
        assert_eq!(u.len(), self.u.len(), "one slice for each channel");
        assert!(u.iter().all(|u| u.len() == y.len()), "as many inputs as outputs");
        assert!(steps.len() == y.len() || steps.is_empty(), "as many time steps as outputs");
        simd::run(Run { simulator: self, u, steps, y });
    }
}

/// A weight in single precision.
fn rounded(weight: f64) -> f32 {
    weight.clamp(-LARGEST_WEIGHT, LARGEST_WEIGHT) as f32
}

struct Run<'a> {
    simulator: &'a mut SinglePrecisionSimulator,
    u: &'a [&'a [f64]],
    steps: &'a [f64],
    y: &'a mut [f64],
}

impl WithSimd for Run<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { simulator, u, steps, y } = self;
        let mut done = 0;
        while done < y.len() {
            let rows = simulator.filled..BLOCK.min(simulator.filled + y.len() - done);
            let next = done..done + rows.len();
            simulator.load(u, next.clone(), rows.start);
            simulator.relax::<S>(u, steps, next.clone(), rows.start);
            simulator.advance(simd, rows.clone());
            simulator.linear::<S>();
            let output = simulator.readout::<S>();
            for (y, &output) in y[next].iter_mut().zip(&output.0.as_flattened()[rows.clone()]) {
                *y = f64::from(output);
            }
            done += rows.len();
            simulator.filled = rows.end;
            if rows.end == BLOCK {
                simulator.end_block();
            }
        }
    }
}

impl SinglePrecisionSimulator {
    /// Takes the inputs of the next rows into the present block, from the row `first` of it on.
    #[inline(always)]
    fn load(&mut self, u: &[&[f64]], next: Range<usize>, first: usize) {
        for (row, u) in self.u.iter_mut().zip(u) {
            for (row, &u) in row.0.as_flattened_mut()[first..].iter_mut().zip(&u[next.clone()]) {
                let low = if u > -LARGEST_INPUT { u } else { -LARGEST_INPUT };
                *row = if low < LARGEST_INPUT { low } else { LARGEST_INPUT } as f32;
            }
        }
    }

    /// Advances the stops by these rows of the block.
    #[inline(always)]
    fn advance<S: Simd>(&mut self, simd: S, rows: Range<usize>) {
        let Self { groups, u, z, .. } = self;
        if !self.started {
            self.started = true;
            for group in groups.iter_mut() {
                let v = drive::<S>(&group.weights, u, rows.start);
                group.play = v.map(|v| follow(0.0, v));
            }
        }
        let first = usize::from(self.linear.is_some());
        for (g, group) in groups.iter_mut().enumerate() {
            let before = group.slip_before.iter().zip(group.inverse_beta);
            let mut strength = [0.0; LANES];
            for (strength, (slip, inverse_beta)) in strength.iter_mut().zip(before) {
                *strength = (1.0 - slip * f64::from(inverse_beta)) as f32;
            }
            let (inverse_beta, mut play, mut slip) = (group.inverse_beta, group.play, group.slip);
            let mut tile = [[0.0; LANES]; BLOCK];
            for t in rows.clone() {
                let v = drive::<S>(&group.weights, u, t);
                for l in 0..LANES {
                    let after = follow(play[l], v[l]);
                    slip[l] += (after - play[l]).abs();
                    play[l] = after;
                    let left = multiply_add::<S>(-slip[l], inverse_beta[l], strength[l]);
                    tile[t][l] = (v[l] - after) * if left > 0.0 { left } else { 0.0 };
                }
            }
            (group.play, group.slip) = (play, slip);
            let z = &mut z[first + g * LANES..self.stops.min((g + 1) * LANES) + first];
            for (index, tile) in tile.as_chunks::<LANES>().0.iter().enumerate() {
                if (index + 1) * LANES > rows.start && index * LANES < rows.end {
                    transpose(simd, tile, z, index);
                }
            }
        }
    }

    #[inline(always)]
    fn linear<S: Simd>(&mut self) {
        if let Some(weights) = &self.linear {
            let mut sum = EMPTY;
            for (&weight, u) in weights.iter().zip(&self.u) {
                accumulate::<S>(weight, u, &mut sum);
            }
            self.z[0] = sum;
        }
    }

    /// Advances the relaxation neurons by the next rows, which begin at the row `first` of the block.
    #[inline(always)]
    fn relax<S: Simd>(&mut self, u: &[&[f64]], steps: &[f64], next: Range<usize>, first: usize) {
        let behind = self.z.len() - self.relaxation.len();
        let mut factors = [[0.0; 2]; BLOCK];
        for (neuron, z) in self.relaxation.iter_mut().zip(&mut self.z[behind..]) {
            let steps = steps.get(next.clone()).unwrap_or(&[0.0; BLOCK][..next.len()]);
            for (factors, step) in factors.iter_mut().zip(steps) {
                let decay = decay::<S>(step * neuron.inverse_tau);
                *factors = [decay.stress, decay.increment];
            }
            let z = &mut z.0.as_flattened_mut()[first..];
            for ((z, &u), [left, gain]) in z.iter_mut().zip(&u[neuron.channel][next.clone()]).zip(factors) {
                let u = u.clamp(-LARGEST_INPUT, LARGEST_INPUT);
                neuron.stress = relaxation::advance(neuron.stress, u - neuron.last, (left, gain));
                neuron.last = u;
                *z = neuron.stress as f32;
            }
        }
    }

    /// Outputs of the rows of the block.
    #[inline(always)]
    fn readout<S: Simd>(&self) -> Row {
        let mut y = Row([[self.constant; LANES]; VECTORS]);
        let (pairs, rest) = self.neurons.as_chunks::<2>();
        for pair in pairs {
            add_neurons::<S, 2>(pair, &self.z, &mut y);
        }
        for neuron in rest {
            add_neurons::<S, 1>(std::array::from_ref(neuron), &self.z, &mut y);
        }
        for (&weight, z) in self.direct.iter().zip(&self.z) {
            accumulate::<S>(weight, z, &mut y);
        }
        y
    }

    /// Adds the slips of the block to those before.
    fn end_block(&mut self) {
        self.filled = 0;
        for group in &mut self.groups {
            for (sum, slip) in group.slip_before.iter_mut().zip(&mut group.slip) {
                *sum += f64::from(std::mem::take(slip));
            }
        }
    }
}

/// Input `v = w·u` of each stop of a group in the row `t`.
#[inline(always)]
fn drive<S: Simd>(weights: &[Lanes], u: &[Row], t: usize) -> Lanes {
    let mut v = [0.0; LANES];
    for (weights, u) in weights.iter().zip(u) {
        let u = u.0.as_flattened()[t];
        for l in 0..LANES {
            v[l] = multiply_add::<S>(weights[l], u, v[l]);
        }
    }
    v
}

/// A play of threshold 1.
#[inline(always)]
fn follow(play: f32, v: f32) -> f32 {
    let (low, high) = (v - 1.0, v + 1.0);
    let raised = if play > low { play } else { low };
    if raised < high { raised } else { high }
}

/// Adds the tanh neurons, times their output weights, to the outputs `y`.
#[inline(always)]
fn add_neurons<S: Simd, const K: usize>(neurons: &[TanhNeuron; K], z: &[Row], y: &mut Row) {
    let mut sums: [Row; K] = std::array::from_fn(|k| Row([[neurons[k].bias; LANES]; VECTORS]));
    let weights: [&[f32]; K] = std::array::from_fn(|k| &neurons[k].weights[..z.len()]);
    for (j, z) in z.iter().enumerate() {
        for k in 0..K {
            accumulate::<S>(weights[k][j], z, &mut sums[k]);
        }
    }
    for k in 0..K {
        for v in 0..VECTORS {
            for l in 0..LANES {
                y.0[v][l] = multiply_add::<S>(neurons[k].output, tanh::<S>(sums[k].0[v][l]), y.0[v][l]);
            }
        }
    }
}

/// `y += factor * x`, row by row.
#[inline(always)]
fn accumulate<S: Simd>(factor: f32, x: &Row, y: &mut Row) {
    for v in 0..VECTORS {
        for l in 0..LANES {
            y.0[v][l] = multiply_add::<S>(factor, x.0[v][l], y.0[v][l]);
        }
    }
}

/// tanh, as [`crate::network::tanh::tanh`], to 2e-7 of its value.
#[inline(always)]
fn tanh<S: Simd>(x: f32) -> f32 {
    /// Adding this rounds to an integer; the low bits of the sum are that integer plus the exponent bias 127.
    const ROUND: f32 = 12_582_912.0 + 127.0;
    /// `(tanh s / s - 1) / s²` by powers of `s²`, highest first: the Taylor series, whose error is 2e-8 of tanh s.
    const CUBIC_AND_UP: [f32; 3] = [-17.0 / 315.0, 2.0 / 15.0, -1.0 / 3.0];
    let magnitude = x.abs();
    // tanh 10 rounds to 1.
    let a = if magnitude < 10.0 { magnitude } else { 10.0 };
    let biased = multiply_add::<S>(a, 2.0 * std::f32::consts::LOG2_E, ROUND);
    let (k, power) = (biased - ROUND, f32::from_bits(biased.to_bits() << 23));
    let s = multiply_add::<S>(-k, 0.5 * std::f32::consts::LN_2, a);
    let square = s * s;
    let cubic = multiply_add::<S>(
        multiply_add::<S>(CUBIC_AND_UP[0], square, CUBIC_AND_UP[1]),
        square,
        CUBIC_AND_UP[2],
    );
    let t = multiply_add::<S>(square * s, cubic, s);
    let (less, more) = (power - 1.0, power + 1.0);
    (multiply_add::<S>(more, t, less) / multiply_add::<S>(less, t, more)).copysign(x)
}

/// `a * b + c`, in one rounding where the hardware fuses.
#[inline(always)]
fn multiply_add<S: Simd>(a: f32, b: f32, c: f32) -> f32 {
    if S::IS_SCALAR || cfg!(target_family = "wasm") { a * b + c } else { a.mul_add(b, c) }
}

/// Writes the columns of `rows` to the vector `index` of `columns`, by shuffles between registers where the machine has
/// them.
///
/// Four times, the two halves of the rows are merged number by number. Each time rotates the bits of every number's place
/// by one, so that in the end the four bits of the row and the four of the column have changed places.
#[inline(always)]
fn transpose<S: Simd>(simd: S, rows: &[Lanes; LANES], columns: &mut [Row], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = (&simd as &dyn std::any::Any).downcast_ref::<pulp::x86::V4>() {
        let rows = std::array::from_fn(|row| pulp::cast(pulp::x86::V4::as_simd_f32s(&rows[row]).0[0]));
        let turned = merge_halves(*simd, merge_halves(*simd, merge_halves(*simd, merge_halves(*simd, rows))));
        for (column, turned) in columns.iter_mut().zip(turned) {
            // Stored as a vector, which the compiler does not take apart again.
            pulp::x86::V4::as_mut_simd_f32s(&mut column.0[index]).0[0] = pulp::cast(turned);
        }
        return;
    }
    let _ = simd;
    for (l, column) in columns.iter_mut().enumerate() {
        for (value, row) in column.0[index].iter_mut().zip(rows) {
            *value = row[l];
        }
    }
}

#[cfg(target_arch = "x86_64")]
type Vectors = [std::arch::x86_64::__m512; LANES];

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn merge_halves(simd: pulp::x86::V4, rows: Vectors) -> Vectors {
    const LEFT: [i32; LANES] = [0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23];
    const RIGHT: [i32; LANES] = [8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31];
    let avx = simd.avx512f;
    let places = [pulp::cast(LEFT), pulp::cast(RIGHT)];
    std::array::from_fn(|row| {
        avx._mm512_permutex2var_ps(rows[row / 2], places[row % 2], rows[row / 2 + LANES / 2])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Architecture, Family, Sizes};

    struct All<'a>(&'a [f32], &'a mut [f32]);

    impl WithSimd for All<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            for (x, y) in self.0.iter().zip(self.1) {
                *y = tanh::<S>(*x);
            }
        }
    }

    #[test]
    fn tanh_agrees_with_double_precision() {
        let x: Vec<f32> = (-60_000..=60_000)
            .map(|k| k as f32 * 2.0e-4)
            .chain((0..300).map(|k| 10f32.powf(-k as f32 / 8.0)))
            .chain([0.0, f32::MAX, f32::INFINITY])
            .collect();
        let mut y = vec![0.0; x.len()];
        for dispatch in [|kernel: All| simd::run(kernel), |kernel: All| kernel.with_simd(pulp::Scalar::new())]
        {
            dispatch(All(&x, &mut y));
            for (&x, &y) in x.iter().zip(&y) {
                let exact = f64::from(x).tanh();
                assert!((f64::from(y) - exact).abs() <= 3e-7 * exact.abs(), "tanh({x}) = {y}, not {exact}");
                assert!(y.abs() <= 1.0);
            }
        }
    }

    /// A network of each family, of more stops than lanes and of fewer, with two inputs where it takes them.
    fn networks() -> Vec<Network> {
        let sizes = [(10, 10, 3), (19, 7, 1)];
        let architectures = Family::ALL.iter().flat_map(|family| {
            sizes.map(|(stops, hidden, relaxation)| {
                let inputs = if *family == Family::XpnnPlus { 2 } else { 1 };
                Architecture::new(*family, Sizes { stops, hidden, relaxation }, inputs, true, true).unwrap()
            })
        });
        let mut seed = 7_u64;
        let mut between = |low: f64, high: f64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * ((seed >> 11) as f64 / (1_u64 << 53) as f64)
        };
        architectures
            .map(|a: Architecture| {
                let layout = Layout::new(a);
                let parameters = (0..layout.len())
                    .map(|index| match index {
                        _ if layout.ln_beta.contains(&index) => between(6.0, 12.0),
                        _ if layout.ln_tau.contains(&index) => between(-3.0, 3.0),
                        _ if layout.stop_weights.contains(&index) => between(-20.0, 20.0),
                        _ => between(-1.0, 1.0),
                    })
                    .collect();
                let output = (0..a.output_weights()).map(|_| between(-1.0, 1.0)).collect();
                Network::new(a, parameters, output).unwrap()
            })
            .collect()
    }

    fn drive_of(network: &Network, rows: usize) -> (Vec<Vec<f64>>, Vec<f64>) {
        let channels = (0..network.architecture().channels()).map(|c| {
            let phase = c as f64;
            (0..rows).map(|t| (0.013 * t as f64 + phase).sin() * (0.000_71 * t as f64).cos()).collect()
        });
        (channels.collect(), (0..rows).map(|t| if t == 0 { 0.0 } else { 0.01 }).collect())
    }

    #[test]
    fn agrees_with_double_precision_over_a_long_record() {
        for network in networks() {
            let (u, steps) = drive_of(&network, 100_000);
            let u: Vec<&[f64]> = u.iter().map(Vec::as_slice).collect();
            let (mut single, mut double) = (vec![0.0; steps.len()], vec![0.0; steps.len()]);
            network.simulator_in_single_precision().run(&u, &steps, &mut single);
            network.simulator().run(&u, &steps, &mut double);
            let mean = double.iter().sum::<f64>() / double.len() as f64;
            let variance = double.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / double.len() as f64;
            let largest = single.iter().zip(&double).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let relative = largest / variance.sqrt();
            assert!(relative > 0.0 && relative < 3e-5, "{:?}: {relative}", network.architecture());
        }
    }

    #[test]
    fn outputs_do_not_depend_on_how_a_signal_is_divided() {
        for network in networks() {
            let (u, steps) = drive_of(&network, 700);
            let u: Vec<&[f64]> = u.iter().map(Vec::as_slice).collect();
            let mut whole = vec![0.0; steps.len()];
            let mut simulator = network.simulator_in_single_precision();
            simulator.run(&u, &steps, &mut whole);
            let mut parts = vec![f64::NAN; steps.len()];
            simulator.reset();
            let mut start = 0;
            for length in [1, 63, 64, 65, 7, 130, 1, 1, 368] {
                let rows = start..start + length;
                let u: Vec<&[f64]> = u.iter().map(|u| &u[rows.clone()]).collect();
                simulator.run(&u, &steps[rows.clone()], &mut parts[rows.clone()]);
                start = rows.end;
            }
            assert_eq!(start, steps.len());
            assert!(whole.iter().zip(&parts).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }

    #[test]
    fn outputs_are_finite_for_any_finite_input_and_extreme_parameters() {
        for network in networks() {
            let a = *network.architecture();
            let layout = Layout::new(a);
            for sign in [1.0, -1.0] {
                let parameters: Vec<f64> = (0..layout.len())
                    .map(|index| {
                        let (low, high) = layout.bounds(index);
                        if (index % 2 == 0) == (sign > 0.0) { low } else { high }
                    })
                    .collect();
                let output = (0..a.output_weights()).map(|i| sign * if i % 2 == 0 { 1e50 } else { -1e50 });
                let network = Network::new(a, parameters, output.collect()).unwrap();
                let values = [0.0, 1.0, -1e300, f64::MAX, f64::MIN, 1e-300, 3.0, -1e9];
                let column: Vec<f64> = values.iter().cycle().take(200).copied().collect();
                let u = vec![column.as_slice(); a.channels()];
                let mut y = vec![f64::NAN; column.len()];
                network.simulator_in_single_precision().run(&u, &vec![1e-3; y.len()], &mut y);
                assert!(y.iter().all(|y| y.is_finite()), "{a:?}: {y:?}");
            }
        }
    }
}
