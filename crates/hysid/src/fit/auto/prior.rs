//! Prior weights of candidates that the data cannot distinguish.
//!
//! Data of one loop between two ends contain no information about smaller loops inside it. Candidates with
//! equal errors on the loop then differ by factors on smaller loops. The ratios of both errors were measured
//! on generated cases: training data of one loop, test data of smaller loops and reversal curves
//! (docs/accuracy.md). Records of one loop at several speeds do distinguish candidates, by their rate
//! dependence; only the folds count then.

use crate::data::record::{Dataset, Record};
use crate::data::turning_points::turning_points;
use crate::options::FitSpec;
use crate::options::classical::{ClassicalModel, ClassicalOptions};

/// Reversals below this share of the range are noise.
const SMALLEST_REVERSAL: f64 = 0.02;

/// A reversal at least this share of the range away from both ends lies inside the loop.
const INSIDE: f64 = 0.1;

/// Reversals inside the loop from which on there is more than one loop.
const SMALLER_LOOP: usize = 2;

/// Records whose speeds differ by more than this factor show more than one loop does.
const OTHER_SPEED: f64 = 1.5;

/// How much wider a band is for data of one loop, on the generated cases.
pub(super) const WIDER_BAND: f64 = 1.6;

/// Power `p` of the weights `(e^S / e^{S_best})^{-p}` for data of one loop (theory.md (11.6)).
pub(super) const POWER: f64 = 8.0;

/// Whether the data tell candidates apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Evidence {
    /// The data hold loops of several sizes, or one at several speeds.
    SeveralLoops,
    /// All reversals of the first input lie at the ends of its range, and all records are run at one speed, as far
    /// as the data tell.
    OneLoop,
}

impl Evidence {
    /// That of a data set.
    pub fn of(data: &Dataset) -> Self {
        let (low, high) = data.input_range(0);
        let range = high - low;
        let is_inside = |x: f64| x > low + INSIDE * range && x < high - INSIDE * range;
        let inside = |x: &[f64]| {
            let turning = turning_points(x, SMALLEST_REVERSAL * range);
            turning.into_iter().filter(|&row| is_inside(x[row])).count()
        };
        let all: usize = data.records().iter().map(|record| inside(&record.inputs()[0])).sum();
        if all < SMALLER_LOOP && !differ_in_speed(data) { Self::OneLoop } else { Self::SeveralLoops }
    }

    /// What is added to the score of a candidate: mean logarithm of its error inside the loop over its error
    /// on the folds.
    pub fn prior(self, candidate: &FitSpec) -> f64 {
        match self {
            Self::SeveralLoops => 0.0,
            Self::OneLoop => inside_over_folds(candidate),
        }
    }
}

fn differ_in_speed(data: &Dataset) -> bool {
    let speeds = data.records().iter().filter_map(speed);
    let (slowest, fastest) =
        speeds.fold((f64::INFINITY, 0.0), |(low, high), speed| (speed.min(low), speed.max(high)));
    fastest > OTHER_SPEED * slowest
}

/// Path of the first input over the time that it takes; `None` without time stamps and for an input at rest.
fn speed(record: &Record) -> Option<f64> {
    let time = record.time()?;
    let path: f64 = record.inputs()[0].windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
    let speed = path / (time.last()? - time.first()?);
    (speed > 0.0 && speed.is_finite()).then_some(speed)
}

fn inside_over_folds(candidate: &FitSpec) -> f64 {
    let companded = |shares: Option<f64>| if shares.is_some() { 0.2 } else { 0.0 };
    match candidate {
        FitSpec::Network(options) => {
            companded(options.shaping.companding) + if options.deteriorates() { 0.85 } else { 1.25 }
        }
        FitSpec::Classical(options) => companded(options.shaping.companding) + of_law(options),
        FitSpec::Auto(_) => 0.0,
    }
}

fn of_law(options: &ClassicalOptions) -> f64 {
    match options.model {
        ClassicalModel::RandomStops if options.deterioration == Some(true) => 0.6,
        model => model.facts().log_error_inside,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::record::{ColumnNames, Record};

    fn data(turning: &[f64]) -> Dataset {
        let mut x = Vec::new();
        for pair in turning.windows(2) {
            x.extend((0..20).map(|row| pair[0] + (pair[1] - pair[0]) * f64::from(row) / 20.0));
        }
        let y = x.clone();
        Dataset::new(ColumnNames::plain(1), vec![Record::new("r", vec![x], y).unwrap()]).unwrap()
    }

    fn evidence(turning: &[f64]) -> Evidence {
        Evidence::of(&data(turning))
    }

    #[test]
    fn cycles_of_one_size_are_one_loop() {
        assert_eq!(evidence(&[0.0, 1.0, -1.0, 1.0, -1.0, 1.0]), Evidence::OneLoop);
        assert_eq!(evidence(&[-1.0, 0.97, -0.98, 1.0, -1.0]), Evidence::OneLoop);
        assert_eq!(evidence(&[0.0, 1.0]), Evidence::OneLoop);
        assert_eq!(evidence(&[198.0, 202.0, 198.0, 202.0, 198.0]), Evidence::OneLoop);
    }

    #[test]
    fn one_loop_at_several_speeds_is_more_than_one_loop() {
        let record = |step: f64| {
            let x: Vec<f64> = (0..200).map(|row| (0.1 * f64::from(row)).sin()).collect();
            let time = (0..200).map(|row| step * f64::from(row)).collect();
            Record::new("r", vec![x.clone()], x).unwrap().with_time(time).unwrap()
        };
        let evidence = |steps: &[f64]| {
            let records = steps.iter().map(|&step| record(step)).collect();
            let names = ColumnNames { time: Some("t".into()), ..ColumnNames::plain(1) };
            Evidence::of(&Dataset::new(names, records).unwrap())
        };
        assert_eq!(evidence(&[1.0, 1.2]), Evidence::OneLoop);
        assert_eq!(evidence(&[1.0, 1.2, 0.1]), Evidence::SeveralLoops);
    }

    #[test]
    fn smaller_loops_and_reversal_curves_are_more() {
        assert_eq!(evidence(&[0.0, 1.0, -1.0, 0.5, -0.5, 0.5, -0.5]), Evidence::SeveralLoops);
        assert_eq!(evidence(&[1.0, -0.2, 1.0, 0.3, 1.0, -1.0]), Evidence::SeveralLoops);
        assert_eq!(evidence(&[0.0, 0.2, -0.3, 0.5, -0.7, 1.0]), Evidence::SeveralLoops);
    }
}
