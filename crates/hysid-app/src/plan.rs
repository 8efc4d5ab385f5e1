//! A plan for its reader: text, page, table of the drive, JSON.

mod page;
#[cfg(feature = "tables")]
mod rows;
mod text;

use std::path::Path;

use hysid::data::unit;
use hysid::plan::Plan;
use hysid_document::{Cell, Table, number, object};
use serde::Serialize;

pub use page::page;
#[cfg(feature = "tables")]
pub use rows::rows;
pub use text::text;

/// A plan and what was understood before it.
pub struct Planned<'a> {
    pub plan: &'a Plan,
    pub title: String,
    /// How the data were read; empty without data.
    pub understood: Vec<(String, String)>,
    /// The command with which the results of the drive are used.
    pub next: String,
}

/// The object that `--json` prints; the drive is in its file.
pub fn printed(plan: &Plan, drive: &Path, page: Option<&Path>) -> impl Serialize {
    object! {
        drive: drive.display().to_string(),
        page: page.map(|page| page.display().to_string()),
        rows: plan.rows(),
        duration: duration(plan),
        wave: plan.wave,
        limits: plan.limits,
        segments: &plan.segments,
        gaps: &plan.gaps,
        sources: &plan.sources,
    }
}

fn duration(plan: &Plan) -> Option<f64> {
    plan.time.as_ref()?.last().copied()
}

/// Unit of the rate of the input, such as mm/s.
fn rate_unit(plan: &Plan) -> String {
    let input = unit::of_column(&plan.names.inputs[0]);
    let time = plan.names.time.as_ref().and_then(|name| unit::of_column(name));
    match (plan.limits.step, input, time) {
        (Some(_), Some(input), Some(time)) => unit::quotient(&input, &time),
        (Some(_), ..) => "per unit of time".into(),
        (None, Some(input), _) => format!("{input} per row"),
        (None, None, _) => "per row".into(),
    }
}

fn headline(plan: &Plan) -> String {
    let input = &plan.names.inputs[0];
    let duration = duration(plan).map_or_else(String::new, |duration| {
        let unit = plan.names.time.as_ref().and_then(|name| unit::of_column(name));
        let shown = number(duration, 4);
        unit.map_or_else(|| format!(" (duration {shown})"), |unit| format!(" ({shown} {unit})"))
    });
    let driven = plan
        .input
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
    let range = |(low, high): (f64, f64)| {
        format!("{} to {}", number(low, 4), hysid_document::unit::with(&number(high, 4), input))
    };
    format!(
        "{} rows{duration}: {} from {}, within the limits {} and {} {}",
        plan.rows(),
        hysid_document::unit::split(input).0,
        range(driven),
        range(plan.limits.range),
        number(plan.limits.max_rate, 3),
        rate_unit(plan)
    )
}

fn segments(plan: &Plan) -> Table {
    let mut table = Table::new(["", "segment", "rows", "amplitude", "mean", "rate"]);
    for (index, segment) in plan.segments.iter().enumerate() {
        table.push([
            Cell::from((index + 1).to_string()),
            segment.kind.words().into(),
            format!("{}-{}", segment.rows.start + 1, segment.rows.end).into(),
            Cell::number(segment.amplitude, 3),
            Cell::number(segment.mean, 3),
            Cell::number(segment.rate, 3),
        ]);
    }
    table
}
