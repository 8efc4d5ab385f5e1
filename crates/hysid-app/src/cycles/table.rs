//! Rows of the table of cycles for text and page.

use hysid::data::unit;
use hysid::diagnosis::cycles::{
    CycleRow, Field, Figure, FigureQuantity, LEVEL_FIGURES, LossAtFrequency, RecordFigure,
};
use hysid_core::significant::Significant;
use hysid_document::{Cell, Table};

use super::Cycles;

/// Frequencies that differ by more than this factor are drawn.
pub(super) const SEVERAL: f64 = 1.05;

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

/// Figures that say where a cycle is. A row that has no others is not shown.
const PLACES: [&str; 9] = [
    "start_time",
    "period",
    "frequency",
    "input_min",
    "input_max",
    "amplitude",
    "mean_input",
    "output_min",
    "output_max",
];

/// A table of some figures of those of the rows that have any of them: `at_each_end` rows of a long table. `label` makes a
/// heading of the name of a quantity with its unit; of the numbers, four digits are shown.
pub fn shown(
    cycles: &Cycles,
    rows: &[&CycleRow],
    figures: &[&Figure],
    at_each_end: usize,
    label: impl Fn(&str) -> String,
) -> Table {
    let (has_voltage, has_polarisation) =
        (cycles.quantities.is_of_voltage(), cycles.quantities.is_polarisation());
    let heading = |figure: &&Figure| {
        let own = match (figure.name, cycles.table.field) {
            // What is lost in a cycle is the loss of a magnet.
            ("energy", Field::Magnet) => "loss per cycle",
            ("coercive_input", Field::Magnet) if has_voltage => "coercive voltage",
            ("remanent_output", Field::Magnet) if has_polarisation => "remanent polarisation",
            ("width_percent", Field::Actuator) => "hysteresis",
            _ => figure.label,
        };
        let per = if figure.quantity == FigureQuantity::Creep { " per decade" } else { "" };
        let named = cycles.quantities.as_figure(own.trim_end_matches(per), figure.quantity);
        label(&named) + per
    };
    let mut table = Table::new(std::iter::once("cycle".to_string()).chain(figures.iter().map(heading)));
    let is_read = |figure: &&Figure| !PLACES.contains(&figure.name);
    let needed: Vec<&Figure> = match figures.iter().any(is_read) {
        true => figures.iter().copied().filter(is_read).collect(),
        false => figures.to_vec(),
    };
    let has_any = |row: &&CycleRow| needed.iter().any(|figure| (figure.of)(row).is_some());
    let rows: Vec<&CycleRow> = rows.iter().copied().filter(has_any).collect();
    let mut next = 0;
    for place in both_ends(rows.len(), at_each_end) {
        if place > next {
            table.push(["…".into(), Cell::Text(format!("{} more", place - next))]);
        }
        let row = rows[place];
        let values = figures.iter().map(|figure| Cell::number((figure.of)(row), 4));
        table.push(std::iter::once(Cell::Text(row_name(cycles, row))).chain(values));
        next = place + 1;
    }
    table
}

/// Open loops that are listed one by one, at most.
const MOST_OPEN: usize = 3;

/// How many loops do not close, if these are many.
fn open_loops(cycles: &Cycles) -> Option<String> {
    let rows = &cycles.table.cycles;
    let open = || rows.iter().filter_map(|row| Some((row, row.opening()?.abs())));
    let (widest, gap) = open().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let unit = unit::suffix(unit::of_column(&cycles.quantities.output).as_deref());
    let words = format!(
        "{} of {} loops do not close (largest gap {:.3}{unit}, cycle {}): their reversals differ, the output drifts \
         (--subtract drift), or they began in another state",
        open().count(),
        rows.len(),
        Significant(gap),
        row_name(cycles, widest)
    );
    (open().count() > MOST_OPEN).then_some(words)
}

pub fn notes(cycles: &Cycles) -> Vec<String> {
    let mut all: Vec<(&str, Vec<String>)> = Vec::new();
    let open = open_loops(cycles);
    for row in &cycles.table.cycles {
        let told: Vec<&String> =
            if open.is_some() { row.other_notes().collect() } else { row.notes.iter().collect() };
        for note in told {
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
    open.iter()
        .cloned()
        .chain(all.into_iter().map(said))
        .chain(cycles.table.notes.iter().cloned())
        .chain(record_notes(cycles))
        .collect()
}

/// The levels of structures with those of the named figures that any level has; `None` for a single level.
pub fn levels(cycles: &Cycles, names: &[&str], label: impl Fn(&str) -> String) -> Option<Table> {
    let rows = &cycles.table.levels;
    let has = |figure: &&Figure<_>| {
        names.contains(&figure.name) && rows.iter().any(|row| (figure.of)(row).is_some())
    };
    let figures: Vec<_> = LEVEL_FIGURES.iter().filter(has).collect();
    let heading = |figure: &&Figure<_>| label(&cycles.quantities.as_figure(figure.label, figure.quantity));
    let is_several = cycles.data.records().len() > 1;
    let mut table =
        Table::new(["level".to_string(), "cycles".into()].into_iter().chain(figures.iter().map(heading)));
    for row in rows {
        let name = if is_several { format!("{}/{}", row.record, row.level) } else { row.level.to_string() };
        let values = figures.iter().map(|figure| Cell::number((figure.of)(row), 4));
        table.push([Cell::Text(name), row.cycles.into()].into_iter().chain(values));
    }
    (rows.len() > 1).then_some(table)
}

/// Losses of the amplitudes that have several frequencies.
pub fn at_several_frequencies<'a>(cycles: &'a Cycles) -> Vec<&'a [LossAtFrequency]> {
    let amplitudes =
        cycles.table.losses.chunk_by(|a, b| b.frequency > a.frequency && alike(a.amplitude, b.amplitude));
    let has_several =
        |losses: &&[LossAtFrequency]| losses[losses.len() - 1].frequency > SEVERAL * losses[0].frequency;
    if cycles.table.field == Field::Actuator { Vec::new() } else { amplitudes.filter(has_several).collect() }
}

fn alike(a: f64, b: f64) -> bool {
    a.max(b) <= SEVERAL * a.min(b)
}

/// Label, quantity and value of a column of losses.
type LossColumn = (&'static str, FigureQuantity, fn(&LossAtFrequency) -> Option<f64>);

/// Losses of amplitudes with several frequencies, with their parts if they are separated; `None` if there are none.
pub fn losses(cycles: &Cycles, label: impl Fn(&str) -> String) -> Option<Table> {
    use FigureQuantity::{Energy, Frequency, Input, Power, PowerPerMass};
    let losses: Vec<&LossAtFrequency> = at_several_frequencies(cycles).into_iter().flatten().collect();
    let columns: [LossColumn; 8] = [
        ("amplitude", Input, |loss| Some(loss.amplitude)),
        ("frequency", Frequency, |loss| Some(loss.frequency)),
        ("loss per cycle", Energy, |loss| Some(loss.energy)),
        ("hysteresis", Energy, |loss| loss.hysteresis),
        ("eddy", Energy, |loss| loss.eddy),
        ("excess", Energy, |loss| loss.excess),
        // Per mass in place of per volume.
        ("loss per time", Power, |loss| Some(loss.power).filter(|_| loss.power_per_mass.is_none())),
        ("specific loss", PowerPerMass, |loss| loss.power_per_mass),
    ];
    let used: Vec<_> =
        columns.iter().filter(|(.., of)| losses.iter().any(|loss| of(loss).is_some())).collect();
    let heading = |(name, quantity, _): &&(&str, FigureQuantity, _)| {
        label(&cycles.quantities.as_figure(name, *quantity))
    };
    let mut table = Table::new(used.iter().map(heading).chain(["cycles".to_string()]));
    for loss in &losses {
        let values = used.iter().map(|(.., of)| Cell::number(of(loss), 4));
        table.push(values.chain([loss.cycles.into()]));
    }
    (!losses.is_empty()).then_some(table)
}

/// The figures of records that have a value: a row for each figure, a column for each part of a record. `label` makes a
/// heading of a figure and its name with unit.
pub fn record_figures(cycles: &Cycles, label: impl Fn(&RecordFigure, &str) -> String) -> Option<Table> {
    let known: Vec<&RecordFigure> =
        cycles.table.figures.iter().filter(|figure| figure.value.is_some()).collect();
    let is_several = known.iter().any(|figure| figure.record != known[0].record);
    let mut parts: Vec<&str> = Vec::new();
    let mut rows: Vec<(&str, &str, String)> = Vec::new();
    for figure in &known {
        if !parts.contains(&figure.of.as_str()) {
            parts.push(&figure.of);
        }
        if !rows.iter().any(|(record, name, _)| (*record, *name) == (&figure.record, figure.kind.name)) {
            let named = cycles.quantities.as_figure(figure.kind.label, figure.kind.quantity);
            let label = label(figure, &named);
            let heading = if is_several { format!("{}: {label}", figure.record) } else { label };
            rows.push((&figure.record, figure.kind.name, heading));
        }
    }
    let heading = |part: &&str| if part.is_empty() { "value".to_string() } else { part.to_string() };
    let mut table = Table::new(std::iter::once("figure".to_string()).chain(parts.iter().map(heading)));
    for (record, name, heading) in &rows {
        let cell = |part: &&str| {
            let is_it = |figure: &&&RecordFigure| {
                (figure.record.as_str(), figure.kind.name, figure.of.as_str()) == (*record, *name, *part)
            };
            let Some(figure) = known.iter().find(is_it) else { return "".into() };
            let value = Cell::number(figure.value, 4);
            match figure.deviation {
                Some(deviation) => {
                    Cell::Text(format!("{} ± {}", value.shown(), hysid_document::number(deviation, 2)))
                }
                None => value,
            }
        };
        table.push(std::iter::once(Cell::Text(heading.clone())).chain(parts.iter().map(cell)));
    }
    (!rows.is_empty()).then_some(table)
}

/// Notes of the figures of records, each with the parts that it concerns.
fn record_notes(cycles: &Cycles) -> Vec<String> {
    let mut all: Vec<(String, Vec<&str>)> = Vec::new();
    for figure in &cycles.table.figures {
        let Some(note) = &figure.note else { continue };
        let note = format!("{}: {note}", figure.kind.label);
        match all.iter_mut().find(|(known, _)| *known == note) {
            Some((_, parts)) if parts.contains(&figure.of.as_str()) => {}
            Some((_, parts)) => parts.push(&figure.of),
            None => all.push((note, vec![&figure.of])),
        }
    }
    let with_parts = |(note, parts): (String, Vec<&str>)| match parts[..] {
        [""] => note,
        _ => format!("{note} ({})", parts.join(", ")),
    };
    all.into_iter().map(with_parts).collect()
}

/// Figures that any of the rows has, in the order of the list.
pub fn present(rows: &[&CycleRow], names: &[&str]) -> Vec<&'static Figure> {
    let has = |figure: &&Figure| rows.iter().any(|row| (figure.of)(row).is_some());
    let find = |name: &&str| hysid::diagnosis::cycles::FIGURES.iter().find(|figure| figure.name == *name);
    names.iter().filter_map(find).filter(has).collect()
}

/// Places of a table's rows that are shown: all, or so many at each end of a long one.
pub fn both_ends(rows: usize, at_each_end: usize) -> impl Iterator<Item = usize> {
    // Leaving out a single one saves nothing.
    (0..rows).filter(move |place| {
        rows <= 2 * at_each_end + 2 || *place < at_each_end || *place + at_each_end >= rows
    })
}
