//! Loops, and how the training converged.

use hysid::data::record::Record;
use hysid::model::history::Phase;
use hysid::model::{Model, Provenance};
use hysid::options::FitSpec;
use hysid::options::network::Method;
use hysid_document::chart::thin::thin_path;
use hysid_document::chart::{Track, records_in_colour};
use hysid_document::{Chart, Colour, Curve, Part, convergence, count, unit};

use crate::ReportSet;

/// Points of all curves of a colour together in a chart of loops.
const LOOP_POINTS: usize = 6000;

/// Width of the line of measured data, in pixels: wide and pale, so that it is seen beside the model on it.
pub const MEASURED_WIDTH: f64 = 4.2;

/// Width of the line of a model, in pixels.
pub const MODEL_WIDTH: f64 = 1.1;

/// Most records drawn into one chart.
const MOST_RECORDS: usize = 200;

/// Most small charts, one a record.
const MOST_MULTIPLES: usize = 12;

/// Loops of a set beside the histories of its records, which have this note.
pub fn section(set: &ReportSet, histories: Vec<Vec<Part>>, note: Option<Part>) -> Part {
    let records = set.data.records();
    let mut columns = vec![vec![Part::chart(loops(set))]];
    columns.extend(histories);
    let mut parts = vec![Part::Columns(columns)];
    parts.extend(note);
    if (2..=MOST_MULTIPLES).contains(&records.len()) {
        let charts = (0..records.len()).map(|index| record_loops(set, index)).collect();
        parts.extend([Part::heading("Record by record"), Part::Charts(charts)]);
    }
    if records.len() > MOST_RECORDS {
        parts.push(Part::note(format!("{MOST_RECORDS} of {} are drawn.", count(records.len(), "record"))));
    }
    let fewest = record_points(set).min(LOOP_POINTS / records.len());
    if records.iter().any(|record| record.len() > fewest) {
        parts.push(Part::note(
            "Of a long path, only sections are drawn, spread from its beginning to its end.",
        ));
    }
    if set.data.names().inputs.len() > 1 {
        parts.push(Part::note("The model has further inputs, which these charts do not show."));
    }
    Part::section(format!("Loops and histories: {} data", set.name), parts)
}

pub fn loops(set: &ReportSet) -> Chart {
    loop_chart(set, &shown(set), "", LOOP_POINTS)
}

pub fn small_loops(set: &ReportSet, title: &str) -> Chart {
    loop_chart(set, &shown(set), title, LOOP_POINTS / 2)
}

/// The records that are drawn: all of a few, evenly chosen of many.
fn shown(set: &ReportSet) -> Vec<usize> {
    let records = set.data.records().len();
    (0..records).step_by(records.div_ceil(MOST_RECORDS).max(1)).collect()
}

/// Points of a colour in the chart of a single record.
fn record_points(set: &ReportSet) -> usize {
    (3 * LOOP_POINTS / 2 / set.data.records().len()).min(LOOP_POINTS)
}

fn record_loops(set: &ReportSet, index: usize) -> Chart {
    loop_chart(set, &[index], set.data.records()[index].name(), record_points(set))
}

fn loop_chart(set: &ReportSet, shown: &[usize], title: &str, points: usize) -> Chart {
    let names = set.data.names();
    let most = (points / shown.len().max(1)).max(16);
    let (mut all, mut simulated): (Vec<Curve>, Vec<Curve>) =
        shown.iter().map(|&index| loop_curves(set, index, most)).unzip();
    let mut legend = vec![(Colour::Measured, "measured".to_string()), (Colour::Simulated, "model".into())];
    // A small chart has no legend.
    if title.is_empty() && shown.len() > 1 {
        let named: Vec<&str> = shown.iter().map(|&index| set.data.records()[index].name()).collect();
        let (colours, entries) = records_in_colour(&named);
        simulated.iter_mut().zip(colours).for_each(|(curve, colour)| curve.colour = colour);
        legend.truncate(1);
        legend.extend(entries.into_iter().map(|(colour, name)| (colour, format!("model, {name}"))));
    }
    all.extend(simulated);
    let (x, y) = (unit::label(&names.inputs[0]), unit::label(&names.output));
    let of = if title.is_empty() { format!("{} data", set.name) } else { title.to_string() };
    let description = format!("Loops of {y} over {x}, measured and simulated: {of}");
    let chart = Chart::new(description, &x, &y, all);
    match title {
        "" => chart.sized(560.0, 400.0).with_legend(legend),
        title => chart.small(title),
    }
}

/// Measured and simulated loops of a record, the same rows of both.
fn loop_curves(set: &ReportSet, index: usize, most: usize) -> (Curve, Curve) {
    let record = &set.data.records()[index];
    let rows = scored_rows(record);
    let first = rows.start;
    let x = &record.inputs()[0][rows.clone()];
    let (measured, simulated) = (&record.output()[rows.clone()], &set.simulated[index][rows]);
    let (wide, thin, drawn) = path_curves(x, measured, simulated, most);
    let track = set.tracks.of_path(record, drawn.into_iter().map(|row| row.map(|row| first + row)));
    // A page needs the cycles of a record once.
    (wide.tracked(track.clone()), thin.tracked(Track { cycles: Vec::new(), ..track }))
}

/// Two outputs over the same input, the same rows of both: the wide curve of one, and the thin one of a model before it;
/// and the rows that are drawn.
pub fn path_curves(
    x: &[f64],
    wide: &[f64],
    model: &[f64],
    most: usize,
) -> (Curve, Curve, Vec<Option<usize>>) {
    let drawn = thin_path(&[x, wide, model], most);
    let curve = |colour: Colour, width: f64, y: &[f64]| {
        let point = |row: &Option<usize>| row.map_or((f64::NAN, f64::NAN), |row| (x[row], y[row]));
        Curve::new(drawn.iter().map(point).collect(), colour, width)
    };
    let curves =
        (curve(Colour::Measured, MEASURED_WIDTH, wide), curve(Colour::Simulated, MODEL_WIDTH, model));
    (curves.0, curves.1, drawn)
}

/// From the first row with an output to the last; all rows if no row has one.
pub fn scored_rows(record: &Record) -> std::ops::Range<usize> {
    let output = record.output();
    let first = output.iter().position(|y| !y.is_nan());
    let last = output.iter().rposition(|y| !y.is_nan());
    first.zip(last).map_or(0..record.len(), |(first, last)| first..last + 1)
}

/// How the training converged, with words; `None` for a model that was not searched for.
pub fn convergence_section(model: &Model) -> Option<Part> {
    let provenance = model.provenance();
    let parts =
        [Part::chart(convergence::chart(&provenance.runs)?), Part::note(convergence_words(provenance))];
    Some(Part::section("Convergence", parts))
}

fn convergence_words(provenance: &Provenance) -> String {
    let on_all_data = provenance.runs.iter().filter(|run| run.phase == Phase::AllData);
    let mut words = match (&provenance.options, provenance.options.starts()) {
        (FitSpec::Network(_), starts) if starts > 1 => format!(
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
