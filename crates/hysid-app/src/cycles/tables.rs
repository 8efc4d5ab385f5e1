//! Cycles, levels, figures of records and reversal curves as CSV.

use hysid::diagnosis::cycles::{CycleRow, Figure, LEVEL_FIGURES, LevelRow, RecordFigure};
use hysid::diagnosis::model::MagnetisationNode;
use hysid::diagnosis::reversal_curves::{MarginalValue, ReversalCurves, ReversalNode};
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
    let row = |row: &CycleRow| {
        let place = [row.cycle, row.rows.0 + 1, row.rows.1 + 1].map(|number| number.to_string());
        let values = figures.iter().map(|figure| optional((figure.of)(row)));
        let marks = [row.backbone_peak, row.backbone_valley].map(|mark| yes(mark).to_string());
        std::iter::once(row.record.clone())
            .chain(place)
            .chain([yes(row.complete).to_string()])
            .chain(values)
            .chain(marks.into_iter().filter(|_| has_backbone))
            .chain([row.notes.join("; ")])
            .collect()
    };
    written(&names, cycles.table.cycles.iter().map(row))
}

fn yes(is: bool) -> &'static str {
    if is { "yes" } else { "no" }
}

/// A table beside that of the cycles.
pub struct SideTable {
    /// Name of its contents.
    pub what: &'static str,
    /// How its file name ends, after the name of the table of cycles.
    pub extension: &'static str,
    /// How it begins, by which it is known again.
    pub beginning: &'static [u8],
    pub content: Vec<u8>,
}

/// The tables beside that of the cycles, as far as the data have them.
pub fn side_tables(cycles: &Cycles) -> Vec<SideTable> {
    let mut tables = Vec::new();
    if !cycles.table.levels.is_empty() {
        let (what, extension, beginning) = ("levels", "levels.csv", &b"record,level,cycles,"[..]);
        tables.push(SideTable { what, extension, beginning, content: levels_csv(cycles) });
    }
    if cycles.table.figures.iter().any(|figure| figure.value.is_some()) {
        let (what, extension, beginning) = ("figures", "figures.csv", &b"record,of,figure,symbol,"[..]);
        tables.push(SideTable { what, extension, beginning, content: figures_csv(cycles) });
    }
    if let Some(curves) = &cycles.curves {
        let (what, extension, beginning) = ("FORC", "forc.csv", &b"reversal_input"[..]);
        tables.push(SideTable { what, extension, beginning, content: curves_csv(cycles, curves) });
        let (what, extension, beginning) = ("margins", "forc-margins.csv", &b"distribution,field"[..]);
        tables.push(SideTable { what, extension, beginning, content: marginals_csv(cycles, curves) });
    }
    if !cycles.magnetisation.is_empty() {
        let (what, extension, beginning) = ("curves", "curves.csv", &b"input"[..]);
        tables.push(SideTable { what, extension, beginning, content: magnetisation_csv(cycles) });
    }
    tables
}

/// Initial and anhysteretic curve as CSV.
fn magnetisation_csv(cycles: &Cycles) -> Vec<u8> {
    let q = &cycles.quantities;
    let names = [q.as_input("input"), q.as_output("initial"), q.as_output("anhysteretic")];
    let row = |node: &MagnetisationNode| [node.input, node.initial, node.anhysteretic].map(shortest).into();
    written(&names, cycles.magnetisation.iter().map(row))
}

/// The levels as CSV.
fn levels_csv(cycles: &Cycles) -> Vec<u8> {
    let figure = |figure: &Figure<_>| cycles.quantities.as_figure(figure.name, figure.quantity);
    let names =
        ["record", "level", "cycles"].map(String::from).into_iter().chain(LEVEL_FIGURES.iter().map(figure));
    let row = |row: &LevelRow| {
        let values = LEVEL_FIGURES.iter().map(|figure| optional((figure.of)(row)));
        [row.record.clone(), row.level.to_string(), row.cycles.to_string()]
            .into_iter()
            .chain(values)
            .collect()
    };
    written(&names.collect::<Vec<_>>(), cycles.table.levels.iter().map(row))
}

/// The figures of records as CSV.
fn figures_csv(cycles: &Cycles) -> Vec<u8> {
    let names =
        ["record", "of", "figure", "symbol", "value", "deviation", "low", "high", "unit", "source", "note"]
            .map(String::from);
    let row = |figure: &RecordFigure| {
        let named = cycles.quantities.as_figure(figure.kind.name, figure.kind.quantity);
        vec![
            figure.record.clone(),
            figure.of.clone(),
            figure.kind.name.into(),
            figure.kind.symbol.into(),
            optional(figure.value),
            optional(figure.deviation),
            optional(figure.interval.map(|interval| interval.0)),
            optional(figure.interval.map(|interval| interval.1)),
            hysid::data::unit::of_column(&named).unwrap_or_default(),
            figure.kind.source.into(),
            figure.note.clone().unwrap_or_default(),
        ]
    };
    written(&names, cycles.table.figures.iter().map(row))
}

/// The nodes as CSV: Everett function and density over reversal input and input.
fn curves_csv(cycles: &Cycles, curves: &ReversalCurves) -> Vec<u8> {
    let q = &cycles.quantities;
    let names = [
        q.as_input("reversal_input"),
        q.as_input("input"),
        q.as_output("output"),
        q.as_output("everett"),
        q.as_density("density"),
        q.as_density("density_deviation"),
        q.as_input("coercivity"),
        q.as_input("interaction"),
    ];
    let row = |node: &ReversalNode| {
        let given = [node.reversal_input, node.input, node.output, node.everett].map(shortest);
        let densities = [node.density, node.density_deviation].map(optional);
        let (coercivity, interaction) = curves.fields(node);
        given.into_iter().chain(densities).chain([coercivity, interaction].map(shortest)).collect()
    };
    written(&names, curves.nodes.iter().map(row))
}

/// The marginal distributions of the density as CSV.
fn marginals_csv(cycles: &Cycles, curves: &ReversalCurves) -> Vec<u8> {
    let q = &cycles.quantities;
    let names = ["distribution".to_string(), q.as_input("field"), q.as_stiffness("density")];
    let row = |name: &str, value: MarginalValue| {
        vec![name.to_string(), shortest(value.field), shortest(value.density)]
    };
    let [coercivity, interaction] = curves.marginals();
    let rows = coercivity.into_iter().map(|value| row("coercivity", value));
    written(&names, rows.chain(interaction.into_iter().map(|value| row("interaction", value))))
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, shortest)
}

fn written(names: &[String], rows: impl Iterator<Item = Vec<String>>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(header_line(b',', names.iter().map(String::as_str)));
    rows.for_each(|row| writer.write_record(row).expect(IN_MEMORY));
    writer.into_inner().expect(IN_MEMORY)
}
