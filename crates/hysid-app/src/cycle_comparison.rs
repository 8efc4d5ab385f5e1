//! The cycles of a model beside those of the data, cycle by cycle.

use std::collections::HashMap;

use hysid::data::record::{Dataset, Record};
use hysid::diagnosis::cycles::{CycleOptions, CycleRow, CycleTable};
use hysid_document::{Cell, Part, Table, count, unit};

use crate::ReportSet;
use crate::cycles::over_amplitude::compared_figures;
use crate::cycles::table::present;
use crate::quantities::Quantities;

/// Most cycles of a table: of more, the one of the largest amplitude and others at equal distances are shown.
const MOST_CYCLES: usize = 30;

/// Significant digits of figures.
const DIGITS: u8 = 3;

/// The data with the outputs of a model in the place of the measured ones. Rows that were not measured stay blank, unless none
/// was.
pub fn with_outputs<'o>(data: &Dataset, outputs: impl Iterator<Item = &'o [f64]>) -> hysid::Result<Dataset> {
    let is_measured = data.scored() > 0;
    let with_output = |(record, output): (&Record, &[f64])| {
        let rows = output.iter().zip(record.output());
        let kept = rows.map(|(model, y)| if is_measured && y.is_nan() { f64::NAN } else { *model });
        record.clone().with_output(kept.collect())
    };
    let records = data.records().iter().zip(outputs).map(with_output).collect::<hysid::Result<_>>()?;
    Dataset::new(data.names().clone(), records)
}

/// The table of the data and that of the model on the same inputs, divided alike; `None` for data without loops.
fn tables(set: &ReportSet) -> Option<(CycleTable, CycleTable)> {
    let measured = CycleTable::of(set.data, &CycleOptions::default()).ok()?;
    let simulated = with_outputs(set.data, set.simulated.iter().map(Vec::as_slice)).ok()?;
    let alike = CycleOptions { division: Some(measured.division), ..CycleOptions::default() };
    let model = CycleTable::of(&simulated, &alike).ok()?;
    Some((measured, model))
}

/// The section of a report; `None` for data without cycles.
pub fn section(set: &ReportSet) -> Option<Part> {
    let (measured, model) = tables(set)?;
    let others: HashMap<_, &CycleRow> = model.complete().map(|row| (rows_of(row), row)).collect();
    let pairs: Vec<(&CycleRow, &CycleRow)> =
        measured.complete().filter_map(|row| Some((row, *others.get(&rows_of(row))?))).collect();
    let rows: Vec<&CycleRow> = pairs.iter().map(|(row, _)| *row).collect();
    let figures = present(&rows, compared_figures(measured.field));
    if pairs.is_empty() || figures.is_empty() {
        return None;
    }
    let quantities = Quantities::of(set.data.names());
    let several = set.data.records().len() > 1;
    let mut headings: Vec<String> = vec!["cycle".into(), unit::label(&quantities.as_input("amplitude"))];
    for figure in &figures {
        headings.extend([
            unit::label(&quantities.as_figure(figure.label, figure.quantity)),
            "model".into(),
            "%".into(),
        ]);
    }
    let every = pairs.len().div_ceil(MOST_CYCLES);
    let largest = (0..pairs.len()).max_by(|&a, &b| amplitude(&pairs, a).total_cmp(&amplitude(&pairs, b)));
    let shown = pairs.iter().enumerate().filter(|(place, _)| place % every == 0 || Some(*place) == largest);
    let row_of = |(_, (row, other)): (usize, &(&CycleRow, &CycleRow))| -> Vec<Cell> {
        let cycle = if several { format!("{}, {}", row.record, row.cycle) } else { row.cycle.to_string() };
        let figures = figures.iter().flat_map(|figure| compared((figure.of)(row), (figure.of)(other)));
        [cycle.into(), Cell::number(row.amplitude, DIGITS)].into_iter().chain(figures).collect()
    };
    let table = Table::new(headings).with_rows(shown.map(row_of));
    let left_out = if every == 1 { "" } else { " Not all of them are in the table." };
    let words = format!(
        "Figures of {} of the data, of the model over the same rows, and by how many percent the model differs.{left_out}",
        count(pairs.len(), "complete cycle")
    );
    Some(Part::section(format!("Cycles: {} data", set.name), [Part::note(words), Part::Table(table)]))
}

fn rows_of(row: &CycleRow) -> (&str, (usize, usize)) {
    (&row.record, row.rows)
}

fn amplitude(pairs: &[(&CycleRow, &CycleRow)], place: usize) -> f64 {
    pairs[place].0.amplitude.unwrap_or_default()
}

/// A figure of the data, of the model, and the difference in percent of that of the data.
fn compared(measured: Option<f64>, model: Option<f64>) -> [Cell; 3] {
    let difference = measured.zip(model).filter(|(measured, _)| *measured != 0.0);
    // The sum with 0 has no sign at 0.
    let percent =
        |(measured, model): (f64, f64)| (1000.0 * (model - measured) / measured.abs()).round() / 10.0 + 0.0;
    let percent =
        difference.map_or(Cell::Missing, |pair| format!("{:+.1}", percent(pair)).replace('-', "−").into());
    [Cell::number(measured, DIGITS), Cell::number(model, DIGITS), percent]
}
