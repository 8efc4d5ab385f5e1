//! Limits of a machine: range, start, sampling step, largest rate and length of a drive.

use serde::Serialize;

use crate::data::record::{Dataset, Record};
use crate::error::{Error, LARGEST_VALUE, OptionError, Result};
use crate::significant::Significant;

/// Fewest rows of a drive.
pub const FEWEST_ROWS: usize = 40;

/// Smallest step and rate: smaller ones make ratios that numbers cannot have.
const SMALLEST_VALUE: f64 = 1e-100;

/// Most rows of a drive.
pub const MOST_ROWS: usize = 1_000_000;

/// Rows on both sides of a row from which its rate follows: noise of the input is no rate.
const HALF_WINDOW: usize = 2;

/// Quantile of the rates of the data that is their largest rate: a few steps of the input are no limit of a machine.
const LARGEST: f64 = 0.99;

/// Fewest rows of a swing over the whole range at the largest rate.
const FEWEST_ROWS_OF_A_SWING: f64 = 8.0;

/// Limits of a drive, in the units of the data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limits {
    /// Lowest and highest input.
    pub range: (f64, f64),
    /// Input at the beginning and at the end.
    pub start: f64,
    /// Time between rows; `None` for data without time.
    pub step: Option<f64>,
    /// Largest change of the input in a unit of time, or from row to row without time.
    pub max_rate: f64,
    /// Most rows.
    pub rows: usize,
}

/// Limits chosen by the user; `None` takes that of the data.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LimitOptions {
    /// Lowest and highest input.
    pub range: Option<(f64, f64)>,
    /// Time between rows.
    pub step: Option<f64>,
    /// Largest change of the input in a unit of time, or from row to row.
    pub max_rate: Option<f64>,
    /// Most rows.
    pub length: Option<usize>,
}

impl Limits {
    /// The limits of the data, where `wanted` gives no others.
    ///
    /// # Errors
    /// Data from which nothing can be identified, limits that cannot be used.
    pub fn of(data: &Dataset, wanted: &LimitOptions) -> Result<Self> {
        data.check_identifiable(crate::data::FEWEST_ROWS)?;
        let range = wanted.range.unwrap_or_else(|| data.input_range(0));
        let fastest = data.records().iter().map(|record| (largest_rate(record), record));
        let (rate, record) =
            fastest.fold((0.0, &data.records()[0]), |best, one| if one.0 > best.0 { one } else { best });
        let step = match (wanted.step, record.time()) {
            (Some(_), None) => {
                return Err(OptionError::value("step", "given", "data with time stamps are needed").into());
            }
            (step, time) => step.or_else(|| time.and_then(median_step)),
        };
        let start = data.records()[0].inputs()[0][0];
        Self {
            range,
            start: start.clamp(range.0, range.1),
            step,
            max_rate: wanted.max_rate.unwrap_or(rate),
            rows: wanted.length.unwrap_or_else(|| data.rows().clamp(FEWEST_ROWS, MOST_ROWS)),
        }
        .checked()
    }

    /// The same limits if a drive can be made within them.
    ///
    /// # Errors
    /// Limits that cannot be used.
    pub fn checked(self) -> Result<Self> {
        let (low, high) = self.range;
        let is_range = low < high && low.abs().max(high.abs()) <= LARGEST_VALUE;
        // The rows of a swing must differ.
        if !is_range || high - low <= 1e-9 * low.abs().max(high.abs()) {
            let needed = format!(
                "two different numbers of at most {LARGEST_VALUE:e} in size are needed, the lower one first"
            );
            let given = format!("{:.9}:{:.9}", Significant(low), Significant(high));
            return Err(OptionError::value("range", given, needed).into());
        }
        let is_usual = |value: f64| (SMALLEST_VALUE..=LARGEST_VALUE).contains(&value);
        for (name, value) in [("step", self.step.unwrap_or(1.0)), ("max_rate", self.max_rate)] {
            if !is_usual(value) {
                let needed = format!("a number from {SMALLEST_VALUE:e} to {LARGEST_VALUE:e} is needed");
                return Err(OptionError::value(name, Significant(value), needed).into());
            }
        }
        if !(FEWEST_ROWS..=MOST_ROWS).contains(&self.rows) {
            let needed = format!("a whole number from {FEWEST_ROWS} to {MOST_ROWS} is needed");
            return Err(OptionError::value("length", self.rows, needed).into());
        }
        let most = self.width() / FEWEST_ROWS_OF_A_SWING;
        let limited = Self { max_rate: self.max_rate.min(most / self.time_step()), ..self };
        let swing = limited.width() / (limited.max_rate * limited.time_step());
        if swing > limited.rows as f64 / 4.0 {
            return Err(Error::Parts(format!(
                "at the largest rate a swing over the range takes {:.0} rows: {} rows are too few (allow more rows, \
                 a larger rate or a longer step)",
                swing.ceil().min(1e15),
                limited.rows
            )));
        }
        Ok(limited)
    }

    /// Width of the range.
    pub fn width(&self) -> f64 {
        self.range.1 - self.range.0
    }

    /// Time between rows; 1 without time.
    pub fn time_step(&self) -> f64 {
        self.step.unwrap_or(1.0)
    }
}

/// The largest rate of the first input, without what noise and a few jumps make; 0 for a record of few rows.
fn largest_rate(record: &Record) -> f64 {
    let x = &record.inputs()[0];
    let at = |row: usize| record.time().map_or(row as f64, |time| time[row]);
    let rate = |row: usize| {
        let (from, to) = (row - HALF_WINDOW, row + HALF_WINDOW);
        ((x[to] - x[from]) / (at(to) - at(from))).abs()
    };
    let rows = HALF_WINDOW..record.len().saturating_sub(HALF_WINDOW);
    let mut rates: Vec<f64> = rows.map(rate).filter(|rate| *rate > 0.0 && rate.is_finite()).collect();
    if rates.is_empty() {
        // Too short for a window.
        let steps = (1..record.len()).map(|row| ((x[row] - x[row - 1]) / (at(row) - at(row - 1))).abs());
        return steps.fold(0.0, f64::max);
    }
    let place = ((rates.len() - 1) as f64 * LARGEST) as usize;
    *rates.select_nth_unstable_by(place, f64::total_cmp).1
}

fn median_step(time: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    (!steps.is_empty()).then(|| *steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;

    fn data(step: f64) -> Dataset {
        let t: Vec<f64> = (0..400).map(|k| step * f64::from(k)).collect();
        let x: Vec<f64> = t.iter().map(|t| 3.0 * sin(0.05 * t / step)).collect();
        Dataset::from_columns(Some(("t", &t)), &[("x", &x)], ("y", &x)).unwrap()
    }

    #[test]
    fn limits_are_those_of_the_data() {
        let limits = Limits::of(&data(0.1), &LimitOptions::default()).unwrap();
        assert_eq!((limits.start, limits.rows), (0.0, 400));
        assert!((limits.step.unwrap() - 0.1).abs() < 1e-12);
        // The rate of 3 sin(0.5 t) is at most 1.5.
        assert!(limits.max_rate < 1.5 && limits.max_rate > 1.49, "{}", limits.max_rate);
    }

    #[test]
    fn a_jump_of_the_input_is_no_rate_of_the_machine() {
        let mut x: Vec<f64> = (0..1000).map(|k| sin(0.02 * f64::from(k))).collect();
        x.iter_mut().skip(500).for_each(|x| *x += 1.0);
        let data = Dataset::from_slices(&x, &x).unwrap();
        assert!(Limits::of(&data, &LimitOptions::default()).unwrap().max_rate < 0.0201);
    }

    #[test]
    fn limits_that_leave_no_drive_are_refused() {
        let refused = |wanted: LimitOptions| Limits::of(&data(0.1), &wanted).unwrap_err().to_string();
        let base = LimitOptions::default();
        assert!(refused(LimitOptions { range: Some((1.0, 1.0)), ..base }).contains("lower one first"));
        assert!(refused(LimitOptions { length: Some(3), ..base }).contains("from 40 to"));
        assert!(refused(LimitOptions { max_rate: Some(-1.0), ..base }).contains("from 1e-100"));
        assert!(refused(LimitOptions { max_rate: Some(1e-3), ..base }).contains("too few"));
        assert!(refused(LimitOptions { step: Some(f64::NAN), ..base }).contains("from 1e-100"));
        assert_eq!(
            refused(LimitOptions { step: Some(1e-300), ..base }),
            "step 1e-300: a number from 1e-100 to 1e100 is needed"
        );
    }
}
