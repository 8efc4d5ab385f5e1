//! Identification of a model by Masing's rule: linear least squares on each of several grids of thresholds.

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
use crate::law::masing::{Masing, MasingParts};
use crate::law::series::Series;
use crate::operator::{play, stop};
use crate::optimise::non_negative::Penalty;
use crate::options::classical::ClassicalModel;
use crate::options::classical::{ClassicalOptions, Sign};
use crate::stop_check::StopCheck;

/// Linear least squares with a penalty on the bends of the virgin curve, chosen by cross-validation.
impl Identify for Masing {
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
        let (grid, weights) = best_on_grids(grids, |grid| slopes_on_grid(&rows, grid, options.sign, stop))?;
        let slope = scaling.output_deviation / scaling.inputs[0];
        let slopes = weights[1..].iter().map(|weight| weight * slope).collect();
        let parts = MasingParts { constant: scaling.output(weights[0]), thresholds: grid, slopes };
        Self::new(parts).map(IdentifiedLaw::by_least_squares)
    }

    fn linearised(&self, data: &Dataset, _: &ClassicalOptions) -> Result<Option<LinearisedLaw>> {
        let (series, rows_each) = in_stretches(Series::all(data, None)?);
        let MasingParts { constant, thresholds, slopes } = self.parts();
        let count = 1 + slopes.len();
        let mut rows = WeightRows::new(count);
        let mut features = vec![1.0; count];
        for series in &series {
            rows.begin();
            let mut plays = vec![0.0; thresholds.len()];
            for (sample, &y) in series.samples.iter().zip(&series.output) {
                slope_features(sample.x, thresholds, &mut plays, &mut features);
                rows.add(&features, y);
            }
        }
        let weights = [&[*constant], slopes.as_slice()].concat();
        let bounded: Vec<bool> = (0..count).map(|i| i > 0).collect();
        // The constant, the bends, which are not fitted, and the slopes.
        let mut gradients = vec![unit_gradient(count, 0)];
        gradients.extend(vec![Vec::new(); thresholds.len()]);
        gradients.extend((1..count).map(|slope| unit_gradient(count, slope)));
        Ok(Some(rows.linearised(&weights, &bounded, gradients, rows_each)))
    }

    fn memory_need(_: &Dataset, options: &ClassicalOptions, size: &LawFitSize) -> MemoryNeed {
        let plays = options.plays();
        size.of_least_squares(plays as f64 + 3.0, plays)
    }

    fn candidates(model: ClassicalModel, request: &CandidateRequest<'_>) -> Vec<RankedLaw> {
        vec![(7, of_law(model, request.options))]
    }
}

/// The features of a row: 1, a stop less the one before for each slope, and what is left of the input for the last one.
fn slope_features(x: f64, thresholds: &[f64], plays: &mut [f64], features: &mut [f64]) {
    let mut before = 0.0;
    for ((play, &r), feature) in plays.iter_mut().zip(thresholds).zip(&mut features[1..]) {
        *play = play::follow(*play, x, r);
        let elongation = stop::elongation(x, *play);
        // (7.13): a slope multiplies the difference of two stops
        *feature = elongation - before;
        before = elongation;
    }
    features[thresholds.len() + 1] = x - before;
}

/// Score by cross-validation, and weights (constant, slopes) in scaled units.
fn slopes_on_grid(
    rows: &TrainingRows,
    grid: &[f64],
    sign: Option<Sign>,
    stop: StopCheck<'_>,
) -> Result<(f64, Vec<f64>)> {
    let sums = slope_sums(rows, grid, stop)?;
    let features = grid.len() + 2;
    // Bends of the curve are what costs; all slopes alike cost next to nothing.
    let mut penalty = Penalty::ridge((0..features).map(|i| if i == 0 { 0.0 } else { 1e-3 }));
    for i in 2..features {
        penalty.add_square(&[(i, 1.0), (i - 1, -1.0)], 1.0);
    }
    let factors = logarithmic(1e-9, 1e-1, 17);
    let choice = sums.choose(&penalty, &factors, sign, &(1..1), stop);
    Ok((choice.score, sums.weights(&penalty, choice, 1..1, stop)?))
}

/// Sums of constant and slopes: the feature of a slope is a stop less the one before.
fn slope_sums(rows: &TrainingRows, grid: &[f64], stop: StopCheck<'_>) -> Result<FoldSums> {
    let TrainingRows { series, folds, scaling } = rows;
    let mut features = vec![1.0; grid.len() + 2];
    let mut gatherer = SumGatherer::new(features.len(), folds, stop);
    let factor = 1.0 / scaling.inputs[0];
    for (series, fold) in series.iter().zip(&folds.of_rows) {
        let mut plays = vec![0.0; grid.len()];
        let targets = scaling.scaled_output(&series.output);
        for (row, ((sample, &fold), target)) in series.samples.iter().zip(fold).zip(targets).enumerate() {
            if gatherer.is_over(6 * features.len()) {
                break;
            }
            slope_features(sample.x, grid, &mut plays, &mut features);
            features[1..].iter_mut().for_each(|feature| *feature *= factor);
            gatherer.add_weighted(fold, &features, target, series.weight(row));
        }
    }
    gatherer.finish()
}
