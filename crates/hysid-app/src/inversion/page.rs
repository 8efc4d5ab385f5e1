//! The page of an inversion: whether the model follows, where it does not, and the drive.

use hysid::Model;
use hysid::model::{Inversion, Reach};
use hysid_document::chart::Track;
use hysid_document::chart::thin::{Point, thin};
use hysid_document::{Cell, Chart, Colour, Curve, Page, Part, Piece, Table, Text, number, unit};

use super::{InputBounds, Inverted, ReferenceOutputs, WantedRecord, meaning};
use crate::histories::Panel;
use crate::tracks::times_or_rows;
use crate::{MEASURED_WIDTH, MODEL_WIDTH, path_curves};

/// Most records drawn; of more, those with the largest deviations.
const MOST_RECORDS: usize = 6;

/// Points of each kind of curve in all records together.
const POINTS: usize = 4000;

const LOOP_POINTS: usize = 6000;

pub fn page(
    model: &Model,
    wanted: &ReferenceOutputs,
    inverted: &Inverted,
    bounds: &InputBounds,
    understood: &[(String, String)],
    warnings: &[String],
) -> Page {
    let shown = shown_records(wanted, inverted);
    let mut parts = vec![lead(model, inverted)];
    if !warnings.is_empty() {
        parts.push(Part::warnings(warnings));
    }
    let charts = [Part::chart(loops(model, wanted, inverted, &shown))];
    parts.push(Part::section("Output over the drive", charts));
    let points = POINTS / shown.len().max(1);
    let mut histories = Vec::new();
    if shown.len() < wanted.records.len() {
        histories.push(Part::note(format!(
            "Of {} records the {} with the largest deviations are drawn.",
            wanted.records.len(),
            shown.len()
        )));
    }
    histories.extend(
        shown.iter().flat_map(|&index| {
            record(model, &wanted.records[index], &inverted.records[index], bounds, points)
        }),
    );
    parts.push(Part::section("Histories", histories));
    parts.push(Part::section("Rows", [Part::Table(reaches(wanted, inverted))]));
    parts.push(Part::section("What was asked for", [Part::Definitions(understood.to_vec())]));
    parts.push(Part::section(
        "What this page does not show",
        [Part::paragraph(
            "The deviations are those of the model from the wanted output. How well the drive works on the real \
             system depends on the model's own error too: measure the response to this drive, and compare.",
        )],
    ));
    Page { title: format!("Inverse of {}", model.name().name()), parts }
}

/// Track that the charts of a record share.
fn track(record: &str, times: Option<Vec<f64>>) -> Track {
    Track { record: record.into(), times, cycles: Vec::new() }
}

fn lead(model: &Model, inverted: &Inverted) -> Part {
    let errors = &inverted.errors;
    let percent = errors
        .nrmse_std_percent
        .map_or_else(String::new, |percent| format!(", {} % of its standard deviation", number(percent, 3)));
    let rmse = unit::with(&number(errors.rmse, 3), &model.names().output);
    Part::Lead(
        format!(
            "Driven by this input, the model deviates from the wanted output by {rmse} (RMSE){percent}; {} of {} rows are \
             reached.",
            inverted.reached(),
            inverted.rows()
        )
        .into(),
    )
}

fn shown_records(wanted: &ReferenceOutputs, inverted: &Inverted) -> Vec<usize> {
    let deviation = |index: &usize| inverted.records[*index].rms_deviation(&wanted.records[*index].wanted);
    let mut order: Vec<usize> = (0..wanted.records.len()).collect();
    order.sort_by(|a, b| deviation(b).total_cmp(&deviation(a)));
    order.truncate(MOST_RECORDS);
    order.sort_unstable();
    order
}

/// Wanted output and that of the model over the drive.
fn loops(model: &Model, wanted: &ReferenceOutputs, inverted: &Inverted, shown: &[usize]) -> Chart {
    let most = (LOOP_POINTS / shown.len().max(1)).max(16);
    let curves = shown.iter().map(|&index| {
        let (record, inversion) = (&wanted.records[index], &inverted.records[index]);
        let (wanted, model, drawn) = path_curves(&inversion.input, &record.wanted, &inversion.output, most);
        let times = times_or_rows(record.time.as_deref(), record.wanted.len());
        let times = drawn.iter().map(|row| row.map_or(f64::NAN, |row| times[row])).collect();
        let track = track(&record.name, Some(times));
        (wanted.tracked(track.clone()), model.tracked(track))
    });
    let (mut back, front): (Vec<Curve>, Vec<Curve>) = curves.unzip();
    back.extend(front);
    let names = model.names();
    let (x, y) = (unit::label(&names.inputs[0]), unit::label(&names.output));
    Chart::new(format!("Wanted and simulated {y} over the drive {x}"), &x, &y, back)
        .sized(560.0, 400.0)
        .with_legend([(Colour::Measured, "wanted"), (Colour::Simulated, "model")])
}

/// The charts of a record, one below the other.
fn record(
    model: &Model,
    record: &WantedRecord,
    inversion: &Inversion,
    bounds: &InputBounds,
    points: usize,
) -> Vec<Part> {
    let names = model.names();
    let time = times_or_rows(record.time.as_deref(), record.wanted.len());
    let time_label = match (&record.time, &names.time) {
        (Some(_), Some(name)) => unit::label(name),
        (Some(_), None) => "time".into(),
        (None, _) => "row".into(),
    };
    let band = bounds.band.map_or(0.0, |level| level.probability);
    let track = track(&record.name, None);
    let panel = Panel { time: &time, record: &record.name, time_label, points, band, track };
    let rms = unit::with(&number(inversion.rms_deviation(&record.wanted), 3), &names.output);
    let heading = Text::from(record.name.as_str()).and(Piece::Aside(format!("RMS deviation {rms}")));
    let deviation: Vec<f64> =
        inversion.output.iter().zip(&record.wanted).map(|(output, wanted)| output - wanted).collect();
    let deviation_label = match unit::split(&names.output).1 {
        Some(unit) => format!("deviation ({unit})"),
        None => "deviation".into(),
    };
    let area = (!inversion.low.is_empty()).then(|| panel.area(&inversion.low, &inversion.high));
    vec![
        Part::Heading(heading),
        Part::chart(panel.chart(
            &unit::label(&names.output),
            220.0,
            &[
                (Colour::Measured, "wanted", MEASURED_WIDTH, &record.wanted),
                (Colour::Simulated, "model", MODEL_WIDTH, &inversion.output),
            ],
            None,
        )),
        Part::chart(panel.chart(
            &deviation_label,
            200.0,
            &[(Colour::Error, "model − wanted", 1.1, &deviation)],
            None,
        )),
        drive(&panel, &unit::label(&names.inputs[0]), inversion, area),
    ]
}

/// The drive in front of its band, with a dot at each row that does not reach the wanted output.
fn drive(panel: &Panel, label: &str, inversion: &Inversion, area: Option<Curve>) -> Part {
    let place = |row: usize| (panel.time[row], inversion.input[row]);
    let rows = (0..inversion.input.len()).filter(|&row| inversion.reach[row] != Reach::Reached);
    let dots: Vec<Point> = thin(&rows.map(place).collect::<Vec<_>>(), panel.points / 4);
    if dots.is_empty() {
        let line = (Colour::Input, "drive", 1.2, inversion.input.as_slice());
        return Part::chart(panel.chart(label, 200.0, &[line], area));
    }
    let mut legend = vec![(Colour::Input, "drive".to_string()), (Colour::Error, "not reached".to_string())];
    legend.extend(area.iter().map(|_| (Colour::Band, format!("{} % band", number(100.0 * panel.band, 3)))));
    let line: Vec<Point> = (0..inversion.input.len()).map(place).collect();
    let line = Curve::new(thin(&line, panel.points), Colour::Input, 1.2);
    let curves = area.into_iter().chain([line, Curve::dots(dots, Colour::Error, 2.5)]).collect();
    let description = format!(
        "{label} over time, and the rows that do not reach the wanted output, record {}",
        panel.record
    );
    let chart = Chart::new(description, &panel.time_label, label, curves);
    Part::chart(chart.with_height(200.0).with_legend(legend))
}

/// How many rows have which reach, and where the first of them stands.
fn reaches(wanted: &ReferenceOutputs, inverted: &Inverted) -> Table {
    let mut table = Table::new(["reach", "rows", "first line"]);
    for reach in Reach::ALL {
        let count = inverted.count(reach);
        if count == 0 {
            continue;
        }
        let first = wanted.records.iter().zip(&inverted.records).find_map(|(record, inversion)| {
            let row = inversion.reach.iter().position(|found| *found == reach)?;
            Some(wanted.lines[record.rows.start + row])
        });
        table.push([
            format!("{}: {}", reach.word(), meaning(reach)).into(),
            Cell::from(count.to_string()),
            Cell::from(first.map_or_else(String::new, |line| line.to_string())),
        ]);
    }
    table
}
