//! Figures of cycles: measured data beside a model.

use std::borrow::Cow;
use std::collections::HashMap;

use anyhow::{Result, anyhow, bail};
use hysid::data::record::Dataset;
use hysid::diagnosis::cycles::{CycleOptions, CycleTable, Field};
use hysid_app::quantities::Quantities;
use hysid_app::tracks::times;
use hysid_app::{MODEL_WIDTH, time_label};
use hysid_document::chart::thin::Point;
use hysid_document::{Chart, Colour, Curve, unit};

use super::PlotData;
use super::curves::{BOTH, alone, legend};
use hysid_app::cycles::Cycles;
use hysid_app::cycles::over_amplitude::{self, Shown};
use hysid_app::cycles::pictures::path;

/// Height of a chart over its width.
const SHAPE: f64 = 0.7;

/// From this width on, in pixels, charts stand side by side: 120 mm.
const WIDE: f64 = 120.0 * hysid_document::chart::PIXELS_PER_MILLIMETRE;

/// Points of the loops behind a backbone.
const LOOP_POINTS: usize = 6000;

/// Radii of the dots of measured data and a model, in pixels.
const RADII: [f64; 2] = [4.2, 2.0];

/// The figures of the field over amplitude, in two columns if there is room.
pub fn figures(subject: &PlotData, options: &CycleOptions, width: f64) -> Result<Vec<Chart>> {
    let sets = Sets::of(subject, options)?;
    let charts = over_amplitude::figures(&sets.shown(subject));
    if charts.is_empty() {
        bail!("no complete cycle has a figure to draw: `hysid cycles` says why");
    }
    let width = if width >= WIDE && charts.len() > 1 { 0.5 * width } else { width };
    Ok(charts.into_iter().map(|chart| chart.sized(width, SHAPE * width)).collect())
}

/// The backbones in front of the loops.
pub fn backbone(subject: &PlotData, options: &CycleOptions, width: f64) -> Result<Chart> {
    let sets = Sets::of(subject, options)?;
    let all = sets.all();
    let data = &all[0].data;
    let most = (LOOP_POINTS / data.records().len()).max(100);
    let of_record = |record: &hysid::data::record::Record| {
        Curve::new(path(&record.inputs()[0], record.output(), most), Colour::Faint, 0.7)
    };
    let mut curves: Vec<Curve> = data.records().iter().map(of_record).collect();
    let loops = curves.len();
    for (cycles, (colour, line, radius)) in all.iter().zip(sets.looks(subject)) {
        curves.extend(over_amplitude::backbone(cycles, colour, (line, radius)));
    }
    if curves.len() == loops {
        bail!("no cycle is larger than all before it in both directions, so there is no backbone");
    }
    let names = subject.data.names();
    let (x, y) = (unit::label(&names.inputs[0]), unit::label(&names.output));
    let of_loops = if subject.is_measured() { "measured loops" } else { "loops of the model" };
    let mut entries = match legend(subject) {
        both if both.is_empty() => vec![(alone(subject), "backbone")],
        both => both,
    };
    entries.push((Colour::Faint, of_loops));
    let chart = Chart::new(format!("Backbone: {y} over {x}"), &x, &y, curves);
    Ok(chart.sized(width, 0.75 * width).with_legend(entries))
}

/// The energy of the complete cycles so far, over time.
pub fn energy(subject: &PlotData, options: &CycleOptions, width: f64) -> Result<Chart> {
    let sets = Sets::of(subject, options)?;
    let mut curves = Vec::new();
    for (cycles, (colour, line, radius)) in sets.all().into_iter().zip(sets.looks(subject)) {
        for points in cumulative(cycles) {
            curves.extend([
                Curve::dots(points.clone(), colour, 0.6 * radius),
                Curve::new(points, colour, line),
            ]);
        }
    }
    if curves.is_empty() {
        bail!(
            "no complete cycle has an energy: `hysid cycles` says why; cycles of an actuator have one with --field general"
        );
    }
    let (x, y) =
        (time_label(&subject.data), unit::label(&sets.all()[0].quantities.as_energy("cumulative energy")));
    let chart = Chart::new(format!("{y} of the cycles over {x}"), &x, &y, curves);
    Ok(chart.sized(width, SHAPE * width).with_legend(legend(subject)))
}

/// The cumulative energy at the end of each complete cycle, record by record, from 0 at the beginning of the first.
fn cumulative(cycles: &Cycles) -> Vec<Vec<Point>> {
    let of_record = |record: &hysid::data::record::Record| {
        let times = times(record);
        let own = || cycles.table.complete().filter(|row| row.record == record.name());
        let start = own().next().map(|row| (times[row.rows.0], 0.0));
        let points = own().filter_map(|row| Some((times[row.rows.1], row.cumulative_energy?)));
        start.into_iter().chain(points).collect::<Vec<Point>>()
    };
    cycles.data.records().iter().map(of_record).filter(|points| points.len() > 1).collect()
}

/// Loss of a cycle over frequency, or width of the loop of an actuator.
pub fn frequency(subject: &PlotData, options: &CycleOptions, width: f64) -> Result<Chart> {
    let sets = Sets::of(subject, options)?;
    let shown = sets.shown(subject);
    let chart = match shown[0].cycles.table.field {
        Field::Actuator => over_amplitude::width_over_frequency(&shown),
        _ => over_amplitude::losses(&shown),
    };
    let Some(chart) = chart else {
        bail!(
            "no amplitude was run at several frequencies (or there is no time), so there is nothing to draw over frequency"
        );
    };
    let chart = chart.sized(width, SHAPE * width);
    let is_by_amplitude = shown.len() > 1 && shown[0].cycles.table.field != Field::Actuator;
    Ok(Chart {
        title: if is_by_amplitude { "dots: measured, lines: model".into() } else { String::new() },
        ..chart
    })
}

/// The cycles of the measured data and of the model on them: one of both, or both.
struct Sets<'a> {
    measured: Option<Cycles<'a>>,
    model: Option<Cycles<'a>>,
}

impl<'a> Sets<'a> {
    fn of(subject: &'a PlotData, options: &CycleOptions) -> Result<Self> {
        let measured =
            subject.is_measured().then(|| cycles(Cow::Borrowed(&subject.data), options)).transpose()?;
        // Both are divided alike.
        let alike = CycleOptions {
            division: measured.as_ref().map(|cycles| cycles.table.division).or(options.division),
            ..options.clone()
        };
        let model = subject.simulated()?.map(|data| cycles(Cow::Owned(data), &alike)).transpose()?;
        if measured.is_none() && model.is_none() {
            bail!("the data have no output");
        }
        Ok(Self { measured, model })
    }

    fn all(&self) -> Vec<&Cycles<'a>> {
        self.measured.iter().chain(&self.model).collect()
    }

    /// Colour, width of lines and radius of dots of each set.
    fn looks(&self, subject: &PlotData) -> Vec<(Colour, f64, f64)> {
        match (&self.measured, &self.model) {
            (Some(_), Some(_)) => {
                BOTH.iter().zip(RADII).map(|(&(colour, line), radius)| (colour, line, radius)).collect()
            }
            _ => vec![(alone(subject), MODEL_WIDTH, 3.0)],
        }
    }

    fn shown(&self, subject: &PlotData) -> Vec<Shown<'_>> {
        let names = ["measured", "model"];
        let looks = self.looks(subject).into_iter().zip(names);
        let shown = |(cycles, ((colour, _, radius), name))| Shown {
            cycles,
            colour,
            of_records: HashMap::new(),
            radius,
            name,
        };
        self.all().into_iter().zip(looks).map(shown).collect()
    }
}

fn cycles<'a>(data: Cow<'a, Dataset>, options: &CycleOptions) -> Result<Cycles<'a>> {
    let table = CycleTable::of(&data, options).map_err(|error| anyhow!("{error}"))?;
    Ok(Cycles {
        file: String::new(),
        of_model: false,
        quantities: Quantities::of(data.names()),
        data,
        table,
        curves: None,
        magnetisation: Vec::new(),
        understood: Vec::new(),
    })
}
