//! Rows of the table of cycles for text and page.

use hysid::diagnosis::cycles::{CycleRow, Field, Figure, FigureQuantity};
use hysid_document::{Cell, Table};

use super::Cycles;

/// True if the tables of the field mark the points of the backbone.
pub fn has_backbone(field: Field) -> bool {
    matches!(field, Field::Structure | Field::General)
}

/// A name for each row: its number, with its record where there are several, and a star if it is incomplete.
pub fn row_name(cycles: &Cycles, row: &CycleRow) -> String {
    let star = if row.complete { "" } else { "*" };
    match cycles.data.records().len() {
        1 => format!("{}{star}", row.cycle),
        _ => format!("{}/{}{star}", row.record, row.cycle),
    }
}

/// A table of some figures of some rows. `label` makes a heading of the name of a quantity with its unit; of the numbers,
/// four digits are shown.
pub fn shown(
    cycles: &Cycles,
    figures: &[&Figure],
    places: impl Iterator<Item = usize>,
    label: impl Fn(&str) -> String,
) -> Table {
    let heading = |figure: &&Figure| {
        let own = match figure.name {
            // What is lost in a cycle is the loss of a magnet.
            "energy" if cycles.table.field == Field::Magnet => "loss per cycle",
            _ => figure.label,
        };
        let per = if figure.quantity == FigureQuantity::Creep { " per decade" } else { "" };
        let named = cycles.quantities.as_figure(own.trim_end_matches(per), figure.quantity);
        label(&named) + per
    };
    let mut table = Table::new(std::iter::once("cycle".to_string()).chain(figures.iter().map(heading)));
    let mut next = 0;
    for place in places {
        if place > next {
            table.push(["…".into(), Cell::Text(format!("{} more", place - next))]);
        }
        let row = &cycles.table.cycles[place];
        let values = figures.iter().map(|figure| Cell::number((figure.of)(row), 4));
        table.push(std::iter::once(Cell::Text(row_name(cycles, row))).chain(values));
        next = place + 1;
    }
    table
}

pub fn notes(cycles: &Cycles) -> Vec<String> {
    let mut all: Vec<(&str, Vec<String>)> = Vec::new();
    for row in &cycles.table.cycles {
        for note in &row.notes {
            let name = row_name(cycles, row);
            match all.iter_mut().find(|(known, _)| known == note) {
                Some((_, rows)) => rows.push(name),
                None => all.push((note, vec![name])),
            }
        }
    }
    let said = |(note, rows): (&str, Vec<String>)| match rows.len() {
        1 => format!("cycle {}: {note}", rows[0]),
        count if count == cycles.table.cycles.len() => format!("all cycles: {note}"),
        _ => format!("cycles {}: {note}", hysid_document::visible::listed(&rows)),
    };
    all.into_iter().map(said).chain(cycles.table.notes.iter().cloned()).collect()
}

/// Figures of the field that any cycle has, in the order of the list.
pub fn present(cycles: &Cycles, names: &[&str]) -> Vec<&'static Figure> {
    let has = |figure: &&Figure| cycles.table.cycles.iter().any(|row| (figure.of)(row).is_some());
    let find = |name: &&str| hysid::diagnosis::cycles::FIGURES.iter().find(|figure| figure.name == *name);
    names.iter().filter_map(find).filter(has).collect()
}
