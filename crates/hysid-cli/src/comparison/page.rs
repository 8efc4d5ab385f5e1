//! The page of a comparison: table, error against size, loops of every model.

use anyhow::Result;
use hysid::data::record::Dataset;

use super::{Fitted, HEADINGS, Row, cells, stopped_note};
use crate::page::{figure, note, section, table, verdict, whole};
use crate::plot::{Axis, Chart, Colour, Curve, Label};
use crate::report::{ReportSet, small_loops};

/// Most records drawn into one chart.
const MOST_RECORDS: usize = 200;

/// Models whose loops are drawn over each other.
const OVERLAID: usize = 3;

/// The whole page.
pub fn page(title: &str, train: &Dataset, test: Option<&Dataset>, rows: &[Row]) -> Result<String> {
    let labels: Vec<String> = rows.iter().map(Row::label).collect();
    let fitted: Vec<(&str, &Fitted)> = rows
        .iter()
        .zip(&labels)
        .filter_map(|(row, label)| Some((label.as_str(), row.outcome.as_ref().ok()?)))
        .collect();
    let shown = test.unwrap_or(train);
    let data = if test.is_some() { "unseen data" } else { "the training data" };
    let mut content = fitted.first().map_or_else(String::new, |(name, best)| {
        let error = super::percent(best.judged());
        verdict(&format!("On {data}, {name} is best: {error} % of the output’s standard deviation."))
    });
    content += &section(
        "Errors",
        &(rows_table(rows)
            + &note(&format!(
                "NRMSE in percent of the output’s standard deviation, of free runs. Fits ran on one thread each, several at a time. {}",
                stopped_note(rows)
            ))),
    );
    if !fitted.is_empty() {
        content += &section("Error against size", &figure(&size_chart(&fitted, data), true));
        let mut loops =
            format!("<div class=\"charts\">\n{}</div>\n", figure(&overlay(&fitted, shown)?, false));
        let mut multiples = String::new();
        for (name, fitted) in &fitted {
            let simulated: Result<Vec<Vec<f64>>, hysid::Error> =
                shown.records().iter().map(|record| fitted.model.simulate(record)).collect();
            let errors = fitted.judged().clone();
            let set =
                ReportSet { name: data.into(), data: shown, simulated: simulated?, predicted: None, errors };
            let title = format!("{name}: {} %", super::percent(fitted.judged()));
            multiples += &figure(&small_loops(&set, title), false);
        }
        loops += &format!("<h3>Model by model</h3>\n<div class=\"charts small\">\n{multiples}</div>\n");
        content += &section(&format!("Loops on {data}"), &loops);
    }
    Ok(whole(title, &content))
}

fn rows_table(rows: &[Row]) -> String {
    let cells_of = |row: &Row| {
        let mut line = vec![row.label()];
        match &row.outcome {
            Ok(fitted) => line.extend(cells(fitted)),
            Err(why) => line.push(why.clone()),
        }
        line
    };
    let rows: Vec<Vec<String>> = rows.iter().map(cells_of).collect();
    table(&HEADINGS.map(String::from), &rows)
}

/// Error against number of parameters, a dot for each model.
fn size_chart(fitted: &[(&str, &Fitted)], data: &str) -> String {
    let point = |fitted: &Fitted| {
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
    Chart {
        description: format!("Error on {data} against number of parameters, a dot for each model"),
        title: String::new(),
        size: (860.0, 400.0),
        // Room for the text to the right of the last point.
        x: Axis::logarithmic("parameters", points.iter().flat_map(|point| [point.0, 4.0 * point.0])),
        y: Axis::logarithmic(format!("error on {data} (% of std)"), points.iter().map(|point| point.1)),
        curves: points
            .iter()
            .map(|&point| Curve { points: vec![point], colour: Colour::Simulated, width: 3.0 })
            .collect(),
        labels: labels(fitted.iter().map(|(name, _)| *name).zip(points.iter().copied())),
        legend: Vec::new(),
    }
    .svg()
}

/// The names beside their points; where two would overlap, the later stands higher.
fn labels<'a>(named: impl Iterator<Item = (&'a str, (f64, f64))>) -> Vec<Label> {
    // About so many pixels for a factor of e on the chart.
    const PIXELS: (f64, f64) = (120.0, 70.0);
    const TEXT: (f64, f64) = (7.2, 14.0);
    let mut placed: Vec<Label> = Vec::new();
    for (name, point) in named {
        let mut rise = 0.0;
        let overlaps = |rise: f64| {
            placed.iter().any(|other| {
                let dx = PIXELS.0 * (point.0 / other.point.0).ln();
                let dy = PIXELS.1 * (point.1 / other.point.1).ln() + rise - other.rise;
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
fn overlay(fitted: &[(&str, &Fitted)], data: &Dataset) -> Result<String> {
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
        curves.push(Curve {
            points: path(x, record.output(), record.output()),
            colour: Colour::Measured,
            width: 2.4,
        });
    }
    for (index, (name, fitted)) in fitted.iter().take(OVERLAID).enumerate() {
        legend.push((Colour::Series(index), name.to_string()));
        for record in records() {
            let simulated = fitted.model.simulate(record)?;
            let points = path(&record.inputs()[0], &simulated, record.output());
            curves.push(Curve { points, colour: Colour::Series(index), width: 1.1 });
        }
    }
    for curve in &mut curves {
        curve.points = crate::plot::thin::thin(&curve.points, 3000);
    }
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let (x, y) = (crate::report::unit_label(&names.inputs[0]), crate::report::unit_label(&names.output));
    Ok(Chart {
        description: format!("Loops of {y} over {x}, measured and of the best models"),
        title: String::new(),
        size: (700.0, 460.0),
        x: Axis::linear(x, points().map(|point| point.0)),
        y: Axis::linear(y, points().map(|point| point.1)),
        labels: Vec::new(),
        legend,
        curves,
    }
    .svg())
}
