//! Speeds at which the first input passes the places of its range. Data in which it passes each place at one speed cannot
//! show how the output depends on the rate: any dependence fits them, and none can be believed at another speed.
//!
//! The range is divided into cells of equal width. The speed of a passage is the width of a cell over the time from one
//! edge to the other, which noise in the input hardly changes. A reversal inside a cell is no passage.

use super::{Dataset, Record};
use crate::data::turning_points::turning_points;

/// Cells of the range. Designed.
const CELLS: usize = 16;

/// Speeds, or times, that differ by less than this factor count as one. Designed.
const ONE: f64 = 1.5;

/// Share of passages, cells and half cycles that may differ from the others. Designed.
const FEW: f64 = 0.1;

/// Reversals below this share of the range do not end a half cycle. Designed.
const SMALLEST_REVERSAL: f64 = 0.05;

/// Whether the speeds of the first input can show a dependence on the rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpeedEvidence {
    /// Nothing: there are no time stamps, or one speed at each place.
    One,
    /// Little: speed grows with amplitude, so that dependences on both look alike.
    OfAmplitude,
    /// There are several speeds at each place, or the input rests most of the time.
    Several,
}

impl Record {
    /// Mean speed of the first input: its path over the time that it takes; `None` without time stamps and for an input at
    /// rest.
    pub fn mean_speed(&self) -> Option<f64> {
        let time = self.time()?;
        let path: f64 = self.inputs[0].windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        let speed = path / (time.last()? - time.first()?);
        (speed > 0.0 && speed.is_finite()).then_some(speed)
    }
}

impl Dataset {
    /// Whether the speeds of the first input can show a dependence on the rate.
    pub fn speeds(&self) -> SpeedEvidence {
        if !self.has_time() {
            return SpeedEvidence::One;
        }
        let (low, high) = self.input_range(0);
        let grid = Grid { low, width: (high - low) / CELLS as f64 };
        let mut cells: Vec<Vec<f64>> = vec![Vec::new(); 2 * CELLS];
        let (mut at_rest, mut steps) = (0, 0);
        for record in &self.records {
            grid.passages(record, &mut cells);
            at_rest += rows_at_rest(record, high - low);
            steps += record.len() - 1;
        }
        if 2 * at_rest > steps {
            return SpeedEvidence::Several;
        }
        let passed = cells.iter().filter(|speeds| speeds.len() > 1).count();
        let several = cells.iter_mut().map(|speeds| usize::from(differ(speeds))).sum::<usize>();
        if several as f64 <= FEW * passed as f64 {
            return SpeedEvidence::One;
        }
        let mut times: Vec<f64> = self.records.iter().flat_map(|r| half_cycles(r, high - low)).collect();
        if times.len() > 2 && !differ(&mut times) {
            SpeedEvidence::OfAmplitude
        } else {
            SpeedEvidence::Several
        }
    }
}

/// True if more than a few of the values differ from the median by a factor that does not count as one value.
fn differ(values: &mut [f64]) -> bool {
    if values.len() < 2 {
        return false;
    }
    let middle = values.len() / 2;
    let median = *values.select_nth_unstable_by(middle, f64::total_cmp).1;
    // A band of the whole factor around the median.
    let half = ONE.sqrt();
    let others = values.iter().filter(|&&value| value > median * half || value < median / half).count();
    others as f64 > FEW * values.len() as f64
}

/// Steps in which the input changes by less than a hundred-thousandth of its range.
fn rows_at_rest(record: &Record, range: f64) -> usize {
    record.inputs[0].windows(2).filter(|pair| (pair[1] - pair[0]).abs() <= 1e-5 * range).count()
}

/// Times from each turning point to the next.
fn half_cycles(record: &Record, range: f64) -> Vec<f64> {
    let Some(time) = record.time() else { return Vec::new() };
    let turning = turning_points(&record.inputs[0], SMALLEST_REVERSAL * range);
    turning.windows(2).map(|pair| time[pair[1]] - time[pair[0]]).collect()
}

struct Grid {
    low: f64,
    width: f64,
}

impl Grid {
    /// Adds the speeds of a record's passages to those of each cell, upwards and downwards apart.
    fn passages(&self, record: &Record, cells: &mut [Vec<f64>]) {
        let Some(time) = record.time() else { return };
        // The last edge that was crossed, and when.
        let mut last: Option<(i64, f64)> = None;
        let place = |x: f64| (x - self.low) / self.width;
        for (x, t) in record.inputs[0].windows(2).zip(time.windows(2)) {
            let (from, to) = (place(x[0]), place(x[1]));
            let rises = to > from;
            let (first, end) = (from.min(to).floor() as i64 + 1, from.max(to).floor() as i64);
            let count = end - first + 1;
            for step in 0..count.max(0) {
                let edge = if rises { first + step } else { end - step };
                let share = (edge as f64 - from) / (to - from);
                let now = t[0] + share * (t[1] - t[0]);
                if let Some((before, then)) = last
                    && (edge - before).abs() == 1
                    && now > then
                {
                    let cell = usize::try_from(edge.min(before)).unwrap_or(0).min(CELLS - 1);
                    cells[2 * cell + usize::from(rises)].push(self.width / (now - then));
                }
                last = Some((edge, now));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::record::ColumnNames;
    use crate::elementary::sin;
    use crate::random::uniform;

    const STEP: f64 = 0.02;

    /// A record of an input over the phase `2 π f t`.
    fn data(records: &[&dyn Fn(f64) -> f64]) -> Dataset {
        let record = |(place, x): (usize, &&dyn Fn(f64) -> f64)| {
            let time: Vec<f64> = (0..2000).map(|row| STEP * f64::from(row)).collect();
            let x: Vec<f64> = time.iter().map(|t| x(*t)).collect();
            Record::new(format!("r{place}"), vec![x.clone()], x).unwrap().with_time(time).unwrap()
        };
        let records = records.iter().enumerate().map(record).collect();
        Dataset::new(ColumnNames { time: Some("t".into()), ..ColumnNames::plain(1) }, records).unwrap()
    }

    /// A triangle of amplitude and period 1 that begins at 0.
    fn triangle(phase: f64) -> f64 {
        let phase = (phase + 0.25).rem_euclid(1.0);
        if phase < 0.5 { 4.0 * phase - 1.0 } else { 3.0 - 4.0 * phase }
    }

    fn sine(phase: f64) -> f64 {
        sin(std::f64::consts::TAU * phase)
    }

    #[test]
    fn one_waveform_has_one_speed_at_each_place() {
        assert_eq!(data(&[&|t| sine(0.2 * t)]).speeds(), SpeedEvidence::One);
        assert_eq!(data(&[&|t| triangle(0.2 * t)]).speeds(), SpeedEvidence::One);
        assert_eq!(data(&[&|t| t]).speeds(), SpeedEvidence::One);
        let jitter = |t: f64| 0.01 * (uniform((t / STEP).round() as u64) - 0.5);
        assert_eq!(data(&[&|t| triangle(0.1 * t) + jitter(t)]).speeds(), SpeedEvidence::One);
        // Growing cycles at one speed, as in a cyclic test of a column.
        let growing = |t: f64| {
            let (mut t, mut amplitude) = (t, 1.0);
            while t > 4.0 * amplitude {
                t -= 4.0 * amplitude;
                amplitude += 0.5;
            }
            amplitude * triangle(t / (4.0 * amplitude))
        };
        assert_eq!(data(&[&growing]).speeds(), SpeedEvidence::One);
    }

    #[test]
    fn cycles_of_one_period_do_not_tell_the_rate_from_the_amplitude() {
        assert_eq!(data(&[&|t| 0.1 * t.floor() * sine(t)]).speeds(), SpeedEvidence::OfAmplitude);
        assert_eq!(
            data(&[&|t| sine(0.2 * t), &|t| 3.0 * sine(0.2 * t)]).speeds(),
            SpeedEvidence::OfAmplitude
        );
    }

    #[test]
    fn several_frequencies_have_several_speeds() {
        assert_eq!(data(&[&|t| sine(0.2 * t), &|t| sine(0.8 * t)]).speeds(), SpeedEvidence::Several);
        assert_eq!(data(&[&|t| sine(0.2 * t), &|t| 3.0 * sine(0.8 * t)]).speeds(), SpeedEvidence::Several);
        assert_eq!(data(&[&|t| sine(0.3 * t) + sine(0.97 * t)]).speeds(), SpeedEvidence::Several);
        // Steps, after each of which the output creeps.
        assert_eq!(data(&[&|t| (t / 4.0).floor().rem_euclid(3.0)]).speeds(), SpeedEvidence::Several);
    }

    #[test]
    fn data_without_time_have_no_speeds() {
        let x: Vec<f64> = (0..50).map(f64::from).collect();
        let record = Record::new("r", vec![x.clone()], x).unwrap();
        assert_eq!(Dataset::new(ColumnNames::plain(1), vec![record]).unwrap().speeds(), SpeedEvidence::One);
    }
}
