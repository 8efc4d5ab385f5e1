//! Compensation: each actuator driven along wanted outputs that no training record resembles, by a straight line, by
//! the inverse of the best classical model, by that of the default model, and by a model of the inverse.

mod page;
mod references;
mod specimens;

use std::ops::ControlFlow;

use hysid::data::record::{Dataset, Record};
use hysid::fit::cross_validate;
use hysid::options::chosen::RateChoice;
use hysid::options::classical::{ClassicalModel, ClassicalOptions};
use hysid::options::{FitSpec, ModelName};
use hysid::{Model, Reference, Result};

use crate::chapter::Chapter;
use crate::conditions::{Observer, Settings};
use crate::fitting::{fit, rival};
use references::{Shape, shapes};
use specimens::{ACTUATORS, Actuator, ROWS};

/// Share of the trained output range that a wanted output covers, about its middle. Designed.
const SHARE: f64 = 0.8;

/// Epochs of the network of a quick run.
const QUICK_EPOCHS: usize = 20;

/// Folds by which the classical model is chosen.
const FOLDS: usize = 5;

/// Classical models of actuators; the best is chosen by cross-validation.
const CLASSICAL: [ClassicalModel; 8] = [
    ClassicalModel::PrandtlIshlinskii,
    ClassicalModel::ModifiedPrandtlIshlinskii,
    ClassicalModel::GeneralizedPrandtlIshlinskii,
    ClassicalModel::RateDependentPrandtlIshlinskii,
    ClassicalModel::Preisach,
    ClassicalModel::Masing,
    ClassicalModel::BoucWen,
    ClassicalModel::JilesAtherton,
];

/// How the input of a wanted output is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    /// By the straight line through the training data: no compensation.
    Line,
    /// By the inverse of the best classical model.
    Classical,
    /// By the inverse of the default model.
    Inverse,
    /// By a default model of exchanged input and output.
    Direct,
}

impl Way {
    const ALL: [Self; 4] = [Self::Line, Self::Classical, Self::Inverse, Self::Direct];
}

/// What came of one way.
struct Tracking {
    way: Way,
    /// RMS deviation of the specimen's output from the wanted one over the second period, in the unit of the output.
    rms: f64,
    /// That of the model itself, and the share of rows it reached, where a model was inverted.
    of_model: Option<(f64, f64)>,
    /// How far the search looked ahead, in s.
    preview: f64,
    /// The specimen's output over the second period.
    output: Vec<f64>,
}

/// The input of a wanted output.
struct Drive {
    input: Vec<f64>,
    /// See [`Tracking`].
    of_model: Option<(f64, f64)>,
    preview: f64,
}

impl Drive {
    fn without_search(input: Vec<f64>) -> Self {
        Self { input, of_model: None, preview: 0.0 }
    }
}

/// One wanted output of one actuator.
struct Course {
    shape: &'static str,
    wanted: Vec<f64>,
    tracked: Vec<Tracking>,
}

impl Course {
    fn of(&self, way: Way) -> &Tracking {
        self.tracked.iter().find(|tracking| tracking.way == way).expect("every way was gone")
    }

    /// How many times smaller the deviation is than without compensation.
    fn gain(&self, way: Way) -> f64 {
        self.of(Way::Line).rms / self.of(way).rms
    }
}

/// One actuator.
struct Compensated {
    actuator: &'static Actuator,
    /// Name of the best classical model, and its error on the folds in percent of the standard deviation.
    classical: (String, f64),
    /// The range of the output in training.
    range: f64,
    courses: Vec<Course>,
}

/// Runs the experiment.
pub fn chapter(settings: Settings, observer: &dyn Observer) -> Result<Chapter> {
    // A quick run has the actuators that are fitted soonest.
    let actuators = if settings.quick { &ACTUATORS[..1] } else { &ACTUATORS[..] };
    let all = actuators.iter().map(|actuator| compensated(actuator, settings, observer));
    Ok(page::chapter(&all.collect::<Result<Vec<_>>>()?))
}

fn compensated(
    actuator: &'static Actuator,
    settings: Settings,
    observer: &dyn Observer,
) -> Result<Compensated> {
    let train = actuator.specimen().train();
    let began = observer.clock();
    let (classical, name, error) = best_classical(&train, settings, observer)?;
    let ours = fit(&train, &default_model(&train, settings), observer)?;
    let exchanged = train.exchanged()?;
    let direct = fit(&exchanged, &default_model(&exchanged, settings), observer)?;
    let (low, high) = ours.trained_ranges().output;
    let time: Vec<f64> = (0..2 * ROWS).map(|row| actuator.period * row as f64 / ROWS as f64).collect();
    let course = |shape: &Shape| -> Result<Course> {
        let level = |value: &f64| 0.5 * (low + high) + 0.5 * SHARE * (high - low) * value;
        let wanted: Vec<f64> = shape.values.iter().chain(&shape.values).map(level).collect();
        let reference = Reference { wanted: &wanted, others: &[], time: Some(&time) };
        let limits = ours.trained_ranges().inputs[0];
        let track = |way: Way| -> Result<Tracking> {
            let Drive { input, of_model, preview } = match way {
                Way::Line => Drive::without_search(line(&train, &wanted, limits)),
                Way::Classical => inverted(&classical, &reference)?,
                Way::Inverse => inverted(&ours, &reference)?,
                Way::Direct => Drive::without_search(simulated(&direct, &reference, limits)?),
            };
            let output = (actuator.response)(&time, &input)[ROWS..].to_vec();
            Ok(Tracking { way, rms: rms(&output, &wanted[ROWS..]), of_model, preview, output })
        };
        let tracked = Way::ALL.into_iter().map(track).collect::<Result<_>>()?;
        Ok(Course { shape: shape.name, wanted: wanted[ROWS..].to_vec(), tracked })
    };
    let courses = shapes(ROWS).iter().map(course).collect::<Result<_>>()?;
    observer.say(&format!(
        "  inverse, {}: {:.1} s; best classical model {name}",
        actuator.name,
        (observer.clock() - began).as_secs_f64()
    ));
    Ok(Compensated { actuator, classical: (name, error), range: high - low, courses })
}

/// `auto`; a network of few epochs in a quick run.
fn default_model(data: &Dataset, settings: Settings) -> FitSpec {
    let name = if settings.quick { "xpnn+" } else { "auto" };
    let model = name.parse::<ModelName>().expect("a model");
    let rate = RateChoice::Auto.method(model, data.has_time());
    match FitSpec::of(model, rate, settings.seed) {
        FitSpec::Network(mut options) => {
            (options.starts, options.epochs) = (1, QUICK_EPOCHS);
            FitSpec::Network(options)
        }
        spec => spec,
    }
}

/// The classical model with the lowest error on the folds, its name and that error.
fn best_classical(
    train: &Dataset,
    settings: Settings,
    observer: &dyn Observer,
) -> Result<(Model, String, f64)> {
    let mut best: Option<(FitSpec, f64)> = None;
    let models = if settings.quick { &CLASSICAL[..2] } else { &CLASSICAL[..] };
    for &model in models {
        let name = ModelName::Classical(model);
        let rate = RateChoice::Auto.method(name, train.has_time());
        let options = ClassicalOptions { rate, seed: settings.seed, ..ClassicalOptions::of(model) };
        let request = rival(FitSpec::Classical(options), settings);
        if request.model().check_data(train, request.rate()).is_err() {
            continue;
        }
        let validated = cross_validate(train, &request, FOLDS, &mut |_| match observer.is_stopped() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })?;
        if observer.is_stopped() {
            return Err(hysid::Error::Stopped);
        }
        let error = validated.unseen_nrmse_std_percent.unwrap_or(f64::INFINITY);
        if best.as_ref().is_none_or(|(_, least)| error < *least) {
            best = Some((request, error));
        }
    }
    let (request, error) = best.expect("classical models fit these data");
    Ok((fit(train, &request, observer)?, request.label(), error))
}

/// The inputs of the straight line through the training data, within the trained range.
fn line(train: &Dataset, wanted: &[f64], (low, high): (f64, f64)) -> Vec<f64> {
    let pairs = || {
        let records = train.records().iter();
        let rows = records.flat_map(|record| record.inputs()[0].iter().zip(record.output()));
        rows.filter(|(_, y)| !y.is_nan())
    };
    let count = pairs().count() as f64;
    let mean_x = pairs().map(|(x, _)| x).sum::<f64>() / count;
    let mean_y = pairs().map(|(_, y)| y).sum::<f64>() / count;
    let covariance: f64 = pairs().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let variance: f64 = pairs().map(|(x, _)| (x - mean_x).powi(2)).sum();
    let slope = covariance / variance;
    wanted.iter().map(|wanted| (mean_x + (wanted - mean_y) / slope).clamp(low, high)).collect()
}

/// The inputs by the inverse of a model.
fn inverted(model: &Model, reference: &Reference<'_>) -> Result<Drive> {
    let inverse = model.inverse();
    let preview = inverse.best_preview(reference)?;
    let found = inverse.preview(preview)?.run(reference)?;
    let reached = found.count(hysid::Reach::Reached) as f64 / found.input.len() as f64;
    let of_model = Some((rms(&found.output[ROWS..], &reference.wanted[ROWS..]), reached));
    Ok(Drive { input: found.input, of_model, preview })
}

/// The outputs of a model of the inverse, within the trained range of the input.
fn simulated(direct: &Model, reference: &Reference<'_>, (low, high): (f64, f64)) -> Result<Vec<f64>> {
    let blank = vec![f64::NAN; reference.wanted.len()];
    let mut record = Record::new("reference", vec![reference.wanted.to_vec()], blank)?;
    if let Some(time) = reference.time {
        record = record.with_time(time.to_vec())?;
    }
    let input = direct.simulate(&record)?;
    Ok(input.into_iter().map(|x| x.clamp(low, high)).collect())
}

fn rms(found: &[f64], wanted: &[f64]) -> f64 {
    let sum: f64 = found.iter().zip(wanted).map(|(found, wanted)| (found - wanted).powi(2)).sum();
    (sum / wanted.len() as f64).sqrt()
}
