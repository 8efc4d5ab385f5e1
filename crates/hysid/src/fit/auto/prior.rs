//! Prior preference among candidates that the data cannot distinguish.
//!
//! Data of one loop between two ends contain no information about smaller loops inside it: candidates with equal errors on
//! the loop differ by factors of a hundred there. The error to be expected inside the loop follows from the family of
//! the candidate and the shape of the branches; it was measured on simulated loops (docs/accuracy.md), and is part of the
//! score:
//!
//! ```text
//! S' = ½ ln(e^{2S} + f²)                                                    theory.md (11.14)
//! ```
//!
//! `S` is the score on the folds, `f` the expected error. Records of one loop at several speeds do distinguish
//! candidates, by their rate dependence; only the folds count then.

use crate::data::record::{Dataset, Record};
use crate::data::turning_points::turning_points;
use crate::law::facts::ErrorsInside;
use crate::options::FitSpec;

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

/// Errors of networks inside a loop, as of a law ([`ErrorsInside`]).
const OF_NETWORKS: ErrorsInside = ErrorsInside { softening: 0.25, sigmoid: 0.25, other: 0.6 };

const PARTS: usize = 10;

/// Ratio of slopes from which on a part of a branch is steeper than another. Designed.
const STEEPER: f64 = 2.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LoopEvidence {
    /// The data hold loops of several sizes, or one at several speeds.
    SeveralLoops,
    /// All reversals of the first input lie at the ends of its range, and all records have one speed.
    OneLoop(LoopShape),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LoopShape {
    /// Steepest after the reversal, and never much steeper again.
    Softening,
    /// Flat at both ends, and steep between.
    Sigmoid,
    Other,
}

impl LoopEvidence {
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
        if all < SMALLER_LOOP && !differ_in_speed(data) {
            Self::OneLoop(shape(data))
        } else {
            Self::SeveralLoops
        }
    }

    pub fn is_one_loop(self) -> bool {
        matches!(self, Self::OneLoop(_))
    }

    /// The error of a candidate to be expected on loops that the data do not show, as a share of the standard deviation.
    pub fn unseen_error(self, candidate: &FitSpec) -> f64 {
        match self {
            Self::SeveralLoops => 0.0,
            Self::OneLoop(shape) => {
                let errors = errors_inside(candidate);
                match shape {
                    LoopShape::Softening => errors.softening,
                    LoopShape::Sigmoid => errors.sigmoid,
                    LoopShape::Other => errors.other,
                }
            }
        }
    }
}

/// The shape of the longest branches of the data, by a majority of them.
fn shape(data: &Dataset) -> LoopShape {
    let (low, high) = data.input_range(0);
    let mut counts = [0; 3];
    for record in data.records() {
        let x = &record.inputs()[0];
        let turning = turning_points(x, SMALLEST_REVERSAL * (high - low));
        let ends: Vec<usize> = std::iter::once(0).chain(turning).chain([record.len() - 1]).collect();
        for pair in ends.windows(2) {
            if let Some(slopes) = slopes(x, record.output(), pair[0], pair[1], high - low) {
                counts[shape_of(&slopes) as usize] += 1;
            }
        }
    }
    let most = counts.iter().copied().max().unwrap_or(0);
    match counts {
        [softening, ..] if softening == most && most > 0 => LoopShape::Softening,
        [_, sigmoid, _] if sigmoid == most && most > 0 => LoopShape::Sigmoid,
        _ => LoopShape::Other,
    }
}

/// Slopes of equal parts of the branch from row `first` to `last`; `None` below half the range, or with too few
/// outputs.
fn slopes(x: &[f64], y: &[f64], first: usize, last: usize, range: f64) -> Option<Vec<f64>> {
    let (from, to) = (x[first], x[last]);
    if (to - from).abs() < 0.5 * range {
        return None;
    }
    // Means of the outputs in each part: noise has little effect on their differences.
    let (mut sums, mut counts) = ([0.0; PARTS], [0.0; PARTS]);
    for row in (first..=last).filter(|&row| !y[row].is_nan()) {
        let part = ((x[row] - from) / (to - from) * PARTS as f64).clamp(0.0, PARTS as f64 - 1.0) as usize;
        sums[part] += y[row];
        counts[part] += 1.0;
    }
    let means: Option<Vec<f64>> =
        sums.iter().zip(counts).map(|(sum, count)| (count > 0.0).then_some(sum / count)).collect();
    let step = (to - from) / PARTS as f64;
    Some(means?.windows(2).map(|pair| (pair[1] - pair[0]) / step).collect())
}

fn shape_of(slopes: &[f64]) -> LoopShape {
    let steepest = slopes.iter().copied().fold(0.0, |a: f64, b| a.max(b.abs()));
    let (first, last) = (slopes[0].abs(), slopes[slopes.len() - 1].abs());
    if STEEPER * first < steepest && STEEPER * last < steepest {
        return LoopShape::Sigmoid;
    }
    // Slopes below a share of the steepest differ by noise.
    let least = 0.02 * steepest;
    let mut flattest = f64::INFINITY;
    let steepens = slopes.iter().any(|slope| {
        flattest = flattest.min(slope.abs().max(least));
        slope.abs() > STEEPER * flattest
    });
    if steepens || last > first { LoopShape::Other } else { LoopShape::Softening }
}

fn differ_in_speed(data: &Dataset) -> bool {
    let speeds = data.records().iter().filter_map(Record::mean_speed);
    let (slowest, fastest) =
        speeds.fold((f64::INFINITY, 0.0), |(low, high), speed| (speed.min(low), speed.max(high)));
    fastest > OTHER_SPEED * slowest
}

fn errors_inside(candidate: &FitSpec) -> ErrorsInside {
    match candidate {
        FitSpec::Network(_) => OF_NETWORKS,
        FitSpec::Classical(options) if options.has_random_layer() => OF_NETWORKS,
        FitSpec::Classical(options) => options.model.facts().errors_inside,
        FitSpec::Auto(_) => ErrorsInside { softening: 0.0, sigmoid: 0.0, other: 0.0 },
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{exp, powi, sin, tanh};

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

    fn evidence(turning: &[f64]) -> LoopEvidence {
        LoopEvidence::of(&data(turning))
    }

    #[test]
    fn cycles_of_one_size_are_one_loop() {
        assert!(evidence(&[0.0, 1.0, -1.0, 1.0, -1.0, 1.0]).is_one_loop());
        assert!(evidence(&[-1.0, 0.97, -0.98, 1.0, -1.0]).is_one_loop());
        assert!(evidence(&[0.0, 1.0]).is_one_loop());
        assert!(evidence(&[198.0, 202.0, 198.0, 202.0, 198.0]).is_one_loop());
    }

    #[test]
    fn the_shape_of_the_branches_is_seen_through_noise() {
        let shape_of = |y: &dyn Fn(f64, f64) -> f64| {
            let data = data(&[1.0, -1.0, 1.0]);
            let record = &data.records()[0];
            let noise = |row: usize| 0.01 * (1e4 * sin(row as f64)).fract();
            let mut falls = true;
            let output = record.inputs()[0].iter().enumerate().map(|(row, &x)| {
                falls &= row < 20;
                y(x, if falls { 1.0 } else { -1.0 }) + noise(row)
            });
            let output = output.collect();
            shape(&data.of_record(record.clone().with_output(output).unwrap()))
        };
        // Coercive field 0.3; a stop that yields after a tenth, and one beside a spring that stiffens.
        assert_eq!(shape_of(&|x, side| tanh(8.0 * (x + 0.3 * side))), LoopShape::Sigmoid);
        let yields = |x: f64, side: f64| side * (1.0 - 2.0 * (1.0 - exp(-(1.0 - side * x) / 0.3)));
        assert_eq!(shape_of(&yields), LoopShape::Softening);
        // A play, which is free after a reversal.
        assert_eq!(
            shape_of(&|x, side| x + 0.3 * side * (1.0 - exp(-(1.0 - side * x) / 0.3))),
            LoopShape::Other
        );
        assert_eq!(shape_of(&|x, side| 0.3 * yields(x, side) + powi(x, 3)), LoopShape::Other);
    }

    #[test]
    fn one_loop_at_several_speeds_is_more_than_one_loop() {
        let record = |step: f64| {
            let x: Vec<f64> = (0..200).map(|row| sin(0.1 * f64::from(row))).collect();
            let time = (0..200).map(|row| step * f64::from(row)).collect();
            Record::new("r", vec![x.clone()], x).unwrap().with_time(time).unwrap()
        };
        let evidence = |steps: &[f64]| {
            let records = steps.iter().map(|&step| record(step)).collect();
            let names = ColumnNames { time: Some("t".into()), ..ColumnNames::plain(1) };
            LoopEvidence::of(&Dataset::new(names, records).unwrap())
        };
        assert!(evidence(&[1.0, 1.2]).is_one_loop());
        assert_eq!(evidence(&[1.0, 1.2, 0.1]), LoopEvidence::SeveralLoops);
    }

    #[test]
    fn smaller_loops_and_reversal_curves_are_more() {
        assert_eq!(evidence(&[0.0, 1.0, -1.0, 0.5, -0.5, 0.5, -0.5]), LoopEvidence::SeveralLoops);
        assert_eq!(evidence(&[1.0, -0.2, 1.0, 0.3, 1.0, -1.0]), LoopEvidence::SeveralLoops);
        assert_eq!(evidence(&[0.0, 0.2, -0.3, 0.5, -0.7, 1.0]), LoopEvidence::SeveralLoops);
    }
}
