//! Output, input and error over time, and the error over the input.

use anyhow::Result;
use hysid::data::record::Record;
use hysid::model::Prediction;
use hysid_app::histories::{Panel, difference, error_label};
use hysid_app::tracks::times;
use hysid_app::{MODEL_WIDTH, scored_rows, time_label};
use hysid_document::chart::thin::{Point, thin};
use hysid_document::chart::{PIXELS_PER_MILLIMETRE, Track};
use hysid_document::{Chart, Colour, Curve, unit};

use super::PlotData;
use super::curves::{BOTH, alone};
use crate::messages::{Usage, note};

/// Most records that are drawn over time.
const MOST_RECORDS: usize = 4;

/// Height of a page of A4 within its margins, in pixels. Charts that are higher together are drawn lower.
const PAGE: f64 = 230.0 * PIXELS_PER_MILLIMETRE;

/// Least share of their height in which charts are drawn. Where that is too high, fewer records are drawn.
const LOWEST: f64 = 0.5;

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
    let of_record = OUTPUT + BELOW * names.inputs.len().min(MOST_INPUTS) as f64;
    for (record, predicted) in drawn(subject, of_record * width, 0.0) {
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
    on_a_page(charts, width)
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
    for ((record, _), error) in drawn(subject, OUTPUT * width, OVER_INPUT * width).zip(&errors) {
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
    Ok(on_a_page(charts, width))
}

/// The first records whose charts, `height` pixels high each, fit on a page below `further` pixels.
fn drawn(
    subject: &PlotData,
    height: f64,
    further: f64,
) -> impl Iterator<Item = (&Record, Option<&Prediction>)> {
    let count = subject.data.records().len();
    let fitting = (PAGE / LOWEST - further) / height;
    let most = (fitting as usize).clamp(1, MOST_RECORDS);
    if count > most {
        note(format_args!(
            "the first {most} of {} are drawn over time: choose others with --only RECORD",
            hysid_document::count(count, "record")
        ));
    }
    subject.records().take(most)
}

/// The charts in this width, together no higher than a page.
fn on_a_page(charts: Vec<Chart>, width: f64) -> Vec<Chart> {
    let height: f64 = charts.iter().map(|chart| chart.size.1).sum();
    let factor = (PAGE / height).min(1.0);
    let sized = |chart: Chart| {
        let height = factor * chart.size.1;
        chart.sized(width, height)
    };
    charts.into_iter().map(sized).collect()
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
