//! Which linear oscillator fits data best in a free run: a grid of frequencies and damping ratios, and around the best of
//! it a search with ever smaller steps. Gain, direct part, offset and initial states follow by linear least squares.

use hysid_core::elementary::{ln, powi};

use super::excerpt::Excerpts;
use super::linear_oscillator::{LinearOscillator, OscillatorStep};
use super::normal_equations::NormalEquations;

/// Cycles in the longest excerpt, at least.
const FEWEST_CYCLES: f64 = 2.0;

/// Cycles in a time step, at most.
const MOST_CYCLES: f64 = 0.3;

/// Frequencies of the grid, each so much higher than the one before, and their damping ratios.
const FACTOR: f64 = 1.1;
const DAMPING_RATIOS: [f64; 3] = [0.03, 0.12, 0.5];

/// Damping ratios between which the best is looked for.
const LEAST_DAMPING: f64 = 5e-4;
const MOST_DAMPING: f64 = 0.95;

/// Valleys of the grid that are followed to their bottom.
const VALLEYS: usize = 3;

/// Halvings of the steps to the bottom, and the most steps there.
const HALVINGS: usize = 12;
const MOST_STEPS: usize = 100;

/// Columns of a free run: two free motions, the oscillator, the input, a constant, the output.
const COLUMNS: usize = 6;

/// The best oscillator: the lowest of the local minima that were followed. `None` if the rows are too few for one.
pub(super) fn best(excerpts: &Excerpts) -> Option<LinearOscillator> {
    let longest = excerpts.parts.iter().map(|part| part.duration()).fold(0.0, f64::max);
    let coarsest = excerpts.parts.iter().map(|part| part.step).fold(0.0, f64::max);
    let mut search = ResonanceSearch {
        excerpts,
        frequencies: (FEWEST_CYCLES / longest, MOST_CYCLES / coarsest),
        columns: std::array::from_fn(|_| Vec::new()),
    };
    let bottoms = search.valleys().into_iter().map(|point| search.bottom(point));
    bottoms.min_by(|a, b| a.residual.total_cmp(&b.residual))
}

/// A frequency and a damping ratio, and the sum of squares that such an oscillator leaves of the scaled output.
#[derive(Debug, Clone, Copy)]
struct OscillatorPoint {
    frequency: f64,
    damping_ratio: f64,
    remainder: f64,
}

struct ResonanceSearch<'e> {
    excerpts: &'e Excerpts,
    /// Lowest and highest frequency.
    frequencies: (f64, f64),
    /// Space for the columns of an oscillator.
    columns: [Vec<f64>; 3],
}

impl ResonanceSearch<'_> {
    /// The products of a free run, with all columns but the output eliminated.
    fn equations(&mut self, frequency: f64, damping_ratio: f64) -> NormalEquations<COLUMNS> {
        let mut sum = NormalEquations::empty();
        for part in &self.excerpts.parts {
            let step = OscillatorStep::new(frequency, damping_ratio, part.step);
            let [distance, speed, response] = &mut self.columns;
            step.decay([1.0, 0.0], part.rows.len(), distance);
            step.decay([0.0, 1.0], part.rows.len(), speed);
            step.response(&part.input, response);
            for column in [&mut *distance, speed, response] {
                self.excerpts.compare(part, column);
            }
            let mut equations = NormalEquations::of([
                distance,
                speed,
                response,
                &part.input_column,
                &part.constant_column,
                &part.output_column,
            ]);
            equations.eliminate(0..2);
            sum.add(&equations);
        }
        sum.eliminate(2..COLUMNS - 1);
        sum
    }

    fn point(&mut self, frequency: f64, damping_ratio: f64) -> OscillatorPoint {
        let frequency = frequency.clamp(self.frequencies.0, self.frequencies.1);
        let damping_ratio = damping_ratio.clamp(LEAST_DAMPING, MOST_DAMPING);
        let remainder = self.equations(frequency, damping_ratio).remainder();
        OscillatorPoint { frequency, damping_ratio, remainder }
    }

    /// The best damping ratio at each frequency of the grid, where it is better than at those beside it.
    fn valleys(&mut self) -> Vec<OscillatorPoint> {
        let (low, high) = self.frequencies;
        let count = (ln(high / low) / ln(FACTOR)).max(0.0) as i32;
        let mut grid: Vec<OscillatorPoint> = Vec::new();
        for k in 0..=count {
            let points = DAMPING_RATIOS.map(|damping_ratio| self.point(low * powi(FACTOR, k), damping_ratio));
            grid.extend(points.into_iter().min_by(|a, b| a.remainder.total_cmp(&b.remainder)));
        }
        let remainder = |k: usize| grid.get(k).map_or(f64::INFINITY, |point| point.remainder);
        let is_valley =
            |k: &usize| remainder(*k) <= remainder(k.wrapping_sub(1)) && remainder(*k) < remainder(k + 1);
        let mut valleys: Vec<OscillatorPoint> = (0..grid.len()).filter(is_valley).map(|k| grid[k]).collect();
        valleys.sort_by(|a, b| a.remainder.total_cmp(&b.remainder));
        valleys.truncate(VALLEYS);
        valleys
    }

    /// Where steps in all four directions lead no deeper.
    fn bottom(&mut self, mut best: OscillatorPoint) -> LinearOscillator {
        let (mut in_frequency, mut in_damping) = (FACTOR.sqrt(), 2.0_f64);
        let (mut halvings, mut steps) = (0, 0);
        while halvings < HALVINGS && steps < MOST_STEPS {
            let OscillatorPoint { frequency, damping_ratio, .. } = best;
            let around = [
                (frequency * in_frequency, damping_ratio),
                (frequency / in_frequency, damping_ratio),
                (frequency, damping_ratio * in_damping),
                (frequency, damping_ratio / in_damping),
            ];
            let around = around.map(|(frequency, damping_ratio)| self.point(frequency, damping_ratio));
            let next = around.into_iter().min_by(|a, b| a.remainder.total_cmp(&b.remainder));
            if let Some(next) = next.filter(|next| next.remainder < best.remainder) {
                best = next;
                steps += 1;
            } else {
                (in_frequency, in_damping) = (in_frequency.sqrt(), in_damping.sqrt());
                halvings += 1;
            }
        }
        self.oscillator(best)
    }

    /// The oscillator in the units of the data.
    fn oscillator(&mut self, point: OscillatorPoint) -> LinearOscillator {
        let equations = self.equations(point.frequency, point.damping_ratio);
        let weights = equations.weights(2);
        let Excerpts { input, output, .. } = *self.excerpts;
        // The columns are the distance from the input and the input: an oscillator is their sum.
        let slope = output.half / input.half;
        LinearOscillator {
            natural_frequency: point.frequency,
            damping_ratio: point.damping_ratio,
            gain: slope * weights[0],
            direct: slope * (weights[1] - weights[0]),
            offset: output.middle + output.half * weights[2] - slope * weights[1] * input.middle,
            compared: self.excerpts.compared,
            residual: self.excerpts.root_mean_square(point.remainder),
        }
    }
}
