//! The page of a plan: the drive, its segments and their reasons, what the data do not cover.

use hysid_document::chart::thin::{Point, thin};
use hysid_document::{Chart, Colour, Curve, Item, Page, Part, Table, unit};

use super::{Planned, headline, segments};

/// Points of the drive at most.
const POINTS: usize = 6000;

pub fn page(planned: &Planned<'_>) -> Page {
    let plan = planned.plan;
    let mut parts = vec![Part::Lead((headline(plan) + ".").into())];
    parts.push(Part::section("Drive", [Part::chart(drive(planned))]));
    parts.push(Part::section("Segments", [Part::Table(segments(plan)), Part::Table(reasons(planned))]));
    if !plan.gaps.is_empty() {
        let mut table = Table::new(["", "what the data do not cover"]);
        plan.gaps.iter().for_each(|gap| table.push([gap.what.into(), gap.statement.as_str().into()]));
        parts.push(Part::section("What the data do not cover", [Part::Table(table)]));
    }
    if !plan.sources.is_empty() {
        let sources =
            plan.sources.iter().map(|source| Item { text: (*source).into(), is_warning: false }).collect();
        parts.push(Part::section("Sources", [Part::List(sources)]));
    }
    parts.push(Part::section(
        "Next",
        [
            Part::paragraph(
                "Run the drive on a specimen like the first, save the results as NEW.csv, and fit again:",
            ),
            Part::Command(planned.next.clone()),
        ],
    ));
    if !planned.understood.is_empty() {
        parts.push(Part::section("How the data were read", [Part::Definitions(planned.understood.clone())]));
    }
    Page { title: planned.title.clone(), parts }
}

/// The input over time.
fn drive(planned: &Planned<'_>) -> Chart {
    let plan = planned.plan;
    let time = |row: usize| plan.time.as_ref().map_or((row + 1) as f64, |time| time[row]);
    let points: Vec<Point> = plan.input.iter().enumerate().map(|(row, &x)| (time(row), x)).collect();
    let x = match (&plan.time, &plan.names.time) {
        (Some(_), Some(name)) => unit::label(name),
        (Some(_), None) => "time".into(),
        (None, _) => "row".into(),
    };
    let y = unit::label(&plan.names.inputs[0]);
    let curve = Curve::new(thin(&points, POINTS), Colour::Input, 1.2);
    Chart::new(format!("{y} of the drive over {x}"), &x, &y, vec![curve]).with_height(260.0)
}

fn reasons(planned: &Planned<'_>) -> Table {
    let mut table = Table::new(["", "why"]);
    for (index, segment) in planned.plan.segments.iter().enumerate() {
        table.push([(index + 1).to_string().into(), segment.reason.as_str().into()]);
    }
    table
}
