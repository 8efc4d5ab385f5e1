//! The page: pictures, the whole table, first-order reversal curves, and how the data were read.

use hysid::diagnosis::cycles::{CycleRow, Figure, LEVEL_FIGURES, RecordFigure};
use hysid_document::{Colour, Page, Part, Text, number, unit};

use super::table::{has_backbone, levels, losses, notes, present, record_figures, shown};
use super::text::{begin, main_figures};
use super::{Cycles, curves, over_amplitude, pictures};

/// Rows of a long table at each end.
const AT_EACH_END: usize = 100;

/// Share of the incomplete cycles that have a figure which is shown.
const MOST_PARTS: f64 = 0.9;

/// Figures that the page leaves to the file: when and where a cycle is, and the deviation of its energy.
const PLACES: [&str; 5] = ["start_time", "input_min", "input_max", "energy_deviation", "width_deviation"];

pub fn page(cycles: &Cycles) -> Page {
    let lead = match cycles.of_model {
        true => {
            format!("{}. Hysid drove the model through cycles over its trained range.", cycles.headline())
        }
        false => format!("{}. Cycles begin {}.", cycles.headline(), begin(cycles)),
    };
    let mut parts = vec![Part::Lead(Text::from(lead))];
    let of_records = pictures::colours(cycles).0;
    let colour = Colour::Simulated;
    let alone = [over_amplitude::Shown { cycles, colour, of_records, radius: 3.0, name: "cycles" }];
    let mut figures = over_amplitude::figures(&alone);
    figures.extend(over_amplitude::losses(&alone));
    let mut columns = vec![vec![Part::chart(pictures::loops(cycles))]];
    let heading = Part::heading("Figures over amplitude");
    columns.extend((!figures.is_empty()).then(|| vec![heading, Part::Charts(figures)]));
    parts.push(Part::section("Loops", [Part::Columns(columns)]));
    if !cycles.table.cycles.is_empty() {
        parts.push(table_section(cycles));
    }
    parts.extend(record_section(cycles));
    parts.extend(levels_section(cycles));
    parts.extend(backbone_section(cycles));
    parts.extend(losses_section(cycles));
    parts.extend(curves_section(cycles));
    parts.push(Part::section("How the data were read", [Part::Definitions(cycles.understood.clone())]));
    Page { title: format!("Cycles: {}", cycles.file), parts }
}

fn table_section(cycles: &Cycles) -> Part {
    let first = main_figures(cycles.table.field);
    let others = cycles.figures().map(|figure| figure.name);
    let others = others.filter(|name| !PLACES.contains(name) && !first.contains(name));
    let names: Vec<&str> = first.iter().copied().chain(others).collect();
    // Parts of cycles have other figures than whole ones: together, half of the cells would be empty.
    let table = |is_complete: bool| {
        let is_it = |row: &&CycleRow| row.complete == is_complete;
        let rows: Vec<&CycleRow> = cycles.table.cycles.iter().filter(is_it).collect();
        let mut figures = present(&rows, &names);
        if !is_complete {
            let known = |figure: &Figure| rows.iter().filter(|row| (figure.of)(row).is_some()).count();
            figures.retain(|figure| known(figure) as f64 >= MOST_PARTS * rows.len() as f64);
        }
        let table = shown(cycles, &rows, &figures, AT_EACH_END, unit::label);
        (!table.rows.is_empty()).then_some(Part::Table(table))
    };
    let whole = table(true);
    let mut parts: Vec<Part> = Vec::new();
    // Reversal curves alone are no cycles, and have a section of their own.
    if (cycles.curves.is_none() || whole.is_some())
        && let Some(incomplete) = table(false)
    {
        let words = Part::note(
            "The record begins or ends within the cycle: what needs a whole cycle, or a peak or valley that few of them \
             have, is left out.",
        );
        let parts_of_cycles = vec![words, incomplete];
        parts.extend(match whole.is_some() {
            true => vec![Part::Folded("Incomplete parts".into(), parts_of_cycles)],
            false => parts_of_cycles,
        });
    }
    parts.splice(..0, whole);
    let notes = notes(cycles);
    if !notes.is_empty() {
        parts.push(Part::Folded("Notes".into(), vec![Part::warnings(&notes)]));
    }
    Part::section("Cycles", parts)
}

/// The figures of records, each with its symbol and source.
fn record_section(cycles: &Cycles) -> Option<Part> {
    let label = |figure: &RecordFigure, name: &str| format!("{}, {}", figure.kind.symbol, unit::label(name));
    let table = record_figures(cycles, label)?;
    let mut sources: Vec<&str> = cycles.table.figures.iter().map(|figure| figure.kind.source).collect();
    sources.dedup();
    let sources =
        format!("Definitions: the page Tables of cycles of the documentation, after {}.", sources.join("; "));
    Some(Part::section("Figures of the record", [Part::Table(table), Part::note(sources)]))
}

fn levels_section(cycles: &Cycles) -> Option<Part> {
    let names: Vec<&str> = LEVEL_FIGURES.iter().map(|figure| figure.name).collect();
    let words = "A level has successive cycles whose amplitudes differ by less than 5 %. Losses are from its first cycle \
                 to its last.";
    // Levels of one cycle each are the table of cycles again, unless they have a drift.
    let has_several =
        cycles.table.levels.iter().any(|level| level.cycles > 1 || level.drift_percent.is_some());
    levels(cycles, &names, unit::label)
        .filter(|_| has_several)
        .map(|table| Part::section("Levels of amplitude", [Part::Table(table), Part::note(words)]))
}

fn backbone_section(cycles: &Cycles) -> Option<Part> {
    let points = &cycles.table.backbone;
    if points.is_empty() || !has_backbone(cycles.table.field) {
        return None;
    }
    let q = &cycles.quantities;
    let headings = ["record".to_string(), "row".into(), unit::label(&q.input), unit::label(&q.output)];
    let mut table = hysid_document::Table::new(headings);
    for point in points {
        table.push([
            point.record.as_str().into(),
            (point.row + 1).into(),
            hysid_document::Cell::number(point.input, 4),
            hysid_document::Cell::number(point.output, 4),
        ]);
    }
    let words = "The turning points of the first cycle of each level: those 5 % beyond the points before them in their \
                 direction.";
    Some(Part::section("Backbone", [Part::Table(table), Part::note(words)]))
}

fn losses_section(cycles: &Cycles) -> Option<Part> {
    let table = losses(cycles, unit::label)?;
    let words = "Means of cycles whose amplitudes and frequencies differ by less than 5 %. The parts of the loss per cycle \
                 are those of the separation in \"Figures of the record\".";
    Some(Part::section("Losses by frequency", [Part::Table(table), Part::note(words)]))
}

fn curves_section(cycles: &Cycles) -> Option<Part> {
    let found = cycles.curves.as_ref()?;
    let q = &cycles.quantities;
    let mut parts = vec![
        Part::paragraph(curves::summary(cycles, found, |value| number(value, 4)) + "."),
        Part::chart(pictures::reversal_curves(cycles, found)),
    ];
    if found.nodes.iter().any(|node| node.density.is_some()) {
        parts.push(Part::heading(format!("FORC diagram: {}", unit::label(&q.as_density("density")))));
        parts.push(Part::chart(pictures::forc_diagram(cycles, found)));
        parts.push(Part::note(format!(
            "H_c: half the distance of input and reversal input, the coercivity of a relay; H_u: their mean, the \
             interaction field. Both axes have the same scale. Colours are classes of the density, with their limits beside them; the density is the mixed derivative of \
             parabolas over {} curves and as many steps of the input. Its largest magnitude is {}.",
            2 * found.smoothing_factor + 1,
            number(found.largest_density(), 3),
        )));
    }
    parts.push(Part::heading(unit::label(&q.as_output("Everett function"))));
    parts.push(Part::chart(pictures::everett(cycles, found)));
    parts.push(Part::note(
        "Half the change of the output from the reversal input to the input: what the relays between both switch.",
    ));
    if !found.notes.is_empty() {
        parts.push(Part::warnings(&found.notes));
    }
    Some(Part::section("First-order reversal curves", parts))
}
