//! The page of a comparison: table, error against size, loops of every model.

use hysid::data::record::Dataset;
use hysid_document::chart::thin::thin;
use hysid_document::{Axis, Cell, Chart, Colour, Curve, Label, Page, Part, Result, Table, number, unit};

use super::{CompareOutcome, CompareRow, ComparedFit, HEADINGS, cells, stopped_note};
use crate::{MEASURED_WIDTH, MODEL_WIDTH, ReportSet, Tracks, small_loops};

/// Most records drawn into one chart.
const MOST_RECORDS: usize = 200;

/// Models whose loops are drawn over each other.
const OVERLAID: usize = 3;

impl CompareOutcome {
    /// The comparison as a page, with the data of the request.
    pub fn page(&self, title: &str, train: &Dataset, test: Option<&Dataset>) -> Result<Page> {
        let rows = &self.rows;
        let labels: Vec<String> = rows.iter().map(CompareRow::label).collect();
        let fitted: Vec<(&str, &ComparedFit)> = rows
            .iter()
            .zip(&labels)
            .filter_map(|(row, label)| Some((label.as_str(), row.fit.as_ref().ok()?)))
            .collect();
        let shown = test.unwrap_or(train);
        let data = if test.is_some() { "unseen data" } else { "the training data" };
        let mut parts = Vec::new();
        parts.extend(fitted.first().map(|(name, best)| {
            let (errors, percent) = (best.judged(), super::percent(best.judged()));
            let rmse = unit::with(&number(errors.rmse, 3), &errors.output);
            let lead = format!(
                "{name} has the lowest error on {data}: {rmse} (root mean square), {percent} % of the standard deviation of \
                 the output."
            );
            Part::Lead(lead.into())
        }));
        if test.is_none() {
            let doubt = "All models were fitted to these data. The error on other data was not measured: name test data (--test).";
            parts.push(Part::warnings(&[doubt.to_string()]));
        }
        parts.extend(self.doubt().map(|doubt| Part::warnings(&[doubt])));
        let words = format!(
            "NRMSE of free runs, in percent of the standard deviation of the output. {}Each fit ran on {}. \
             {}",
            self.beginning().map_or_else(String::new, |words| words + " "),
            self.threads(),
            stopped_note(rows)
        );
        let mut columns = vec![vec![Part::Table(rows_table(rows)), Part::note(words)]];
        if !fitted.is_empty() {
            let words = "A dot for each model. Named are the six with the lowest errors, and those that no other model beats in both.";
            let heading = Part::heading("Error against size");
            columns.push(vec![heading, Part::note(words), Part::chart(size_chart(&fitted, data))]);
        }
        parts.push(Part::section("Errors", [Part::Columns(columns)]));
        if !fitted.is_empty() {
            let tracks = Tracks::of(data, shown);
            let loops = fitted.iter().map(|(name, fitted)| loops(name, fitted, data, shown, tracks.clone()));
            let loops = loops.collect::<Result<_>>()?;
            let overlay = Part::chart(overlay(&fitted, shown)?);
            let content = [overlay, Part::heading("Model by model"), Part::Charts(loops)];
            parts.push(Part::section(format!("Loops on {data}"), content));
        }
        Ok(Page { title: title.into(), parts })
    }
}

/// Measured and simulated loops of one model.
fn loops(name: &str, fitted: &ComparedFit, data: &str, shown: &Dataset, tracks: Tracks) -> Result<Chart> {
    let simulated = shown.records().iter().map(|record| fitted.model.simulate(record));
    let simulated = simulated.collect::<hysid::Result<_>>()?;
    let errors = fitted.judged().clone();
    let set = ReportSet { name: data.into(), data: shown, simulated, predicted: None, errors, tracks };
    Ok(small_loops(&set, &format!("{name}: {} %", super::percent(fitted.judged()))))
}

fn rows_table(rows: &[CompareRow]) -> Table {
    let cells_of = |row: &CompareRow| -> Vec<Cell> {
        let cells = match &row.fit {
            Ok(fitted) => cells(fitted).to_vec(),
            Err(why) => vec![why.clone()],
        };
        std::iter::once(row.label()).chain(cells).map(Cell::from).collect()
    };
    Table::new(HEADINGS).with_rows(rows.iter().map(cells_of))
}

/// Error against number of parameters, a dot for each model.
fn size_chart(fitted: &[(&str, &ComparedFit)], data: &str) -> Chart {
    let point = |fitted: &ComparedFit| {
        let error = fitted.judged().nrmse_std_percent.unwrap_or(f64::NAN);
        (fitted.model.parameters() as f64, error)
    };
    let points: Vec<(f64, f64)> = fitted.iter().map(|(_, fitted)| point(fitted)).collect();
    // One that is far off must not press the others together: it is drawn at the edge.
    let median = {
        let mut errors: Vec<f64> = points.iter().map(|point| point.1).collect();
        errors.sort_by(f64::total_cmp);
        errors[errors.len() / 2]
    };
    let points: Vec<(f64, f64)> =
        points.into_iter().map(|(n, error)| (n, error.min(30.0 * median))).collect();
    // Room for the text to the right of the last point.
    let x = Axis::logarithmic("parameters", points.iter().flat_map(|point| [point.0, 4.0 * point.0]));
    let y = Axis::logarithmic(format!("error on {data} (% of std)"), points.iter().map(|point| point.1));
    let all = fitted.iter().map(|(name, _)| *name).zip(points.iter().copied()).enumerate();
    let named = all.filter(|(place, (_, point))| *place < NAMED || is_on_front(*point, &points));
    let labels = labels(named.map(|(_, named)| named), &x, &y);
    let curves = points.iter().map(|&point| Curve::new(vec![point], Colour::Simulated, 3.0)).collect();
    let description = format!("Error on {data} against number of parameters, a dot for each model");
    Chart { labels, ..Chart::on_axes(description, x, y, curves) }.with_height(SIZE_CHART.1)
}

/// True if no other model has both a lower error and at most as many parameters, or the same error and fewer.
fn is_on_front((n, error): (f64, f64), all: &[(f64, f64)]) -> bool {
    !all.iter().any(|&(fewer, lower)| fewer <= n && lower <= error && (fewer, lower) != (n, error))
}

/// Models of the lowest errors that are named in any case.
const NAMED: usize = 6;

/// Width of the page's charts and height of this one, in pixels.
const SIZE_CHART: (f64, f64) = (860.0, 400.0);

/// The names beside their points; where two would overlap, the later stands higher.
fn labels<'a>(named: impl Iterator<Item = (&'a str, (f64, f64))>, x: &Axis, y: &Axis) -> Vec<Label> {
    const TEXT: (f64, f64) = (7.2, 14.0);
    let mut placed: Vec<Label> = Vec::new();
    for (name, point) in named {
        let mut rise = 0.0;
        let overlaps = |rise: f64| {
            placed.iter().any(|other| {
                let dx = SIZE_CHART.0 * (x.place(point.0) - x.place(other.point.0));
                let dy = SIZE_CHART.1 * (y.place(point.1) - y.place(other.point.1)) + rise - other.rise;
                let width = if dx < 0.0 { name.len() } else { other.text.len() } as f64 * TEXT.0;
                dx.abs() < width && dy.abs() < TEXT.1
            })
        };
        while overlaps(rise) {
            rise += 3.0;
        }
        placed.push(Label { point, rise, text: name.to_string() });
    }
    placed
}

/// Measured loops, and those of the best models over them.
fn overlay(fitted: &[(&str, &ComparedFit)], data: &Dataset) -> Result<Chart> {
    let names = data.names();
    let (mut curves, mut legend) = (Vec::new(), vec![(Colour::Measured, "measured".to_string())]);
    let path = |x: &[f64], y: &[f64], shown: &[f64]| -> Vec<(f64, f64)> {
        let rows = x.iter().zip(y).zip(shown);
        rows.map(|((x, y), shown)| if shown.is_nan() { (f64::NAN, f64::NAN) } else { (*x, *y) }).collect()
    };
    let every = data.records().len().div_ceil(MOST_RECORDS).max(1);
    let records = || data.records().iter().step_by(every);
    for record in records() {
        let x = &record.inputs()[0];
        curves.push(Curve::new(path(x, record.output(), record.output()), Colour::Measured, MEASURED_WIDTH));
    }
    for (index, (name, fitted)) in fitted.iter().take(OVERLAID).enumerate() {
        legend.push((Colour::Series(index), name.to_string()));
        for record in records() {
            let simulated = fitted.model.simulate(record)?;
            let points = path(&record.inputs()[0], &simulated, record.output());
            curves.push(Curve::new(points, Colour::Series(index), MODEL_WIDTH));
        }
    }
    for curve in &mut curves {
        curve.points = thin(&curve.points, 3000);
    }
    let (x, y) = (unit::label(&names.inputs[0]), unit::label(&names.output));
    let description = format!("Loops of {y} over {x}, measured and of the best models");
    Ok(Chart::new(description, &x, &y, curves).sized(700.0, 460.0).with_legend(legend))
}
