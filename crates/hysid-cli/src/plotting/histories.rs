//! Output, input and error over time, and the error over the input.

use anyhow::Result;
use hysid::data::record::Record;
use hysid::model::Prediction;
use hysid_app::histories::{Panel, difference, error_label};
use hysid_app::tracks::times;
use hysid_app::{MODEL_WIDTH, scored_rows, time_label};
use hysid_document::chart::Track;
use hysid_document::chart::thin::{Point, thin};
use hysid_document::{Chart, Colour, Curve, unit};

use super::PlotData;
use super::curves::{BOTH, alone};
use crate::messages::{Usage, note};

/// Most records that are drawn over time.
const MOST_RECORDS: usize = 4;

const POINTS: usize = 4000;

const MOST_INPUTS: usize = 4;

/// Heights of charts over their width: of the output, of input and error over time, and of the error over the input.
const OUTPUT: f64 = 0.5;
const BELOW: f64 = 0.42;
const OVER_INPUT: f64 = 0.6;

/// Output and input of each record over time.
pub fn histories(subject: &PlotData, width: f64) -> Vec<Chart> {
    let names = subject.data.names();
    let mut charts = Vec::new();
    for (record, predicted) in drawn(subject) {
        let (time, output) = (times(record), unit::label(&names.output));
        let panel = panel(subject, record, &time);
        let simulated = predicted.map(|predicted| predicted.output.as_slice());
        let only = alone(subject);
        let lines: Vec<(Colour, &str, f64, &[f64])> = match (simulated, subject.is_measured()) {
            (Some(simulated), true) => vec![
                (BOTH[0].0, "measured", BOTH[0].1, record.output()),
                (BOTH[1].0, "model", BOTH[1].1, simulated),
            ],
            (Some(simulated), false) => vec![(only, "model", MODEL_WIDTH, simulated)],
            (None, _) => vec![(only, "measured", MODEL_WIDTH, record.output())],
        };
        let band = predicted.filter(|_| subject.band.is_some());
        let band = band.map(|predicted| panel.area(&predicted.low, &predicted.high));
        let is_alone = lines.len() == 1 && band.is_none();
        let chart = panel.chart(&output, OUTPUT * width, &lines, band);
        let chart = if is_alone { Chart { legend: Vec::new(), ..chart } } else { chart };
        let mut of_record = vec![titled(chart, subject, record)];
        for (name, input) in names.inputs.iter().zip(record.inputs()).take(MOST_INPUTS) {
            let line = (Colour::Input, "input", 1.1, &**input);
            let chart = panel.chart(&unit::label(name), BELOW * width, &[line], None);
            of_record.push(Chart { legend: Vec::new(), ..chart });
        }
        let lowest = of_record.len() - 1;
        of_record[..lowest].iter_mut().for_each(|chart| chart.shares_axis = true);
        charts.extend(of_record);
    }
    charts.into_iter().map(|chart| wide(chart, width)).collect()
}

/// Error of each record over time, and of all over the input.
pub fn errors(subject: &PlotData, width: f64) -> Result<Vec<Chart>> {
    if subject.predicted.is_none() {
        return Err(Usage("errors need a model: hysid plot MODEL.json DATA.csv --kind errors".into()).into());
    }
    anyhow::ensure!(
        subject.is_measured(),
        "the data have no measured output, so there are no errors to draw"
    );
    let names = subject.data.names();
    let label = error_label(&names.output);
    let error = |(record, predicted): (&Record, Option<&Prediction>)| {
        predicted.map_or_else(Vec::new, |predicted| difference(&predicted.output, record.output()))
    };
    let errors: Vec<Vec<f64>> = subject.records().map(error).collect();
    let mut charts = Vec::new();
    for ((record, _), error) in drawn(subject).zip(&errors) {
        let (time, rows) = (times(record), scored_rows(record));
        let panel = panel(subject, record, &time[rows.clone()]);
        let line = (Colour::Error, "error", 1.1, &error[rows]);
        let chart = panel.chart(&label, OUTPUT * width, &[line], None);
        charts.push(titled(Chart { legend: Vec::new(), ..chart }, subject, record));
    }
    let most = (3 * POINTS / errors.len()).max(200);
    let over_input = |(record, error): (&Record, &Vec<f64>)| {
        let points: Vec<Point> = record.inputs()[0].iter().copied().zip(error.iter().copied()).collect();
        Curve::new(thin(&points, most), Colour::Error, 0.8)
    };
    let curves = subject.data.records().iter().zip(&errors).map(over_input).collect();
    let input = unit::label(&names.inputs[0]);
    let chart = Chart::new(format!("{label}, model less measured, over {input}"), &input, &label, curves);
    charts.push(chart.with_height(OVER_INPUT * width));
    Ok(charts.into_iter().map(|chart| wide(chart, width)).collect())
}

fn drawn(subject: &PlotData) -> impl Iterator<Item = (&Record, Option<&Prediction>)> {
    let count = subject.data.records().len();
    if count > MOST_RECORDS {
        note(format_args!(
            "the first {MOST_RECORDS} of {count} records are drawn over time: choose others with --only RECORD"
        ));
    }
    subject.records().take(MOST_RECORDS)
}

fn panel<'a>(subject: &PlotData, record: &'a Record, time: &'a [f64]) -> Panel<'a> {
    Panel {
        time,
        time_label: time_label(&subject.data),
        record: record.name(),
        points: POINTS,
        band: subject.band.unwrap_or_default(),
        track: Track { record: String::new(), times: None, cycles: Vec::new() },
    }
}

/// The chart with the name of its record if there are several.
fn titled(chart: Chart, subject: &PlotData, record: &Record) -> Chart {
    match subject.data.records().len() {
        1 => chart,
        _ => Chart { title: record.name().to_string(), ..chart },
    }
}

fn wide(chart: Chart, width: f64) -> Chart {
    let height = chart.size.1;
    chart.sized(width, height)
}
