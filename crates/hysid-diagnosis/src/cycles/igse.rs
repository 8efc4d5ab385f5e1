//! Losses of any waveform by the improved generalised Steinmetz equation.
//!
//! ```text
//! W = k_i ∫ |dB/dt|^α ΔB^(β-α) dt,    k_i = k / ((2π)^(α-1) 2^(β-α) ∫_0^2π |cos θ|^α dθ)
//! ```
//!
//! `ΔB` is the range of the loop that a moment belongs to: smaller loops on the way are separated from the larger one (K.
//! Venkatachalam, C. R. Sullivan, T. Abdallah, H. Tacca, IEEE Workshop on Computers in Power Electronics, 2002, 36-41).

use std::f64::consts::TAU;

use hysid_core::data::record::Record;
use hysid_core::elementary::{cos, powf};

use super::harmonic::is_sine;
use super::row::CycleRow;

/// Points of the integral of `|cos θ|^α`.
const POINTS: u32 = 20_000;

/// The Steinmetz equation as it holds for any waveform.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steinmetz {
    /// `k_i`.
    factor: f64,
    /// `α`.
    frequency: f64,
    /// `β`.
    amplitude: f64,
}

impl Steinmetz {
    /// From the parameters `k`, `α` and `β` of a sine.
    pub fn of_sine(coefficient: f64, frequency: f64, amplitude: f64) -> Self {
        let angle = |k: u32| TAU * (f64::from(k) + 0.5) / f64::from(POINTS);
        let powers: f64 = (0..POINTS).map(|k| powf(cos(angle(k)).abs(), frequency)).sum();
        let integral = powers * TAU / f64::from(POINTS);
        let factor = coefficient / (powf(TAU, frequency - 1.0) * powf(2.0, amplitude - frequency) * integral);
        Self { factor, frequency, amplitude }
    }
}

/// Time and output of a cycle, closed by the step from its last row to its first of the next period.
pub(super) struct Waveform {
    time: Vec<f64>,
    output: Vec<f64>,
}

impl Waveform {
    /// The output of a complete cycle with a period and without blank rows, over time in the unit in which `rate` units of
    /// time are one.
    pub fn of(record: &Record, row: &CycleRow, rate: f64) -> Option<Self> {
        let (time, rows) = (record.time()?, row.rows.0..row.rows.1 + 1);
        let period = row.period.filter(|_| row.complete && row.frequency.is_some())?;
        let first = *time.get(rows.start)?;
        // The row that begins the next period, if it is among them, is the first once more.
        let rows = rows.filter(|&row| time[row] < first + (1.0 - 1e-9) * period);
        let (mut time, mut output): (Vec<f64>, Vec<f64>) =
            rows.map(|row| (time[row], record.output()[row])).unzip();
        time.push(first + period);
        output.push(*output.first()?);
        time.iter_mut().for_each(|time| *time /= rate);
        let is_measured = output.iter().all(|y| !y.is_nan());
        is_measured.then_some(Self { time, output })
    }

    /// True if the output is nearly a sine.
    pub fn is_sine(&self) -> bool {
        is_sine(&self.time, &self.output)
    }

    /// The loss of the cycle.
    pub fn energy(&self, law: &Steinmetz) -> f64 {
        let Steinmetz { factor, frequency: alpha, amplitude: beta } = *law;
        let ranges = self.ranges();
        let step = |k: usize| {
            let (db, dt) = ((self.output[k + 1] - self.output[k]).abs(), self.time[k + 1] - self.time[k]);
            if db == 0.0 { 0.0 } else { powf(db / dt, alpha) * powf(ranges[k], beta - alpha) * dt }
        };
        factor * (0..ranges.len()).map(step).sum::<f64>()
    }

    /// Range of the loop that each step belongs to.
    fn ranges(&self) -> Vec<f64> {
        let count = self.output.len() - 1;
        let top = (0..count).max_by(|&a, &b| self.output[a].total_cmp(&self.output[b])).unwrap_or(0);
        // From the largest output around to it again: the whole loop goes from there to the smallest one and back.
        let at = |place: usize| self.output[(top + place) % count];
        let is_turn = |place: usize| (at(place) - at(place - 1)) * (at(place + 1) - at(place)) < 0.0;
        let turns = std::iter::once(0).chain((1..count).filter(|&place| is_turn(place))).chain([count]);
        let (low, high) = super::path::range(&self.output);
        let mut ranges = vec![high - low; count];
        let mut assigned = vec![false; count];
        let mut stack: Vec<usize> = Vec::new();
        for turn in turns {
            stack.push(turn);
            while let [.., a, b, c, d] = stack[..] {
                let inner = (at(c) - at(b)).abs();
                if inner > (at(b) - at(a)).abs() || inner > (at(d) - at(c)).abs() {
                    break;
                }
                // The smaller loop goes from b to c and back to the output of b.
                let (least, most) = (at(b).min(at(c)), at(b).max(at(c)));
                for place in b..d {
                    let middle = 0.5 * (at(place) + at(place + 1));
                    if !assigned[place] && (least..=most).contains(&middle) {
                        assigned[place] = true;
                        ranges[(top + place) % count] = inner;
                    }
                }
                stack.truncate(stack.len() - 3);
                stack.push(d);
            }
        }
        ranges
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use hysid_core::elementary::sin;

    use super::*;

    fn law() -> Steinmetz {
        Steinmetz::of_sine(3.0, 1.4, 2.3)
    }

    /// Straight lines between corners, in 400 steps each.
    fn lines(corners: &[(f64, f64)]) -> Waveform {
        let (mut time, mut output) = (vec![corners[0].0], vec![corners[0].1]);
        for pair in corners.windows(2) {
            let share = |k: i32| f64::from(k) / 400.0;
            time.extend((1..=400).map(|k| pair[0].0 + share(k) * (pair[1].0 - pair[0].0)));
            output.extend((1..=400).map(|k| pair[0].1 + share(k) * (pair[1].1 - pair[0].1)));
        }
        Waveform { time, output }
    }

    /// Loss of lines of a slope over a rise in a loop of a range.
    fn of_lines(rises: &[(f64, f64, f64)]) -> f64 {
        let cosines: f64 =
            (0..40_000).map(|k| powf(cos(TAU * f64::from(k) / 4e4).abs(), 1.4)).sum::<f64>() * TAU / 4e4;
        let factor = 3.0 / (powf(TAU, 0.4) * powf(2.0, 0.9) * cosines);
        rises.iter().map(|(rise, dt, range)| factor * powf(rise / dt, 1.4) * powf(*range, 0.9) * dt).sum()
    }

    #[test]
    fn a_sine_has_the_loss_of_the_steinmetz_equation() {
        for frequency in [1.0, 50.0] {
            let time: Vec<f64> = (0..=4000).map(|k| f64::from(k) / 4000.0 / frequency).collect();
            let output = time.iter().map(|t| 0.7 + 0.5 * sin(TAU * frequency * t + 0.4)).collect();
            let energy = Waveform { time, output }.energy(&law());
            assert_relative_eq!(energy, 3.0 * powf(frequency, 0.4) * powf(0.5, 2.3), max_relative = 1e-5);
        }
    }

    #[test]
    fn a_triangle_has_the_loss_of_its_two_slopes() {
        let energy = lines(&[(0.0, 0.0), (0.3, 1.0), (1.0, -1.0), (1.3, 0.0)]).energy(&law());
        assert_relative_eq!(energy, of_lines(&[(2.0, 0.6, 2.0), (2.0, 0.7, 2.0)]), max_relative = 1e-6);
    }

    #[test]
    fn a_smaller_loop_on_the_way_has_its_own_range() {
        // Up to 1, down to 0, back to 0.5, and on down to -1.
        let energy = lines(&[(0.0, -1.0), (1.0, 1.0), (1.5, 0.0), (1.7, 0.5), (2.5, -1.0)]).energy(&law());
        let outer = [(2.0, 1.0, 2.0), (1.0, 0.5, 2.0), (1.0, 0.8 / 1.5, 2.0)];
        let inner = [(0.5, 0.2, 0.5), (0.5, 0.8 / 3.0, 0.5)];
        assert_relative_eq!(energy, of_lines(&outer) + of_lines(&inner), max_relative = 1e-2);
    }
}
