//! Loops, and how the training converged.

use hysid::data::record::Record;
use hysid::model::history::{Phase, Run};
use hysid::model::{Model, Provenance};
use hysid::options::Request;
use hysid::options::network::Method;

use super::{ReportSet, unit};
use crate::page::{count, figure, note, section};
use crate::plot::thin::{thin, thin_path};
use crate::plot::{Axis, Chart, Colour, Curve};

/// Points of all curves of a colour together in a chart of loops.
const LOOP_POINTS: usize = 6000;

/// Most records drawn into one chart.
const MOST_RECORDS: usize = 200;

/// Most small charts, one a record.
const MOST_MULTIPLES: usize = 12;

/// Lowest error on the logarithmic axis, in percent.
const LOWEST_PERCENT: f64 = 1e-6;

/// Charts of a set's loops.
pub fn loops_section(set: &ReportSet) -> String {
    let records = set.data.records();
    let mut content = format!("<div class=\"charts\">\n{}</div>\n", figure(&loops(set), false));
    if (2..=MOST_MULTIPLES).contains(&records.len()) {
        let charts: String =
            (0..records.len()).map(|index| figure(&record_loops(set, index), false)).collect();
        content += &format!("<h3>Record by record</h3>\n<div class=\"charts small\">\n{charts}</div>\n");
    }
    if records.len() > MOST_RECORDS {
        content += &note(&format!("{MOST_RECORDS} of {} are drawn.", count(records.len(), "record")));
    }
    let fewest = record_points(set).min(LOOP_POINTS / records.len());
    if records.iter().any(|record| record.len() > fewest) {
        content += &note(
            "Where a path is too long to be drawn whole, stretches from its beginning to its end stand for it.",
        );
    }
    if set.data.names().inputs.len() > 1 {
        content += &note("The model has further inputs, which these charts do not show.");
    }
    section(&format!("Loops: {} data", set.name), &content)
}

/// All records of a set in one chart.
pub fn loops(set: &ReportSet) -> String {
    let records = set.data.records();
    let every = records.len().div_ceil(MOST_RECORDS).max(1);
    let shown: Vec<usize> = (0..records.len()).step_by(every).collect();
    loop_chart(set, &shown, (560.0, 400.0), String::new(), LOOP_POINTS)
}

/// All records of a set in one small chart.
pub fn small_loops(set: &ReportSet, title: String) -> String {
    let every = set.data.records().len().div_ceil(MOST_RECORDS).max(1);
    let shown: Vec<usize> = (0..set.data.records().len()).step_by(every).collect();
    loop_chart(set, &shown, (400.0, 290.0), title, LOOP_POINTS / 2)
}

/// Points of a colour in the chart of a single record.
fn record_points(set: &ReportSet) -> usize {
    (3 * LOOP_POINTS / 2 / set.data.records().len()).min(LOOP_POINTS)
}

fn record_loops(set: &ReportSet, index: usize) -> String {
    let title = set.data.records()[index].name().to_string();
    loop_chart(set, &[index], (400.0, 290.0), title, record_points(set))
}

fn loop_chart(set: &ReportSet, shown: &[usize], size: (f64, f64), title: String, points: usize) -> String {
    let names = set.data.names();
    let most = (points / shown.len().max(1)).max(16);
    let (mut all, simulated): (Vec<Curve>, Vec<Curve>) =
        shown.iter().map(|&index| loop_curves(set, index, most)).unzip();
    all.extend(simulated);
    let (x, y) = (unit::label(&names.inputs[0]), unit::label(&names.output));
    let legend = [(Colour::Measured, "measured"), (Colour::Simulated, "model")];
    let of = if title.is_empty() { format!("{} data", set.name) } else { title.clone() };
    Chart {
        labels: Vec::new(),
        description: format!("Loops of {y} over {x}, measured and simulated: {of}"),
        legend: if title.is_empty() {
            legend.map(|(colour, name)| (colour, name.to_string())).into()
        } else {
            vec![]
        },
        title,
        size,
        x: Axis::linear(x, all.iter().flat_map(|curve| &curve.points).map(|point| point.0)),
        y: Axis::linear(y, all.iter().flat_map(|curve| &curve.points).map(|point| point.1)),
        curves: all,
    }
    .svg()
}

/// Measured and simulated loops of a record, the same rows of both.
fn loop_curves(set: &ReportSet, index: usize, most: usize) -> (Curve, Curve) {
    let record = &set.data.records()[index];
    let rows = scored_rows(record);
    let x = &record.inputs()[0][rows.clone()];
    let (measured, simulated) = (&record.output()[rows.clone()], &set.simulated[index][rows]);
    let drawn = thin_path(&[x, measured, simulated], most);
    let curve = |colour: Colour, width: f64, y: &[f64]| {
        let point = |row: &Option<usize>| row.map_or((f64::NAN, f64::NAN), |row| (x[row], y[row]));
        Curve { points: drawn.iter().map(point).collect(), colour, width }
    };
    (curve(Colour::Measured, 2.2, measured), curve(Colour::Simulated, 1.1, simulated))
}

/// From the first row with an output to the last; all rows if no row has one.
fn scored_rows(record: &Record) -> std::ops::Range<usize> {
    let output = record.output();
    let first = output.iter().position(|y| !y.is_nan());
    let last = output.iter().rposition(|y| !y.is_nan());
    first.zip(last).map_or(0..record.len(), |(first, last)| first..last + 1)
}

/// How the training converged, with words; empty for a model that was not searched for.
pub fn convergence_section(model: &Model) -> String {
    let Some(chart) = convergence(model) else { return String::new() };
    section("Convergence", &(figure(&chart, true) + &note(&convergence_words(model.provenance()))))
}

/// Error against epoch of the start that became the model, and of those on the folds; `None` for a model that
/// was not searched for.
pub fn convergence(model: &Model) -> Option<String> {
    let provenance = model.provenance();
    if provenance.runs.is_empty() {
        return None;
    }
    let mut curves: Vec<Curve> = Vec::new();
    for run in &provenance.runs {
        let (colour, width) = match (run.phase, run.method) {
            (Phase::Starts, _) => (Colour::Faint, 1.0),
            (Phase::AllData, Method::Genetic) => (Colour::Input, 2.0),
            (Phase::AllData, _) => (Colour::Error, 2.0),
        };
        let point = |p: &hysid::model::history::HistoryPoint| {
            (p.epoch as f64, p.train_nrmse_percent.max(LOWEST_PERCENT))
        };
        curves.push(Curve {
            points: thin(&run.history.iter().map(point).collect::<Vec<_>>(), 1000),
            colour,
            width,
        });
    }
    curves.sort_by_key(|curve| curve.colour != Colour::Faint);
    let chart = Chart {
        labels: Vec::new(),
        description: "Training error against epoch".into(),
        title: String::new(),
        size: (860.0, 300.0),
        x: Axis::linear("epoch", curves.iter().flat_map(|curve| &curve.points).map(|point| point.0)),
        y: Axis::logarithmic(
            "training error (% of std)",
            curves.iter().flat_map(|curve| &curve.points).map(|point| point.1),
        ),
        curves,
        legend: convergence_legend(&provenance.runs),
    };
    Some(chart.svg())
}

fn convergence_legend(runs: &[Run]) -> Vec<(Colour, String)> {
    let mut legend = Vec::new();
    if runs.iter().any(|run| run.phase == Phase::Starts) {
        legend.push((Colour::Faint, "on parts of the data".to_string()));
    }
    for run in runs.iter().filter(|run| run.phase == Phase::AllData) {
        legend.push(match run.method {
            Method::Genetic => (Colour::Input, "on all data: genetic algorithm".to_string()),
            Method::Subgradient => (Colour::Error, "sub-gradient method".to_string()),
            Method::LevenbergMarquardt | Method::LeastSquares => (Colour::Error, "on all data".to_string()),
        });
    }
    legend
}

fn convergence_words(provenance: &Provenance) -> String {
    let on_all_data = provenance.runs.iter().filter(|run| run.phase == Phase::AllData);
    let mut words = match (&provenance.options, provenance.options.starts()) {
        (Request::Network(_), starts) if starts > 1 => format!(
            "Of {} on all data, number {} has the lowest error. ",
            count(starts, "random start"),
            provenance.chosen_start + 1,
        ),
        _ => String::new(),
    };
    for run in on_all_data {
        let what = match run.method {
            Method::LevenbergMarquardt | Method::LeastSquares => continue,
            Method::Genetic => "Genetic algorithm",
            Method::Subgradient => "Sub-gradient method with space dilatation",
        };
        let (first, last) = (run.history.first(), run.history.last());
        let epochs = first.zip(last).map_or(0, |(first, last)| last.epoch - first.epoch);
        words += &format!("{what}: {}, {}. ", count(epochs, "epoch"), run.termination);
    }
    let evaluations = provenance.runs.iter().filter(|run| run.phase == Phase::AllData);
    let evaluations = evaluations.flat_map(|run| run.history.last()).map(|point| point.evaluations).max();
    words += &match evaluations {
        Some(n) if n > 0 => format!("The objective was evaluated {n} times on all data. "),
        _ => String::new(),
    };
    words + &format!("The training ended: {}.", provenance.termination)
}
