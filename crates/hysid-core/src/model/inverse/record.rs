//! The inverse along a whole record, and the choice of its preview.

use crate::elementary::{exp2, log2, square};
use crate::error::{Error, InverseError, Result, SampleError};
use crate::model::inverse::{Inverse, Inverted, Reach};

/// Rows from which a preview is chosen, at most.
const ROWS_OF_A_CHOICE: usize = 20_000;

/// The longest preview that is tried, as a share of the record.
const LONGEST: f64 = 0.125;

/// Longer previews without improvement after which the search ends, if the lowest cost is at most [`GOOD`].
const WORSE: usize = 4;
const GOOD: f64 = 0.1;

/// The cost of an inverse is the deviation of its output in standard deviations of the wanted output, and these multiples
/// of the share of rows with an input or rate outside the trained range, and of the number of turning points of the input
/// in excess of those of the wanted output, divided by the number of rows.
const WEIGHT_OF_EXTRAPOLATION: f64 = 2.0;
const WEIGHT_OF_TURNS: f64 = 0.25;

/// No preview is tried if every row is reached, or at a bound, without one, and the cost is at most this.
const LITTLE: f64 = 0.005;

/// Wanted outputs of a record.
#[derive(Debug, Clone, Copy)]
pub struct Reference<'a> {
    /// The wanted output of each row, in its unit.
    pub wanted: &'a [f64],
    /// Columns of the further inputs of the model, in their units.
    pub others: &'a [&'a [f64]],
    /// Time of each row; `None` for a model that needs none.
    pub time: Option<&'a [f64]>,
}

/// The inverse along a record.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Inversion {
    /// The first input of each row, in its unit.
    pub input: Vec<f64>,
    /// The output of the model there, in its unit.
    pub output: Vec<f64>,
    /// Whether the wanted output was reached.
    pub reach: Vec<Reach>,
    /// Whether the input or its rate is outside the range of the training data.
    pub is_extrapolated: Vec<bool>,
    /// Lowest and highest inputs whose band contains the wanted output; empty without [`Inverse::band`].
    pub low: Vec<f64>,
    /// See `low`.
    pub high: Vec<f64>,
}

impl Inversion {
    fn push(&mut self, inverted: &Inverted) {
        self.input.push(inverted.input);
        self.output.push(inverted.output);
        self.reach.push(inverted.reach);
        self.is_extrapolated.push(inverted.is_extrapolated);
        if let Some((low, high)) = inverted.band {
            self.low.push(low);
            self.high.push(high);
        }
    }

    /// Number of rows with this reach.
    pub fn count(&self, reach: Reach) -> usize {
        self.reach.iter().filter(|&&found| found == reach).count()
    }

    /// Root mean square deviation of the output of the model from the wanted one, in the unit of the output.
    pub fn rms_deviation(&self, wanted: &[f64]) -> f64 {
        let sum: f64 = self.output.iter().zip(wanted).map(|(output, wanted)| square(output - wanted)).sum();
        (sum / self.output.len().max(1) as f64).sqrt()
    }

    /// The cost of this inverse, for a wanted output with this standard deviation.
    fn cost(&self, wanted: &[f64], spread: f64) -> f64 {
        let share = |count: f64| count / wanted.len().max(1) as f64;
        let extrapolated = self.is_extrapolated.iter().filter(|is_extrapolated| **is_extrapolated).count();
        let turns = |values: &[f64]| {
            values.windows(3).filter(|row| (row[1] - row[0]) * (row[2] - row[1]) < 0.0).count() as f64
        };
        let idle_turns = (turns(&self.input) - turns(wanted)).max(0.0);
        self.rms_deviation(wanted) / spread.max(f64::MIN_POSITIVE)
            + WEIGHT_OF_EXTRAPOLATION * share(extrapolated as f64)
            + WEIGHT_OF_TURNS * share(idle_turns)
    }
}

impl Reference<'_> {
    fn beginning<'a>(&'a self, rows: usize, others: &'a mut Vec<&'a [f64]>) -> Reference<'a> {
        others.extend(self.others.iter().map(|column| &column[..rows.min(column.len())]));
        Reference {
            wanted: &self.wanted[..rows.min(self.wanted.len())],
            others,
            time: self.time.map(|time| &time[..rows.min(time.len())]),
        }
    }

    fn check(&self) -> Result<()> {
        let rows = self.wanted.len();
        let lengths = self.others.iter().map(|column| column.len()).chain(self.time.map(<[f64]>::len));
        if let Some(length) = lengths.into_iter().find(|&length| length != rows) {
            return Err(InverseError::Length { rows, length }.into());
        }
        // With a preview, an earlier row would be blamed for it.
        match self.wanted.iter().position(|wanted| !wanted.is_finite()) {
            Some(row) => {
                Err(InverseError::Row { row, problem: SampleError::Wanted(self.wanted[row]) }.into())
            }
            None => Ok(()),
        }
    }

    /// Previews to try: powers of two of the unit of time, independent of the time step.
    fn previews(&self) -> impl Iterator<Item = f64> + use<> {
        let time = self.time.unwrap_or_default();
        let longest = match time {
            [first, .., last] => LONGEST * (last - first),
            _ => 0.0,
        };
        let shortest = longest / LONGEST / time.len().max(2) as f64;
        let exponents = (longest > 0.0 && longest.is_finite() && shortest > 0.0)
            .then(|| log2(shortest).ceil() as i32..=log2(longest).floor() as i32);
        exponents.into_iter().flatten().map(|exponent| exp2(f64::from(exponent)))
    }
}

/// The wanted output at times that increase.
struct TargetPath<'a> {
    reference: Reference<'a>,
    /// The row before the last time.
    row: usize,
}

impl TargetPath<'_> {
    /// The wanted output at this time, on a straight line between rows; behind the last row, the last one.
    fn at(&mut self, time: f64) -> f64 {
        let (times, wanted) = (self.reference.time.unwrap_or_default(), self.reference.wanted);
        while self.row + 1 < times.len() && times[self.row + 1] <= time {
            self.row += 1;
        }
        match times.get(self.row + 1) {
            Some(next) => {
                let share = (time - times[self.row]) / (next - times[self.row]);
                wanted[self.row] + share * (wanted[self.row + 1] - wanted[self.row])
            }
            None => wanted[self.row],
        }
    }
}

impl Inverse<'_> {
    /// Takes all rows of a record, after the samples so far. With a preview, the wanted output ahead is that of the rows
    /// to come.
    ///
    /// # Errors
    /// As [`Inverse::step`], with the row; columns of other lengths. No row has been taken if a length or a wanted output
    /// is invalid, otherwise those before the invalid one.
    pub fn run(&mut self, reference: &Reference<'_>) -> Result<Inversion> {
        self.check_time(reference)?;
        reference.check()?;
        let mut ahead = TargetPath { reference: *reference, row: 0 };
        let mut inversion = Inversion::default();
        let mut others = vec![0.0; reference.others.len()];
        for row in 0..reference.wanted.len() {
            let time = reference.time.map_or(f64::NAN, |time| time[row]);
            others.iter_mut().zip(reference.others).for_each(|(value, column)| *value = column[row]);
            let is_first = self.last.is_none();
            let wanted = match self.preview > 0.0 && !is_first {
                true => ahead.at(time + self.preview),
                false => reference.wanted[row],
            };
            let inverted = self.step(wanted, &others, time).map_err(|error| at_row(row, error))?;
            inversion.push(&inverted);
        }
        Ok(inversion)
    }

    /// The best preview of those tried: none, and powers of two of the unit of time, up to an eighth of the record.
    ///
    /// It is the one with which the output of the model deviates little from the wanted one, while the input stays within
    /// the trained range and rates, and turns seldom where the wanted output does not. Without time stamps, or for a
    /// model without rate and relaxation, it is 0.
    ///
    /// It is found from the initial state of the model on the first 20,000 rows, or fewer; the state of the inverse stays
    /// as it is.
    ///
    /// # Errors
    /// As [`Inverse::run`].
    pub fn best_preview(&self, reference: &Reference<'_>) -> Result<f64> {
        reference.check()?;
        if !self.sees_time() || reference.time.is_none() {
            return Ok(0.0);
        }
        let mut columns = Vec::new();
        let reference = reference.beginning(ROWS_OF_A_CHOICE, &mut columns);
        let mut trial = self.clone();
        trial.band = None;
        let spread = standard_deviation(reference.wanted);
        let mut cost = |preview: f64| -> Result<(f64, bool)> {
            trial.reset();
            trial.preview = preview;
            let inversion = trial.run(&reference)?;
            let is_at_bounds = |reach: &Reach| *reach == Reach::Reached || reach.is_at_a_bound();
            let is_exact =
                inversion.reach.iter().all(is_at_bounds) && inversion.bounds_are_of(reference.wanted);
            Ok((inversion.cost(reference.wanted, spread), is_exact))
        };
        let (mut least, is_exact) = cost(0.0)?;
        let mut best = 0.0;
        if is_exact && least <= LITTLE {
            return Ok(best);
        }
        let mut worse = 0;
        for preview in reference.previews() {
            let (found, _) = cost(preview)?;
            if found < least {
                (least, best, worse) = (found, preview, 0);
            } else if least <= GOOD {
                worse += 1;
            }
            if worse == WORSE {
                break;
            }
        }
        Ok(best)
    }

    fn check_time(&self, reference: &Reference<'_>) -> Result<()> {
        match reference.time {
            None if self.needs_time() => Err(InverseError::NoTime.into()),
            _ => Ok(()),
        }
    }
}

impl Inversion {
    /// True if rows are at a limit only where the wanted output is beyond what was reached elsewhere.
    fn bounds_are_of(&self, wanted: &[f64]) -> bool {
        let reached = || {
            let rows = self.reach.iter().zip(wanted);
            rows.filter(|(reach, _)| **reach == Reach::Reached).map(|(_, wanted)| *wanted)
        };
        let low = reached().fold(f64::INFINITY, f64::min);
        let high = reached().fold(f64::NEG_INFINITY, f64::max);
        let is_lost = |(reach, wanted): (&Reach, &f64)| {
            matches!(reach, Reach::LowLimit | Reach::HighLimit) && *wanted > low && *wanted < high
        };
        !self.reach.iter().zip(wanted).any(is_lost)
    }
}

fn standard_deviation(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| square(value - mean)).sum::<f64>() / count).sqrt()
}

fn at_row(row: usize, error: Error) -> Error {
    match error {
        Error::Sample(problem) => InverseError::Row { row, problem }.into(),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::sin;

    #[test]
    fn wanted_outputs_ahead_lie_on_straight_lines() {
        let (time, wanted) = ([0.0, 1.0, 3.0], [0.0, 2.0, -2.0]);
        let reference = Reference { wanted: &wanted, others: &[], time: Some(&time) };
        let mut ahead = TargetPath { reference, row: 0 };
        let found = [0.0, 0.25, 1.0, 1.5, 2.0, 3.0, 9.0].map(|time| ahead.at(time));
        assert_eq!(found, [0.0, 0.5, 2.0, 1.0, 0.0, -2.0, -2.0]);
    }

    #[test]
    fn previews_do_not_depend_on_the_time_step() {
        let previews = |rows: usize| -> Vec<f64> {
            let time: Vec<f64> = (0..rows).map(|row| row as f64 / (rows - 1) as f64).collect();
            let wanted = vec![0.0; rows];
            Reference { wanted: &wanted, others: &[], time: Some(&time) }.previews().collect()
        };
        assert_eq!(previews(65), [0.015_625, 0.031_25, 0.0625, 0.125]);
        assert!(previews(1000).ends_with(&previews(65)));
        assert!(previews(1).is_empty());
    }

    #[test]
    fn an_input_that_runs_to_and_fro_costs_more() {
        let wanted: Vec<f64> = (0..100).map(|row| sin(0.1 * f64::from(row))).collect();
        let cost = |input: Vec<f64>| {
            let is_extrapolated = vec![false; 100];
            let output = wanted.clone();
            Inversion { input, output, is_extrapolated, ..Inversion::default() }.cost(&wanted, 0.7)
        };
        assert_eq!(cost(wanted.clone()), 0.0);
        let alternating = (0..100).map(|row| if row % 2 == 0 { 0.0 } else { 1.0 }).collect();
        assert!((0.2..0.25).contains(&cost(alternating)));
    }

    #[test]
    fn errors_tell_the_row() {
        let error = at_row(4, SampleError::NotFinite(f64::NAN).into());
        assert!(error.to_string().starts_with("row 5: "), "{error}");
        let reference = Reference { wanted: &[0.0, f64::NAN], others: &[], time: None };
        let error = reference.check().unwrap_err();
        assert_eq!(error.to_string(), "row 2: the wanted output is NaN, not a finite number");
    }
}
