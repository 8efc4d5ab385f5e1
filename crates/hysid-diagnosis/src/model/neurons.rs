//! Inside a network: what each neuron of the memory layer does on a path, and what the output would be
//! without a part of it.
//!
//! ```text
//! influence of a part = rms(y without it - y) / R                                        theory.md (10.36)
//! ```

use serde::Serialize;

use super::probe::{Probe, extent, times};
use super::properties::{PROTOCOL, repeated_loops};
use hysid_core::error::Result;
use hysid_core::network::scaling::Scaling;
use hysid_core::network::{Drive, Layout, Network};
use hysid_core::operator::{deteriorating_stop, play, relaxation, stop};

/// A part without which the output changes by less than this share of its range does not matter.
pub(super) const MATTERS: f64 = 1e-3;

/// Rows of a path at which outputs are compared.
const COMPARED: usize = 250;

/// Turning points of the protocol until the first whole loop is done.
const FIRST_LOOP: usize = 3;

/// A stop slips at rest if the input moves it by more than this from one end of its range to the other.
pub(super) const SLIPS: f64 = 2.0;

/// What a neuron of the memory layer does within the trained range. One may be several.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NeuronKind {
    /// Slips however slowly the input goes: it makes a static loop.
    Static,
    /// Its rate weight matters.
    Dynamic,
    /// Its slip matters: the loops it makes shrink.
    Deteriorating,
    /// A spring: the input is too small for it to slip, and it does not see the rate.
    NeverSlips,
    /// Without strength after the first loop.
    DiesAtOnce,
    /// Forgets with time.
    Relaxation,
    /// The output hardly changes without it.
    Idle,
}

/// A stop or relaxation neuron and what it does. Swings are in units of a stop's threshold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Neuron {
    /// Such as `stop 3`.
    pub name: String,
    /// What it does.
    pub kinds: Vec<NeuronKind>,
    /// `|w_x| ptp(x)`: how far the input moves it; a stop slips at rest if that is above 2.
    pub input_swing: Option<f64>,
    /// `|w_rate| max|rate|`; 0 where it does not see the rate.
    pub rate_swing: Option<f64>,
    /// Slip over `β` in 25 loops over the whole range; 1 and above is dead.
    pub wear: Option<f64>,
    /// Relaxation time, in the unit of time.
    pub relaxation_time: Option<f64>,
    /// Change of the output without it, over the range of the output.
    pub influence: f64,
}

/// A network on the protocol at its middle speed, in scaled units.
pub(super) struct Inside<'a> {
    network: &'a Network,
    layout: Layout,
    drive: Drive,
    rows: Vec<usize>,
    first_loop: usize,
    /// Outputs of the memory neurons at the rows compared.
    z: Vec<Vec<f64>>,
    /// Arguments of the tanh neurons there.
    pub arguments: Vec<Vec<f64>>,
    /// Outputs of the tanh neurons there.
    hidden: Vec<Vec<f64>>,
    /// Range of the output.
    pub height: f64,
    /// Largest scaled input and rate, and how far the input swings.
    pub largest: [f64; 2],
    swing: f64,
    /// Slip of each stop over many loops.
    slips: Vec<f64>,
}

/// A stop on a path.
struct StopRun {
    z: Vec<f64>,
    slip: f64,
    early_slip: f64,
}

impl<'a> Inside<'a> {
    /// # Errors
    /// A rate that cannot be computed.
    pub fn new(probe: &Probe, network: &'a Network, scaling: &Scaling) -> Result<Self> {
        let architecture = *network.architecture();
        let drive = |x: &[f64]| {
            let record = probe.record("protocol", x, &times(x, probe.speeds.middle))?;
            let (seen, rate) = probe.as_seen(record)?;
            scaling.drive(&seen, &architecture, rate)
        };
        let path = probe.path(&PROTOCOL);
        let every = path.x.len().div_ceil(COMPARED);
        let preprocessing = probe.model.input_transform();
        let [low, high] = [-probe.half, probe.half].map(|by| preprocessing.input(probe.centre + by));
        let fastest = preprocessing.rate(probe.speeds.tried()[3]);
        let mut inside = Self {
            network,
            layout: Layout::new(architecture),
            drive: drive(&path.x)?,
            rows: (0..path.x.len()).step_by(every).collect(),
            first_loop: path.turns[FIRST_LOOP],
            z: Vec::new(),
            arguments: Vec::new(),
            hidden: Vec::new(),
            height: 0.0,
            largest: [
                low.abs().max(high.abs()) / scaling.inputs[0],
                scaling.rate.map_or(0.0, |scale| fastest / scale),
            ],
            swing: (high - low) / scaling.inputs[0],
            slips: Vec::new(),
        };
        let many = drive(&probe.path(&repeated_loops()).x)?;
        inside.slips = (0..architecture.stops)
            .map(|j| run_stop(inside.stop_weights(j), 0.0, &many, &[], 0).slip)
            .collect();
        inside.run_memory();
        inside.run_readout();
        Ok(inside)
    }

    fn stop_weights(&self, j: usize) -> &[f64] {
        let channels = self.network.architecture().channels();
        &self.network.parameters()[self.layout.stop_weights.clone()][j * channels..(j + 1) * channels]
    }

    /// `1/β`; 0 without deterioration.
    fn inverse_beta(&self, j: usize) -> f64 {
        self.network.parameters()[self.layout.ln_beta.clone()].get(j).map_or(0.0, |ln_beta| (-ln_beta).exp())
    }

    fn run(&self, weights: &[f64], inverse_beta: f64) -> StopRun {
        run_stop(weights, inverse_beta, &self.drive, &self.rows, self.first_loop)
    }

    /// Linear neuron, stops, relaxation neurons.
    fn run_memory(&mut self) {
        let a = self.network.architecture();
        let mut z = Vec::with_capacity(a.memory_neurons());
        z.extend(a.linear.then(|| self.linear(&self.network.parameters()[self.layout.linear.clone()])));
        z.extend((0..a.stops).map(|j| self.run(self.stop_weights(j), self.inverse_beta(j)).z));
        z.extend((0..a.relaxation_neurons()).map(|m| self.relax(m)));
        self.z = z;
    }

    fn linear(&self, weights: &[f64]) -> Vec<f64> {
        let at = |row: usize| weights.iter().zip(&self.drive.channels).map(|(a, u)| a * u[row]).sum();
        self.rows.iter().map(|&row| at(row)).collect()
    }

    fn relaxation_time(&self, m: usize) -> f64 {
        self.network.parameters()[self.layout.ln_tau.clone()][m].exp()
    }

    fn relax(&self, m: usize) -> Vec<f64> {
        let a = self.network.architecture();
        let input = m / a.relaxation;
        let u = &self.drive.channels[if input == 0 { 0 } else { input + usize::from(a.rate) }];
        let tau = self.relaxation_time(m);
        let mut stress = u[0];
        let mut all = vec![stress];
        for (pair, &step) in u.windows(2).zip(&self.drive.steps[1..]) {
            stress = relaxation::advance(stress, pair[1] - pair[0], relaxation::decay(step, tau));
            all.push(stress);
        }
        self.rows.iter().map(|&row| all[row]).collect()
    }

    /// Places, among those compared, after the first whole loop.
    pub fn settled(&self) -> std::ops::Range<usize> {
        self.rows.partition_point(|&row| row < self.first_loop)..self.rows.len()
    }

    /// Bias and weights of each tanh neuron.
    pub fn tanh_neurons(&self) -> impl Iterator<Item = (f64, &[f64])> {
        let run = 1 + self.network.architecture().memory_neurons();
        self.network.parameters()[self.layout.hidden.clone()].chunks_exact(run).map(|run| (run[0], &run[1..]))
    }

    /// Output weights of the tanh neurons and of the direct path.
    pub fn output_weights(&self) -> (&[f64], &[f64]) {
        let a = self.network.architecture();
        self.network.output()[usize::from(a.constant)..].split_at(a.hidden)
    }

    fn run_readout(&mut self) {
        let rows = 0..self.rows.len();
        let argument = |(bias, weights): (f64, &[f64])| -> Vec<f64> {
            let at = |row: usize| bias + weights.iter().zip(&self.z).map(|(u, z)| u * z[row]).sum::<f64>();
            rows.clone().map(at).collect()
        };
        let arguments: Vec<Vec<f64>> = self.tanh_neurons().map(argument).collect();
        let hidden: Vec<Vec<f64>> =
            arguments.iter().map(|argument| argument.iter().map(|s| s.tanh()).collect()).collect();
        let (c, d) = self.output_weights();
        let at = |row: usize| {
            let hidden: f64 = c.iter().zip(&hidden).map(|(c, h)| c * h[row]).sum();
            hidden + d.iter().zip(&self.z).map(|(d, z)| d * z[row]).sum::<f64>()
        };
        let y: Vec<f64> = rows.map(at).collect();
        self.height = extent(&y).max(f64::MIN_POSITIVE);
        self.hidden = hidden;
        self.arguments = arguments;
    }

    /// Change of the output if memory neuron `m` gave `other`, theory.md (10.36).
    fn change(&self, m: usize, other: &[f64]) -> f64 {
        let (c, d) = self.output_weights();
        let weights: Vec<f64> = self.tanh_neurons().map(|(_, weights)| weights[m]).collect();
        let square = |row: usize| {
            let by = other[row] - self.z[m][row];
            if by == 0.0 {
                return 0.0;
            }
            let arguments = self.arguments.iter().zip(&self.hidden);
            let hidden = c.iter().zip(&weights).zip(arguments);
            let change: f64 = hidden.map(|((c, u), (s, h))| c * ((s[row] + u * by).tanh() - h[row])).sum();
            (change + d.get(m).copied().unwrap_or(0.0) * by).powi(2)
        };
        (other.iter().enumerate().map(|(row, _)| square(row)).sum::<f64>() / other.len() as f64).sqrt()
            / self.height
    }

    fn influence(&self, m: usize) -> f64 {
        self.change(m, &vec![0.0; self.rows.len()])
    }

    /// Change of the output if the linear neuron did not see the rate.
    pub fn influence_of_linear_rate(&self) -> f64 {
        let a = self.network.architecture();
        if !(a.linear && a.rate) {
            return 0.0;
        }
        let mut weights = self.network.parameters()[self.layout.linear.clone()].to_vec();
        weights[1] = 0.0;
        self.change(0, &self.linear(&weights))
    }

    /// Extent of what stops and relaxation neurons put into each tanh neuron, as a share of that of all.
    pub fn shares_of_memory(&self) -> Vec<f64> {
        let first = usize::from(self.network.architecture().linear);
        let extents: Vec<f64> = self.z.iter().map(|z| extent(z)).collect();
        let share = |(_, weights): (f64, &[f64])| {
            let part = |from: usize| -> f64 {
                weights[from..].iter().zip(&extents[from..]).map(|(u, extent)| u.abs() * extent).sum()
            };
            part(first) / part(0).max(f64::MIN_POSITIVE)
        };
        self.tanh_neurons().map(share).collect()
    }

    /// What each stop and each relaxation neuron does.
    pub fn neurons(&self) -> Vec<Neuron> {
        let a = self.network.architecture();
        let stops = (0..a.stops).map(|j| self.stop(j));
        stops.chain((0..a.relaxation_neurons()).map(|m| self.relaxation(m))).collect()
    }

    fn stop(&self, j: usize) -> Neuron {
        let a = self.network.architecture();
        let (weights, inverse_beta) = (self.stop_weights(j), self.inverse_beta(j));
        let place = usize::from(a.linear) + j;
        let input_swing = weights[0].abs() * self.swing;
        let rate_swing = if a.rate { weights[1].abs() * self.largest[1] } else { 0.0 };
        let as_it_is = self.run(weights, inverse_beta);
        let dynamic = rate_swing > 0.0 && {
            let mut still = weights.to_vec();
            still[1] = 0.0;
            self.change(place, &self.run(&still, inverse_beta).z) > MATTERS
        };
        let deteriorating = inverse_beta > 0.0 && self.change(place, &self.run(weights, 0.0).z) > MATTERS;
        let influence = self.influence(place);
        let dies = inverse_beta > 0.0 && as_it_is.early_slip * inverse_beta >= 1.0;
        let kinds = [
            (NeuronKind::Static, input_swing > SLIPS && !dies),
            (NeuronKind::Dynamic, dynamic && !dies),
            (NeuronKind::Deteriorating, deteriorating && !dies),
            (NeuronKind::NeverSlips, input_swing <= SLIPS && !dynamic && !dies),
            (NeuronKind::DiesAtOnce, dies),
            (NeuronKind::Idle, influence < MATTERS),
        ];
        Neuron {
            name: format!("stop {}", j + 1),
            kinds: kinds.into_iter().filter_map(|(kind, is)| is.then_some(kind)).collect(),
            input_swing: Some(input_swing),
            rate_swing: Some(rate_swing),
            wear: a.deterioration.then(|| self.slips[j] * inverse_beta),
            relaxation_time: None,
            influence,
        }
    }

    fn relaxation(&self, m: usize) -> Neuron {
        let a = self.network.architecture();
        let influence = self.influence(usize::from(a.linear) + a.stops + m);
        let mut kinds = vec![NeuronKind::Relaxation];
        kinds.extend((influence < MATTERS).then_some(NeuronKind::Idle));
        Neuron {
            name: format!("relaxation {} of x{}", m % a.relaxation + 1, m / a.relaxation + 1),
            kinds,
            input_swing: None,
            rate_swing: None,
            wear: None,
            relaxation_time: Some(self.relaxation_time(m)),
            influence,
        }
    }
}

/// One NDS neuron over a path, theory.md (2.2).
fn run_stop(weights: &[f64], inverse_beta: f64, drive: &Drive, rows: &[usize], early: usize) -> StopRun {
    let mut run = StopRun { z: Vec::with_capacity(rows.len()), slip: 0.0, early_slip: 0.0 };
    let mut wanted = rows.iter().copied().peekable();
    let mut held = 0.0;
    for row in 0..drive.len() {
        let v = weights.iter().zip(&drive.channels).map(|(w, u)| w * u[row]).sum();
        let follows = play::follow(held, v, 1.0);
        if row > 0 {
            run.slip = deteriorating_stop::accumulate(run.slip, held, follows);
        }
        held = follows;
        if row == early {
            run.early_slip = run.slip;
        }
        if wanted.next_if_eq(&row).is_some() {
            let strength = deteriorating_stop::remaining_strength(run.slip, inverse_beta);
            run.z.push(stop::elongation(v, held) * strength);
        }
    }
    run
}
