//! Online use of measured outputs: a disturbance that fades, and a gain and an offset of the output that drift.
//!
//! ```text
//! ŷ_k = m_k + (a - 1) (m_k - o) + b + d_k                                 theory.md (8.65)
//! d_k|k-1 = λ d_k-1,    d_k = d_k|k-1 + K (e_k - d_k|k-1)                 theory.md (8.66)
//! λ = clip(c_2/c_1; c_1/c_0, 1 - 1/N),    ρ = min(1, c_1/(λ c_0))         theory.md (8.67)
//! K = P/(P + 1 - ρ),    P² + (1 - λ²)(1 - 2ρ) P = (1 - λ²) ρ (1 - ρ)      theory.md (8.68)
//! J_k = J_k-1 + (D + φ φᵀ - J_k-1)/R,    θ_k = θ_k-1 + J_k⁻¹ φ ε/R        theory.md (8.69)
//! ```

use crate::error::{FEWEST_ADAPTATION_ROWS, LARGEST_VALUE, Result, SampleError};
use crate::model::Model;
use crate::model::stepper::Stepper;

/// Default memory of [`Stepper::adapt`] in rows: about ten cycles of a hundred rows, so that the error of the model within
/// a cycle is averaged and does not look like a drift.
pub const ADAPTATION_ROWS: usize = 1000;

/// `N`: rows of memory of the autocovariances, which it determines to about 2 % of the variance.
const MEMORY: f64 = 1000.0;

/// Standard deviations `1/√n` of a correlation of white residuals beyond which residuals count as correlated.
const SIGNIFICANT: f64 = 3.0;

/// Bounds of the gain of the output.
const GAIN_BOUNDS: (f64, f64) = (0.5, 2.0);

/// Bound of the offset, and of the scaled values of the regression, in halves of the width of the trained output: the
/// offset is at most the width, and a gain of 2 adds half of it at its edge.
const LARGEST_OFFSET: f64 = 2.0;
const LARGEST_SCALED: f64 = 3.0;

/// `D`: information on gain and offset that each row adds. It bounds their covariance; without excitation, ten times as
/// much of a residual becomes offset as gain.
const PRIOR: [f64; 2] = [0.1, 0.01];

/// Largest residual of a memory that fits, in multiples of the validation error, and the fewest rows that tell.
const LARGEST_RATIO: f64 = 2.0;
const FEWEST_ROWS: f64 = 100.0;

/// State of the online corrections of a [`Stepper`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracking {
    /// Gain `a` of the output, from 1/2 to 2; 1 unless [`Stepper::adapt`] is used.
    pub gain: f64,
    /// Offset `b` in `a · model + b`, in the unit of the output; 0 unless [`Stepper::adapt`] is used.
    pub offset: f64,
    /// Disturbance `d` that the last output had or [`Stepper::correct`] found since, in the unit of the output.
    pub disturbance: f64,
    /// Factor `λ` by which the disturbance fades from row to row, from 0 to below 1.
    pub decay: f64,
    /// Share `K` of a residual that becomes disturbance, from 0 to 1; 0 while the residuals are not correlated.
    pub kalman_gain: f64,
    /// Root mean square of the recent residuals `y - (a · model + b)`; `None` before the first measured output.
    pub residual: Option<f64>,
    /// True if this residual is at most twice the validation error of the model; `None` for a model without one, and
    /// before 100 measured outputs.
    pub memory_fits: Option<bool>,
}

impl Stepper<'_> {
    /// Takes the output measured at the last sample, in the unit of the output, and corrects the outputs from the next
    /// sample on (theory.md (8.65) to (8.68)).
    ///
    /// The correction is a disturbance beside the output of the model: the part of the recent residuals that persists.
    /// It fades by a factor from row to row. Factor and share of a residual are learned from the residuals themselves;
    /// without correlation between consecutive residuals nothing is corrected. So the output must be measured in
    /// consecutive rows; rows without a measurement in between do no harm.
    ///
    /// **The memory of the model is not corrected.** A model that begins in another state than the system keeps a wrong
    /// memory: [`Model::find_state`] (`--known` of the program) finds it from the first outputs of a record.
    /// The prediction band remains that of the model.
    ///
    /// # Errors
    /// A measured output that is not finite; no sample yet, or a trial that is not committed. Nothing changes then.
    pub fn correct(&mut self, y: f64) -> Result<()> {
        let output = self.measurable(y)?;
        self.tracker().correct(output, y);
        Ok(())
    }

    /// Takes the output measured at the last sample, in the unit of the output, and adapts gain and offset of the output
    /// from the next sample on, `y ≈ a · model + b` (theory.md (8.69)).
    ///
    /// `rows` is the memory in rows ([`ADAPTATION_ROWS`] by default): residuals that are older count little. `a` stays
    /// between 1/2 and 2, and the middle of the trained output is moved by at most its width. With [`Stepper::correct`],
    /// call this first. As there, the memory of the model is not corrected.
    ///
    /// # Errors
    /// As [`Stepper::correct`], and a memory below [`FEWEST_ADAPTATION_ROWS`].
    pub fn adapt(&mut self, y: f64, rows: usize) -> Result<()> {
        let output = self.measurable(y)?;
        if rows < FEWEST_ADAPTATION_ROWS {
            return Err(SampleError::AdaptationRows(rows).into());
        }
        self.tracker().adapt(output, y, rows as f64);
        Ok(())
    }

    /// State of the corrections at the last committed sample.
    pub fn tracking(&self) -> Tracking {
        let tracker = self.committed.as_ref().map_or(&self.state.tracker, |committed| &committed.tracker);
        let tracker = tracker.as_deref().copied().unwrap_or_else(|| Tracker::new(&self.model));
        tracker.tracking(self.model.provenance().validation.as_ref().map(|errors| errors.rmse))
    }

    fn tracker(&mut self) -> &mut Tracker {
        self.state.tracker.get_or_insert_with(|| Box::new(Tracker::new(&self.model)))
    }

    /// The output of the model at the committed sample, if this output can be one that was measured there.
    fn measurable(&self, y: f64) -> Result<f64> {
        let last = self.state.last.filter(|_| self.committed.is_none()).ok_or(SampleError::NotCommitted)?;
        if y.is_finite() { Ok(last.output) } else { Err(SampleError::Measured(y).into()) }
    }
}

/// What a stepper has learned from measured outputs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tracker {
    /// Middle and half the width of the trained output.
    origin: f64,
    scale: f64,
    /// Residuals of the last sample and of the two before, where outputs were measured.
    residuals: [Option<f64>; 3],
    /// Sums of the products of residuals 0, 1 and 2 samples apart, and of their weights.
    products: [f64; 3],
    weights: [f64; 3],
    decay: f64,
    kalman_gain: f64,
    disturbance: f64,
    /// `θ`: gain less 1, and scaled offset.
    change: [f64; 2],
    /// `J`: the elements 11, 12 and 22.
    information: [f64; 3],
}

impl Tracker {
    pub fn new(model: &Model) -> Self {
        let [origin, scale] = model.trained_ranges().middle_and_half_width();
        Self {
            origin,
            scale,
            residuals: [None; 3],
            products: [0.0; 3],
            weights: [0.0; 3],
            decay: 0.0,
            kalman_gain: 0.0,
            disturbance: 0.0,
            change: [0.0; 2],
            information: [PRIOR[0], 0.0, PRIOR[1]],
        }
    }

    /// Takes the output of the model at the next sample and returns the corrected one.
    pub fn step(&mut self, output: f64) -> f64 {
        self.residuals = [None, self.residuals[0], self.residuals[1]];
        self.disturbance *= self.decay; // (8.66)
        let correction = self.adaptation(output) + self.disturbance; // (8.65)
        // Without a correction, the sign of a zero remains too.
        if correction == 0.0 { output } else { output + correction }
    }

    /// Difference of the adapted output from that of the model.
    fn adaptation(&self, output: f64) -> f64 {
        self.change[0] * (output - self.origin) + self.change[1] * self.scale
    }

    /// The residual of the adapted output; the first of a sample is added to the sums.
    fn residual(&mut self, output: f64, y: f64) -> f64 {
        let residual = y - (output + self.adaptation(output));
        let residual = residual.clamp(-LARGEST_VALUE, LARGEST_VALUE);
        if self.residuals[0].is_none() {
            self.residuals[0] = Some(residual);
            for (lag, before) in self.residuals.into_iter().enumerate() {
                if let Some(before) = before {
                    self.products[lag] = (1.0 - 1.0 / MEMORY) * self.products[lag] + residual * before;
                    self.weights[lag] = (1.0 - 1.0 / MEMORY) * self.weights[lag] + 1.0;
                }
            }
        }
        residual
    }

    fn correct(&mut self, output: f64, y: f64) {
        let residual = self.residual(output, y);
        (self.decay, self.kalman_gain) = self.kalman();
        self.disturbance += self.kalman_gain * (residual - self.disturbance); // (8.66)
    }

    /// Decay and steady gain of the Kalman filter; 0 where the residuals are not correlated.
    fn kalman(&self) -> (f64, f64) {
        let covariance = |lag: usize| self.products[lag] / self.weights[lag].max(1.0);
        let correlation = covariance(1) / covariance(0);
        let is_correlated = correlation > SIGNIFICANT / self.weights[1].sqrt();
        if !is_correlated {
            return (0.0, 0.0);
        }
        // (8.67)
        let decay = (covariance(2) / covariance(1)).max(correlation).min(1.0 - 1.0 / MEMORY);
        let share = (correlation / decay).min(1.0);
        // (8.68)
        let renewed = 1.0 - decay * decay;
        let half = 0.5 * renewed * (1.0 - 2.0 * share);
        let variance = (half * half + renewed * share * (1.0 - share)).sqrt() - half;
        (decay, variance / (variance + (1.0 - share)))
    }

    fn adapt(&mut self, output: f64, y: f64, rows: f64) {
        let scaled = |value: f64, scale: f64| (value / scale).clamp(-LARGEST_SCALED, LARGEST_SCALED);
        let error = scaled(self.residual(output, y), self.scale) / rows;
        let x = scaled(output - self.origin, self.scale);
        // (8.69), for φ = (x, 1).
        let [mut gain, mut both, mut offset] = self.information;
        gain += (PRIOR[0] + x * x - gain) / rows;
        both += (x - both) / rows;
        offset += (PRIOR[1] + 1.0 - offset) / rows;
        self.information = [gain, both, offset];
        let determinant = gain * offset - both * both;
        let [of_gain, of_offset] = &mut self.change;
        *of_gain += error * (offset * x - both) / determinant;
        *of_gain = of_gain.clamp(GAIN_BOUNDS.0 - 1.0, GAIN_BOUNDS.1 - 1.0);
        *of_offset += error * (gain - both * x) / determinant;
        *of_offset = of_offset.clamp(-LARGEST_OFFSET, LARGEST_OFFSET);
    }

    fn tracking(&self, expected: Option<f64>) -> Tracking {
        let [gain, offset] = self.change;
        let residual = (self.weights[0] > 0.0).then(|| (self.products[0] / self.weights[0]).sqrt());
        let judged = residual.filter(|_| self.weights[0] >= FEWEST_ROWS);
        Tracking {
            gain: 1.0 + gain,
            offset: offset * self.scale - gain * self.origin,
            disturbance: self.disturbance,
            decay: self.decay,
            kalman_gain: self.kalman_gain,
            residual,
            memory_fits: judged
                .zip(expected)
                .map(|(residual, expected)| residual <= LARGEST_RATIO * expected),
        }
    }
}
