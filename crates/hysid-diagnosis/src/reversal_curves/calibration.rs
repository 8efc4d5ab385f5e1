//! Calibration points of first-order reversal curves: single measurements in one large field, before each curve, that show
//! the drift of the instrument. They are no part of the curves.

use hysid_core::data::record::{Dataset, Record};
use hysid_core::elementary::square;
use hysid_core::significant::Significant;

use crate::significance::median;

/// Fewest calibration points.
const FEWEST: usize = 5;

/// A calibration point is further from the rows beside it and from all rows of curves than so many median steps of the input.
const APART: f64 = 5.0;

/// Calibration points are within this share of the input's range.
const SAME: f64 = 0.002;

/// Variance of the calibration points over half the mean square of their successive differences from which they drift: 1
/// for noise alone.
const DRIFTS: f64 = 2.0;

/// Share of the mean of the calibration points that is rounding.
const ROUNDING: f64 = 1e-12;

/// A measurement in the calibration field.
struct CalibrationPoint {
    record: usize,
    row: usize,
    output: f64,
}

/// The data without calibration points and with the drift that they show removed from the output, each curve a record of its
/// own, and a note that says so; `None` if there are none.
pub(crate) fn without_calibration_points(data: &Dataset) -> Option<(Dataset, String)> {
    let inputs = |record: &Record| record.inputs()[0].to_vec();
    let steps = data.records().iter().flat_map(|record| {
        let x = inputs(record);
        x.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect::<Vec<f64>>()
    });
    let far = APART * median(&mut steps.collect::<Vec<f64>>());
    let mut isolated: Vec<CalibrationPoint> = Vec::new();
    let mut curves: Vec<f64> = Vec::new();
    for (number, record) in data.records().iter().enumerate() {
        let x = inputs(record);
        let is_far = |a: usize, b: Option<&f64>| b.is_none_or(|b| (x[a] - b).abs() > far);
        for row in 0..x.len() {
            let before = row.checked_sub(1).and_then(|before| x.get(before));
            match is_far(row, before) && is_far(row, x.get(row + 1)) {
                true => isolated.push(CalibrationPoint { record: number, row, output: record.output()[row] }),
                false => curves.push(x[row]),
            }
        }
    }
    let field = |point: &CalibrationPoint| data.records()[point.record].inputs()[0][point.row];
    let (low, high) = data.input_range(0);
    let centre = median(&mut isolated.iter().map(field).collect::<Vec<f64>>());
    let is_apart = curves.iter().all(|x| (x - centre).abs() > far);
    let is_one_field = isolated.iter().all(|point| (field(point) - centre).abs() <= SAME * (high - low));
    let is_measured = isolated.iter().all(|point| !point.output.is_nan());
    if isolated.len() < FEWEST || !(is_apart && is_one_field && is_measured && far > 0.0) {
        return None;
    }
    let drift = Drift::of(data, &isolated);
    let mut records = Vec::new();
    for (number, record) in data.records().iter().enumerate() {
        let cuts = isolated.iter().filter(|point| point.record == number).map(|point| point.row);
        let mut from = 0;
        for to in cuts.chain([record.len()]).collect::<Vec<usize>>() {
            if to > from {
                let name = format!("{} {}", record.name(), records.len() + 1);
                records.push(part(record, name, from..to, |row| drift.at(number, row))?);
            }
            from = to + 1;
        }
    }
    Some((data.of_records(records), note(&isolated, centre, &drift)))
}

fn note(points: &[CalibrationPoint], field: f64, drift: &Drift) -> String {
    let words = match drift.range {
        0.0 => "show no drift".to_string(),
        range => format!("drift by {:.2}, which is removed from the output", Significant(range)),
    };
    format!(
        "{} calibration points at {:.4} are no part of the curves; they {words}",
        points.len(),
        Significant(field)
    )
}

/// Rows of a record with a correction subtracted from their outputs.
fn part(
    record: &Record,
    name: String,
    rows: std::ops::Range<usize>,
    correction: impl Fn(usize) -> f64,
) -> Option<Record> {
    let inputs = record.inputs().iter().map(|x| x[rows.clone()].to_vec()).collect();
    let output = rows.clone().map(|row| record.output()[row] - correction(row)).collect();
    let part = Record::new(name, inputs, output).ok()?;
    match record.time() {
        Some(time) => part.with_time(time[rows].to_vec()).ok(),
        None => Some(part),
    }
}

/// Deviation of the calibration points from their mean, straight between them, over the rows of all records.
struct Drift {
    /// Rows before each record.
    before: Vec<usize>,
    /// Row and deviation.
    points: Vec<(f64, f64)>,
    /// Largest less smallest deviation; 0 if they do not drift.
    range: f64,
}

impl Drift {
    fn of(data: &Dataset, found: &[CalibrationPoint]) -> Self {
        let before: Vec<usize> = data
            .records()
            .iter()
            .scan(0, |rows, record| {
                *rows += record.len();
                Some(*rows - record.len())
            })
            .collect();
        let count = found.len() as f64;
        let mean = found.iter().map(|point| point.output).sum::<f64>() / count;
        let place = |point: &CalibrationPoint| (before[point.record] + point.row) as f64;
        let points: Vec<(f64, f64)> = found.iter().map(|point| (place(point), point.output - mean)).collect();
        let scatter =
            points.windows(2).map(|pair| square(pair[1].1 - pair[0].1)).sum::<f64>() / (2.0 * (count - 1.0));
        let variance = points.iter().map(|point| square(point.1)).sum::<f64>() / (count - 1.0);
        let is_rounding = variance.sqrt() <= ROUNDING * mean.abs();
        let drifts = variance > DRIFTS * scatter && !is_rounding;
        let most = |sign: f64| points.iter().map(|point| sign * point.1).fold(0.0, f64::max);
        let range = if drifts { most(1.0) + most(-1.0) } else { 0.0 };
        Self { before, points, range }
    }

    fn at(&self, record: usize, row: usize) -> f64 {
        if self.range == 0.0 {
            return 0.0;
        }
        let place = (self.before[record] + row) as f64;
        let after = self.points.partition_point(|point| point.0 < place).clamp(1, self.points.len() - 1);
        let (a, b) = (self.points[after - 1], self.points[after]);
        // Beyond the first and the last calibration point the drift is theirs.
        a.1 + (b.1 - a.1) * ((place - a.0) / (b.0 - a.0)).clamp(0.0, 1.0)
    }
}
