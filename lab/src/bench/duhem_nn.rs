//! Speed of the Duhem neural network.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Instant;

use anyhow::{Context, Result};
use hysid::data::rate::RateMethod;
use hysid::data::record::Dataset;
use hysid::fit::identify;
use hysid::law::Classical;
use hysid::law::duhem_nn::{CellLayout, CellRun, DuhemNn};
use hysid::law::series::Series;
use hysid::model::{Model, Predictor};
use hysid::options::FitSpec;
use hysid::options::classical::{ClassicalModel, ClassicalOptions};
use hysid_core::stop_check::StopCheck;

use super::spread::Spread;
use super::{FITS, RUNS};

/// A network of the default sizes with rate and time.
pub(super) struct Network {
    model: Model,
    /// Seconds of the fit from one start.
    pub fit_s: Spread,
}

impl Network {
    pub fn fitted(data: &Dataset) -> Result<Self> {
        let options = ClassicalOptions {
            rate: Some(RateMethod::Central),
            starts: Some(1),
            ..ClassicalOptions::of(ClassicalModel::DuhemNn)
        };
        let mut model = None;
        let fit_s = Spread::over(FITS, || {
            let began = Instant::now();
            let spec = FitSpec::Classical(options.clone());
            model = Some(identify(data, &spec, &mut |_| ControlFlow::Continue(()))?.model);
            Ok(began.elapsed().as_secs_f64())
        })?;
        Ok(Self { model: model.context("there was a fit")?, fit_s })
    }

    pub fn model(&self) -> &Model {
        &self.model
    }

    fn law(&self) -> Result<&DuhemNn> {
        match self.model.predictor() {
            Predictor::Law(Classical::DuhemNn(law)) => Some(law),
            _ => None,
        }
        .context("a Duhem neural network was fitted")
    }

    /// Its parts, in a few words.
    pub fn parts(&self) -> Result<String> {
        let shape = self.law()?.cell.shape();
        let parameters = CellLayout::new(shape).count();
        Ok(format!(
            "duhem-nn, {} states, {} stops, {} hidden, rate and time, {parameters} searched parameters",
            shape.states, shape.stops, shape.neurons
        ))
    }

    /// Nanoseconds a sample of the exact derivatives by all searched parameters, and of their Gram matrix over all
    /// samples besides.
    pub fn jacobian_ns(&self, data: &Dataset) -> Result<(Spread, Spread)> {
        let law = self.law()?;
        let series = Series::all(data, Some(RateMethod::Central))?;
        let drives: Vec<Vec<_>> = series
            .iter()
            .map(|series| series.samples.iter().map(|&sample| law.scaled(sample)).collect())
            .collect();
        let targets = |y: f64| -> Vec<Vec<f64>> { drives.iter().map(|drive| vec![y; drive.len()]).collect() };
        let (none, all) = (targets(f64::NAN), targets(0.5));
        let pass = |targets: &[Vec<f64>]| {
            let run = CellRun {
                cell: &law.cell,
                drives: &drives,
                further: &[],
                initial: &[],
                targets,
                with_jacobian: true,
                stop: StopCheck::never(),
            };
            let began = Instant::now();
            black_box(black_box(run).gram());
            1e9 * began.elapsed().as_secs_f64() / data.rows() as f64
        };
        let (mut derivatives, mut gram) = (Vec::new(), Vec::new());
        for _ in 0..RUNS {
            let without = pass(&none);
            derivatives.push(without);
            gram.push(pass(&all) - without);
        }
        Ok((Spread::of(derivatives), Spread::of(gram)))
    }
}
