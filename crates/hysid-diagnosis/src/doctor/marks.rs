//! Values that were not measured: marks of a missing value such as -999, full scale of an integer, and spikes. They
//! stand far from all others; a mark within the range is known by its value and by the jumps to it and back.

use super::{DataIssue, DataIssueKind, Severity, piece};
use crate::Piece;
use hysid_core::data::record::{Dataset, Record};
use hysid_core::data::unit;
use hysid_core::elementary::log10;
use hysid_core::significant::Significant;
use hysid_core::words::Hint;

/// Numbers that mark missing values, or are the full scale of an integer or of a number of single precision.
const MARKS: [f64; 22] = [
    99.0,
    999.0,
    9999.0,
    99999.0,
    999999.0,
    9999999.0,
    99.99,
    999.9,
    999.99,
    9999.9,
    9999.99,
    8888.0,
    888888.0,
    7999.0,
    32767.0,
    32768.0,
    65535.0,
    2147483647.0,
    2147483648.0,
    4294967295.0,
    9.96921e36,
    3.402823466e38,
];

/// Marks are told by their powers too: at least this is no measured value beside small ones.
const HUGE: f64 = 1e10;

/// Fewest values that are examined.
const FEWEST: usize = 10;

/// A mark stands apart by this share of the range of all other values, one value that is no known mark by so many
/// ranges, and different values that are few by so many.
const MARK_APART: f64 = 0.5;
const VALUE_APART: f64 = 3.0;
const SPIKES_APART: f64 = 10.0;

/// Share of the values that may be one value far off, and that may be spikes.
const MOST_ALIKE: f64 = 0.1;
const MOST_SPIKES: f64 = 0.01;

/// A mark within the range: jumps to it and back, against the median step, and as a share of the range.
const JUMP_STEPS: f64 = 20.0;
const JUMP_RANGE: f64 = 0.1;

/// Most different values of a column that are listed.
const MOST_TOLD: usize = 3;

/// Rows that are shown of each value.
const SHOWN: usize = 3;

/// A column: its name, and its values in a record.
struct NamedColumn<'d> {
    name: &'d str,
    is_output: bool,
    of: Box<dyn Fn(&'d Record) -> &'d [f64] + 'd>,
}

pub(super) fn complaints(data: &Dataset) -> Vec<DataIssue> {
    let names = data.names();
    let inputs = names.inputs.iter().enumerate().map(|(input, name)| NamedColumn {
        name,
        is_output: false,
        of: Box::new(move |record: &Record| &*record.inputs()[input]),
    });
    let output = NamedColumn { name: &names.output, is_output: true, of: Box::new(Record::output) };
    inputs.chain([output]).flat_map(|column| column.complaints(data)).collect()
}

struct DistantValues {
    /// From this value on, away from the others.
    low: f64,
    high: f64,
    is_mark: bool,
}

impl<'d> NamedColumn<'d> {
    fn complaints(&self, data: &'d Dataset) -> Vec<DataIssue> {
        let values = data.records().iter().flat_map(|record| (self.of)(record));
        let mut sorted: Vec<f64> = values.copied().filter(|value| !value.is_nan()).collect();
        sorted.sort_by(f64::total_cmp);
        let mut found = Vec::new();
        for mark in distinct_marks(&sorted) {
            let others: Vec<f64> = sorted.iter().copied().filter(|value| *value != mark).collect();
            if others.len() >= FEWEST
                && (stands_apart(&others, mark) || self.is_jumped_to(data, mark, &others))
            {
                sorted = others;
                found.push(DistantValues { low: mark, high: mark, is_mark: true });
            }
        }
        while let Some(apart) = far_off(&sorted) {
            sorted.retain(|value| *value < apart.low || *value > apart.high);
            found.push(apart);
        }
        found.truncate(MOST_TOLD);
        found.iter().map(|apart| self.complaint(data, apart)).collect()
    }

    /// True if the mark stands in few rows, and the column jumps to it and back in all of them.
    fn is_jumped_to(&self, data: &'d Dataset, mark: f64, others: &[f64]) -> bool {
        let columns = || data.records().iter().map(|record| (self.of)(record));
        let steps = columns().flat_map(|column| column.windows(2).map(|pair| (pair[0], pair[1])));
        let steps: Vec<(bool, f64)> = steps
            .map(|(from, to)| ((from == mark) != (to == mark), (to - from).abs()))
            .filter(|(_, step)| !step.is_nan())
            .collect();
        let mut usual: Vec<f64> = steps.iter().filter(|(jumps, _)| !jumps).map(|(_, step)| *step).collect();
        let jumps: Vec<f64> = steps.iter().filter(|(jumps, _)| *jumps).map(|(_, step)| *step).collect();
        let count = columns().flatten().filter(|value| **value == mark).count();
        if jumps.len() < 4 || usual.len() < FEWEST || count as f64 > MOST_ALIKE * others.len() as f64 {
            return false;
        }
        let range = others[others.len() - 1] - others[0];
        let middle = usual.len() / 2;
        let median = *usual.select_nth_unstable_by(middle, f64::total_cmp).1;
        let least = (JUMP_STEPS * median).max(JUMP_RANGE * range);
        jumps.iter().filter(|jump| **jump >= least).count() as f64 >= 0.8 * jumps.len() as f64
    }

    fn complaint(&self, data: &'d Dataset, apart: &DistantValues) -> DataIssue {
        let mut rows: Vec<Piece> = Vec::new();
        let (mut count, mut first) = (0, None);
        for record in data.records() {
            for (row, value) in (self.of)(record).iter().enumerate() {
                if (apart.low..=apart.high).contains(value) {
                    count += 1;
                    first.get_or_insert((record, row));
                    if rows.len() < SHOWN {
                        rows.push(piece(record, row, row));
                    }
                }
            }
        }
        let unit = unit::of_column(self.name);
        let shown = |value: f64| format!("{:.4}{}", Significant(value), unit::suffix(unit.as_deref()));
        let which = match apart.low == apart.high {
            true => format!("is {}", shown(apart.low)),
            false => format!("is between {} and {}", shown(apart.low), shown(apart.high)),
        };
        let how_many = if count == 1 { "1 row".to_string() } else { format!("{count} rows") };
        let place = first.map_or_else(String::new, |(record, row)| {
            format!(" (first in row {} of record \"{}\")", row + 1, record.name())
        });
        let what = match apart.is_mark {
            true => "a code for a missing value, or the full scale of the instrument?",
            false => "far from all other values: a code for a missing value, or a spike?",
        };
        let help = match self.is_output {
            true => "leave the output of these rows blank",
            false => "leave these rows out, or interpolate: every value of an input changes the memory",
        };
        let name = self.name;
        let statement =
            format!("\"{name}\" {which} in {how_many}{place}: {what} If it was not measured, {help}");
        let value = if apart.low.abs() > apart.high.abs() { apart.low } else { apart.high };
        DataIssue {
            value: Some(value),
            unit,
            advice: self.is_output.then(|| Hint::MissingWord(value.to_string()).into()),
            ..DataIssue::of_rows(DataIssueKind::MissingValueMark, Severity::Warning, statement, rows)
        }
    }
}

/// Known marks among sorted values.
fn distinct_marks(sorted: &[f64]) -> Vec<f64> {
    let mut found: Vec<f64> = sorted.iter().copied().filter(|value| is_mark(*value)).collect();
    found.dedup();
    // Of very many huge values none is a mark.
    if found.len() > 2 * MARKS.len() { Vec::new() } else { found }
}

fn is_mark(value: f64) -> bool {
    let size = value.abs();
    let is_near = |mark: &f64| (size / mark - 1.0).abs() < 1e-6;
    let is_power = || size >= HUGE && (log10(size) - log10(size).round()).abs() < 1e-9;
    MARKS.iter().any(is_near) || is_power()
}

/// True if a mark lies beyond all other values, by a part of their range.
fn stands_apart(others: &[f64], mark: f64) -> bool {
    let plain = || others.iter().copied().filter(|value| !is_mark(*value));
    let low = plain().fold(f64::INFINITY, f64::min);
    let high = plain().fold(f64::NEG_INFINITY, f64::max);
    let distance = (mark - high).max(low - mark);
    high > low && distance > MARK_APART * (high - low)
}

/// The values at one end that are far from all others, if there are some.
fn far_off(sorted: &[f64]) -> Option<DistantValues> {
    let count = sorted.len();
    if count < FEWEST {
        return None;
    }
    let spikes = ((MOST_SPIKES * count as f64) as usize).max(1);
    let alike = (MOST_ALIKE * count as f64) as usize;
    let tail = |at_end: bool| {
        // The values from the end inwards, and how far each is from the next.
        let value = |k: usize| if at_end { sorted[count - 1 - k] } else { sorted[k] };
        let gap = |k: usize| (value(k) - value(k + 1)).abs();
        let rest = |k: usize| (value(k + 1) - value(count - 1)).abs();
        let most = spikes.max(alike).min(count - FEWEST);
        (0..most).rev().find_map(|last| {
            let is_one = value(0) == value(last);
            // A single row is a spike.
            let apart = if is_one && last > 0 { VALUE_APART } else { SPIKES_APART };
            let is_few = last < spikes || is_one && last < alike;
            let is_far = is_few && rest(last) > 0.0 && gap(last) > apart * rest(last);
            is_far.then(|| (value(0).min(value(last)), value(0).max(value(last))))
        })
    };
    let (low, high) = tail(true).or_else(|| tail(false))?;
    Some(DistantValues { low, high, is_mark: false })
}
