//! The cycles on a terminal: the main figures, both ends of a long table, and notes.

use hysid::diagnosis::cycles::Field;
use hysid_core::significant::Significant;
use hysid_document::plain::{WIDTH, indented, rendered, wrapped};
use hysid_document::{Cell, Part, Table, count};

use super::Cycles;
use super::table::{both_ends, notes, present, shown};
use crate::quantities::text_label;

/// Rows shown at each end of a long table.
const AT_EACH_END: usize = 8;

/// Most figures of a cycle in the text.
const MOST_FIGURES: usize = 6;

/// Figures that text and page show first.
pub fn main_figures(field: Field) -> &'static [&'static str] {
    match field {
        Field::Structure => &[
            "amplitude",
            "energy",
            "damping_percent",
            "secant_stiffness",
            "storage_modulus",
            "loss_modulus",
            "loss_angle",
            "residual_after_peak",
            "residual_after_valley",
        ],
        Field::Magnet => &[
            "amplitude",
            "frequency",
            "coercive_input",
            "remanent_output",
            "power_per_mass",
            "energy_per_mass",
            "energy",
            "power",
            "squareness",
        ],
        Field::Actuator => &[
            "amplitude",
            "peak_to_peak",
            "butterfly_remanence",
            "butterfly_coercive_input",
            "width",
            "width_percent",
            "nonlinearity_percent",
            "creep",
            "creep_per_decade",
        ],
        Field::Thermal => {
            &["heating_start", "heating_finish", "cooling_start", "cooling_finish", "thermal_width", "width"]
        }
        Field::Battery => {
            &["input_min", "input_max", "mean_gap", "width", "energy", "energy_efficiency_percent"]
        }
        Field::Hydrology => &["input_min", "input_max", "output_min", "output_max", "hysteresis_index"],
        Field::General => {
            &["amplitude", "mean_input", "energy", "width", "coercive_input", "remanent_output"]
        }
    }
}

/// All of it within 80 columns.
pub fn text(cycles: &Cycles) -> String {
    let mut blocks = vec![lines(&format!(
        "{}. Field: {}; cycles begin {}.",
        cycles.headline(),
        cycles.table.field,
        begin(cycles)
    ))];
    let table = main_table(cycles);
    if !table.rows.is_empty() {
        blocks.push(rendered(&[Part::Table(table)]));
    }
    blocks.extend(levels(cycles));
    blocks.extend(losses(cycles));
    blocks.extend(backbone(cycles));
    blocks.extend(record_figures(cycles));
    blocks.extend(curves(cycles));
    let notes: String = notes(cycles).iter().map(|note| indented(&format!("- {note}"), 2)).collect();
    if !notes.is_empty() {
        blocks.push(format!("notes\n{notes}"));
    }
    blocks.join("\n")
}

fn lines(text: &str) -> String {
    wrapped(text, WIDTH).join("\n") + "\n"
}

pub fn begin(cycles: &Cycles) -> &'static str {
    use hysid::diagnosis::cycles::Division;
    match cycles.table.division {
        Division::Zero => "where the input passes 0",
        Division::Mean => "where the input passes its mean",
        Division::Reversals => "at turning points",
        Division::Start => "where the input passes its first value",
    }
}

fn main_table(cycles: &Cycles) -> Table {
    let mut figures = present(&cycles.rows(), main_figures(cycles.table.field));
    // Names of records need the room of a figure or two.
    figures.truncate(if cycles.data.records().len() > 1 { 4 } else { MOST_FIGURES });
    let mut table = shown(cycles, &cycles.rows(), &figures, AT_EACH_END, text_label);
    for cell in table.rows.iter_mut().flatten() {
        *cell = Cell::Text(cell.ascii());
    }
    table
}

fn levels(cycles: &Cycles) -> Option<String> {
    let names = [
        "amplitude",
        "drift_percent",
        "output_first",
        "strength_loss_percent",
        "energy_first",
        "energy_mean",
        "damping_percent",
    ];
    let table = super::table::levels(cycles, &names, text_label)?;
    Some(format!("levels of amplitude\n{}", rendered(&[Part::Table(shortened(table))])))
}

fn record_figures(cycles: &Cycles) -> Option<String> {
    let table = super::table::record_figures(cycles, |_, name| text_label(name))?;
    Some(format!("figures of the record\n{}", rendered(&[Part::Table(shortened(table))])))
}

/// Both ends of a long table, in ASCII.
fn shortened(mut table: Table) -> Table {
    let rows = table.rows.len();
    let shown: Vec<usize> = both_ends(rows, AT_EACH_END).collect();
    table.rows = shown.iter().map(|&row| std::mem::take(&mut table.rows[row])).collect();
    for cell in table.rows.iter_mut().flatten() {
        *cell = Cell::Text(cell.ascii());
    }
    if shown.len() < rows {
        table.rows.insert(AT_EACH_END, vec!["…".into(), format!("{} more", rows - shown.len()).into()]);
    }
    table
}

/// Losses at several frequencies.
fn losses(cycles: &Cycles) -> Option<String> {
    let table = super::table::losses(cycles, text_label)?;
    Some(format!("losses by amplitude and frequency\n{}", rendered(&[Part::Table(shortened(table))])))
}

fn backbone(cycles: &Cycles) -> Option<String> {
    let points = &cycles.table.backbone;
    let strongest = points.iter().max_by(|a, b| a.output.abs().total_cmp(&b.output.abs()))?;
    let at = |value: f64, name: &str| {
        let unit = hysid::data::unit::suffix(hysid::data::unit::of_column(name).as_deref());
        format!("{:.4}{unit}", Significant(value))
    };
    Some(lines(&format!(
        "backbone: {}; the largest output is {} at {}",
        count(points.len(), "point"),
        at(strongest.output, &cycles.quantities.output),
        at(strongest.input, &cycles.quantities.input),
    )))
}

fn curves(cycles: &Cycles) -> Option<String> {
    let curves = cycles.curves.as_ref()?;
    let mut text =
        lines(&(super::curves::summary(cycles, curves, |value| format!("{:.4}", Significant(value))) + "."));
    for note in &curves.notes {
        text += &indented(&format!("- {note}"), 2);
    }
    Some(text)
}
