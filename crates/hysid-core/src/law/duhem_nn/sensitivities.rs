//! Exact derivatives of states and output by every parameter found by search, carried forward along a record,
//! and their Gram matrix for least squares.
//!
//! ```text
//! ∂s_i,k = (1 - a_i) ∂s_i,k-1 + a_i F_i Σ_j W_ij g_j Σ_l A_jl ∂s_l,k-1 + direct   theory.md (8.33)
//! ∂y_k   = Σ_i w_i ∂s_i,k + Σ_j w_j g_j Σ_l A_jl ∂s_l,k-1 + direct,   g_j = f_j (1 - h_j²)   theory.md (8.34)
//! ```
//!
//! `f_j = 1 + Σ_m α_jm m` and `F_i = 1 + Σ_m β_im m` are 1 without modulating inputs.
//!
//! `∂` is the derivative by all parameters `θ`, and *direct* are the terms in which a parameter occurs itself.
//! One pass costs `S² P` multiplications a sample, for `S` states and `P` parameters.

use pulp::{Simd, WithSimd};

use super::cell::{Cell, CellMemory, Input};
use super::parameters::CellLayout;
use crate::law::gram_of_rows::{GramOfRows, RowUse};
use crate::law::tanh_layer::{LANES, add_multiples, product};
use crate::linear_algebra::Gram;
use crate::simd;
use crate::stop_check::{Pace, StopCheck};

/// A cell and the records that it is run over.
#[derive(Debug, Clone, Copy)]
pub struct CellRun<'a> {
    /// The cell; its output weights count only for the Jacobian.
    pub cell: &'a Cell,
    /// The samples of each record.
    pub drives: &'a [Vec<Input>],
    /// Scaled further inputs of each record, row by row, first the direct, then the modulating ones; empty without.
    pub further: &'a [Vec<f64>],
    /// States before the first sample of each record; those of the cell if empty.
    pub initial: &'a [Vec<f64>],
    /// Scaled output of each sample; NaN where it is not compared.
    pub targets: &'a [Vec<f64>],
    /// True if the Jacobian is wanted.
    pub with_jacobian: bool,
    /// Stops the computation early.
    pub stop: StopCheck<'a>,
}

impl<'a> CellRun<'a> {
    /// The Gram matrix over all samples with a target: terms of the output, target, Jacobian. `None` once stopped.
    pub fn gram(self) -> Option<Gram> {
        let count = self.columns();
        let rows = GramOfRows::new(count, self.stop);
        match self.sweep(RowUse::Gram(rows))? {
            RowUse::Gram(rows) => Some(rows.gram),
            _ => None,
        }
    }

    /// The columns of [`CellRun::gram`] themselves, row by row; `None` once stopped.
    pub fn rows(self) -> Option<Vec<Vec<f64>>> {
        match self.sweep(RowUse::Rows(Vec::new()))? {
            RowUse::Rows(rows) => Some(rows),
            _ => None,
        }
    }

    /// The entries of [`CellRun::gram`] with each instruction set of the machine.
    #[cfg(test)]
    pub(super) fn grams_of_all(self) -> Vec<Vec<f64>> {
        let count = self.columns();
        let rows = || RowUse::Gram(GramOfRows::new(count, self.stop));
        let grams = simd::run_with_all(|| CellSweep { run: self, rows: rows() }).into_iter().flatten();
        grams.filter_map(RowUse::entries).collect()
    }

    /// The rows as they were used; `None` once stopped.
    fn sweep(self, rows: RowUse<'a>) -> Option<RowUse<'a>> {
        simd::run(CellSweep { run: self, rows })
    }

    fn columns(&self) -> usize {
        let shape = self.cell.shape();
        let jacobian = if self.with_jacobian { CellLayout::new(shape).count() } else { 0 };
        shape.terms() + 1 + jacobian
    }
}

/// A run whose rows are taken.
struct CellSweep<'a> {
    run: CellRun<'a>,
    rows: RowUse<'a>,
}

impl<'a> WithSimd for CellSweep<'a> {
    type Output = Option<RowUse<'a>>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> Option<RowUse<'a>> {
        let CellRun { cell, drives, targets, with_jacobian, stop, .. } = self.run;
        let shape = cell.shape();
        let mut pace = Pace::new(stop);
        let mut sensitivities = with_jacobian.then(|| CellSensitivities::new(cell));
        let per_sample = shape.inputs() * shape.neurons;
        let per_sample = per_sample
            + sensitivities.as_ref().map_or(0, |all| all.width * shape.states * (shape.states + 1));
        let mut row = vec![0.0; self.run.columns()];
        let target = shape.terms();
        let width = shape.direct + shape.modulators;
        for (record, (drive, targets)) in drives.iter().zip(targets).enumerate() {
            let initial = self.run.initial.get(record).unwrap_or(&cell.initial);
            let further = self.run.further.get(record).map_or(&[][..], Vec::as_slice);
            let mut memory = cell.memory_with(initial);
            sensitivities.iter_mut().for_each(CellSensitivities::begin);
            for (row_index, (&input, &y)) in drive.iter().zip(targets).enumerate() {
                if pace.is_over(per_sample) {
                    return None;
                }
                let further = &further[row_index * width..][..width];
                cell.advance::<S>(&mut memory, input, further);
                if let Some(sensitivities) = &mut sensitivities {
                    sensitivities.advance::<S>(cell, &memory, input, &further[shape.direct..]);
                }
                if !y.is_nan() {
                    row[..target].copy_from_slice(&memory.terms);
                    row[target] = y;
                    if let Some(sensitivities) = &mut sensitivities {
                        let further = &further[shape.direct..];
                        sensitivities.of_output::<S>(cell, &memory, further, &mut row[target + 1..]);
                    }
                    self.rows.take(simd, &row);
                }
            }
        }
        self.rows.end(simd);
        (!stop.is_asked()).then_some(self.rows)
    }
}

/// `∂s/∂θ` on its way along a record, and what it follows from at the present sample.
struct CellSensitivities {
    layout: CellLayout,
    /// Parameters, rounded up to whole groups.
    width: usize,
    /// `∂s_i` of each state, `width` numbers each, and the same before the present sample.
    states: Vec<f64>,
    before: Vec<f64>,
    /// The direct terms of each state, and `∂y`.
    direct: Vec<f64>,
    of_output: Vec<f64>,
    /// `∂p` and `∂e` of each stop by its own weights, in their order.
    plays: Vec<f64>,
    elongations: Vec<f64>,
    inputs: Vec<f64>,
    /// `1 - h_j²`, `g_j`, and `a_i F_i W_ij g_j` or `w_j g_j`.
    steepness: Vec<f64>,
    slopes: Vec<f64>,
    back: Vec<f64>,
    /// Factors of `∂s_l,k-1`.
    carried: Vec<f64>,
}

impl CellSensitivities {
    fn new(cell: &Cell) -> Self {
        let layout = CellLayout::new(cell.shape());
        let shape = layout.shape;
        let width = layout.count().next_multiple_of(LANES);
        let of_stops = vec![0.0; shape.channels * shape.stops];
        Self {
            width,
            states: vec![0.0; shape.states * width],
            before: vec![0.0; shape.states * width],
            direct: vec![0.0; shape.states * width],
            of_output: vec![0.0; width],
            plays: of_stops.clone(),
            elongations: of_stops,
            inputs: vec![0.0; shape.inputs()],
            steepness: vec![0.0; shape.neurons],
            slopes: vec![0.0; shape.neurons],
            back: vec![0.0; shape.neurons],
            carried: vec![0.0; shape.states],
            layout,
        }
    }

    /// Before the first sample of a record the states are parameters themselves.
    fn begin(&mut self) {
        self.states.fill(0.0);
        self.plays.fill(0.0);
        for (i, place) in self.layout.initial.clone().enumerate() {
            self.states[i * self.width + place] = 1.0;
        }
    }

    /// To the sample to which the cell has just advanced (theory.md (8.33)).
    #[inline(always)]
    fn advance<S: Simd>(&mut self, cell: &Cell, memory: &CellMemory, input: Input, modulating: &[f64]) {
        let Self { layout, width, states, before, direct, inputs, steepness, slopes, back, carried, .. } =
            self;
        let (shape, width) = (layout.shape, *width);
        of_plays(memory, input, &mut self.plays, &mut self.elongations);
        let (first, neurons) = (shape.first_state(), &memory.terms[shape.inputs()..][..shape.neurons]);
        inputs[..first].copy_from_slice(&memory.terms[..first]);
        inputs[first..].copy_from_slice(&memory.states_before);
        for (j, h) in neurons.iter().enumerate() {
            steepness[j] = 1.0 - h * h;
            slopes[j] = steepness[j] * memory.layer_factors[j]; // (8.33): g_j
        }
        std::mem::swap(states, before);
        for i in 0..shape.states {
            let (leak, pull) = (memory.leaks[i], memory.pulls[i]);
            let weights = &cell.targets[i * shape.neurons..][..shape.neurons];
            let leak_of_target = leak * memory.target_factors[i];
            for ((back, weight), slope) in back.iter_mut().zip(weights).zip(&*slopes) {
                *back = leak_of_target * weight * slope;
            }
            let direct = &mut direct[i * width..][..width];
            of_layer(inputs, back, direct);
            if !modulating.is_empty() {
                of_layer_modulation(layout, memory, (leak_of_target, weights, steepness), modulating, direct);
                let target = product::<S>(weights, neurons);
                for (m, modulator) in modulating.iter().enumerate() {
                    direct[layout.target_modulation.start + m * shape.states + i] = leak * modulator * target;
                }
            }
            of_stops::<S>(cell, layout, back, &self.elongations, direct);
            let own = layout.targets.start + i * shape.neurons;
            for (direct, h) in direct[own..own + shape.neurons].iter_mut().zip(neurons) {
                *direct = leak_of_target * h;
            }
            if shape.channels == 2 {
                direct[layout.rate_gains.start + i] = leak * input.rate;
            }
            let kept = (1.0 - leak) * pull;
            direct[layout.ln_path_leaks.start + i] = kept * cell.path_leaks[i] * memory.moved;
            if shape.has_time {
                let steps = memory.elapsed / cell.relaxation_times[i];
                // After an infinite step nothing is kept.
                direct[layout.ln_relaxation_times.start + i] = if kept == 0.0 { 0.0 } else { -kept * steps };
            }
            carry::<S>(cell, back, carried);
            carried[i] += 1.0 - leak; // (8.33)
            let state = &mut states[i * width..][..width];
            state.copy_from_slice(direct);
            add_multiples::<S>(state, carried, before); // (8.33)
        }
    }

    /// The derivative of the output at the present sample (theory.md (8.34)).
    #[inline(always)]
    fn of_output<S: Simd>(
        &mut self,
        cell: &Cell,
        memory: &CellMemory,
        modulating: &[f64],
        jacobian: &mut [f64],
    ) {
        let Self { layout, states, before, inputs, steepness, slopes, back, carried, of_output, .. } = self;
        let shape = layout.shape;
        let (of_inputs, of_neurons) = cell.output.split_at(shape.inputs());
        for ((back, weight), slope) in back.iter_mut().zip(of_neurons).zip(slopes) {
            *back = weight * *slope;
        }
        of_output.fill(0.0);
        of_layer(inputs, back, of_output);
        of_layer_modulation(layout, memory, (1.0, of_neurons, steepness), modulating, of_output);
        of_stops::<S>(cell, layout, back, &self.elongations, of_output);
        let own = of_inputs[shape.first_stop()..].iter().take(shape.stops);
        let (stops, elongations) = (layout.stops.start, &self.elongations);
        for (stop, weight) in own.enumerate() {
            for channel in 0..shape.channels {
                let place = channel * shape.stops + stop;
                of_output[stops + place] += weight * elongations[place];
            }
        }
        carry::<S>(cell, back, carried);
        add_multiples::<S>(of_output, carried, before); // (8.34)
        add_multiples::<S>(of_output, &of_inputs[shape.first_state()..], states); // (8.34)
        jacobian.copy_from_slice(&of_output[..jacobian.len()]);
    }
}

/// `∂p` and `∂e` of each stop by its own weights: a play follows its input where it has just moved.
#[inline(always)]
fn of_plays(memory: &CellMemory, input: Input, plays: &mut [f64], elongations: &mut [f64]) {
    let stops = memory.plays.len();
    if stops == 0 {
        return;
    }
    let channels = plays.chunks_exact_mut(stops).zip(elongations.chunks_exact_mut(stops));
    for ((plays, elongations), value) in channels.zip([input.from_origin, input.rate]) {
        for (stop, (play, elongation)) in plays.iter_mut().zip(elongations).enumerate() {
            if memory.plays[stop] != memory.plays_before[stop] {
                *play = value;
            }
            *elongation = value - *play;
        }
    }
}

/// The direct terms of `b` and `A`: `back_j` times each input of the layer.
#[inline(always)]
fn of_layer(inputs: &[f64], back: &[f64], direct: &mut [f64]) {
    for (direct, input) in direct.chunks_exact_mut(back.len()).zip(inputs) {
        for (direct, back) in direct.iter_mut().zip(back) {
            *direct = input * back;
        }
    }
}

/// The direct terms of `α`, from the weights of the neurons, a factor of theirs and `1 - h_j²`.
#[inline(always)]
fn of_layer_modulation(
    layout: &CellLayout,
    memory: &CellMemory,
    (factor, weights, steepness): (f64, &[f64], &[f64]),
    modulating: &[f64],
    direct: &mut [f64],
) {
    let direct = direct[layout.layer_modulation.clone()].chunks_exact_mut(steepness.len());
    for (direct, modulator) in direct.zip(modulating) {
        for (j, direct) in direct.iter_mut().enumerate() {
            *direct = factor * weights[j] * steepness[j] * memory.sums[j] * modulator;
        }
    }
}

/// The direct terms of the weights of the stops through the layer.
#[inline(always)]
fn of_stops<S: Simd>(
    cell: &Cell,
    layout: &CellLayout,
    back: &[f64],
    elongations: &[f64],
    direct: &mut [f64],
) {
    let shape = layout.shape;
    let direct = &mut direct[layout.stops.clone()];
    for stop in 0..shape.stops {
        let weights = &cell.hidden[(shape.first_stop() + stop) * back.len()..][..back.len()];
        let through = product::<S>(back, weights);
        for channel in 0..shape.channels {
            let place = channel * shape.stops + stop;
            direct[place] = through * elongations[place];
        }
    }
}

/// `Σ_j back_j A_jl` of each state `l`.
#[inline(always)]
fn carry<S: Simd>(cell: &Cell, back: &[f64], carried: &mut [f64]) {
    let weights = &cell.hidden[cell.shape().first_state() * back.len()..];
    for (carried, column) in carried.iter_mut().zip(weights.chunks_exact(back.len())) {
        *carried = product::<S>(back, column);
    }
}
