//! Loops, histories and errors of several models on the same data.

use hysid::data::record::Dataset;
use hysid_document::chart::thin::{Point, thin, thin_path};
use hysid_document::{Axis, Chart, Colour, Curve, unit};

use super::largest;

/// Points of a curve in a chart of a history.
const POINTS: usize = 1600;

/// The same in a chart of loops, and at least so many of every stretch without a gap.
const LOOP_POINTS: (usize, usize) = (3000, 420);

/// A history of more samples is shown from its beginning.
const LONGEST_HISTORY: usize = 1200;

/// Smallest error on the logarithmic axis, in percent.
const LOWEST_PERCENT: f64 = 1e-4;

/// Outputs of a model for a set of data.
pub struct FigureLine<'a> {
    /// The model.
    pub name: &'a str,
    /// Its outputs, record by record.
    pub simulated: &'a [Vec<f64>],
}

fn colour(index: usize) -> Colour {
    if index == 0 { Colour::Simulated } else { Colour::Error }
}

fn legend(lines: &[FigureLine]) -> Vec<(Colour, String)> {
    let measured = (Colour::Measured, "specimen".to_string());
    let models = lines.iter().enumerate().map(|(index, line)| (colour(index), line.name.to_string()));
    std::iter::once(measured).chain(models).collect()
}

/// Inputs, outputs of the specimen and of the models, in the rows that have an output, record after record.
#[derive(Default)]
struct Scored {
    input: Vec<f64>,
    output: Vec<f64>,
    simulated: Vec<Vec<f64>>,
    /// Where a new record, or a stretch after blanks, begins.
    begins: Vec<usize>,
}

impl Scored {
    fn of(data: &Dataset, lines: &[FigureLine]) -> Self {
        let mut scored = Self { simulated: vec![Vec::new(); lines.len()], ..Self::default() };
        for (index, record) in data.records().iter().enumerate() {
            let mut after_blank = true;
            for (row, &output) in record.output().iter().enumerate() {
                if output.is_nan() {
                    after_blank = true;
                    continue;
                }
                if std::mem::take(&mut after_blank) {
                    scored.begins.push(scored.output.len());
                }
                scored.input.push(record.inputs()[0][row]);
                scored.output.push(output);
                for (values, line) in scored.simulated.iter_mut().zip(lines) {
                    values.push(line.simulated[index][row]);
                }
            }
        }
        scored
    }

    fn stretches(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let ends = self.begins.iter().copied().skip(1).chain([self.output.len()]);
        self.begins.iter().copied().zip(ends).map(|(begin, end)| begin..end)
    }
}

/// Loops of the specimen and of the models.
pub fn loops(set: &str, data: &Dataset, lines: &[FigureLine]) -> Chart {
    let scored = Scored::of(data, lines);
    let names = data.names();
    let most = (LOOP_POINTS.0 / scored.begins.len().max(1)).max(LOOP_POINTS.1);
    let path = |values: &[f64], colour: Colour, width: f64| {
        let mut points: Vec<Point> = Vec::new();
        for stretch in scored.stretches() {
            let (x, y) = (&scored.input[stretch.clone()], &values[stretch]);
            let rows = thin_path(&[x, y], most);
            points
                .extend(rows.into_iter().map(|row| row.map_or((f64::NAN, f64::NAN), |row| (x[row], y[row]))));
            points.push((f64::NAN, f64::NAN));
        }
        Curve::new(points, colour, width)
    };
    let mut curves = vec![path(&scored.output, Colour::Measured, 2.2)];
    // The XPNN lies over its rival.
    let models = scored.simulated.iter().enumerate().rev();
    curves.extend(models.map(|(index, values)| path(values, colour(index), 1.1)));
    let (x, y) = (unit::label(&names.inputs[0]), unit::label(&names.output));
    let description = format!("Loops of {y} over {x}, {set} data, specimen and models");
    let x = Axis::linear(x, scored.input.iter().copied());
    let y = Axis::linear(y, scored.output.iter().copied());
    Chart::on_axes(description, x, y, curves).small(set)
}

/// Outputs over the samples of the unseen data.
pub fn history(data: &Dataset, lines: &[FigureLine]) -> Chart {
    let scored = Scored::of(data, lines);
    let curve = |values: &[f64], colour: Colour, width: f64| {
        let shown = values.iter().take(LONGEST_HISTORY).enumerate();
        let points: Vec<Point> = shown.map(|(row, &y)| (row as f64, y)).collect();
        Curve::new(thin(&points, POINTS), colour, width)
    };
    let mut curves = vec![curve(&scored.output, Colour::Measured, 2.4)];
    let models = scored.simulated.iter().enumerate().rev();
    curves.extend(models.map(|(index, values)| curve(values, colour(index), 1.1)));
    let label = unit::label(&data.names().output);
    let all = scored.output.len();
    let from = if all > LONGEST_HISTORY { format!(", the first of {all}") } else { String::new() };
    let description = format!("{label} over the unseen samples, specimen and models");
    let x = Axis::linear(format!("unseen sample{from}"), curves[0].points.iter().map(|point| point.0));
    let y = Axis::linear(label, scored.output.iter().take(LONGEST_HISTORY).copied());
    Chart::on_axes(description, x, y, curves).with_height(230.0).with_legend(legend(lines))
}

/// Magnitude of the error in percent of the largest output, as one curve for training and one for unseen.
pub fn relative_errors(sets: &[(&Dataset, Vec<FigureLine>); 2]) -> Chart {
    let mut curves: Vec<Curve> = Vec::new();
    let mut begun = 0;
    for (data, lines) in sets {
        let scored = Scored::of(data, lines);
        let largest = largest(data);
        for (index, simulated) in scored.simulated.iter().enumerate().rev() {
            let percent = simulated
                .iter()
                .zip(&scored.output)
                .map(|(y, measured)| 100.0 * (y - measured).abs() / largest);
            let points: Vec<Point> = percent
                .enumerate()
                .map(|(row, percent)| ((begun + row) as f64, percent.max(LOWEST_PERCENT)))
                .collect();
            curves.push(Curve::new(thin(&points, POINTS / 2), colour(index), 0.9));
        }
        begun += scored.output.len();
    }
    let unseen_from = curves.last().and_then(|curve| curve.points.first()).map_or(0.0, |point| point.0);
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let x = Axis::linear(format!("sample; unseen from {unseen_from}"), points().map(|point| point.0));
    let y = Axis::logarithmic("error (% of largest)", points().map(|point| point.1));
    let description = "Error in percent of the largest output over all samples, training first, then unseen";
    Chart::on_axes(description, x, y, curves).with_height(260.0).with_legend(legend(&sets[0].1).split_off(1))
}
