//! `compensation`: actuators driven along wanted outputs that no training record resembles, by a straight line, by the
//! inverse of the best classical model, by that of the default model, and by a model of the inverse.

mod references;
mod specimens;

use std::ops::ControlFlow;
use std::time::Instant;

use anyhow::Result;
use hysid::Model;
use hysid::data::record::{Dataset, Record};
use hysid::fit::{cross_validate, identify};
use hysid::model::Reference;
use hysid::options::chosen::RateChoice;
use hysid::options::classical::{ClassicalModel, ClassicalOptions};
use hysid::options::{FitSpec, ModelName};
use hysid_core::elementary::square;

use crate::cases::{aligned, row};
use references::{Shape, shapes};
use specimens::{ACTUATORS, Actuator, ROWS};

/// Share of the trained output range that a wanted output covers, about its middle. Designed.
const SHARE: f64 = 0.8;

/// Seed of all fits.
const SEED: u64 = 1;

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

/// Result of one way.
struct Tracking {
    way: Way,
    /// RMS deviation of the specimen's output from the wanted one over the second period, in the unit of the output.
    rms: f64,
    /// RMS deviation of the model itself, and the share of rows it reached, where a model was inverted.
    of_model: Option<(f64, f64)>,
    /// How far the search looked ahead, in s.
    preview: f64,
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

/// Runs the command.
pub fn run() -> Result<()> {
    let all = ACTUATORS.iter().map(compensated).collect::<Result<Vec<_>>>()?;
    println!("{}\n\n{}", deviations(&all), models(&all));
    Ok(())
}

fn compensated(actuator: &'static Actuator) -> Result<Compensated> {
    let train = actuator.specimen().train();
    let begun = Instant::now();
    let (classical, name, error) = best_classical(&train)?;
    let ours = fit(&train, &default_model(&train))?;
    let exchanged = train.exchanged()?;
    let direct = fit(&exchanged, &default_model(&exchanged))?;
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
            let output = (actuator.response)(&time, &input);
            Ok(Tracking { way, rms: rms(&output[ROWS..], &wanted[ROWS..]), of_model, preview })
        };
        let tracked = Way::ALL.into_iter().map(track).collect::<Result<_>>()?;
        Ok(Course { shape: shape.name, tracked })
    };
    let courses = shapes(ROWS).iter().map(course).collect::<Result<_>>()?;
    eprintln!("{}: {:.1} s; best classical model {name}", actuator.name, begun.elapsed().as_secs_f64());
    Ok(Compensated { actuator, classical: (name, error), range: high - low, courses })
}

/// `auto` with its defaults.
fn default_model(data: &Dataset) -> FitSpec {
    let rate = RateChoice::Auto.method(ModelName::AUTO, data);
    FitSpec::of(ModelName::AUTO, rate, SEED)
}

fn fit(data: &Dataset, spec: &FitSpec) -> Result<Model> {
    Ok(identify(data, spec, &mut |_| ControlFlow::Continue(()))?.model)
}

/// The classical model with the lowest error on the folds, its name and that error.
fn best_classical(train: &Dataset) -> Result<(Model, String, f64)> {
    let mut best: Option<(FitSpec, f64)> = None;
    for model in CLASSICAL {
        let rate = RateChoice::Auto.method(ModelName::Classical(model), &train);
        let options = ClassicalOptions { rate, seed: SEED, ..ClassicalOptions::of(model) };
        let spec = FitSpec::Classical(options);
        if spec.model().check_data(train, spec.rate()).is_err() {
            continue;
        }
        let validated = cross_validate(train, &spec, FOLDS, &mut |_| ControlFlow::Continue(()))?;
        let error = validated.unseen.nrmse_std_percent.unwrap_or(f64::INFINITY);
        if best.as_ref().is_none_or(|(_, least)| error < *least) {
            best = Some((spec, error));
        }
    }
    let (spec, error) = best.expect("classical models fit these data");
    Ok((fit(train, &spec)?, spec.label(), error))
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
    let variance: f64 = pairs().map(|(x, _)| square(x - mean_x)).sum();
    let slope = covariance / variance;
    wanted.iter().map(|wanted| (mean_x + (wanted - mean_y) / slope).clamp(low, high)).collect()
}

/// The inputs by the inverse of a model.
fn inverted(model: &Model, reference: &Reference<'_>) -> Result<Drive> {
    let inverse = model.inverse();
    let preview = inverse.best_preview(reference)?;
    let found = inverse.preview(preview)?.run(reference)?;
    let reached = found.count(hysid::model::Reach::Reached) as f64 / found.input.len() as f64;
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

/// RMS deviations of the specimen's output from the wanted one, in percent of the range.
fn deviations(all: &[Compensated]) -> String {
    let mut rows = vec![row("specimen", &["wanted output", "line", "classical", "inverse", "direct"])];
    for compensated in all {
        for course in &compensated.courses {
            let cells = Way::ALL.map(|way| {
                let percent = 100.0 * course.of(way).rms / compensated.range;
                match way {
                    Way::Line => format!("{percent:.3}"),
                    _ => format!("{percent:.3} ({:.1})", course.gain(way)),
                }
            });
            let cells = [vec![course.shape.to_owned()], cells.to_vec()].concat();
            rows.push(row(compensated.actuator.name, &cells));
        }
    }
    aligned(&rows)
}

/// The models that were inverted: RMS deviation of the model's own output, in percent of the range.
fn models(all: &[Compensated]) -> String {
    let columns = ["wanted output", "inverted model", "model deviates, %", "rows reached, %", "preview, ms"];
    let mut rows = vec![row("specimen", &columns)];
    for Compensated { actuator, classical: (name, error), range, courses } in all {
        for course in courses {
            for way in [Way::Classical, Way::Inverse] {
                let &Tracking { of_model: Some((deviation, reached)), preview, .. } = course.of(way) else {
                    continue;
                };
                let model = match way {
                    Way::Classical => format!("{name}, {error:.3} % of std on the folds"),
                    _ => "auto".into(),
                };
                let figures = [
                    format!("{:.2e}", 100.0 * deviation / range),
                    format!("{:.2}", 100.0 * reached),
                    format!("{:.3}", 1e3 * preview),
                ];
                rows.push(row(
                    actuator.name,
                    &[vec![course.shape.to_owned(), model], figures.to_vec()].concat(),
                ));
            }
        }
    }
    aligned(&rows)
}

fn rms(found: &[f64], wanted: &[f64]) -> f64 {
    let sum: f64 = found.iter().zip(wanted).map(|(found, wanted)| square(found - wanted)).sum();
    (sum / wanted.len() as f64).sqrt()
}
