//! Output, error and input over time.

use hysid::model::Prediction;
use hysid_document::chart::Track;
use hysid_document::chart::thin::{Point, outline, thin};
use hysid_document::{Axis, Chart, Colour, Curve, Part, Piece, Text, number, unit};

use crate::figures::{MEASURED_WIDTH, MODEL_WIDTH};
use crate::tracks::times;
use crate::{BAND, ReportSet, time_label};

/// Most records drawn; of more, those with the largest errors.
const MOST_RECORDS: usize = 6;

/// Points of each kind of curve in all records together.
const POINTS: usize = 4000;

const MOST_INPUTS: usize = 4;

/// The charts of each record that is drawn.
pub fn of_records(set: &ReportSet) -> Vec<Vec<Part>> {
    let shown = shown_records(set);
    let points = POINTS / shown.len().max(1);
    shown.iter().map(|&index| record(set, index, points)).collect()
}

/// Which records are drawn, if not all are.
pub fn left_out(set: &ReportSet) -> Option<Part> {
    let all = set.data.records().len();
    let words =
        format!("Histories are those of the {MOST_RECORDS} of {all} records with the largest errors.");
    (all > MOST_RECORDS).then(|| Part::note(words))
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

/// Simulated less measured output of a record.
fn errors(set: &ReportSet, index: usize) -> Vec<f64> {
    difference(&set.simulated[index], set.data.records()[index].output())
}

/// Simulated less measured output.
pub fn difference(simulated: &[f64], measured: &[f64]) -> Vec<f64> {
    simulated.iter().zip(measured).map(|(model, measured)| model - measured).collect()
}

/// The charts of a record, one below the other.
fn record(set: &ReportSet, index: usize, points: usize) -> Vec<Part> {
    let record = &set.data.records()[index];
    let names = set.data.names();
    let time = times(record);
    let track = set.tracks.over_time(record.name());
    let time_label = time_label(set.data);
    let panel = Panel { time: &time, record: record.name(), time_label, points, band: BAND, track };
    let output = unit::label(&names.output);
    let error = error_label(&names.output);
    let predicted = set.predicted.as_ref().map(|predicted| &predicted[index]);
    let rmse = rmse(set, index);
    let rmse = match rmse < 0.0 {
        true => "no measured output".to_string(),
        false => format!("RMSE {}", unit::with(&number(rmse, 3), &names.output)),
    };
    let name = Text::from(record.name()).and(Piece::Aside(rmse));
    let mut parts = vec![Part::Heading(name)];
    let mut known = record.known().to_vec();
    known.resize(record.len(), f64::NAN);
    let mut lines = vec![
        (Colour::Measured, "measured", MEASURED_WIDTH, record.output()),
        (Colour::Simulated, "model", MODEL_WIDTH, &set.simulated[index]),
    ];
    if !record.known().is_empty() {
        lines.insert(0, (Colour::Series(1), "known beginning", MEASURED_WIDTH, &known));
    }
    parts.push(Part::chart(panel.chart(
        &output,
        220.0,
        &lines,
        predicted.map(|predicted| panel.area(&predicted.low, &predicted.high)),
    )));
    let errors = errors(set, index);
    let line = (Colour::Error, "model − measured", 1.1, errors.as_slice());
    let band = predicted.map(|predicted| panel.error_band(predicted));
    parts.push(Part::chart(panel.chart(&error, 165.0, &[line], band)));
    for (name, input) in names.inputs.iter().zip(record.inputs()).take(MOST_INPUTS) {
        let line = (Colour::Input, "input", 1.2, &**input);
        parts.push(Part::chart(panel.chart(&unit::label(name), 165.0, &[line], None)));
    }
    parts
}

pub fn error_label(output: &str) -> String {
    match unit::split(output).1 {
        Some(unit) => format!("error ({unit})"),
        None => "error".into(),
    }
}

/// Time axis, record and track that charts share.
pub struct Panel<'a> {
    /// Times of the rows, or their numbers.
    pub time: &'a [f64],
    pub time_label: String,
    pub record: &'a str,
    pub points: usize,
    pub band: f64,
    /// Track that the charts of the record share.
    pub track: Track,
}

impl Panel<'_> {
    pub fn area(&self, low: &[f64], high: &[f64]) -> Curve {
        Curve::new(outline(self.time, low, high, self.points), Colour::Band, 0.0)
    }

    fn error_band(&self, predicted: &Prediction) -> Curve {
        let from = |edges: &[f64]| -> Vec<f64> {
            predicted.output.iter().zip(edges).map(|(output, edge)| output - edge).collect()
        };
        self.area(&from(&predicted.high), &from(&predicted.low))
    }

    /// Lines over time. A band lies on those of the data and behind the last one.
    pub fn chart(
        &self,
        label: &str,
        height: f64,
        lines: &[(Colour, &str, f64, &[f64])],
        band: Option<Curve>,
    ) -> Chart {
        let curve = |&(colour, _, width, values): &(Colour, &str, f64, &[f64])| {
            let points: Vec<Point> = self.time.iter().copied().zip(values.iter().copied()).collect();
            Curve::new(thin(&points, self.points), colour, width).tracked(self.track.clone())
        };
        let mut legend: Vec<(Colour, String)> =
            lines.iter().map(|(colour, name, ..)| (*colour, name.to_string())).collect();
        if band.is_some() {
            legend.push((Colour::Band, format!("{} % band", number(100.0 * self.band, 3))));
        }
        let mut lines: Vec<Curve> = lines.iter().map(curve).collect();
        let y = Axis::linear(label, reach(&lines, band.as_ref()).into_iter());
        let behind_model = lines.len().saturating_sub(1);
        lines.splice(behind_model..behind_model, band);
        let description = format!("{label} over {}, record {}", self.time_label, self.record);
        let x = Axis::linear(self.time_label.as_str(), self.time.iter().copied());
        Chart::on_axes(description, x, y, lines).with_height(height).with_legend(legend)
    }
}

/// How far beyond the lines, as a share of their range, a band is drawn: where it is wider still, it is cut off, or it
/// would press the lines together.
const MOST_BEYOND: f64 = 1.0;

/// Ordinates that the vertical axis must cover, of lines and the band behind them.
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
