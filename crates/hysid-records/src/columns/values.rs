//! Roles of columns from their values: time grows, a counter counts, a condition keeps few values for long.

use std::ops::Range;

use hysid_core::data::column::Course;
use hysid_core::data::unit;
use hysid_tables::{CellReader, ColumnReader, Table, starts_again};

/// Share of the range within which a value counts as kept.
const KEPT: f64 = 0.02;

/// Rows for which a condition keeps a value.
const LEAST_KEPT: usize = 20;

/// Most times that a condition takes another value in one record.
const MOST_LEVELS: usize = 12;

/// Share of the rows that a condition keeps its values for; the others are on the way from one to the next.
const LEAST_SHARE: f64 = 0.9;

/// Largest range of what is held constant, as a share of its value.
const HELD: f64 = 0.03;

/// Range of the middle half of the values of what is held, as a share of the largest.
const STEADY: f64 = 0.1;

/// Longest step of a time that runs through where another starts again, in the longest of its other steps.
const MOST_STEP: f64 = 1.5;

/// Share of a record's duration within which time starts again where the record began.
const SAME_BEGINNING: f64 = 0.02;

/// Statistics of a column's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ValueStatistics {
    /// How they change from row to row.
    pub course: Course,
    /// Whether they may be time stamps.
    pub running: TimeCheck,
    /// None is smaller than the one before.
    pub never_falls: bool,
    /// All are multiples of one half.
    pub is_whole: bool,
    /// A few values that are kept for many rows, or one for each record.
    pub is_kept: bool,
    /// Nothing but noise around one value.
    pub is_held: bool,
}

impl ValueStatistics {
    /// Of the values of a column, in records.
    pub fn of(values: &[f64], records: &[Range<usize>]) -> Self {
        let parts: Vec<&[f64]> = records.iter().map(|rows| &values[rows.clone()]).collect();
        let steps = || parts.iter().flat_map(|part| part.windows(2).map(|pair| pair[1] - pair[0]));
        let course = Course::of(parts.iter().copied());
        Self {
            course,
            running: TimeCheck::of(&parts),
            never_falls: course != Course::Constant && values.len() >= 10 && steps().all(|step| step >= 0.0),
            is_whole: values.iter().all(|value| (2.0 * value).fract() == 0.0),
            is_kept: is_kept(values, &parts),
            is_held: is_held(values),
        }
    }

    /// True for a column that goes on as a counter does: in whole numbers, in steps, or never backwards.
    pub fn may_count(self) -> bool {
        self.never_falls
            || self.is_whole
            || self.is_kept
            || matches!(self.course, Course::Counts | Course::CountsInSteps)
    }
}

/// The numbers of a column, NaN where it is blank; `None` if its cells are no numbers.
pub fn numbers(table: &Table, name: &str) -> Option<Vec<f64>> {
    let place = table.column(name)?;
    let mut cells = CellReader::new(table.numbers());
    let mut column = ColumnReader::new(table, place);
    let number =
        |(row, &line): (usize, &u64)| column.number(table, &mut cells, table.cell(row, place), line).ok();
    let numbers: Vec<Option<f64>> = table.lines.iter().enumerate().map(number).collect();
    // A single word among numbers is a mistake, which is told where the column is read for its numbers.
    let is_text = numbers.iter().all(|number| number.is_none_or(f64::is_nan));
    (!is_text).then(|| numbers.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect())
}

/// Whether values may be time stamps: they grow, and may start again where a record begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeCheck {
    /// Every value is larger than the one before.
    Strictly,
    /// Some are equal to the one before, as of a clock of few digits.
    WithEqualStamps,
    /// Some rise, and as many fall, or more.
    Falls,
    /// Others.
    No,
}

impl TimeCheck {
    fn of(records: &[&[f64]]) -> Self {
        let (mut equal, mut rises, mut falls) = (0, 0, 0);
        for values in records {
            let Some(&first) = values.first() else { continue };
            let mut first = first;
            for pair in values.windows(2) {
                match pair[1] - pair[0] {
                    step if step > 0.0 => rises += 1,
                    0.0 => equal += 1,
                    _ if starts_again(first, pair[0], pair[1]) && is_the_same(first, pair[0], pair[1]) => {
                        first = pair[1];
                    }
                    _ => falls += 1,
                }
            }
        }
        match (rises, equal, falls) {
            (_, _, 1..) if 4 * falls > rises => Self::Falls,
            (0, ..) | (_, _, 1..) => Self::No,
            (_, 0, 0) => Self::Strictly,
            _ => Self::WithEqualStamps,
        }
    }
}

/// The column that runs through where a time starts again, with steps no longer than those before: the total time of a test
/// in steps. The clock of several tests has gaps.
pub fn running_through<'n>(
    table: &Table,
    stepped: &str,
    mut others: impl Iterator<Item = &'n String>,
) -> Option<&'n String> {
    let stepped = numbers(table, stepped)?;
    let restarts: Vec<usize> = (1..stepped.len()).filter(|&row| stepped[row] < stepped[row - 1]).collect();
    others.find(|name| {
        let values = unit::may_be_time(name).then(|| numbers(table, name)).flatten().unwrap_or_default();
        let step = |row: usize| values[row] - values[row - 1];
        let rows = 1..values.len();
        let longest =
            rows.clone().filter(|row| restarts.binary_search(row).is_err()).map(step).fold(0.0, f64::max);
        !restarts.is_empty()
            && values.len() == stepped.len()
            && rows.clone().all(|row| step(row) >= 0.0)
            && restarts.iter().all(|&row| step(row) <= MOST_STEP * longest)
    })
}

/// Time starts again where it began, and a field of reversal curves elsewhere.
fn is_the_same(first: f64, previous: f64, stamp: f64) -> bool {
    (stamp - first).abs() <= SAME_BEGINNING * (previous - first)
}

/// Largest less smallest value.
pub fn span(values: &[f64]) -> f64 {
    let (low, high) = range(values);
    high - low
}

fn range(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().filter(|value| value.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)))
}

fn is_kept(values: &[f64], records: &[&[f64]]) -> bool {
    let tolerance = tolerance(values);
    let keeps = |part: &&[f64]| {
        let (low, high) = range(part);
        high - low <= tolerance
    };
    if tolerance.is_nan() || tolerance <= 0.0 {
        return false;
    }
    let levels = kept(values, tolerance);
    let rows: usize = levels.iter().map(Range::len).sum();
    let are_few = (1..=MOST_LEVELS * records.len()).contains(&levels.len());
    records.len() > 1 && records.iter().all(keeps)
        || are_few && rows as f64 >= LEAST_SHARE * values.len() as f64
}

fn tolerance(values: &[f64]) -> f64 {
    let (low, high) = range(values);
    KEPT * (high - low)
}

/// Rows for which one value after another is kept.
fn kept(values: &[f64], tolerance: f64) -> Vec<Range<usize>> {
    let mut levels = Vec::new();
    let mut start = 0;
    while start < values.len() {
        let (mut low, mut high, mut end) = (values[start], values[start], start + 1);
        while end < values.len() {
            (low, high) = (low.min(values[end]), high.max(values[end]));
            if high - low > tolerance {
                break;
            }
            end += 1;
        }
        if end - start >= LEAST_KEPT {
            levels.push(start..end);
        }
        start = end;
    }
    levels
}

/// The rows at which a condition takes another value, the first row included. Rows on the way to a value belong to it.
pub fn changes(values: &[f64]) -> Vec<usize> {
    let levels = kept(values, tolerance(values));
    let is_other = |pair: &&[Range<usize>]| {
        let middle = |rows: &Range<usize>| values[rows.start + rows.len() / 2];
        (middle(&pair[0]) - middle(&pair[1])).abs() > tolerance(values)
    };
    std::iter::once(0).chain(levels.windows(2).filter(is_other).map(|pair| pair[0].end)).collect()
}

/// Rows of each plateau of a column of measured numbers that is to tell records apart, such as a temperature; `None` for
/// names and whole numbers.
pub fn plateaus(table: &Table, name: &str) -> Option<Vec<Range<usize>>> {
    let values = numbers(table, name)?;
    let seen = ValueStatistics::of(&values, std::slice::from_ref(&(0..values.len())));
    if seen.is_whole || !seen.is_kept {
        return None;
    }
    let begins: Vec<usize> = changes(&values).into_iter().chain([values.len()]).collect();
    Some(begins.windows(2).map(|pair| pair[0]..pair[1]).collect())
}

fn is_held(values: &[f64]) -> bool {
    let (low, high) = range(values);
    if values.len() < LEAST_KEPT || high - low > HELD * low.abs().min(high.abs()) {
        return false;
    }
    // Noise turns at two of three values; what moves turns seldom.
    let turns = values.windows(3).filter(|row| (row[1] - row[0]) * (row[2] - row[1]) < 0.0).count();
    10 * turns > 4 * values.len()
}

/// True for a load that is held with some error, or held after it was applied: half of its values lie close together.
pub fn is_steady(values: &[f64]) -> bool {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(low), Some(high)) = (sorted.first(), sorted.last()) else { return true };
    let (quarter, largest) = (sorted.len() / 4, low.abs().max(high.abs()));
    sorted[3 * quarter] - sorted[quarter] < STEADY * largest
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::sin;

    use super::*;

    fn seen(value: impl Fn(f64) -> f64, rows: u32) -> ValueStatistics {
        let values: Vec<f64> = (0..rows).map(|k| value(f64::from(k))).collect();
        ValueStatistics::of(&values, std::slice::from_ref(&(0..values.len())))
    }

    /// A sequence between -1 and 1 that turns as noise does.
    fn noise(k: f64) -> f64 {
        2.0 * (43_758.545 * sin(12.9898 * k)).rem_euclid(1.0) - 1.0
    }

    #[test]
    fn what_falls_is_no_time() {
        assert_eq!(seen(|k| 0.1 * k, 100).running, TimeCheck::Strictly);
        assert_eq!(seen(|k| (0.1 * k).floor(), 100).running, TimeCheck::WithEqualStamps);
        assert_eq!(seen(|k| k % 25.0, 100).running, TimeCheck::Strictly, "records");
        assert_eq!(seen(|k| (k - 40.0).abs(), 81).running, TimeCheck::Falls, "a field from its maximum");
        assert_eq!(seen(|k| 40.0 - (k - 40.0).abs(), 81).running, TimeCheck::Falls, "a field from 0");
        assert_eq!(seen(|k| -k, 81).running, TimeCheck::Falls);
        // Reversal curves begin at other fields, and end at one.
        let curves = |k: f64| {
            let (curve, place) = ((k / 20.0).floor(), k % 20.0);
            100.0 - 10.0 * (curve + 1.0) * (1.0 - place / 19.0)
        };
        assert_ne!(seen(curves, 200).running, TimeCheck::Strictly);
    }

    #[test]
    fn conditions_keep_few_values() {
        let levels = |k: f64| [5.0, 50.0, 150.0, 300.0][(k / 200.0) as usize] + 0.05 * noise(k);
        assert!(seen(levels, 800).is_kept);
        let values: Vec<f64> = (0..800).map(|k| levels(f64::from(k))).collect();
        assert_eq!(changes(&values), [0, 200, 400, 600]);
        assert!(seen(|k| (k / 40.0).floor() / 2.0, 400).is_kept, "half cycles");
        assert!(!seen(|k| sin(0.01 * k), 4000).is_kept);
        assert!(!seen(|k| sin(0.001 * k), 12_000).is_kept);
        assert!(!seen(|k| k, 10_000).is_kept);
        assert!(!seen(noise, 400).is_kept);
    }

    #[test]
    fn what_is_held_is_noise_around_a_value() {
        assert!(seen(|k| 300.0 + 0.2 * noise(k), 160).is_held);
        assert!(!seen(|k| 300.0 + sin(0.1 * k), 160).is_held);
        assert!(!seen(noise, 160).is_held);
    }
}
