//! Cycles and reversal curves as CSV.

use hysid::diagnosis::cycles::Figure;
use hysid::diagnosis::reversal_curves::ReversalCurves;
use hysid_records::{IN_MEMORY, header_line};
use hysid_tables::shortest;

use super::Cycles;
use super::table::has_backbone;

/// How every table of cycles begins, by which it is known again.
pub const BEGINNING: &[u8] = b"record,cycle,first_row,last_row,complete,";

/// The table as CSV: rows count from 1 in their record, an empty cell is a figure that the data do not give.
pub fn csv(cycles: &Cycles) -> Vec<u8> {
    let fixed = ["record", "cycle", "first_row", "last_row", "complete"].map(String::from);
    let named = |figure: &Figure| cycles.quantities.as_figure(figure.name, figure.quantity);
    let figures: Vec<&Figure> = cycles.figures().collect();
    let has_backbone = has_backbone(cycles.table.field);
    let marks: &[&str] =
        if has_backbone { &["backbone_peak", "backbone_valley", "notes"] } else { &["notes"] };
    let names: Vec<String> = fixed
        .into_iter()
        .chain(figures.iter().map(|figure| named(figure)))
        .chain(marks.iter().map(|mark| mark.to_string()))
        .collect();
    let mut writer = csv::Writer::from_writer(header_line(b',', names.iter().map(String::as_str)));
    for row in &cycles.table.cycles {
        let place = [row.cycle, row.rows.0 + 1, row.rows.1 + 1].map(|number| number.to_string());
        let values = figures.iter().map(|figure| (figure.of)(row).map_or_else(String::new, shortest));
        let marks = [row.backbone_peak, row.backbone_valley].map(|mark| yes(mark).to_string());
        let cells = std::iter::once(row.record.clone())
            .chain(place)
            .chain([yes(row.complete).to_string()])
            .chain(values)
            .chain(marks.into_iter().filter(|_| has_backbone))
            .chain([row.notes.join("; ")]);
        writer.write_record(cells).expect(IN_MEMORY);
    }
    writer.into_inner().expect(IN_MEMORY)
}

fn yes(is: bool) -> &'static str {
    if is { "yes" } else { "no" }
}

/// How every table of reversal curves begins, by which it is known again.
pub const BEGINNING_OF_CURVES: &[u8] = b"reversal_input";

/// The nodes as CSV: Everett function and density over reversal input and input.
pub fn curves_csv(cycles: &Cycles, curves: &ReversalCurves) -> Vec<u8> {
    let q = &cycles.quantities;
    let names = [
        q.as_input("reversal_input"),
        q.as_input("input"),
        q.as_output("output"),
        q.as_output("everett"),
        q.as_density("density"),
        q.as_density("density_deviation"),
    ];
    let mut writer = csv::Writer::from_writer(header_line(b',', names.iter().map(String::as_str)));
    for node in &curves.nodes {
        let given = [node.reversal_input, node.input, node.output, node.everett].map(shortest);
        let densities =
            [node.density, node.density_deviation].map(|value| value.map_or_else(String::new, shortest));
        writer.write_record(given.into_iter().chain(densities)).expect(IN_MEMORY);
    }
    writer.into_inner().expect(IN_MEMORY)
}
