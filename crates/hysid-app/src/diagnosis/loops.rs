//! The loops of a record in numbers: first, last and largest for a terminal, all of them for a page. They are
//! those of `hysid cycles`.

use hysid::diagnosis::cycles::{CycleRow, CycleTable, FIGURES, Figure};
use hysid_core::significant::Significant;
use hysid_document::chart::thin::{Point, thin};
use hysid_document::plain::aligned;
use hysid_document::{Axis, Cell, Chart, Colour, Curve, Part, Table, count, unit};

use crate::quantities::{Quantities, text_label};
use hysid_document::visible::clipped;

/// Cycles shown at each end of a long table.
const AT_EACH_END: usize = 8;

/// More cycles than these are drawn as a line.
const MOST_DOTS: usize = 400;

/// The figures that are shown, where the field has them.
const SHOWN: &str = "input_min input_max output_min output_max energy secant_stiffness damping_percent \
                     coercive_input remanent_output width frequency";

fn known(table: &CycleTable) -> Vec<&'static Figure> {
    let has = |figure: &&Figure| table.complete().any(|row| (figure.of)(row).is_some());
    FIGURES.iter().filter(|figure| SHOWN.split(' ').any(|name| name == figure.name)).filter(has).collect()
}

fn name(figure: &Figure, quantities: &Quantities) -> String {
    let of_both = if figure.name == "width" { "width along the output" } else { figure.label };
    quantities.as_figure(of_both, figure.quantity)
}

/// The cycle that loses most energy, or has the largest amplitude.
fn largest(rows: &[&CycleRow]) -> Option<usize> {
    let size = |row: &CycleRow| row.energy.map_or(row.amplitude.unwrap_or(0.0), f64::abs);
    (0..rows.len()).max_by(|&a, &b| size(rows[a]).total_cmp(&size(rows[b])))
}

/// Heading of the cycle with the largest energy.
const LARGEST: &str = "largest energy";

/// First, last and largest cycle, column by column.
pub fn text(table: &CycleTable, quantities: &Quantities) -> String {
    let cycles: Vec<&CycleRow> = table.complete().collect();
    let heading = format!("loops of {} over {}", clipped(&quantities.output), clipped(&quantities.input));
    let Some(largest) = largest(&cycles) else {
        return format!("{heading}: no whole cycle\n");
    };
    let shown = [("first", 0), ("last", cycles.len() - 1), (LARGEST, largest)];
    let shown = if cycles.len() == 1 { &shown[..1] } else { &shown };
    let mut rows = vec![vec![count(cycles.len(), "cycle")]];
    rows[0].extend(shown.iter().map(|(which, _)| which.to_string()));
    for figure in known(table) {
        let cell = |&(_, place): &(&str, usize)| {
            (figure.of)(cycles[place]).map_or_else(|| "-".into(), |v| format!("{:.4}", Significant(v)))
        };
        let label = text_label(&name(figure, quantities));
        rows.push(std::iter::once(label).chain(shown.iter().map(cell)).collect());
    }
    format!("{heading}\n{}\n", aligned(&rows).join("\n"))
}

/// Energy over the number of the cycle, and the table; `None` without cycles.
pub fn cycles_section(table: &CycleTable, quantities: &Quantities, several_records: bool) -> Option<Part> {
    let cycles: Vec<&CycleRow> = table.complete().collect();
    let largest = largest(&cycles)?;
    let words = "The cycles of `hysid cycles`, whose page in the documentation defines the figures. Rows count from 1 in their \
                 record.";
    let mut parts: Vec<Part> = energy_chart(&cycles, quantities).map(Part::chart).into_iter().collect();
    parts.push(Part::Table(cycles_table(table, &cycles, quantities, largest, several_records)));
    parts.push(Part::note(words));
    Some(Part::section(format!("Loops: {}", count(cycles.len(), "cycle")), parts))
}

fn energy_chart(cycles: &[&CycleRow], quantities: &Quantities) -> Option<Chart> {
    let points: Vec<Point> = cycles
        .iter()
        .enumerate()
        .filter_map(|(number, cycle)| Some(((number + 1) as f64, cycle.energy?)))
        .collect();
    if points.is_empty() {
        return None;
    }
    let label = unit::label(&quantities.as_energy("energy"));
    let mut curves = vec![Curve::new(thin(&points, 2000), Colour::Faint, 1.0)];
    if cycles.len() <= MOST_DOTS {
        curves.push(Curve::dots(points.iter().copied(), Colour::Simulated, 3.0));
    }
    let y = Axis::linear(label, points.iter().map(|point| point.1).chain([0.0]));
    let x = Axis::linear("cycle", points.iter().map(|point| point.0));
    let words = "Energy of each cycle in the order of the record";
    Some(Chart::on_axes(words, x, y, curves).with_height(260.0))
}

fn cycles_table(
    table: &CycleTable,
    cycles: &[&CycleRow],
    quantities: &Quantities,
    largest: usize,
    several_records: bool,
) -> Table {
    let figures = known(table);
    let mut headings = vec!["cycle".to_string()];
    if several_records {
        headings.push("record".into());
    }
    headings.push("rows".into());
    headings.extend(figures.iter().map(|figure| unit::label(&name(figure, quantities))));
    let row = |place: usize| {
        let cycle = cycles[place];
        let mark = if place == largest { " (largest)" } else { "" };
        let mut cells = vec![Cell::from(format!("{}{mark}", place + 1))];
        if several_records {
            cells.push(cycle.record.as_str().into());
        }
        cells.push(format!("{} to {}", cycle.rows.0 + 1, cycle.rows.1 + 1).into());
        cells.extend(figures.iter().map(|figure| Cell::number((figure.of)(cycle), 4)));
        cells
    };
    let mut printed = Table::new(headings);
    let mut next = 0;
    for place in shown(cycles.len(), largest) {
        if place > next {
            printed.push(["…".into(), format!("{} more", count(place - next, "cycle")).into()]);
        }
        printed.push(row(place));
        next = place + 1;
    }
    printed
}

/// The cycles that a table shows: all of a few, otherwise the first, the last and the largest.
fn shown(cycles: usize, largest: usize) -> Vec<usize> {
    let ends = |place: &usize| *place < AT_EACH_END || *place + AT_EACH_END >= cycles || *place == largest;
    // Leaving out a single one saves nothing.
    let all = cycles <= 2 * AT_EACH_END + 2;
    (0..cycles).filter(|place| all || ends(place)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_tables_show_both_ends_and_the_largest() {
        assert_eq!(shown(18, 3), (0..18).collect::<Vec<_>>());
        let expected: Vec<usize> = (0..8).chain([50]).chain(92..100).collect();
        assert_eq!(shown(100, 50), expected);
        assert_eq!(shown(100, 99).len(), 16);
    }
}
