//! Random stops: a network of random deteriorating stops whose output weights alone are fitted, by ridge
//! regression.
//!
//! ```text
//! y = c_0 + d_0 a·u + Σ_j d_j DS_{1,β_j}[w_j·u] (+ Σ_i c_i h_i),    w, β (and the tanh layer) random
//! d = argmin ‖Φd - y‖²/N + λ‖d‖²                                            theory.md (7.1), (7.14)
//! ```
//!
//! `u` are the scaled inputs, `DS` is a [deteriorating stop](crate::operator::deteriorating_stop) of
//! threshold 1 and capacity `β_j`, `h_i` a random tanh neuron, and `Φ` the matrix of the terms of the output,
//! one row for each of the `N` scored samples.
//!
//! The result is a [`Network`] like any other. Source: an extreme learning machine of deteriorating stops,
//! after Farrokh, Ghasemi, Noori, Wang and Sarhosis (2022), with a ridge instead of their support vector
//! machine.

use hysid_core::elementary::exp;

use crate::data::FEWEST_ROWS;
use crate::data::rate::RateMethod;
use crate::data::record::{Dataset, Record};
use crate::error::{Error, Result};
use crate::fit::law::candidates::{COMPRESSION, RankedLaw, compressed, with_compressed_rate};
use crate::fit::memory_need::{LawFitSize, MemoryNeed};
use crate::fit::random_start::{self, Capacities};
use crate::fit::sums::{FoldSums, Sums, logarithmic};
use crate::network::scaling::Scaling;
use crate::network::{
    Architecture, GramOverRecords, JacobianColumns, Network, NetworkDrive, ParameterLayout, RowsOverRecords,
};
use crate::optimise::non_negative::Penalty;
use crate::options::classical::{ClassicalModel, ClassicalOptions, Sign};
use crate::options::fit_spec::AutoOptions;
use crate::options::input_options::{HISTORY_INPUTS, InputOptions};
use crate::stop_check::StopCheck;
use crate::validation::RowFolds;

/// A fitted network of random stops.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomStops {
    /// The network, in scaled units.
    pub network: Network,
    /// Scale factors between the user's units and the network's.
    pub scaling: Scaling,
    /// Root mean square error on held-out rows, in percent of the standard deviation: geometric mean over the folds.
    pub validation_nrmse_percent: f64,
}

/// Tanh neurons, where cross-validation finds them better than none. Designed.
const HIDDEN: usize = 100;

/// From stops that are soon dead to such as hardly wear. Designed.
const CAPACITIES: Capacities = Capacities { typical: 300.0, spread: 2.0 };

/// Candidates with a linear readout, and with a random tanh layer: stops and tanh neurons. Designed.
const LINEAR: (usize, usize) = (300, 0);
const LAYERED: (usize, usize) = (100, 100);

/// The peak memory of a fit with these options to data of this size.
pub(super) fn memory_need(data: &Dataset, options: &ClassicalOptions, size: &LawFitSize) -> MemoryNeed {
    let inputs = data.names().inputs.len() + if options.shaping.history { HISTORY_INPUTS } else { 0 };
    let (stops, hidden) = (options.operators(), options.hidden.unwrap_or(HIDDEN));
    let features = (stops + hidden + 3) as f64;
    let weights = (hidden * stops) as f64;
    let need = size.of_least_squares(features, stops);
    need.and(600.0 * (features + weights / 10.0) + size.rows * (inputs + 4) as f64)
}

/// The candidates of `auto`, the quickest first.
pub(super) fn candidates(model: ClassicalModel, options: &AutoOptions) -> Vec<RankedLaw> {
    let as_it_is = InputOptions::default();
    let rate = options.rate;
    let mut all = vec![(as_it_is, None, false, LINEAR), (compressed(COMPRESSION[0]), None, false, LINEAR)];
    all.extend(match rate.is_some() {
        true => [(with_compressed_rate(), rate, false, LINEAR), (as_it_is, rate, true, LAYERED)],
        false => [(as_it_is, None, true, LINEAR), (as_it_is, None, true, LAYERED)],
    });
    let of = |(shaping, rate, deterioration, (stops, hidden))| ClassicalOptions {
        rate,
        shaping,
        deterioration: Some(deterioration),
        operators: Some(options.operators.unwrap_or(stops)),
        hidden: Some(hidden),
        seed: options.seed,
        ..ClassicalOptions::of(model)
    };
    all.into_iter().map(of).enumerate().collect()
}

/// Fits random stops. Cross-validation chooses whether they deteriorate, and no tanh neurons or 100, where the options
/// do not say. Asked to stop, it is the best architecture so far, its penalty chosen by fewer folds.
///
/// # Errors
/// Data from which no model can be identified, invalid options, a rate that cannot be computed.
pub fn fit_random_stops(
    data: &Dataset,
    options: &ClassicalOptions,
    stop: StopCheck<'_>,
) -> Result<RandomStops> {
    data.check_identifiable(FEWEST_ROWS)?;
    let scaling = Scaling::of(data, options.rate)?;
    let mut best: Option<RandomStops> = None;
    let deteriorations = options.deterioration.map_or(vec![false, true], |one| vec![one]);
    let hidden = options.hidden.map_or(vec![0, HIDDEN], |one| vec![one]);
    let candidates = deteriorations
        .iter()
        .flat_map(|&deterioration| hidden.iter().map(move |&hidden| (deterioration, hidden)));
    for (deterioration, hidden) in candidates {
        if best.is_some() && stop.is_asked() {
            break;
        }
        let architecture = architecture(data, options, deterioration, hidden)?;
        let candidate = match fit_readout(data, options, &scaling, architecture, stop) {
            Err(Error::Stopped) if best.is_some() => break,
            candidate => candidate?,
        };
        let is_better =
            |best: &RandomStops| candidate.validation_nrmse_percent < best.validation_nrmse_percent;
        if best.as_ref().is_none_or(is_better) {
            best = Some(candidate);
        }
    }
    Ok(best.expect("at least one candidate"))
}

pub(crate) struct DrawnStops {
    architecture: Architecture,
    parameters: Vec<f64>,
}

impl DrawnStops {
    /// The stops for these data, with the first of the architectures that the options leave open.
    pub fn of(data: &Dataset, options: &ClassicalOptions) -> Result<Self> {
        let (deterioration, hidden) = (options.deterioration.unwrap_or(false), options.hidden.unwrap_or(0));
        let architecture = architecture(data, options, deterioration, hidden)?;
        let parameters = drawn(&architecture, options.seed);
        Ok(Self { architecture, parameters })
    }

    /// Number of output weights.
    pub fn features(&self) -> usize {
        self.architecture.output_weights()
    }

    /// The features of the output layer and then the target, column by column, of the rows with an output.
    pub fn rows(
        &self,
        record: &Record,
        scaling: &Scaling,
        rate: Option<RateMethod>,
        stop: StopCheck<'_>,
    ) -> Result<Vec<Vec<f64>>> {
        let Self { architecture, parameters } = self;
        let drives = [scaling.drive(record, architecture, rate)?];
        let targets = [scaling.target(record)];
        let columns = JacobianColumns { architecture, parameters, output: None };
        let rows = RowsOverRecords { columns, first: 0, drives: &drives, targets: &targets, stop }.columns();
        if stop.is_asked() { Err(Error::Stopped) } else { Ok(rows) }
    }
}

fn architecture(
    data: &Dataset,
    options: &ClassicalOptions,
    deterioration: bool,
    hidden: usize,
) -> Result<Architecture> {
    let architecture = Architecture {
        inputs: data.names().inputs.len(),
        rate: options.rate.is_some(),
        stops: options.operators(),
        deterioration,
        linear: true,
        relaxation: 0,
        hidden,
        direct: true,
        constant: true,
    };
    architecture.check()?;
    Ok(architecture)
}

/// Random stops rounded to few digits, because all digits would fill the model file; rounding keeps the bounds.
fn drawn(architecture: &Architecture, seed: u64) -> Vec<f64> {
    let short = |value: f64| format!("{value:.3e}").parse().unwrap_or(value);
    let mut values: Vec<f64> =
        random_start::draw(architecture, CAPACITIES, None, seed).into_iter().map(short).collect();
    ParameterLayout::new(*architecture).clamp(&mut values);
    values
}

fn fit_readout(
    data: &Dataset,
    options: &ClassicalOptions,
    scaling: &Scaling,
    architecture: Architecture,
    stop: StopCheck<'_>,
) -> Result<RandomStops> {
    let used = || data.records().iter().filter(|record| record.scored() > 0);
    let drives: Vec<NetworkDrive> =
        used().map(|record| scaling.drive(record, &architecture, options.rate)).collect::<Result<_>>()?;
    let targets: Vec<Vec<f64>> = used().map(|record| scaling.target(record)).collect();
    let parameters = drawn(&architecture, options.seed);
    let sums = fold_sums(
        &JacobianColumns { architecture: &architecture, parameters: &parameters, output: None },
        &drives,
        &targets,
        &RowFolds::of(data),
        stop,
    )?;

    let features = architecture.output_weights();
    let penalty = Penalty::ridge((0..features).map(|i| f64::from(u8::from(i > 0))));
    let choice = sums.choose(&penalty, &logarithmic(1e-9, 1e-1, 17), Some(Sign::Any), &(0..0), stop);
    let output = sums.weights(&penalty, choice, 0..0, stop)?; // (7.1)
    Ok(RandomStops {
        network: Network::new(architecture, parameters, output)?,
        scaling: scaling.clone(),
        validation_nrmse_percent: 100.0 * exp(0.5 * choice.score),
    })
}

/// Sums of the output layer's features, fold by fold; the memory runs through every row.
fn fold_sums(
    columns: &JacobianColumns,
    drives: &[NetworkDrive],
    targets: &[Vec<f64>],
    folds: &RowFolds,
    stop: StopCheck<'_>,
) -> Result<FoldSums> {
    let of_fold = |fold: usize| {
        let mut rows = 0;
        let masked: Vec<Vec<f64>> = targets
            .iter()
            .zip(&folds.of_rows)
            .map(|(targets, of_rows)| {
                let mask = |(&target, &other): (&f64, &usize)| if other == fold { target } else { f64::NAN };
                targets.iter().zip(of_rows).map(mask).collect()
            })
            .inspect(|masked: &Vec<f64>| rows += masked.iter().filter(|y| !y.is_nan()).count())
            .collect();
        let gram = GramOverRecords { columns: *columns, drives, targets: &masked, stop }.gram();
        Sums::new(gram, columns.count() - 1, rows as f64)
    };
    let sums = FoldSums::new((0..folds.count).map(of_fold).collect(), folds.judged.clone());
    if stop.is_asked() { Err(Error::Stopped) } else { Ok(sums) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With few digits `ln 0.3` is out of its bounds: every fourth of these seeds drew such a stop.
    #[test]
    fn what_is_drawn_is_within_its_bounds() {
        let architecture = Architecture {
            inputs: 1,
            rate: false,
            stops: 200,
            deterioration: true,
            linear: true,
            relaxation: 0,
            hidden: 0,
            direct: true,
            constant: true,
        };
        let layout = ParameterLayout::new(architecture);
        for seed in 0..40 {
            layout.check(&drawn(&architecture, seed)).unwrap();
        }
    }
}
