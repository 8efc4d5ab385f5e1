//! Derivatives of the stops of an element over a step.

use pulp::Simd;

use super::ElementEnds;
use crate::law::hysteretic_dynamics::ElementShape;
use crate::law::tanh_layer::{add_multiple, add_two};

/// Derivatives of stops: rows with one number for each parameter.
pub(super) struct StopSensitivities {
    width: usize,
    deteriorates: bool,
    /// `∂ε` and `∂Λ` where a step begins. Slips count only for stops that deteriorate.
    elongations: Vec<f64>,
    slips: Vec<f64>,
    elongations_ahead: Vec<f64>,
    slips_ahead: Vec<f64>,
    /// By `δ` and `ν` at the end: of `ε`, of `Λ` and of the output `z`.
    by_end_of_elongations: Vec<[f64; 2]>,
    by_end_of_slips: Vec<[f64; 2]>,
    pub outputs: Vec<[f64; 2]>,
}

impl StopSensitivities {
    pub fn new(shape: ElementShape, width: usize) -> Self {
        let rows = || vec![0.0; shape.stops * width];
        let by_end = || vec![[0.0; 2]; shape.stops];
        Self {
            width,
            deteriorates: shape.deteriorates,
            elongations: rows(),
            slips: rows(),
            elongations_ahead: rows(),
            slips_ahead: rows(),
            by_end_of_elongations: by_end(),
            by_end_of_slips: by_end(),
            outputs: by_end(),
        }
    }

    /// Before the first sample nothing depends on parameters.
    pub fn begin(&mut self) {
        self.elongations.fill(0.0);
        self.slips.fill(0.0);
    }

    /// A step without `∂δ` and `∂ν` at its end; `point` has them at its beginning, `outputs` takes `∂z`.
    #[inline(always)]
    pub fn take<S: Simd>(&mut self, ends: ElementEnds<'_>, point: &[f64], outputs: &mut [f64]) {
        let ElementEnds { element, layout, from, step, .. } = ends;
        let width = self.width;
        let (displacement, velocity) = point[..2 * width].split_at(width);
        for i in 0..element.thresholds.len() {
            let rows = i * width..(i + 1) * width;
            let (elongation, threshold) = (&mut self.elongations_ahead[rows.clone()], element.thresholds[i]);
            let (of_velocity, at_threshold) = (element.stop_velocities[i], step.at_threshold[i]);
            // ∂ε̂
            elongation.copy_from_slice(&self.elongations[rows.clone()]);
            add_multiple::<S>(elongation, -1.0, displacement);
            add_multiple::<S>(elongation, -of_velocity, velocity);
            elongation[layout.stop_velocities.start + i] += step.end.inputs[2] - from.inputs[2];
            let of_free = [1.0, of_velocity];
            self.by_end_of_elongations[i] = of_free;
            let sign = if at_threshold == 0.0 { 0.0 } else { at_threshold.signum() };
            if self.deteriorates {
                // Λ moves by |ε̂| - ρ where the stop slips.
                let slip = &mut self.slips_ahead[rows.clone()];
                slip.copy_from_slice(&self.slips[rows.clone()]);
                if sign != 0.0 {
                    add_multiple::<S>(slip, sign, elongation);
                    slip[layout.ln_thresholds.start + i] -= threshold;
                }
                self.by_end_of_slips[i] = of_free.map(|by| sign * by);
            }
            if sign != 0.0 {
                elongation.fill(0.0);
                elongation[layout.ln_thresholds.start + i] = at_threshold;
                self.by_end_of_elongations[i] = [0.0; 2];
            }
            let output = &mut outputs[rows.clone()];
            output.copy_from_slice(elongation);
            self.outputs[i] = self.by_end_of_elongations[i];
            if self.deteriorates {
                let (strength, length) = (step.strengths[i], step.end.elongations[i]);
                let by_slip = if strength > 0.0 { -element.strength_losses[i] * length } else { 0.0 };
                output.iter_mut().for_each(|by| *by *= strength);
                add_multiple::<S>(output, by_slip, &self.slips_ahead[rows]);
                if strength > 0.0 {
                    output[layout.strength_losses.start + i] -= length * step.end.slips[i];
                }
                for k in 0..2 {
                    self.outputs[i][k] =
                        strength * self.by_end_of_elongations[i][k] + by_slip * self.by_end_of_slips[i][k];
                }
            }
        }
    }

    /// To the end of the step, from `∂δ` and `∂ν` there.
    #[inline(always)]
    pub fn end<S: Simd>(&mut self, displacement: &[f64], velocity: &[f64]) {
        add_by_end::<S>(&mut self.elongations_ahead, &self.by_end_of_elongations, displacement, velocity);
        std::mem::swap(&mut self.elongations, &mut self.elongations_ahead);
        if self.deteriorates {
            add_by_end::<S>(&mut self.slips_ahead, &self.by_end_of_slips, displacement, velocity);
            std::mem::swap(&mut self.slips, &mut self.slips_ahead);
        }
    }
}

/// Adds to each row what depends on `δ` and `ν` at the end of a step.
#[inline(always)]
pub(super) fn add_by_end<S: Simd>(
    rows: &mut [f64],
    by_end: &[[f64; 2]],
    displacement: &[f64],
    velocity: &[f64],
) {
    for (row, by) in rows.chunks_exact_mut(displacement.len()).zip(by_end) {
        add_two::<S>(row, *by, [displacement, velocity]);
    }
}
