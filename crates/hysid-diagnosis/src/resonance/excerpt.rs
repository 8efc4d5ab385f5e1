//! The rows that a resonance is looked for in: of each record the contiguous part whose input moves most.

use std::ops::Range;

use hysid_core::data::record::{Dataset, Record};

/// Rows of all excerpts together, at most.
const MOST_ROWS: usize = 6000;

/// Rows of one excerpt, at least.
const FEWEST_ROWS: usize = 200;

/// Time stamps are evenly spaced up to this share of a step.
pub(crate) const JITTER: f64 = 1e-3;

/// Whether the output or its changes are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComparedSignal {
    /// The output itself.
    Output,
    /// Its changes from row to row, in which a permanent deformation is small.
    Changes,
}

impl ComparedSignal {
    /// Turns a column into what is compared: its values, or their changes, in rows with an output, and 0 elsewhere.
    fn apply(self, column: &mut [f64], scored: &[f64]) {
        match self {
            Self::Output => {
                column.iter_mut().zip(scored).for_each(|(value, scored)| *value *= scored);
            }
            Self::Changes => {
                for row in (1..column.len()).rev() {
                    column[row] = scored[row] * scored[row - 1] * (column[row] - column[row - 1]);
                }
                column.iter_mut().take(1).for_each(|first| *first = 0.0);
            }
        }
    }
}

/// Evenly spaced rows of a record. Input and output are scaled to their middle and half their range over all excerpts.
#[derive(Debug)]
pub(super) struct Excerpt {
    pub record: usize,
    pub rows: Range<usize>,
    /// Time between rows.
    pub step: f64,
    pub input: Vec<f64>,
    /// 1 in a row with an output, otherwise 0.
    scored: Vec<f64>,
    /// Signal compared, from the scaled output, from the scaled input, and from the constant 1.
    pub output_column: Vec<f64>,
    pub input_column: Vec<f64>,
    pub constant_column: Vec<f64>,
}

impl Excerpt {
    pub fn duration(&self) -> f64 {
        self.step * (self.rows.len() - 1) as f64
    }
}

/// Middle and half the range of values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    pub middle: f64,
    pub half: f64,
}

impl Scale {
    /// Of values some of which may be NaN; `None` if they do not differ.
    fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let (low, high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), value| (l.min(value), h.max(value)));
        let scale = Self { middle: 0.5 * low + 0.5 * high, half: 0.5 * high - 0.5 * low };
        (scale.middle.is_finite() && scale.half.is_normal()).then_some(scale)
    }

    pub fn apply(self, value: f64) -> f64 {
        (value - self.middle) / self.half
    }
}

/// Excerpts of all records, and how they are scaled.
#[derive(Debug)]
pub(super) struct Excerpts {
    pub compared: ComparedSignal,
    pub parts: Vec<Excerpt>,
    pub input: Scale,
    pub output: Scale,
    /// Rows with an output.
    pub scored: usize,
}

impl Excerpts {
    /// Of data with one input and evenly spaced time; `None` for other data, for too few rows, and where input or output
    /// are constant.
    pub fn of(data: &Dataset, compared: ComparedSignal) -> Option<Self> {
        if data.names().inputs.len() != 1 {
            return None;
        }
        let chosen = chosen_rows(data);
        let records = data.records();
        let values = |column: fn(&Record) -> &[f64]| {
            let rows = chosen.iter();
            rows.flat_map(move |(record, rows)| column(&records[*record])[rows.clone()].iter().copied())
        };
        let input = Scale::of(values(|record| &record.inputs()[0]))?;
        let output = Scale::of(values(Record::output))?;
        let scored = values(Record::output).filter(|y| !y.is_nan()).count();
        if scored < FEWEST_ROWS {
            return None;
        }
        let excerpt = |(record, rows): &(usize, Range<usize>)| {
            let y = &records[*record].output()[rows.clone()];
            let x: Vec<f64> =
                records[*record].inputs()[0][rows.clone()].iter().map(|&x| input.apply(x)).collect();
            let scored: Vec<f64> = y.iter().map(|y| if y.is_nan() { 0.0 } else { 1.0 }).collect();
            let scaled = y.iter().map(|&y| if y.is_nan() { 0.0 } else { output.apply(y) }).collect();
            let column = |mut values: Vec<f64>| {
                compared.apply(&mut values, &scored);
                values
            };
            Some(Excerpt {
                record: *record,
                rows: rows.clone(),
                step: even_step(&records[*record].time()?[rows.clone()])?,
                output_column: column(scaled),
                input_column: column(x.clone()),
                constant_column: column(vec![1.0; x.len()]),
                input: x,
                scored,
            })
        };
        let parts = chosen.iter().map(excerpt).collect::<Option<Vec<Excerpt>>>()?;
        Some(Self { compared, parts, input, output, scored })
    }

    /// Turns the values of all rows of an excerpt into what is compared of them.
    pub fn compare(&self, part: &Excerpt, column: &mut [f64]) {
        self.compared.apply(column, &part.scored);
    }

    /// A remainder as root mean square in the unit of the output.
    pub fn root_mean_square(&self, remainder: f64) -> f64 {
        self.output.half * (remainder / self.scored as f64).sqrt()
    }
}

/// Which rows of which records: a share of each, the same for all as far as a share has enough rows.
fn chosen_rows(data: &Dataset) -> Vec<(usize, Range<usize>)> {
    let share = (MOST_ROWS as f64 / data.rows() as f64).min(1.0);
    let mut left = MOST_ROWS;
    let mut chosen = Vec::new();
    for (number, record) in data.records().iter().enumerate() {
        let wanted = ((share * record.len() as f64) as usize).max(FEWEST_ROWS);
        if record.len() >= FEWEST_ROWS && wanted <= left {
            left -= wanted;
            chosen.push((number, busiest(&record.inputs()[0], wanted)));
        }
    }
    chosen
}

/// So many rows, or all if there are no more, over which the input travels furthest.
fn busiest(x: &[f64], count: usize) -> Range<usize> {
    let count = count.min(x.len());
    let travel = |row: usize| (x[row] - x[row - 1]).abs();
    let mut current: f64 = (1..count).map(travel).sum();
    let (mut first, mut most) = (0, current);
    for start in 1..=x.len() - count {
        current += travel(start + count - 1) - travel(start);
        if current > most {
            (first, most) = (start, current);
        }
    }
    first..first + count
}

/// The time between rows, if it is the same everywhere.
pub(crate) fn even_step(time: &[f64]) -> Option<f64> {
    let first = *time.first()?;
    let step = (time.last()? - first) / (time.len() - 1) as f64;
    let is_even = |(row, t): (usize, &f64)| (t - first - row as f64 * step).abs() <= JITTER * step;
    (step.is_normal() && step > 0.0 && time.iter().enumerate().all(is_even)).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_that_moves() {
        let x: Vec<f64> =
            (0..100).map(|k| if (40..60).contains(&k) { f64::from(k % 2) } else { 0.0 }).collect();
        let rows = busiest(&x, 22);
        assert!(rows.start <= 40 && rows.end >= 60, "{rows:?}");
        assert_eq!(busiest(&x, 1000), 0..100);
    }

    #[test]
    fn changes_are_compared_where_both_rows_have_an_output() {
        let scored = [1.0, 1.0, 0.0, 1.0, 1.0];
        let compared = |compared: ComparedSignal| {
            let mut column = [3.0, 5.0, 6.0, 7.0, 11.0];
            compared.apply(&mut column, &scored);
            column
        };
        assert_eq!(compared(ComparedSignal::Output), [3.0, 5.0, 0.0, 7.0, 11.0]);
        assert_eq!(compared(ComparedSignal::Changes), [0.0, 2.0, 0.0, 0.0, 4.0]);
    }
}
