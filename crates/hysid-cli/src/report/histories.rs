//! Output, error and input over time.

use hysid::model::Prediction;

use super::{BAND, ReportSet, unit};
use crate::page::{figure, note, number, section as section_of};
use crate::plot::thin::{Point, outline, thin};
use crate::plot::{Axis, Chart, Colour, Curve, escape};

/// Most records drawn; of more, those with the largest errors.
const MOST_RECORDS: usize = 6;

/// Points of each kind of curve in all records together.
const POINTS: usize = 4000;

/// Most inputs drawn.
const MOST_INPUTS: usize = 4;

/// The histories of a set.
pub fn section(set: &ReportSet) -> String {
    let shown = shown_records(set);
    let mut content = String::new();
    if shown.len() < set.data.records().len() {
        content += &note(&format!(
            "Of {} records the {} with the largest errors are drawn.",
            set.data.records().len(),
            shown.len()
        ));
    }
    let points = POINTS / shown.len().max(1);
    content.extend(shown.iter().map(|&index| record(set, index, points)));
    section_of(&format!("Histories: {} data", set.name), &content)
}

fn shown_records(set: &ReportSet) -> Vec<usize> {
    let mut order: Vec<usize> = (0..set.data.records().len()).collect();
    order.sort_by(|&a, &b| rmse(set, b).total_cmp(&rmse(set, a)));
    order.truncate(MOST_RECORDS);
    order.sort_unstable();
    order
}

/// Root of the mean square error of a record; -1 if nothing is scored.
fn rmse(set: &ReportSet, index: usize) -> f64 {
    let (sum, rows) = errors(set, index)
        .into_iter()
        .filter(|error| !error.is_nan())
        .fold((0.0, 0usize), |(sum, rows), error| (sum + error * error, rows + 1));
    if rows == 0 { -1.0 } else { (sum / rows as f64).sqrt() }
}

/// Simulated less measured output.
fn errors(set: &ReportSet, index: usize) -> Vec<f64> {
    let measured = set.data.records()[index].output();
    set.simulated[index].iter().zip(measured).map(|(model, measured)| model - measured).collect()
}

/// The charts of a record, one below the other.
fn record(set: &ReportSet, index: usize, points: usize) -> String {
    let record = &set.data.records()[index];
    let names = set.data.names();
    let time: Vec<f64> = match record.time() {
        Some(time) => time.to_vec(),
        None => (1..=record.len()).map(|row| row as f64).collect(),
    };
    let panel = Panel { time: &time, record: record.name(), time_label: time_label(set), points };
    let output = unit::label(&names.output);
    let error = match unit::split(&names.output).1 {
        Some(unit) => format!("error ({unit})"),
        None => "error".into(),
    };
    let predicted = set.predicted.as_ref().map(|predicted| &predicted[index]);
    let mut charts = panel.figure(
        &output,
        220.0,
        &[
            (Colour::Measured, "measured", 2.4, record.output()),
            (Colour::Simulated, "model", 1.1, &set.simulated[index]),
        ],
        predicted.map(|predicted| panel.band(&predicted.low, &predicted.high)),
    );
    let error_lines = [(Colour::Error, "model − measured", 1.1, errors(set, index))];
    let error_lines = error_lines
        .each_ref()
        .map(|(colour, name, width, values)| (*colour, *name, *width, values.as_slice()));
    charts +=
        &panel.figure(&error, 165.0, &error_lines, predicted.map(|predicted| panel.error_band(predicted)));
    for (name, input) in names.inputs.iter().zip(record.inputs()).take(MOST_INPUTS) {
        charts += &panel.figure(&unit::label(name), 165.0, &[(Colour::Input, "input", 1.2, input)], None);
    }
    let rmse = rmse(set, index);
    let rmse = match rmse < 0.0 {
        true => "no measured output".to_string(),
        false => format!("RMSE {}", unit::with(&number(rmse, 3), &names.output)),
    };
    format!("<h3>{} <small>{}</small></h3>\n{charts}", escape(record.name()), escape(&rmse))
}

fn time_label(set: &ReportSet) -> String {
    match (&set.data.names().time, set.data.has_time()) {
        (Some(name), true) => unit::label(name),
        (None, true) => "time".into(),
        (_, false) => "row".into(),
    }
}

/// What the charts of a record have in common.
struct Panel<'a> {
    time: &'a [f64],
    time_label: String,
    record: &'a str,
    points: usize,
}

impl Panel<'_> {
    /// The area between two curves.
    fn band(&self, low: &[f64], high: &[f64]) -> Curve {
        Curve { points: outline(self.time, low, high, self.points), colour: Colour::Band, width: 0.0 }
    }

    /// Where the error is to be expected.
    fn error_band(&self, predicted: &Prediction) -> Curve {
        let from = |edges: &[f64]| -> Vec<f64> {
            predicted.output.iter().zip(edges).map(|(output, edge)| output - edge).collect()
        };
        self.band(&from(&predicted.high), &from(&predicted.low))
    }

    /// Lines over time, in front of a band if there is one.
    fn figure(
        &self,
        label: &str,
        height: f64,
        lines: &[(Colour, &str, f64, &[f64])],
        band: Option<Curve>,
    ) -> String {
        let curve = |&(colour, _, width, values): &(Colour, &str, f64, &[f64])| {
            let points: Vec<Point> = self.time.iter().copied().zip(values.iter().copied()).collect();
            Curve { points: thin(&points, self.points), colour, width }
        };
        let mut legend: Vec<(Colour, String)> =
            lines.iter().map(|(colour, name, ..)| (*colour, name.to_string())).collect();
        if band.is_some() {
            legend.push((Colour::Band, format!("{} % band", number(100.0 * BAND, 3))));
        }
        let lines: Vec<Curve> = lines.iter().map(curve).collect();
        let y = Axis::linear(label, reach(&lines, band.as_ref()).into_iter());
        let curves = band.into_iter().chain(lines).collect();
        let chart = Chart {
            labels: Vec::new(),
            description: format!("{label} over {}, record {}", self.time_label, self.record),
            title: String::new(),
            size: (860.0, height),
            x: Axis::linear(self.time_label.clone(), self.time.iter().copied()),
            y,
            legend,
            curves,
        };
        figure(&chart.svg(), true)
    }
}

/// How far beyond the lines, as a share of their range, a band is drawn: where it is wider still, it is cut off, or it
/// would press the lines together.
const MOST_BEYOND: f64 = 1.0;

/// What the vertical axis must show of lines and the band behind them.
fn reach(lines: &[Curve], band: Option<&Curve>) -> Vec<f64> {
    let range = |curves: &[Curve]| {
        let ordinates = curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
        let finite = ordinates.filter(|y| y.is_finite());
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)))
    };
    let (low, high) = range(lines);
    let Some((band_low, band_high)) = band.map(|band| range(std::slice::from_ref(band))) else {
        return vec![low, high];
    };
    let most = MOST_BEYOND * (high - low);
    vec![low, high, band_low.max(low - most), band_high.min(high + most)]
}
