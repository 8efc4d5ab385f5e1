//! Additions of an instrument to loops, and their removal: a straight background, a drift over the record, an offset.

use std::fmt;
use std::str::FromStr;

use hysid_core::data::record::{Dataset, Record};
use hysid_core::data::unit;
use hysid_core::elementary::square;
use hysid_core::error::Result;
use hysid_core::significant::Significant;

use super::CLOSED;
use super::path::range;

/// Part to be removed from the outputs of each record before its loops are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Correction {
    /// The slope that both branches have beyond 70 % of the largest input: the diamagnetism of a holder, a leakage.
    Slope,
    /// Change of the output from the beginning of the record to its end, evenly over time or rows.
    Drift,
    /// The middle of the outputs at both ends of the input.
    Offset,
}

/// Inputs beyond this share of half the swing show the slope of the background.
const OUTER: f64 = 0.7;

/// Inputs within this share of the swing from an end show the output there.
const AT_THE_END: f64 = 0.02;

/// Fewest rows of which a line is fitted.
const FEWEST: usize = 3;

impl Correction {
    /// Those that are chosen by name; the offset is removed by an option of its own.
    pub const NAMED: [Self; 2] = [Self::Slope, Self::Drift];

    /// The name, such as `slope`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slope => "slope",
            Self::Drift => "drift",
            Self::Offset => "offset",
        }
    }
}

impl fmt::Display for Correction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Correction {
    type Err = hysid_core::Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::NAMED.into_iter().find(|correction| correction.name() == name).ok_or_else(|| {
            let known = Self::NAMED.map(Self::name).to_vec();
            hysid_core::Error::UnknownName { what: "correction", name: name.into(), known }
        })
    }
}

/// The data after corrections, in their order, and what was removed, in words.
///
/// # Errors
/// None for valid data.
pub fn corrected(data: &Dataset, corrections: &[Correction]) -> Result<(Dataset, Vec<String>)> {
    let mut notes = Vec::new();
    let mut records = data.records().to_vec();
    let unit = unit::suffix(data.names().inputs.first().and_then(|name| unit::of_column(name)).as_deref());
    let several = records.len() > 1;
    for record in &mut records {
        let of = if several { format!(" of record {}", record.name()) } else { String::new() };
        for &correction in corrections {
            let Some((removed, words)) = removed(record, correction, &unit) else {
                notes.push(format!("no {correction} is removed{of}: {}", correction.why_not()));
                continue;
            };
            let output = record.output().iter().zip(removed).map(|(y, removed)| y - removed).collect();
            *record = record.clone().with_output(output)?;
            notes.push(format!("{correction} removed{of}: {words}"));
        }
    }
    Ok((Dataset::new(data.names().clone(), records)?, notes))
}

impl Correction {
    fn why_not(self) -> &'static str {
        match self {
            Self::Slope => "the input has too few rows near both ends",
            Self::Drift => "the input does not come back to where the record begins",
            Self::Offset => "the output is missing at an end of the input",
        }
    }
}

/// Amount that a correction subtracts from each row, and its size in words.
fn removed(record: &Record, correction: Correction, input_unit: &str) -> Option<(Vec<f64>, String)> {
    let (x, y) = (&*record.inputs()[0], record.output());
    let (low, high) = range(x);
    let (middle, swing) = (0.5 * (low + high), high - low);
    let measured = || (0..x.len()).filter(|&row| !y[row].is_nan());
    match correction {
        Correction::Slope => {
            let side = |sign: f64| -> Vec<usize> {
                measured().filter(|&row| sign * (x[row] - middle) >= 0.5 * OUTER * swing).collect()
            };
            let (mut covariance, mut variance) = (0.0, 0.0);
            for rows in [side(-1.0), side(1.0)] {
                if rows.len() < FEWEST {
                    return None;
                }
                let mean =
                    |values: &[f64]| rows.iter().map(|&row| values[row]).sum::<f64>() / rows.len() as f64;
                let (mean_x, mean_y) = (mean(x), mean(y));
                for &row in &rows {
                    covariance += (x[row] - mean_x) * (y[row] - mean_y);
                    variance += square(x[row] - mean_x);
                }
            }
            let slope = covariance / variance;
            let words = format!("{:.4} per unit of the input, from its outer 30 %", Significant(slope));
            slope.is_finite().then(|| (x.iter().map(|x| slope * x).collect(), words))
        }
        Correction::Drift => {
            let last = x.len() - 1;
            if (x[last] - x[0]).abs() > CLOSED * swing {
                return None;
            }
            let gap = gap(x, y)?;
            let share = |row: usize| match record.time() {
                Some(time) => (time[row] - time[0]) / (time[last] - time[0]),
                None => row as f64 / last as f64,
            };
            let words = format!("{:.4} from the beginning to the end", Significant(gap));
            Some(((0..x.len()).map(|row| gap * share(row)).collect(), words))
        }
        Correction::Offset => {
            let mean = |end: f64| {
                let rows: Vec<usize> =
                    measured().filter(|&row| (x[row] - end).abs() <= AT_THE_END * swing).collect();
                let sum: f64 = rows.iter().map(|&row| y[row]).sum();
                (!rows.is_empty()).then(|| sum / rows.len() as f64)
            };
            let offset = 0.5 * (mean(low)? + mean(high)?);
            let words = format!(
                "{:.4}, the middle of the outputs at {:.3} and {:.3}{input_unit}",
                Significant(offset),
                Significant(low),
                Significant(high)
            );
            Some((vec![offset; x.len()], words))
        }
    }
}

/// Change of the output from the beginning to the end of a part of a record whose input comes back, from lines through
/// the rows near both.
pub(super) fn gap(x: &[f64], y: &[f64]) -> Option<f64> {
    let (low, high) = range(x);
    let last = x.len().checked_sub(1)?;
    let near = |rows: &mut dyn Iterator<Item = usize>, end: f64| -> Vec<usize> {
        let close = rows.take_while(|&row| (x[row] - end).abs() <= AT_THE_END * (high - low));
        close.filter(|&row| !y[row].is_nan()).collect()
    };
    let (first, end) = (near(&mut (0..=last), x[0]), near(&mut (0..=last).rev(), x[last]));
    Some(line_at(x, y, &end, x[0])? - line_at(x, y, &first, x[0])?)
}

/// The output at an input, of the line through some rows; their mean if there are few.
fn line_at(x: &[f64], y: &[f64], rows: &[usize], at: f64) -> Option<f64> {
    if rows.is_empty() {
        return None;
    }
    let mean = |values: &[f64]| rows.iter().map(|&row| values[row]).sum::<f64>() / rows.len() as f64;
    let (mean_x, mean_y) = (mean(x), mean(y));
    let (covariance, variance) = rows.iter().fold((0.0, 0.0), |(covariance, variance), &row| {
        let away = x[row] - mean_x;
        (covariance + away * (y[row] - mean_y), variance + away * away)
    });
    let slope = if rows.len() >= FEWEST && variance > 0.0 { covariance / variance } else { 0.0 };
    Some(mean_y + slope * (at - mean_x))
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use hysid_core::elementary::tanh;

    use super::*;

    /// `tanh((x ± 1)/0.5)` from 10 to -10 and back, with a background and a drift.
    fn loop_of(slope: f64, drift: f64, offset: f64) -> Dataset {
        let x: Vec<f64> =
            (0..=800).map(|k| 10.0 - 20.0 * (1.0 - (f64::from(k) / 400.0 - 1.0).abs())).collect();
        let y = x.iter().enumerate().map(|(row, x)| {
            let shift = if row <= 400 { 1.0 } else { -1.0 };
            tanh((x + shift) / 0.5) + slope * x + drift * row as f64 / 800.0 + offset
        });
        Dataset::from_slices(&x, &y.collect::<Vec<f64>>()).unwrap()
    }

    #[test]
    fn a_slope_a_drift_and_an_offset_are_removed_as_they_were_added() {
        let clean = loop_of(0.0, 0.0, 0.0);
        for (correction, data) in [
            (Correction::Slope, loop_of(-0.3, 0.0, 0.0)),
            (Correction::Drift, loop_of(0.0, 0.4, 0.0)),
            (Correction::Offset, loop_of(0.0, 0.0, 2.5)),
        ] {
            let (found, notes) = corrected(&data, &[correction]).unwrap();
            assert_eq!(notes.len(), 1);
            for (found, clean) in found.records()[0].output().iter().zip(clean.records()[0].output()) {
                assert_relative_eq!(found, clean, epsilon = 1e-6);
            }
        }
    }

    #[test]
    fn a_record_that_does_not_come_back_keeps_its_output() {
        let x: Vec<f64> = (0..100).map(f64::from).collect();
        let data = Dataset::from_slices(&x, &x).unwrap();
        let (same, notes) = corrected(&data, &[Correction::Drift]).unwrap();
        assert_eq!(same, data);
        assert!(notes[0].starts_with("no drift is removed"), "{notes:?}");
    }
}
