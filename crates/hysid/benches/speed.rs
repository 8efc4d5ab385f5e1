//! How fast the parts are. The sizes stand in the names.

mod inputs;

use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use hysid::fit::network::fit;
use hysid::fit::network::objective::Objective;
use hysid::operator::{DeterioratingStop, Operator, Play, Relaxation, Stop};
use hysid::optimise::levenberg_marquardt::LevenbergMarquardt;
use hysid::options::network::{FitOptions, Trainer};
use hysid_core::network::Family;
use hysid_core::network::scaling::Scaling;

use inputs::{data, network, options, parameters, path, xpnn};

fn group<'c>(criterion: &'c mut Criterion, name: &str) -> BenchmarkGroup<'c, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_secs(1)).sample_size(30);
    group
}

fn operators(criterion: &mut Criterion) {
    const ROWS: usize = 10_000;
    let x = path(ROWS);
    let time: Vec<f64> = (0..ROWS).map(|k| 0.1 * k as f64).collect();
    let mut group = group(criterion, "operators");
    group.throughput(Throughput::Elements(ROWS as u64));
    let mut play = Play::new(0.3).unwrap();
    group.bench_function("play_10000", |b| b.iter(|| play.run(black_box(&x))));
    let mut stop = Stop::new(0.3).unwrap();
    group.bench_function("stop_10000", |b| b.iter(|| stop.run(black_box(&x))));
    let mut stop = DeterioratingStop::new(0.3, 1e4).unwrap();
    group.bench_function("deteriorating_stop_10000", |b| b.iter(|| stop.run(black_box(&x))));
    let mut element = Relaxation::new(2.0).unwrap();
    group.bench_function("relaxation_10000", |b| b.iter(|| element.run(black_box(&time), &x).unwrap()));
}

fn simulation(criterion: &mut Criterion) {
    const ROWS: usize = 100_000;
    let x = path(ROWS);
    let mut y = vec![0.0; ROWS];
    let mut group = group(criterion, "simulation");
    group.throughput(Throughput::Elements(ROWS as u64));
    for (name, architecture) in [
        ("run_100000x10x10_deteriorating", xpnn(10, 10, true)),
        ("run_100000x10x10", xpnn(10, 10, false)),
        ("run_100000x40x40_deteriorating", xpnn(40, 40, true)),
    ] {
        let mut simulator = network(architecture).simulator();
        group.bench_function(name, |b| {
            b.iter(|| {
                simulator.reset();
                simulator.run(&[black_box(&x)], &[], &mut y);
                y[ROWS - 1]
            })
        });
    }
    group.throughput(Throughput::Elements(1));
    let mut simulator = network(xpnn(10, 10, true)).simulator();
    let mut k = 0;
    group.bench_function("step_10x10_deteriorating", |b| {
        b.iter(|| {
            k = (k + 1) % ROWS;
            simulator.step(black_box(&x[k..k + 1]), 0.0)
        })
    });
}

fn jacobian(criterion: &mut Criterion) {
    let (data, architecture) = (data(2000), xpnn(10, 10, true));
    let scaling = Scaling::of(&data, None).unwrap();
    let objective = Objective::new(&data, &scaling, architecture, &options()).unwrap();
    let parameters = parameters(architecture, 2);
    let value = objective.value(&parameters);
    let mut group = group(criterion, "jacobian");
    group.throughput(Throughput::Elements(2000));
    group.bench_function("value_2000x10x10", |b| b.iter(|| objective.value(black_box(&parameters))));
    group.bench_function("gradient_2000x10x10", |b| {
        b.iter(|| objective.gradient(black_box(&parameters), &value))
    });
    group.bench_function("levenberg_marquardt_iteration_2000x10x10", |b| {
        b.iter_batched(
            || LevenbergMarquardt::new(&objective, parameters.clone()),
            |mut descent| descent.advance(&objective),
            BatchSize::SmallInput,
        )
    });
}

/// Steps of the paper's training.
fn paper(criterion: &mut Criterion) {
    let data = data(2000);
    let mut group = group(criterion, "paper");
    group.sample_size(10);
    for (name, training, population) in [
        ("genetic_50_generations_of_50_2000x10x10", Trainer::Genetic, 50),
        ("subgradient_50_iterations_2000x10x10", Trainer::Subgradient, 50),
    ] {
        let sizes = options().sizes;
        let defaults = FitOptions::of(training);
        let limits = FitOptions { population, starts: 1, epochs: 50, stall: 0, ..defaults };
        let options = FitOptions { model: Family::Xpnn, sizes, ..limits };
        group.bench_function(name, |b| {
            b.iter(|| fit(&data, &options, &mut |_| ControlFlow::Continue(())).unwrap())
        });
    }
}

fn training(criterion: &mut Criterion) {
    let data = data(2000);
    let options = options();
    let mut group = group(criterion, "training");
    group.sample_size(10);
    let name = format!("fit_2000x10x10_{}_starts_{}_epochs", options.starts, options.epochs);
    group.bench_function(name, |b| {
        b.iter(|| fit(&data, &options, &mut |_| ControlFlow::Continue(())).unwrap())
    });
}

criterion_group!(benches, operators, simulation, jacobian, paper, training);
criterion_main!(benches);
