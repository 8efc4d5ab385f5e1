//! Loops of measured data and of a model.

use hysid_app::{MEASURED_WIDTH, MODEL_WIDTH, path_curves, scored_rows};
use hysid_document::chart::records_in_colour;
use hysid_document::{Chart, Colour, Curve, unit};

use super::PlotData;
use hysid_app::cycles::pictures::path;

/// Points of all curves of a colour together.
const POINTS: usize = 12_000;

/// Height of a chart of loops over its width.
const SHAPE: f64 = 0.75;

pub fn loops(subject: &PlotData, width: f64) -> Chart {
    let most = (POINTS / subject.data.records().len()).max(100);
    let (mut back, mut front) = (Vec::new(), Vec::new());
    for (record, predicted) in subject.records() {
        let rows = scored_rows(record);
        let (x, y) = (&record.inputs()[0][rows.clone()], &record.output()[rows.clone()]);
        match predicted {
            Some(predicted) if subject.is_measured() => {
                let (measured, model, _) = path_curves(x, y, &predicted.output[rows], most);
                back.push(measured);
                front.push(model);
            }
            only => {
                let y = only.map_or(y, |predicted| &predicted.output);
                front.push(Curve::new(path(x, y, most), alone(subject), MODEL_WIDTH));
            }
        }
    }
    let names: Vec<&str> = subject.data.records().iter().map(|record| record.name()).collect();
    let (colours, mut named) = records_in_colour(&names);
    front.iter_mut().zip(colours).for_each(|(curve, colour)| curve.colour = colour);
    let mut entries: Vec<(Colour, String)> =
        legend(subject).into_iter().map(|(colour, name)| (colour, name.to_string())).collect();
    if !named.is_empty() {
        if !entries.is_empty() {
            named.iter_mut().for_each(|(_, name)| *name = format!("model, {name}"));
        }
        entries.retain(|(colour, _)| *colour == Colour::Measured);
        entries.extend(named);
    }
    back.extend(front);
    let names = subject.data.names();
    let (x, y) = (unit::label(&names.inputs[0]), unit::label(&names.output));
    Chart::new(format!("Loops of {y} over {x}"), &x, &y, back)
        .sized(width, SHAPE * width)
        .with_legend(entries)
}

/// The legend of measured data and a model; nothing for one of both.
pub fn legend(subject: &PlotData) -> Vec<(Colour, &'static str)> {
    match subject.is_measured() && subject.predicted.is_some() {
        true => vec![(Colour::Measured, "measured"), (Colour::Simulated, "model")],
        false => Vec::new(),
    }
}

/// Colour of the only curve there is: of a model without measured data, or of measured data without a model.
pub fn alone(subject: &PlotData) -> Colour {
    if subject.predicted.is_some() { Colour::Simulated } else { Colour::Series(0) }
}

pub const BOTH: [(Colour, f64); 2] = [(Colour::Measured, MEASURED_WIDTH), (Colour::Simulated, MODEL_WIDTH)];
