//! Selection of the rows of long records for a search.

use crate::data::polyline::{PolylineColumn, polyline, steps_between};
use crate::data::record::Thinning;
use crate::law::Sample;
use crate::law::series::Series;

/// Maximum number of scored rows.
const MOST_COMPARED: usize = 5000;

/// Most rows of a search; of longer data the first parts of the records, unless they have few scored rows.
const MOST_RUN: usize = 200_000;

/// With more rows than this, rows on straight parts of the path are left out.
const LONG: usize = 20_000;

/// Tolerance of the polyline and longest step, as shares of the largest magnitude. A law depends on the step.
const STEPS_OF_INPUT: [f64; 2] = [1e-3, 1e-2];
/// The same for the rate.
const STEPS_OF_RATE: [f64; 2] = [1e-2, 5e-2];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MemoryKind {
    /// Only the turning points of the input: rows between them may be left out.
    TurningPoints,
    /// The path of the input and its rate: rows on a straight part of it may be left out.
    Path,
    /// Every row.
    EveryRow,
}

/// The records with at most 5000 scored rows and without rows that the memory does not need, so that the cost of a search
/// is bounded. [`MemoryKind::TurningPoints`] keeps every turning point, so the memory is unchanged; [`MemoryKind::Path`] keeps
/// the path within a tolerance.
pub(crate) fn thinned(series: Vec<Series>, memory: MemoryKind) -> Vec<Series> {
    thinned_to(series, memory, MOST_COMPARED)
}

/// As [`thinned`], with at most `most` rows that are compared.
pub(crate) fn thinned_to(series: Vec<Series>, memory: MemoryKind, most: usize) -> Vec<Series> {
    let whole = condensed(&series, memory, most);
    let rows = rows(&whole);
    if rows <= MOST_RUN {
        return whole;
    }
    let share = MOST_RUN as f64 / rows as f64;
    let mut begun: Vec<Series> = series.iter().map(|series| beginning(series, share)).collect();
    begun.retain(|series| series.output.iter().any(|y| !y.is_nan()));
    if scored(&begun) < scored(&series) / 20 { whole } else { condensed(&begun, memory, most) }
}

fn rows(series: &[Series]) -> usize {
    series.iter().map(|series| series.samples.len()).sum()
}

fn scored(series: &[Series]) -> usize {
    series.iter().map(|series| series.output.iter().filter(|y| !y.is_nan()).count()).sum()
}

/// At most `most` scored rows, and of the others those that the memory depends on.
fn condensed(series: &[Series], memory: MemoryKind, most: usize) -> Vec<Series> {
    let mut outputs: Vec<Vec<f64>> = series.iter().map(|series| series.output.clone()).collect();
    Thinning::new(scored(series), most).blank(outputs.iter_mut().flatten());
    let is_long = rows(series) > LONG;
    let kept = |samples: &[Sample], output: &[f64]| match memory {
        MemoryKind::TurningPoints => turning_rows(samples, output),
        MemoryKind::Path if is_long => rows_of_path(samples, output),
        MemoryKind::Path | MemoryKind::EveryRow => (0..samples.len()).collect(),
    };
    let condensed =
        |(series, output): (&Series, &Vec<f64>)| through(series, output, &kept(&series.samples, output));
    series.iter().zip(&outputs).map(condensed).collect()
}

/// Scored rows, turning points, and the first and last row.
fn turning_rows(samples: &[Sample], output: &[f64]) -> Vec<usize> {
    let x = |row: usize| samples[row].x;
    let last = samples.len() - 1;
    let stays = |&row: &usize| {
        row == 0
            || row == last
            || !output[row].is_nan()
            || (x(row) - x(row - 1)) * (x(row + 1) - x(row)) <= 0.0
    };
    (0..=last).filter(stays).collect()
}

/// Scored rows, and the rows of a polyline in short steps along the input and its rate.
fn rows_of_path(samples: &[Sample], output: &[f64]) -> Vec<usize> {
    let values = |of: fn(&Sample) -> f64| -> Vec<f64> { samples.iter().map(of).collect() };
    let (x, rate) = (values(|sample| sample.x), values(|sample| sample.rate));
    let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let column = |values, [tolerance, longest]: [f64; 2]| {
        let largest = largest(values);
        PolylineColumn { values, tolerance: tolerance * largest, longest: longest * largest }
    };
    let has_time = samples.iter().any(|sample| sample.step > 0.0);
    let step = |row: usize| if has_time { samples[row].step } else { 1.0 };
    let columns = [column(&x, STEPS_OF_INPUT), column(&rate, STEPS_OF_RATE)];
    polyline(&columns, step, |row| !output[row].is_nan())
}

/// The series of these rows only, each with the time since the previous one.
fn through(Series { samples, weights, further, .. }: &Series, output: &[f64], rows: &[usize]) -> Series {
    let steps = steps_between(rows, |row| samples[row].step);
    let sample = |(&row, step): (&usize, f64)| Sample { step, ..samples[row] };
    Series {
        samples: rows.iter().zip(steps).map(sample).collect(),
        output: rows.iter().map(|&row| output[row]).collect(),
        weights: rows.iter().filter_map(|&row| weights.get(row).copied()).collect(),
        further: further.iter().map(|column| rows.iter().map(|&row| column[row]).collect()).collect(),
    }
}

fn beginning(series: &Series, share: f64) -> Series {
    let rows = (share * series.samples.len() as f64).ceil() as usize;
    Series {
        samples: series.samples[..rows].to_vec(),
        output: series.output[..rows].to_vec(),
        weights: series.weights.iter().take(rows).copied().collect(),
        further: series.further.iter().map(|column| column[..rows].to_vec()).collect(),
    }
}

pub(crate) fn measured(series: &[Series]) -> Vec<f64> {
    series.iter().flat_map(|series| series.output.iter().copied().filter(|y| !y.is_nan())).collect()
}

/// Square roots of the weights of the rows that [`measured`] gives; empty if all count alike.
pub(super) fn roots_of_weights(series: &[Series]) -> Vec<f64> {
    let of_one = |series: &Series| -> Vec<f64> {
        let scored = series.weights.iter().zip(&series.output).filter(|(_, y)| !y.is_nan());
        scored.map(|(weight, _)| weight.sqrt()).collect()
    };
    series.iter().flat_map(of_one).collect()
}

/// Mean and standard deviation.
pub(crate) fn spread(values: &[f64]) -> (f64, f64) {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / n;
    (mean, square.sqrt())
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{cos, sin};

    use super::*;

    fn zigzag(rows: usize) -> Series {
        let x = |row: usize| ((row % 100) as f64 - 50.0).abs();
        let samples = (0..rows).map(|row| Sample { x: x(row), rate: 0.0, step: 1.0 }).collect();
        let output = (0..rows).map(|row| row as f64).collect();
        Series { samples, output, weights: Vec::new(), further: Vec::new() }
    }

    #[test]
    fn short_records_stay_as_they_are() {
        assert_eq!(thinned(vec![zigzag(4000)], MemoryKind::Path), [zigzag(4000)]);
    }

    #[test]
    fn long_records_keep_their_turning_points_and_their_time() {
        let found = &thinned(vec![zigzag(100_000)], MemoryKind::TurningPoints)[0];
        assert_eq!(found.output.iter().filter(|y| !y.is_nan()).count(), MOST_COMPARED);
        assert!(found.samples.len() <= MOST_COMPARED + 2001);
        let turns = found.samples.iter().filter(|sample| sample.x == 50.0 || sample.x == 0.0).count();
        assert_eq!(turns, 2000);
        let elapsed: f64 = found.samples.iter().map(|sample| sample.step).sum();
        assert_eq!(elapsed, 100_000.0);
        assert_eq!(thinned(vec![zigzag(1_000_000)], MemoryKind::Path)[0].samples.len(), MOST_RUN);
    }

    /// Long paths keep time and short steps, and their beginning alone has as many compared rows.
    #[test]
    fn long_paths_keep_their_shape_and_their_time() {
        let signal = |row: usize| sin(0.002 * row as f64);
        let series = |rows: usize, step: f64| {
            let sample = |row| Sample { x: signal(row), rate: 0.002 / step * cos(0.002 * row as f64), step };
            Series {
                samples: (0..rows).map(sample).collect(),
                output: (0..rows).map(signal).collect(),
                weights: Vec::new(),
                further: Vec::new(),
            }
        };
        let found = &thinned(vec![series(100_000, 0.5)], MemoryKind::Path)[0];
        assert!(found.samples.len() < 30_000, "{}", found.samples.len());
        assert_eq!(found.output.iter().filter(|y| !y.is_nan()).count(), MOST_COMPARED);
        assert!(found.samples.windows(2).all(|pair| (pair[1].x - pair[0].x).abs() <= 0.0101));
        let elapsed: f64 = found.samples.iter().map(|sample| sample.step).sum();
        assert!((elapsed - 50_000.0).abs() < 1e-6);
        let rough = Series {
            weights: Vec::new(),
            further: Vec::new(),
            samples: (0..600_000).map(|row| Sample { x: (row % 2) as f64, rate: 0.0, step: 1.0 }).collect(),
            output: (0..600_000).map(|row| row as f64).collect(),
        };
        let found = &thinned(vec![rough], MemoryKind::Path)[0];
        assert_eq!(found.samples.len(), MOST_RUN);
        assert_eq!(found.output.iter().filter(|y| !y.is_nan()).count(), MOST_COMPARED);
    }
}
