//! `bench`: speed on this machine.

mod duhem_nn;
mod spread;

use std::collections::BTreeMap;
use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use clap::Args;
use hysid::data::rate::RateMethod;
use hysid::data::record::{ColumnNames, Dataset, Record};
use hysid::fit::network::fit;
use hysid::fit::network::objective::Objective;
use hysid::fit::progress::Fitted;
use hysid::model::Model;
use hysid::operator::{Operator, Stop};
use hysid::options::network::{FitOptions, Method, Trainer};
use hysid_core::elementary::{powi, sin};
use hysid_core::network::scaling::Scaling;
use hysid_core::network::{Family, Network, Sizes};
use hysid_core::significant::Significant;
use hysid_document::plain::indented;

use spread::Spread;

/// Samples of the simulation.
const SAMPLES: usize = 1_000_000;

/// Samples of the training record.
const TRAINING_SAMPLES: usize = 2000;

/// Evaluations of the objective in a run.
const EVALUATIONS: usize = 200;

/// A speed is the median of this many runs.
const RUNS: usize = 9;

/// The time of a whole fit is the median of this many fits.
const FITS: usize = 3;

/// One measured speed.
#[derive(serde::Serialize)]
struct Speed {
    #[serde(flatten)]
    spread: Spread,
    unit: &'static str,
    setting: String,
}

fn speed(spread: Spread, unit: &'static str, setting: String) -> Speed {
    Speed { spread, unit, setting }
}

impl Speed {
    /// Name, median and spread in a line of at most 80 columns, then the setting.
    fn text(&self, name: &str) -> String {
        let Spread { value, lowest, highest, runs } = self.spread;
        let number = |value| format!("{:.4}", Significant(value));
        let spread = format!("{} to {} in {runs} runs", number(lowest), number(highest));
        format!("{name:<39} {:>7} {:<2} ({spread})\n{}", number(value), self.unit, indented(&self.setting, 4))
    }
}

/// How to print the speeds.
#[derive(Debug, Args)]
pub struct Request {
    /// Print the result as one JSON object
    #[arg(long)]
    json: bool,
    /// Use a narrower instruction set than this machine has: AVX2 or baseline
    #[arg(long, value_name = "SET")]
    instructions: Option<String>,
}

/// Runs the command.
pub fn run(request: &Request) -> Result<()> {
    if let Some(set) = &request.instructions {
        ensure!(hysid_core::simd::narrow_to(set), "no instruction set {set} on this machine");
    }
    let instructions = hysid_core::simd::instruction_set();
    if !request.json {
        eprintln!("measuring, a minute or two (instruction set: {instructions})\n");
    }
    let speeds = speeds(instructions)?;
    let line = |(name, speed): (&&str, &Speed)| speed.text(name);
    match request.json {
        true => println!("{}", serde_json::to_string_pretty(&speeds)?),
        false => print!("{}", speeds.iter().map(line).collect::<String>()),
    }
    Ok(())
}

fn speeds(instructions: &str) -> Result<BTreeMap<&'static str, Speed>> {
    let data = Dataset::new(ColumnNames::plain(1), vec![record(TRAINING_SAMPLES)?])?;
    let options = FitOptions {
        model: Family::Xpnn,
        sizes: Sizes { stops: 10, hidden: 10, relaxation: 0 },
        rate: Some(RateMethod::Central),
        ..FitOptions::default()
    };
    let network = format!("xpnn, 10 stops, 10 hidden, rate, deterioration, {instructions}");

    let fit_s = Spread::over(FITS, || {
        let began = Instant::now();
        fit(&data, &options, &mut |_| ControlFlow::Continue(()))?;
        Ok(began.elapsed().as_secs_f64())
    })?;
    let one_thread =
        rayon::ThreadPoolBuilder::new().num_threads(1).build().context("cannot start a thread")?;
    let (fitted, iteration_ms) = one_thread.install(|| one_start(&data, &options))?;
    let paper = paper_trainer(&data, &options, &fitted)?;
    let recurrent = one_thread.install(|| duhem_nn::Network::fitted(&data))?;
    let parts = format!("{}, {instructions}, 1 thread", recurrent.parts()?);
    let (derivatives, gram) = recurrent.jacobian_ns(&data)?;

    let threads = rayon::current_num_threads();
    let (starts, epochs) = (options.starts, options.epochs);
    Ok(BTreeMap::from([
        (
            "simulate_ns_per_sample",
            speed(
                network_ns(&fitted)?,
                "ns",
                format!("{network}, {SAMPLES} samples, 1 thread, inputs given scaled"),
            ),
        ),
        (
            "simulate_record_ns_per_sample",
            speed(
                record_ns(&fitted.model)?,
                "ns",
                format!("{network}, {SAMPLES} samples, 1 thread, with rates and units"),
            ),
        ),
        ("step_ns", speed(step_ns(&fitted)?, "ns", format!("{network}, sample by sample"))),
        (
            "levenberg_marquardt_iteration_ms",
            speed(iteration_ms, "ms", format!("{network}, {TRAINING_SAMPLES} samples, 1 thread")),
        ),
        (
            "genetic_evaluation_us",
            speed(
                paper.evaluation_us,
                "µs",
                format!(
                    "{network}, {TRAINING_SAMPLES} samples, one individual with its least squares, 1 thread"
                ),
            ),
        ),
        (
            "genetic_generation_ms",
            speed(
                paper.generation_ms,
                "ms",
                format!("{network}, {TRAINING_SAMPLES} samples, 50 individuals, {threads} threads"),
            ),
        ),
        (
            "subgradient_us",
            speed(
                paper.subgradient_us,
                "µs",
                format!("{network}, {TRAINING_SAMPLES} samples, without its evaluation, 1 thread"),
            ),
        ),
        (
            "subgradient_iteration_us",
            speed(
                paper.iteration_us,
                "µs",
                format!(
                    "{network}, {TRAINING_SAMPLES} samples, outer iteration with all its evaluations, 1 thread"
                ),
            ),
        ),
        (
            "hybrid_2000_epochs_s",
            speed(
                paper.hybrid_s,
                "s",
                format!(
                    "{network}, {TRAINING_SAMPLES} samples, 1000 generations of 50 and 1000 outer iterations, {threads} threads"
                ),
            ),
        ),
        (
            "duhem_nn_fit_s",
            speed(recurrent.fit_s, "s", format!("{parts}, {TRAINING_SAMPLES} samples, 1 start")),
        ),
        (
            "duhem_nn_simulate_ns_per_sample",
            speed(
                record_ns(recurrent.model())?,
                "ns",
                format!("{parts}, {SAMPLES} samples, with rates and units"),
            ),
        ),
        (
            "duhem_nn_derivatives_ns_per_sample",
            speed(derivatives, "ns", format!("{parts}, derivatives of the states by all parameters")),
        ),
        (
            "duhem_nn_gram_ns_per_sample",
            speed(gram, "ns", format!("{parts}, derivatives of the output and their Gram matrix, besides")),
        ),
        (
            "fit_s",
            speed(
                fit_s,
                "s",
                format!(
                    "{network}, {TRAINING_SAMPLES} samples, {starts} starts, {epochs} epochs, {threads} threads"
                ),
            ),
        ),
    ]))
}

/// A specimen with memory under a swept, modulated input.
fn record(samples: usize) -> Result<Record> {
    let time: Vec<f64> = (0..samples).map(|k| 0.01 * k as f64).collect();
    let x: Vec<f64> = time.iter().map(|t| sin(3.0 * t) * (0.6 + 0.4 * sin(0.37 * t))).collect();
    let sliders = [0.1, 0.3, 0.7].map(|r| Stop::new(r).map(|mut stop| stop.run(&x)));
    let [a, b, c] = sliders;
    let (a, b, c) = (a?, b?, c?);
    let y = (0..samples).map(|k| a[k] + b[k] + c[k] + 0.1 * powi(x[k], 3)).collect();
    Ok(Record::new("bench", vec![x], y)?.with_time(time)?)
}

/// A fit by Levenberg-Marquardt from one start, and the milliseconds of an iteration, fit by fit.
fn one_start(data: &Dataset, options: &FitOptions) -> Result<(Fitted, Spread)> {
    let defaults = FitOptions::of(Trainer::LevenbergMarquardt);
    let options =
        FitOptions { starts: 1, training: defaults.training, epochs: defaults.epochs, ..options.clone() };
    let mut fitted = None;
    let spread = Spread::over(FITS, || {
        let mut iterations = 0usize;
        let began = Instant::now();
        fitted = Some(fit(data, &options, &mut |progress| {
            iterations = progress.epoch;
            ControlFlow::Continue(())
        })?);
        Ok(1e3 * began.elapsed().as_secs_f64() / iterations.max(1) as f64)
    })?;
    Ok((fitted.context("there was a fit")?, spread))
}

/// Speeds of the paper's training.
struct PaperTrainer {
    evaluation_us: Spread,
    generation_ms: Spread,
    subgradient_us: Spread,
    iteration_us: Spread,
    hybrid_s: Spread,
}

fn paper_trainer(data: &Dataset, options: &FitOptions, fitted: &Fitted) -> Result<PaperTrainer> {
    let scaling = Scaling::of(data, options.rate)?;
    let objective = Objective::new(data, &scaling, options.architecture(data)?, options)?;
    let parameters = network(fitted)?.parameters();
    let value = objective.value(parameters);
    let evaluation_us = ns_of_one(|| {
        for _ in 0..EVALUATIONS {
            black_box(objective.value(black_box(parameters)));
        }
        Ok(EVALUATIONS)
    })?
    .times(1e-3);
    let subgradient_us = ns_of_one(|| {
        for _ in 0..EVALUATIONS {
            black_box(objective.gradient(black_box(parameters), &value));
        }
        Ok(EVALUATIONS)
    })?
    .times(1e-3);
    // The whole training tells the rest: when its first phase ended, and when its second.
    let hybrid = FitOptions { stall: 0, starts: 1, ..FitOptions::of(Trainer::Hybrid) };
    let hybrid = FitOptions { model: options.model, sizes: options.sizes, rate: options.rate, ..hybrid };
    let mut measured: [Vec<f64>; 3] = Default::default();
    for _ in 0..FITS {
        let times = hybrid_training(data, &hybrid)?;
        measured.iter_mut().zip(times).for_each(|(all, one)| all.push(one));
    }
    let [generation_ms, iteration_us, hybrid_s] = measured.map(Spread::of);
    Ok(PaperTrainer { evaluation_us, generation_ms, subgradient_us, iteration_us, hybrid_s })
}

/// A whole training: milliseconds of a generation, microseconds of an outer iteration, seconds of all.
fn hybrid_training(data: &Dataset, hybrid: &FitOptions) -> Result<[f64; 3]> {
    let began = Instant::now();
    let (mut genetic_s, mut generations, mut epochs) = (0.0, 0usize, 0usize);
    fit(data, hybrid, &mut |progress| {
        // Progress is also reported within an epoch.
        epochs = progress.epoch;
        if progress.method == Method::Genetic {
            generations = epochs;
            genetic_s = began.elapsed().as_secs_f64();
        }
        ControlFlow::Continue(())
    })?;
    let hybrid_s = began.elapsed().as_secs_f64();
    Ok([
        1e3 * genetic_s / generations.max(1) as f64,
        1e6 * (hybrid_s - genetic_s) / (epochs - generations).max(1) as f64,
        hybrid_s,
    ])
}

fn network(fitted: &Fitted) -> Result<&Network> {
    fitted.model.network().context("a network was fitted")
}

/// The network alone: scaled inputs and rates in, scaled outputs out.
fn network_ns(fitted: &Fitted) -> Result<Spread> {
    let mut simulator = network(fitted)?.simulator();
    let x = record(SAMPLES)?.inputs()[0].to_vec();
    let rate: Vec<f64> = x.iter().map(|x| 1.0 - x * x).collect();
    let mut y = vec![0.0; SAMPLES];
    ns_of_one(|| {
        simulator.reset();
        simulator.run(black_box(&[&x, &rate]), &[], &mut y);
        black_box(&y);
        Ok(SAMPLES)
    })
}

/// All that a record takes: rates by central differences, units, a new output.
fn record_ns(model: &Model) -> Result<Spread> {
    let record = record(SAMPLES)?;
    ns_of_one(|| {
        black_box(model.simulate(black_box(&record))?);
        Ok(SAMPLES)
    })
}

fn step_ns(fitted: &Fitted) -> Result<Spread> {
    let record = record(SAMPLES / 10)?;
    let time = record.time().context("the record has time stamps")?;
    ns_of_one(|| {
        let mut stepper = fitted.model.stepper();
        for (x, t) in record.inputs()[0].iter().zip(time) {
            black_box(stepper.step(&[*x], *t, None)?);
        }
        Ok(time.len())
    })
}

/// Nanoseconds for one sample, over several runs; a run tells its samples.
fn ns_of_one(mut run: impl FnMut() -> Result<usize>) -> Result<Spread> {
    Spread::over(RUNS, || {
        let began = Instant::now();
        let samples = run()?;
        Ok(1e9 * began.elapsed().as_secs_f64() / samples as f64)
    })
}
