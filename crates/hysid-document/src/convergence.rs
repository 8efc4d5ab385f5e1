//! Chart of the convergence of a training.

use hysid_core::model::history::{HistoryPoint, Phase, Run};
use hysid_core::options::network::Method;

use crate::chart::thin::thin;
use crate::chart::{Axis, Chart, Colour, Curve};

const POINTS: usize = 1000;

/// Lowest error on the logarithmic axis, in percent.
const LOWEST_PERCENT: f64 = 1e-6;

/// Error against epoch of the start that became the model, and of the runs on folds; `None` without runs, as
/// for a model that was not found by a search.
pub fn chart(runs: &[Run]) -> Option<Chart> {
    if runs.is_empty() {
        return None;
    }
    let mut curves: Vec<Curve> = runs.iter().map(curve).collect();
    curves.sort_by_key(|curve| curve.colour != Colour::Faint);
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let x = Axis::linear("epoch", points().map(|point| point.0));
    let y = Axis::logarithmic("training error (% of std)", points().map(|point| point.1));
    Some(Chart::on_axes("Training error against epoch", x, y, curves).with_legend(legend(runs)))
}

fn curve(run: &Run) -> Curve {
    let (colour, width) = match (run.phase, run.method) {
        (Phase::Starts, _) => (Colour::Faint, 1.0),
        (Phase::AllData, Method::Genetic) => (Colour::Input, 2.0),
        (Phase::AllData, _) => (Colour::Error, 2.0),
    };
    let point = |p: &HistoryPoint| (p.epoch as f64, p.train_nrmse_percent.max(LOWEST_PERCENT));
    Curve::new(thin(&run.history.iter().map(point).collect::<Vec<_>>(), POINTS), colour, width)
}

fn legend(runs: &[Run]) -> Vec<(Colour, &'static str)> {
    let on_parts = runs.iter().any(|run| run.phase == Phase::Starts);
    let mut legend: Vec<(Colour, &str)> =
        on_parts.then_some((Colour::Faint, "on parts of the data")).into_iter().collect();
    legend.extend(runs.iter().filter(|run| run.phase == Phase::AllData).map(|run| match run.method {
        Method::Genetic => (Colour::Input, "on all data: genetic algorithm"),
        Method::Subgradient => (Colour::Error, "sub-gradient method"),
        Method::LevenbergMarquardt | Method::LeastSquares => (Colour::Error, "on all data"),
    }));
    legend
}
