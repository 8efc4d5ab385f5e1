//! Identification of a Prandtl-Ishlinskii model: linear least squares on each of several grids of thresholds.

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::law::candidates::{CandidateRequest, RankedLaw, of_law};
use crate::fit::law::grids::best_on_grids;
use crate::fit::law::linearised::{LinearisedLaw, WeightRows, in_stretches, unit_gradient};
use crate::fit::law::search::IdentifiedLaw;
use crate::fit::law::{Identify, grids};
use crate::fit::memory_need::{LawFitSize, MemoryNeed};
use crate::fit::progress::SearchObserver;
use crate::fit::sums::{FoldSums, SumGatherer, TrainingRows, logarithmic};
use crate::law::prandtl_ishlinskii::PrandtlIshlinskii;
use crate::law::series::Series;
use crate::operator::play;
use crate::optimise::non_negative::Penalty;
use crate::options::classical::ClassicalModel;
use crate::options::classical::{ClassicalOptions, Sign};
use crate::stop_check::StopCheck;

impl Identify for PrandtlIshlinskii {
    const TAKES_WEIGHTS: bool = true;

    fn identify(
        data: &Dataset,
        options: &ClassicalOptions,
        _: &mut SearchObserver<'_>,
        stop: StopCheck<'_>,
    ) -> Result<IdentifiedLaw<Self>> {
        // A stop leaves out grids and penalties that were not compared yet.
        let rows = TrainingRows::of(data)?;
        let scaling = &rows.scaling;
        let grids = grids::candidates(options.thresholds.as_deref(), options.operators(), scaling.inputs[0])?;
        let (grid, weights) = best_on_grids(grids, |grid| weights_on_grid(&rows, grid, options.sign, stop))?;
        let slope = scaling.output_deviation / scaling.inputs[0];
        let plays = weights[2..].iter().map(|weight| weight * slope).collect();
        let law = Self::new(scaling.output(weights[0]), weights[1] * slope, grid, plays)?;
        Ok(IdentifiedLaw::by_least_squares(law))
    }

    fn linearised(&self, data: &Dataset, _: &ClassicalOptions) -> Result<Option<LinearisedLaw>> {
        let (series, rows_each) = in_stretches(Series::all(data, None)?);
        let count = 2 + self.weights().len();
        let mut rows = WeightRows::new(count);
        let mut features = vec![1.0; count];
        for series in &series {
            rows.begin();
            let mut plays = vec![0.0; self.weights().len()];
            for (sample, &y) in series.samples.iter().zip(&series.output) {
                features[1] = sample.x;
                for ((play, &r), feature) in plays.iter_mut().zip(self.thresholds()).zip(&mut features[2..]) {
                    *play = play::follow(*play, sample.x, r);
                    *feature = *play; // (7.4)
                }
                rows.add(&features, y);
            }
        }
        let weights = [&[self.constant(), self.linear()], self.weights()].concat();
        // A sign may bound the weight of the input and those of the plays; one that is 0 is at its bound.
        let bounded: Vec<bool> = (0..count).map(|i| i >= PLAYS_BEGIN.start).collect();
        // Constant and input, then a threshold, which is not fitted, and a weight of each play.
        let mut gradients = vec![unit_gradient(count, 0), unit_gradient(count, 1)];
        gradients.extend((2..count).flat_map(|play| [Vec::new(), unit_gradient(count, play)]));
        Ok(Some(rows.linearised(&weights, &bounded, gradients, rows_each)))
    }

    fn memory_need(_: &Dataset, options: &ClassicalOptions, size: &LawFitSize) -> MemoryNeed {
        let plays = options.plays();
        size.of_least_squares(plays as f64 + 3.0, plays)
    }

    fn candidates(model: ClassicalModel, request: &CandidateRequest<'_>) -> Vec<RankedLaw> {
        vec![(6, of_law(model, request.options))]
    }
}

/// Score by cross-validation and weights (constant, input, plays) in scaled units.
fn weights_on_grid(
    rows: &TrainingRows,
    thresholds: &[f64],
    sign: Option<Sign>,
    stop: StopCheck<'_>,
) -> Result<(f64, Vec<f64>)> {
    let sums = play_sums(rows, thresholds, stop)?;
    // The constant is free, the input nearly.
    let of = |i: usize| match i {
        0 => 0.0,
        1 => 1e-3,
        _ => 1.0,
    };
    let penalty = Penalty::ridge((0..2 + thresholds.len()).map(of));
    let penalties = logarithmic(1e-9, 1e-1, 17);
    let choice = sums.choose(&penalty, &penalties, sign, &PLAYS_BEGIN, stop);
    Ok((choice.score, sums.weights(&penalty, choice, PLAYS_BEGIN, stop)?))
}

/// Constant and input come first and are free.
const PLAYS_BEGIN: std::ops::Range<usize> = 2..2;

/// Sums of constant, input and plays, inputs and plays in units of the largest input.
fn play_sums(rows: &TrainingRows, thresholds: &[f64], stop: StopCheck<'_>) -> Result<FoldSums> {
    let TrainingRows { series, folds, scaling } = rows;
    let mut gatherer = SumGatherer::new(2 + thresholds.len(), folds, stop);
    let mut features = vec![0.0; 2 + thresholds.len()];
    features[0] = 1.0;
    let factor = 1.0 / scaling.inputs[0];
    for (series, fold) in series.iter().zip(&folds.of_rows) {
        let mut plays = vec![0.0; thresholds.len()];
        let targets = scaling.scaled_output(&series.output);
        for (row, ((sample, &fold), target)) in series.samples.iter().zip(fold).zip(targets).enumerate() {
            if gatherer.is_over(4 * features.len()) {
                break;
            }
            features[1] = sample.x * factor;
            for ((play, &r), feature) in plays.iter_mut().zip(thresholds).zip(&mut features[2..]) {
                *play = play::follow(*play, sample.x, r);
                *feature = *play * factor; // (7.4)
            }
            gatherer.add_weighted(fold, &features, target, series.weight(row));
        }
    }
    gatherer.finish()
}
