//! The rows of a residual: each with its residual, inputs, rate and place.

use hysid_core::data::rate::RateMethod;
use hysid_core::data::record::{Dataset, Record};
use hysid_core::data::turning_points::turning_points;

/// Share of the way of a half cycle that is behind a turning point.
pub(super) const AFTER_A_TURN: f64 = 0.25;

/// Rows of a stretch, where long data are tested in stretches.
const STRETCH: usize = 20_000;

#[derive(Debug, Clone)]
pub(super) struct ResidualRow {
    /// Measured less simulated output.
    pub residual: f64,
    /// Rate of the first input: by time, or by row where there is no time.
    pub rate: f64,
    /// True in the first part of a half cycle that begins at a turning point; `None` before the first turning point.
    pub after_a_turn: Option<bool>,
    /// Half the range of the half cycle.
    pub amplitude: f64,
    /// Distance of the first input from its mean.
    pub distance: f64,
    /// True where the first input rises to the next turning point.
    pub rises: bool,
    /// 0, 1 or 2: first, second or last third of the record.
    pub third: usize,
}

/// The scored rows of records.
#[derive(Debug, Clone)]
pub(super) struct ResidualRows {
    pub records: Vec<Vec<ResidualRow>>,
    /// Of each record, the inputs at the scored rows.
    pub inputs: Vec<Vec<Vec<f64>>>,
    /// Mean magnitude of the rate of each half cycle with a scored row.
    pub speeds: Vec<f64>,
}

impl ResidualRows {
    pub fn of(data: &Dataset, simulated: &[Vec<f64>], smallest_reversal: f64) -> Self {
        let (low, high) = data.input_range(0);
        let smallest = smallest_reversal * (high - low);
        let mut count = 0usize;
        let mut sum = 0.0;
        for record in data.records() {
            count += record.len();
            sum += record.inputs()[0].iter().sum::<f64>();
        }
        let mean = sum / count.max(1) as f64;
        let (mut records, mut inputs, mut speeds) = (Vec::new(), Vec::new(), Vec::new());
        for (record, simulated) in data.records().iter().zip(simulated) {
            if record.scored() == 0 {
                continue;
            }
            let scored: Vec<usize> =
                (0..record.len()).filter(|&row| !record.output()[row].is_nan()).collect();
            records.push(rows(record, simulated, &scored, smallest, mean, &mut speeds));
            let at_scored = |input: &[f64]| scored.iter().map(|&row| input[row]).collect();
            inputs.push(record.inputs().iter().map(|input| at_scored(input)).collect());
        }
        Self { records, inputs, speeds }
    }

    pub fn len(&self) -> usize {
        self.records.iter().map(Vec::len).sum()
    }

    /// At most so many rows, roughly: evenly spaced stretches, each of which counts as a record.
    pub fn stretches(self, most: usize) -> Self {
        let all = self.len();
        if all <= most {
            return self;
        }
        let share = most as f64 / all as f64;
        let (mut records, mut inputs) = (Vec::new(), Vec::new());
        for (rows, columns) in self.records.iter().zip(&self.inputs) {
            let kept = ((share * rows.len() as f64) as usize).max(1);
            let count = kept.div_ceil(STRETCH).max(2);
            let length = (kept / count).max(1);
            for stretch in 0..count {
                let first = (rows.len() - length) * stretch / (count - 1);
                records.push(rows[first..first + length].to_vec());
                inputs.push(columns.iter().map(|column| column[first..first + length].to_vec()).collect());
            }
        }
        Self { records, inputs, speeds: self.speeds }
    }

    pub fn residual(&self) -> Vec<Vec<f64>> {
        self.records.iter().map(|rows| rows.iter().map(|row| row.residual).collect()).collect()
    }
}

/// The scored rows of a record; adds the mean speeds of its half cycles.
fn rows(
    record: &Record,
    simulated: &[f64],
    scored: &[usize],
    smallest: f64,
    mean: f64,
    speeds: &mut Vec<f64>,
) -> Vec<ResidualRow> {
    let (x, rate) = (&record.inputs()[0], rates(record));
    let turns = turning_points(x, smallest);
    let ends: Vec<usize> =
        std::iter::once(0).chain(turns.iter().copied()).chain([record.len() - 1]).collect();
    let mut found = Vec::with_capacity(scored.len());
    let mut at = scored.iter().copied().peekable();
    for (half_cycle, pair) in ends.windows(2).enumerate() {
        let (first, last) = (pair[0], pair[1]);
        let way = x[last] - x[first];
        let is_last = half_cycle + 2 == ends.len();
        let before = found.len();
        let mut speed = 0.0;
        while let Some(row) = at.next_if(|&row| row < last || is_last) {
            speed += rate[row].abs();
            let share = if way == 0.0 { 0.0 } else { (x[row] - x[first]) / way };
            found.push(ResidualRow {
                residual: record.output()[row] - simulated[row],
                rate: rate[row],
                after_a_turn: (half_cycle > 0).then_some(share <= AFTER_A_TURN),
                amplitude: 0.5 * way.abs(),
                distance: (x[row] - mean).abs(),
                rises: way > 0.0,
                third: (3 * row / record.len()).min(2),
            });
        }
        if found.len() > before {
            speeds.push(speed / (found.len() - before) as f64);
        }
    }
    found
}

/// The rate of the first input: as given, by central differences over time, or by row where there is no time.
fn rates(record: &Record) -> Vec<f64> {
    let x = &record.inputs()[0];
    let method = if record.given_rate().is_some() { RateMethod::Given } else { RateMethod::Central };
    if let Ok(rate) = method.rate(record) {
        return rate;
    }
    let last = x.len() - 1;
    let difference = |row: usize| {
        let (before, after) = (row.saturating_sub(1), (row + 1).min(last));
        if after > before { (x[after] - x[before]) / (after - before) as f64 } else { 0.0 }
    };
    (0..x.len()).map(difference).collect()
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;

    #[test]
    fn rows_know_their_place() {
        let x = [0.0, 1.0, 2.0, 1.8, 1.0, 0.0, 0.2, 1.0, 2.0];
        let mut y = x.to_vec();
        y[1] = f64::NAN;
        let data = Dataset::from_slices(&x, &y).unwrap();
        let rows = ResidualRows::of(&data, &[vec![0.5; 9]], 0.02);
        let rows = &rows.records[0];
        assert_eq!(rows.len(), 8);
        let after: Vec<Option<bool>> = rows.iter().map(|row| row.after_a_turn).collect();
        let (yes, no) = (Some(true), Some(false));
        assert_eq!(after, [None, yes, yes, no, yes, yes, no, no]);
        assert_eq!(
            rows.iter().map(|row| row.rises).collect::<Vec<_>>(),
            [true, false, false, false, true, true, true, true]
        );
        assert_eq!(rows[1].residual, 1.5);
        assert_eq!((rows[2].amplitude, rows[0].third, rows[7].third), (1.0, 0, 2));
        approx::assert_relative_eq!(rows[2].rate, -0.5);
    }

    #[test]
    fn long_data_are_cut_into_stretches_from_beginning_to_end() {
        let x: Vec<f64> = (0..90_000).map(|k| sin(0.01 * f64::from(k))).collect();
        let y: Vec<f64> = (0..90_000).map(f64::from).collect();
        let data = Dataset::from_slices(&x, &y).unwrap();
        let rows = ResidualRows::of(&data, &[vec![0.0; 90_000]], 0.02).stretches(30_000);
        assert_eq!(rows.len(), 30_000);
        assert_eq!(rows.records[0][0].residual, 0.0);
        assert_eq!(rows.records.last().unwrap().last().unwrap().residual, 89_999.0);
        assert!(
            rows.records
                .iter()
                .all(|record| record.windows(2).all(|pair| pair[1].residual - pair[0].residual == 1.0))
        );
    }
}
