//! The memory layer: linear neuron, stop neurons, relaxation neurons.
//!
//! ```text
//! v = w·u;  p = clip(p; v - 1, v + 1);  ε = v - p;  s += |Δp|;  z = ε max(0, 1 - s/β)    theory.md (2.2)
//! z_0 = a·u                                                                              theory.md (2.3)
//! z'  = u_c' - z/τ                                                                       theory.md (2.4)
//! ```
//!
//! The symbols are those of the [module of networks](crate::network).
//!
//! Rows depend on those before, neurons do not depend on each other: eight stops, or the last four, advance
//! together as the lanes of a vector. Their outputs are then transposed from time-major to neuron-major for the readout,
//! whose lanes are rows.

use std::ops::{Deref, DerefMut};

use pulp::Simd;

use crate::elementary::exp;
use crate::network::decay::decay;
use crate::network::transpose::transpose;
use crate::network::{Architecture, ParameterLayout};
use crate::operator::{deteriorating_stop, play, relaxation, stop};
use crate::simd::multiply_add;

/// Rows handled together. All rows of a block lie in the first-level cache.
pub(crate) const BLOCK: usize = 64;

/// One quantity over a block of rows.
///
/// It begins at a cache line: a vector of 512 bits that lies across two of them is slow.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub(crate) struct BlockValues(pub [f64; BLOCK]);

impl Deref for BlockValues {
    type Target = [f64; BLOCK];

    #[inline(always)]
    fn deref(&self) -> &[f64; BLOCK] {
        &self.0
    }
}

impl<'a> IntoIterator for &'a BlockValues {
    type Item = &'a f64;
    type IntoIter = std::slice::Iter<'a, f64>;

    #[inline(always)]
    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

impl BlockValues {
    /// Takes some numbers of a channel. Rows beyond the last repeat it, up to whole vectors: a stop that sees an input
    /// again rests.
    #[inline(always)]
    pub fn take_channel(&mut self, u: &[f64]) {
        for (to, &u) in self.0.iter_mut().zip(u) {
            *to = limited(u);
        }
        let rows = u.len();
        if rows < whole_lanes(rows) {
            let last = self.0[rows - 1];
            self.0[rows..whole_lanes(rows)].fill(last);
        }
    }
}

#[inline(always)]
pub(crate) fn limited(u: f64) -> f64 {
    let low = if u > -LARGEST_SCALED { u } else { -LARGEST_SCALED };
    if low < LARGEST_SCALED { low } else { LARGEST_SCALED }
}

impl AsRef<[f64; BLOCK]> for BlockValues {
    #[inline(always)]
    fn as_ref(&self) -> &[f64; BLOCK] {
        &self.0
    }
}

impl AsRef<[f64]> for BlockValues {
    #[inline(always)]
    fn as_ref(&self) -> &[f64] {
        &self.0
    }
}

impl DerefMut for BlockValues {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64; BLOCK] {
        &mut self.0
    }
}

/// Neurons of a group, which advance together.
pub(crate) const LANES: usize = 8;

/// One number for each neuron of a group.
pub(crate) type Lanes = [f64; LANES];

/// Neurons of a group that is at most half full: the rest of its lanes is left out.
const HALF: usize = LANES / 2;

/// Values of a group over a block, time-major.
type Tile = [Lanes; BLOCK];

/// Largest magnitude of a scaled input. Beyond it, far outside anything trained on, the input is
/// taken as this, so that no sum of products overflows whatever the parameters.
const LARGEST_SCALED: f64 = 1e50;

#[derive(Debug, Clone)]
pub(crate) struct MemoryLayer {
    channels: usize,
    stops: usize,
    deteriorating: bool,
    groups: Vec<StopGroup>,
    linear: Option<Vec<f64>>,
    /// Channel and 1/τ of each relaxation neuron.
    relaxation: Vec<(usize, f64)>,
}

#[derive(Debug, Clone)]
struct StopGroup {
    weights: Vec<Lanes>,
    inverse_beta: Lanes,
}

/// The state of a network: plays, slips, states of the relaxation neurons, and the last inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct MemoryState {
    started: bool,
    play: Vec<Lanes>,
    slip: Vec<Lanes>,
    stress: Vec<f64>,
    /// The last row's inputs, which the relaxation neurons take increments of.
    last: Vec<f64>,
}

/// Derivatives of the state by the parameters, carried along with it.
#[derive(Debug, Clone)]
pub(crate) struct Sensitivity {
    /// `∂p/∂w` of each group and channel: the input at the last sample that slipped.
    play: Vec<Vec<Lanes>>,
    /// `∂s/∂w`.
    slip: Vec<Vec<Lanes>>,
    /// `∂σ/∂ln τ`.
    stress: Vec<f64>,
}

/// Outputs of the memory layer over a block, and their derivatives, each neuron-major.
#[derive(Debug, Clone, Default)]
pub(crate) struct MemorySlopes {
    /// `∂z_j/∂w_jc`, see [`MemorySlopes::by_weight`].
    pub weights: Vec<BlockValues>,
    /// `∂z_j/∂ln β_j`; empty without deterioration.
    pub ln_beta: Vec<BlockValues>,
    /// `∂z/∂ln τ` of each relaxation neuron.
    pub ln_tau: Vec<BlockValues>,
}

impl MemorySlopes {
    pub fn new(a: &Architecture) -> Self {
        Self {
            weights: vec![BlockValues([0.0; BLOCK]); a.stops * a.channels()],
            ln_beta: vec![BlockValues([0.0; BLOCK]); if a.deterioration { a.stops } else { 0 }],
            ln_tau: vec![BlockValues([0.0; BLOCK]); a.relaxation_neurons()],
        }
    }

    /// `∂z_j/∂w_jc`: a group's rows stand together, by channel, then by stop.
    pub fn by_weight(&self, stops: usize, channels: usize, j: usize, c: usize) -> &BlockValues {
        let first = j - j % LANES;
        let live = (stops - first).min(LANES);
        &self.weights[first * channels + c * live + j % LANES]
    }
}

impl MemoryLayer {
    /// Arranges the parameters, which must fit the architecture.
    pub fn new(architecture: &Architecture, parameters: &[f64]) -> Self {
        let layout = ParameterLayout::new(*architecture);
        let channels = architecture.channels();
        let weights = &parameters[layout.stop_weights];
        let ln_beta = &parameters[layout.ln_beta];
        let group = |first: usize| {
            let lane = |value: &dyn Fn(usize) -> f64| {
                std::array::from_fn(|l| if first + l < architecture.stops { value(first + l) } else { 0.0 })
            };
            StopGroup {
                weights: (0..channels).map(|c| lane(&|j| weights[j * channels + c])).collect(),
                inverse_beta: lane(&|j| ln_beta.get(j).map_or(0.0, |ln_beta| exp(-ln_beta))),
            }
        };
        let channel_of_input = |input: usize| {
            if input == 0 { 0 } else { input + usize::from(architecture.rate) }
        };
        let ln_tau = parameters[layout.ln_tau].iter().enumerate();
        Self {
            channels,
            stops: architecture.stops,
            deteriorating: architecture.deterioration,
            groups: (0..architecture.stops).step_by(LANES).map(group).collect(),
            linear: architecture.linear.then(|| parameters[layout.linear].to_vec()),
            relaxation: ln_tau
                .map(|(m, ln_tau)| (channel_of_input(m / architecture.relaxation), exp(-ln_tau)))
                .collect(),
        }
    }

    /// The virgin state.
    pub fn virgin(&self) -> MemoryState {
        MemoryState {
            started: false,
            play: vec![[0.0; LANES]; self.groups.len()],
            slip: vec![[0.0; LANES]; self.groups.len()],
            stress: vec![0.0; self.relaxation.len()],
            last: vec![0.0; self.channels],
        }
    }

    /// The derivatives of the virgin state.
    pub fn virgin_sensitivity(&self) -> Sensitivity {
        let zeros = || vec![vec![[0.0; LANES]; self.channels]; self.groups.len()];
        Sensitivity { play: zeros(), slip: zeros(), stress: vec![0.0; self.relaxation.len()] }
    }

    fn neurons(&self) -> usize {
        usize::from(self.linear.is_some()) + self.stops + self.relaxation.len()
    }

    /// Advances by `rows` rows of scaled inputs `u` (by channel, as [`BlockValues::take_channel`] takes them), and writes
    /// every neuron's output into `z`.
    ///
    /// `steps` are the time steps before each row, 0 at the start of a record; empty without
    /// relaxation neurons.
    #[inline(always)]
    pub fn forward<S: Simd>(
        &self,
        simd: S,
        state: &mut MemoryState,
        u: &[BlockValues],
        steps: &BlockValues,
        rows: usize,
        z: &mut [BlockValues],
    ) {
        let (linear, rest) = z[..self.neurons()].split_at_mut(usize::from(self.linear.is_some()));
        let (stops, stress) = rest.split_at_mut(self.stops);
        self.begin::<S>(state, |c| u[c][0]);
        let memory = state.play.iter_mut().zip(&mut state.slip);
        for ((group, memory), z) in self.groups.iter().zip(memory).zip(stops.chunks_mut(LANES)) {
            if z.len() > HALF {
                self.advance::<S, LANES>(simd, group, memory, u, rows, z);
            } else {
                self.advance::<S, HALF>(simd, group, memory, u, rows, z);
            }
        }
        self.run_linear::<S>(u, rows, linear);
        self.relax::<S>(state, None, u, steps, rows, stress, &mut []);
        self.remember(state, u, rows);
    }

    /// Advances the first `L` stops of a group through a block.
    #[inline(always)]
    fn advance<S: Simd, const L: usize>(
        &self,
        simd: S,
        group: &StopGroup,
        memory: (&mut Lanes, &mut Lanes),
        u: &[BlockValues],
        rows: usize,
        z: &mut [BlockValues],
    ) {
        match (self.deteriorating, self.channels > 2) {
            (true, true) => advance::<S, L, true, true>(simd, group, memory, u, rows, z),
            (true, false) => advance::<S, L, true, false>(simd, group, memory, u, rows, z),
            (false, true) => advance::<S, L, false, true>(simd, group, memory, u, rows, z),
            (false, false) => advance::<S, L, false, false>(simd, group, memory, u, rows, z),
        }
    }

    /// [`MemoryLayer::forward`] for one row, to the last bit: one value for each channel and each neuron.
    #[inline(always)]
    pub fn step<S: Simd>(&self, state: &mut MemoryState, u: &[f64], time_step: f64, z: &mut [f64]) {
        let (linear, rest) = z[..self.neurons()].split_at_mut(usize::from(self.linear.is_some()));
        let (stops, stress) = rest.split_at_mut(self.stops);
        self.begin::<S>(state, |c| u[c]);
        let memory = state.play.iter_mut().zip(&mut state.slip);
        for ((group, (play, slip)), z) in self.groups.iter().zip(memory).zip(stops.chunks_mut(LANES)) {
            let v = drive::<S>(group, |c| u[c]);
            let (mut plays, mut slips) = (*play, *slip);
            let outputs = if self.deteriorating {
                follow::<S, LANES, true>(v, &mut plays, &mut slips, &group.inverse_beta)
            } else {
                follow::<S, LANES, false>(v, &mut plays, &mut slips, &group.inverse_beta)
            };
            (*play, *slip) = (plays, slips);
            z.copy_from_slice(&outputs[..z.len()]);
        }
        if let (Some(weights), Some(z)) = (&self.linear, linear.first_mut()) {
            // (2.3)
            *z = weights.iter().zip(u).fold(0.0, |sum, (&weight, &u)| multiply_add::<S>(weight, u, sum));
        }
        for ((&(channel, inverse_tau), z), stress) in
            self.relaxation.iter().zip(stress).zip(&mut state.stress)
        {
            let increment = u[channel] - state.last[channel];
            let factors = decay::<S>(time_step * inverse_tau);
            // (2.4)
            *stress = relaxation::advance(*stress, increment, (factors.stress, factors.increment));
            *z = *stress;
        }
        state.last.copy_from_slice(u);
    }

    /// [`MemoryLayer::forward`] with all derivatives, theory.md (2.9) and (2.10). Outputs agree with
    /// `forward` to the last bit.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    pub fn forward_with_slopes<S: Simd>(
        &self,
        simd: S,
        state: &mut MemoryState,
        sensitivity: &mut Sensitivity,
        u: &[BlockValues],
        steps: &BlockValues,
        rows: usize,
        z: &mut [BlockValues],
        slopes: &mut MemorySlopes,
    ) {
        let (linear, rest) = z[..self.neurons()].split_at_mut(usize::from(self.linear.is_some()));
        let (stops, stress) = rest.split_at_mut(self.stops);
        if !state.started {
            self.begin_slopes::<S>(sensitivity, u);
        }
        self.begin::<S>(state, |c| u[c][0]);
        for (g, group) in self.groups.iter().enumerate() {
            let first = g * LANES;
            let memory = StopMemory {
                play: &mut state.play[g],
                slip: &mut state.slip[g],
                play_slope: &mut sensitivity.play[g],
                slip_slope: &mut sensitivity.slip[g],
            };
            let outputs = StopSlopes {
                z: &mut stops[first..],
                weights: &mut slopes.weights[first * self.channels..],
                ln_beta: slopes.ln_beta.get_mut(first..).unwrap_or(&mut []),
            };
            advance_with_slopes(simd, group, memory, u, rows, outputs);
        }
        self.run_linear::<S>(u, rows, linear);
        self.relax::<S>(state, Some(sensitivity), u, steps, rows, stress, &mut slopes.ln_tau);
        self.remember(state, u, rows);
    }

    /// Initializes the plays at the first row of a record, without slip: `s_0 = 0` (theory.md (1.5)).
    #[inline(always)]
    fn begin<S: Simd>(&self, state: &mut MemoryState, first: impl Fn(usize) -> f64) {
        if state.started {
            return;
        }
        state.started = true;
        for (group, plays) in self.groups.iter().zip(&mut state.play) {
            for (play, v) in plays.iter_mut().zip(drive::<S>(group, &first)) {
                *play = play::follow(*play, v, 1.0); // (2.2)
            }
        }
    }

    /// A play that has jumped at the first row follows that row's input.
    #[inline(always)]
    fn begin_slopes<S: Simd>(&self, sensitivity: &mut Sensitivity, u: &[BlockValues]) {
        for (group, slopes) in self.groups.iter().zip(&mut sensitivity.play) {
            let v = drive::<S>(group, |c| u[c][0]);
            for (slopes, u) in slopes.iter_mut().zip(u) {
                for (slope, v) in slopes.iter_mut().zip(v) {
                    *slope = if v.abs() > 1.0 { u[0] } else { 0.0 }; // (2.9): u_ref
                }
            }
        }
    }

    #[inline(always)]
    fn run_linear<S: Simd>(&self, u: &[BlockValues], rows: usize, z: &mut [BlockValues]) {
        if let Some(weights) = &self.linear {
            let z = &mut z[0][..whole_lanes(rows)];
            z.fill(0.0);
            for (&weight, u) in weights.iter().zip(u) {
                for (z, &u) in z.iter_mut().zip(u) {
                    *z = multiply_add::<S>(weight, u, *z); // (2.3)
                }
            }
        }
    }

    /// Relaxation neurons, and their derivatives by ln τ if a sensitivity is carried along.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn relax<S: Simd>(
        &self,
        state: &mut MemoryState,
        mut sensitivity: Option<&mut Sensitivity>,
        u: &[BlockValues],
        steps: &BlockValues,
        rows: usize,
        z: &mut [BlockValues],
        ln_tau: &mut [BlockValues],
    ) {
        if self.relaxation.is_empty() {
            return;
        }
        let mut factors = [BlockValues([0.0; BLOCK]); 3];
        let [left, gain, by_ln_tau] = &mut factors;
        let reached = whole_lanes(rows);
        for (m, &(channel, inverse_tau)) in self.relaxation.iter().enumerate() {
            let of_row = left[..reached].iter_mut().zip(&mut gain[..reached]).zip(&mut by_ln_tau[..reached]);
            for (((left, gain), by_ln_tau), &step) in of_row.zip(&steps[..reached]) {
                let decay = decay::<S>(step * inverse_tau);
                (*left, *gain, *by_ln_tau) = (decay.stress, decay.increment, decay.by_ln_tau);
            }
            let mut last = state.last[channel];
            let mut stress = state.stress[m];
            let mut slope = sensitivity.as_ref().map_or(0.0, |s| s.stress[m]);
            for t in 0..rows {
                let increment = u[channel][t] - last;
                if sensitivity.is_some() {
                    // theory.md (2.10), with (1 - E - φE)/φ = G - E
                    slope = left[t] * slope + by_ln_tau[t] * stress + increment * (gain[t] - left[t]);
                    ln_tau[m][t] = slope;
                }
                stress = relaxation::advance(stress, increment, (left[t], gain[t])); // (2.4)
                z[m][t] = stress;
                last = u[channel][t];
            }
            state.stress[m] = stress;
            if let Some(sensitivity) = &mut sensitivity {
                sensitivity.stress[m] = slope;
            }
        }
    }

    #[inline(always)]
    fn remember(&self, state: &mut MemoryState, u: &[BlockValues], rows: usize) {
        for (last, u) in state.last.iter_mut().zip(u) {
            *last = u[rows - 1];
        }
    }
}

/// Input `v = w·u` of each stop of a group in a row, in one rounding order for every kernel.
#[inline(always)]
fn drive<S: Simd>(group: &StopGroup, u: impl Fn(usize) -> f64) -> Lanes {
    let x = u(0);
    let mut v: Lanes = std::array::from_fn(|l| group.weights[0][l] * x);
    for (c, weights) in group.weights.iter().enumerate().skip(1) {
        let u = u(c);
        for l in 0..LANES {
            v[l] = multiply_add::<S>(weights[l], u, v[l]);
        }
    }
    v
}

/// [`deteriorating_stop::remaining_strength`] with a fused product: one operation less, and another rounding.
#[inline(always)]
fn remaining_strength<S: Simd>(slip: f64, inverse_beta: f64) -> f64 {
    let strength = multiply_add::<S>(-slip, inverse_beta, 1.0); // (2.2): 1 - s/β
    if strength > 0.0 { strength } else { 0.0 }
}

/// Moves the first `L` stops of a group to the inputs `v`, and returns their outputs.
#[inline(always)]
fn follow<S: Simd, const L: usize, const DETERIORATING: bool>(
    v: [f64; L],
    play: &mut [f64; L],
    slip: &mut [f64; L],
    inverse_beta: &[f64; L],
) -> [f64; L] {
    let mut outputs = [0.0; L];
    // A plain loop, which becomes vectors; a closure for each lane does not.
    for l in 0..L {
        let before = play[l];
        let after = play::follow(before, v[l], 1.0); // (2.2): p
        play[l] = after;
        let mut output = stop::elongation(v[l], after); // (2.2): ε
        if DETERIORATING {
            slip[l] = deteriorating_stop::accumulate(slip[l], before, after); // (2.2): s
            output *= remaining_strength::<S>(slip[l], inverse_beta[l]); // (2.2): z
        }
        outputs[l] = output;
    }
    outputs
}

/// Advances the first `L` stops of a group through a block, eight rows at a time; `MANY` channels are more than two.
#[inline(always)]
fn advance<S: Simd, const L: usize, const DETERIORATING: bool, const MANY: bool>(
    simd: S,
    group: &StopGroup,
    (play, slip): (&mut Lanes, &mut Lanes),
    u: &[BlockValues],
    rows: usize,
    z: &mut [BlockValues],
) {
    // Nearly all networks have one or two channels: their weights stay in registers.
    const NO_INPUT: &BlockValues = &BlockValues([0.0; BLOCK]);
    let (x, second) = (&u[0], u.get(1).unwrap_or(NO_INPUT));
    let of_x: [f64; L] = first_lanes(&group.weights[0]);
    let of_second: [f64; L] = first_lanes(group.weights.get(1).unwrap_or(&[0.0; LANES]));
    let further = u.get(2..).unwrap_or(&[]);
    let inverse_beta: [f64; L] = first_lanes(&group.inverse_beta);
    let (mut plays, mut slips): ([f64; L], [f64; L]) = (first_lanes(play), first_lanes(slip));
    let mut tile = [[0.0; L]; LANES];
    let inputs = x.as_chunks::<LANES>().0.iter().zip(second.as_chunks::<LANES>().0);
    for (chunk, (x, second)) in inputs.enumerate().take(rows.div_ceil(LANES)) {
        for t in 0..LANES {
            let mut v = of_x;
            for l in 0..L {
                v[l] = multiply_add::<S>(of_second[l], second[t], of_x[l] * x[t]);
            }
            if MANY {
                for (u, c) in further.iter().zip(2..) {
                    for (v, &weight) in v.iter_mut().zip(&group.weights[c]) {
                        *v = multiply_add::<S>(weight, u.as_chunks::<LANES>().0[chunk][t], *v);
                    }
                }
            }
            tile[t] = follow::<S, L, DETERIORATING>(v, &mut plays, &mut slips, &inverse_beta);
        }
        turn(simd, &tile, chunk, z);
    }
    play[..L].copy_from_slice(&plays);
    slip[..L].copy_from_slice(&slips);
}

#[inline(always)]
fn first_lanes<const L: usize>(lanes: &Lanes) -> [f64; L] {
    *lanes.first_chunk().expect("no more lanes than a group has")
}

/// Turns eight rows of a block, the chunk with this number, from time-major to neuron-major.
#[inline(always)]
fn turn<S: Simd, const L: usize>(simd: S, tile: &[[f64; L]; LANES], chunk: usize, rows: &mut [BlockValues]) {
    transpose(simd, tile, rows.iter_mut().map(|row| &mut row.as_chunks_mut::<LANES>().0[chunk]));
}

/// Rows of whole vectors that hold `rows` rows. Loops run so far and no further: a loop over a whole
/// block has a length that is known to the compiler, which would unroll the kernel out of the instruction
/// cache.
#[inline(always)]
pub(crate) fn whole_lanes(rows: usize) -> usize {
    rows.next_multiple_of(LANES).min(BLOCK)
}

/// Turns a group's values over a block from time-major to neuron-major.
#[inline(always)]
fn turn_block<S: Simd>(simd: S, values: &[Lanes], rows: &mut [BlockValues]) {
    for (chunk, tile) in values.as_chunks::<LANES>().0.iter().enumerate() {
        turn(simd, tile, chunk, rows);
    }
}

/// A group's state and its derivatives by the weights.
struct StopMemory<'a> {
    play: &'a mut Lanes,
    slip: &'a mut Lanes,
    play_slope: &'a mut [Lanes],
    slip_slope: &'a mut [Lanes],
}

/// Where a group's outputs and their derivatives go, one row for each.
struct StopSlopes<'a> {
    z: &'a mut [BlockValues],
    weights: &'a mut [BlockValues],
    ln_beta: &'a mut [BlockValues],
}

/// Advances one group through a block with its sub-gradient `∂z/∂w = (1 - s/β) ∂ε/∂w - (ε/β) ∂s/∂w`
/// (theory.md (2.9)). At a kink the sample counts as sticking.
#[inline(always)]
fn advance_with_slopes<S: Simd>(
    simd: S,
    group: &StopGroup,
    memory: StopMemory,
    u: &[BlockValues],
    rows: usize,
    outputs: StopSlopes,
) {
    let StopSlopes { z, weights, ln_beta } = outputs;
    let live = z.len().min(LANES);
    let reached = whole_lanes(rows);
    let mut output: Tile = [[0.0; LANES]; BLOCK];
    let mut by_ln_beta: Tile = [[0.0; LANES]; BLOCK];
    let mut strength: Tile = [[0.0; LANES]; BLOCK];
    let mut wear: Tile = [[0.0; LANES]; BLOCK];
    let mut moved: Tile = [[0.0; LANES]; BLOCK];
    for t in 0..rows {
        let v = drive::<S>(group, |c| u[c][t]);
        for l in 0..LANES {
            let v = v[l];
            let before = memory.play[l];
            let after = play::follow(before, v, 1.0); // (2.2): p
            memory.play[l] = after;
            let slip = deteriorating_stop::accumulate(memory.slip[l], before, after); // (2.2): s
            memory.slip[l] = slip;
            let left = remaining_strength::<S>(slip, group.inverse_beta[l]);
            let elongation = stop::elongation(v, after); // (2.2): ε
            let wears = if left > 0.0 { elongation * group.inverse_beta[l] } else { 0.0 };
            output[t][l] = elongation * left; // (2.2): z
            strength[t][l] = left;
            wear[t][l] = wears;
            by_ln_beta[t][l] = wears * slip; // (2.9): ∂z/∂ln β
            moved[t][l] = after - before;
        }
    }
    turn_block(simd, &output[..reached], &mut z[..live]);
    if !ln_beta.is_empty() {
        turn_block(simd, &by_ln_beta[..reached], &mut ln_beta[..live]);
    }
    let mut slope: Tile = [[0.0; LANES]; BLOCK];
    for (c, u) in u.iter().enumerate() {
        let mut play_slope = memory.play_slope[c];
        let mut slip_slope = memory.slip_slope[c];
        for (t, &u) in u[..rows].iter().enumerate() {
            for l in 0..LANES {
                let before = play_slope[l];
                let after = if moved[t][l] != 0.0 { u } else { before }; // (2.9): ∂p/∂w
                play_slope[l] = after;
                // (2.9): ∂s/∂w
                slip_slope[l] += if moved[t][l] > 0.0 { after - before } else { before - after };
                // (2.9): ∂z/∂w
                slope[t][l] = strength[t][l] * (u - after) - wear[t][l] * slip_slope[l];
            }
        }
        memory.play_slope[c] = play_slope;
        memory.slip_slope[c] = slip_slope;
        turn_block(simd, &slope[..reached], &mut weights[c * live..(c + 1) * live]);
    }
}
