//! The loops of a record in numbers: first, last and largest for a terminal, all of them for a page.

use hysid::diagnosis::Cycle;
use hysid::significant::Significant;
use hysid_document::chart::thin::{Point, thin};
use hysid_document::plain::aligned;
use hysid_document::{Axis, Cell, Chart, Colour, Curve, Part, Table, count, unit};

use crate::quantities::{Quantities, text_label};
use hysid_document::visible::clipped;

/// Cycles shown at each end of a long table.
const AT_EACH_END: usize = 8;

/// More cycles than these are drawn as a line.
const MOST_DOTS: usize = 400;

/// A number read from a loop.
struct Measure {
    /// Named like a column, with its unit.
    name: String,
    of: fn(&Cycle) -> Option<f64>,
}

fn measures(quantities: &Quantities) -> Vec<Measure> {
    let measure = |name: String, of: fn(&Cycle) -> Option<f64>| Measure { name, of };
    vec![
        measure(quantities.as_input("input from"), |cycle| Some(cycle.input.0)),
        measure(quantities.as_input("input to"), |cycle| Some(cycle.input.1)),
        measure(quantities.as_energy("energy"), |cycle| Some(cycle.energy)),
        measure(quantities.as_input("width"), |cycle| Some(cycle.width)),
        measure(quantities.as_output("height"), |cycle| Some(cycle.height())),
        measure(quantities.as_input("coercive input"), |cycle| cycle.coercive_input),
        measure(quantities.as_output("remanent output"), |cycle| cycle.remanent_output),
        measure(quantities.as_stiffness("secant stiffness"), |cycle| Some(cycle.secant_stiffness)),
        measure(quantities.as_speed("speed"), |cycle| cycle.speed),
    ]
}

/// The measures that any of the cycles has.
fn known(quantities: &Quantities, cycles: &[Cycle]) -> Vec<Measure> {
    let mut measures = measures(quantities);
    measures.retain(|measure| cycles.iter().any(|cycle| (measure.of)(cycle).is_some()));
    measures
}

/// The cycle with the largest area.
fn largest(cycles: &[Cycle]) -> Option<usize> {
    (0..cycles.len()).max_by(|&a, &b| cycles[a].area.total_cmp(&cycles[b].area))
}

/// First, last and largest loop, column by column.
pub fn text(cycles: &[Cycle], quantities: &Quantities) -> String {
    let heading = format!("loops of {} over {}", clipped(&quantities.output), clipped(&quantities.input));
    let Some(largest) = largest(cycles) else {
        return format!("{heading}: none closes\n");
    };
    let shown = [("first", 0), ("last", cycles.len() - 1), ("largest", largest)];
    let shown = if cycles.len() == 1 { &shown[..1] } else { &shown };
    let mut rows = vec![vec![count(cycles.len(), "cycle")]];
    rows[0].extend(shown.iter().map(|(which, _)| which.to_string()));
    for measure in known(quantities, cycles) {
        let cell = |&(_, place): &(&str, usize)| {
            (measure.of)(&cycles[place]).map_or_else(|| "-".into(), |v| format!("{:.4}", Significant(v)))
        };
        rows.push(std::iter::once(text_label(&measure.name)).chain(shown.iter().map(cell)).collect());
    }
    format!("{heading}\n{}\n", aligned(&rows).join("\n"))
}

/// Energy over the number of the cycle, and the table; `None` without cycles.
pub fn cycles_section(cycles: &[Cycle], quantities: &Quantities, several_records: bool) -> Option<Part> {
    let largest = largest(cycles)?;
    let words = "Energy is the area ∮ y dx, positive if the loop is traversed clockwise. Width is measured \
                 at half the height; coercive input and remanent output are half the distance of the \
                 branches where the output, or the input, is 0; secant stiffness is the slope from tip to \
                 tip. Rows count from 1 in their record.";
    let parts = [
        Part::chart(energy_chart(cycles, quantities)),
        Part::Table(cycles_table(cycles, quantities, largest, several_records)),
        Part::note(words),
    ];
    Some(Part::section(format!("Loops: {}", count(cycles.len(), "cycle")), parts))
}

fn energy_chart(cycles: &[Cycle], quantities: &Quantities) -> Chart {
    let points: Vec<Point> =
        cycles.iter().enumerate().map(|(number, cycle)| ((number + 1) as f64, cycle.energy)).collect();
    let label = unit::label(&quantities.as_energy("energy"));
    let mut curves = vec![Curve::new(thin(&points, 2000), Colour::Faint, 1.0)];
    if cycles.len() <= MOST_DOTS {
        curves.push(Curve::dots(points.iter().copied(), Colour::Simulated, 3.0));
    }
    let y = Axis::linear(label, points.iter().map(|point| point.1).chain([0.0]));
    let x = Axis::linear("cycle", points.iter().map(|point| point.0));
    Chart::on_axes("Energy of each cycle in the order of the record", x, y, curves).with_height(260.0)
}

fn cycles_table(cycles: &[Cycle], quantities: &Quantities, largest: usize, several_records: bool) -> Table {
    let measures = known(quantities, cycles);
    let mut headings = vec!["cycle".to_string()];
    if several_records {
        headings.push("record".into());
    }
    headings.push("rows".into());
    headings.extend(measures.iter().map(|measure| unit::label(&measure.name)));
    let row = |place: usize| {
        let cycle = &cycles[place];
        let mark = if place == largest { " (largest)" } else { "" };
        let mut cells = vec![Cell::from(format!("{}{mark}", place + 1))];
        if several_records {
            cells.push(cycle.record.as_str().into());
        }
        cells.push(format!("{} to {}", cycle.rows.0 + 1, cycle.rows.1 + 1).into());
        cells.extend(measures.iter().map(|measure| Cell::number((measure.of)(cycle), 4)));
        cells
    };
    let mut table = Table::new(headings);
    let mut next = 0;
    for place in shown(cycles.len(), largest) {
        if place > next {
            table.push(["…".into(), format!("{} more", count(place - next, "cycle")).into()]);
        }
        table.push(row(place));
        next = place + 1;
    }
    table
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
