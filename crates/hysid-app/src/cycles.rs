//! Results of `hysid cycles`: tables as CSV, text for a terminal, one JSON object, and a page with pictures.

mod curves;
pub mod over_amplitude;
mod page;
pub mod pictures;
pub(crate) mod table;
#[cfg(feature = "tables")]
mod tables;
mod text;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use hysid::Model;
use hysid::data::record::Dataset;
use hysid::diagnosis::cycles::{
    Correction, CycleOptions, CycleRow, CycleTable, FIGURES, Figure, LEVEL_FIGURES, corrected, prepared,
};
use hysid::diagnosis::model::{MagnetisationNode, ModelCycles};
use hysid::diagnosis::reversal_curves::{ReversalCurveOptions, ReversalCurves};
use hysid_document::visible::clipped;
use hysid_document::{Problem, Result, count, object};

use crate::quantities::Quantities;

pub use page::page;
#[cfg(feature = "tables")]
pub use tables::{BEGINNING, SideTable, csv, side_tables};
pub use text::text;

pub struct Cycles<'a> {
    /// The files that the title of the page names.
    pub file: String,
    /// True for a model that was driven; false for measured data.
    pub of_model: bool,
    pub data: Cow<'a, Dataset>,
    pub table: CycleTable,
    /// First-order reversal curves, if there are any.
    pub curves: Option<ReversalCurves>,
    /// Initial and anhysteretic curve of a model of a magnet; otherwise empty.
    pub magnetisation: Vec<MagnetisationNode>,
    /// Names and units.
    pub quantities: Quantities,
    /// Reading of the data, label and text.
    pub understood: Vec<(String, String)>,
}

impl<'a> Cycles<'a> {
    /// The cycles of measured data from a file, of which this was understood.
    ///
    /// # Errors
    /// Data without cycles or reversal curves that can be looked at.
    pub fn of_data(
        data: &'a Dataset,
        options: &CycleOptions,
        corrections: &[Correction],
        (smoothing_factor, smoothing_growth): (Option<usize>, f64),
        (file, understood): (&str, Vec<(String, String)>),
    ) -> hysid::Result<Self> {
        let (mut set, mut removed) = prepared(data, options.field);
        if !corrections.is_empty() {
            let (other, notes) = corrected(&set, corrections)?;
            set = Cow::Owned(other);
            removed.extend(notes);
        }
        let mut table = CycleTable::of(&set, options)?;
        table.notes.splice(..0, removed);
        let of_curves =
            ReversalCurveOptions { branches: options.branches(), smoothing_factor, smoothing_growth };
        let curves = ReversalCurves::of(&set, &of_curves)?;
        Ok(Self {
            file: file.into(),
            of_model: false,
            quantities: Quantities::of(data.names()),
            data: set,
            table,
            curves,
            magnetisation: Vec::new(),
            understood,
        })
    }

    /// The cycles that a model is driven through.
    pub fn of_model(
        path: &Path,
        model: &Model,
        options: &CycleOptions,
        smoothing_factor: Option<usize>,
    ) -> Result<Cycles<'static>> {
        let file = path.display().to_string();
        let driven = ModelCycles::of(model, options, smoothing_factor)
            .map_err(|error| Problem::in_file(&file, error.to_string()))?;
        let understood = understood(&file, model, &driven);
        Ok(Cycles {
            file,
            of_model: true,
            quantities: Quantities::of(driven.data.names()),
            data: Cow::Owned(driven.data),
            table: driven.table,
            curves: driven.reversal_curves,
            magnetisation: driven.magnetisation,
            understood,
        })
    }

    /// All rows of the table, those of incomplete cycles too.
    pub(crate) fn rows(&self) -> Vec<&CycleRow> {
        self.table.cycles.iter().collect()
    }

    pub fn figures(&self) -> impl Iterator<Item = &'static Figure> + use<'_> {
        FIGURES.iter().filter(|figure| figure.is_of(self.table.field))
    }

    pub fn json(&self, files: &Files) -> Result<String> {
        let cycles = self.figures().map(|figure| (figure.name, figure.quantity));
        let records = self.table.figures.iter().map(|figure| (figure.kind.name, figure.kind.quantity));
        let levels = LEVEL_FIGURES.iter().filter(|_| !self.table.levels.is_empty());
        let all = cycles.chain(levels.map(|figure| (figure.name, figure.quantity))).chain(records);
        let named = all.map(|(name, quantity)| {
            (name, hysid::data::unit::of_column(&self.quantities.as_figure(name, quantity)))
        });
        Ok(hysid_document::json(&object! {
            input: &self.quantities.input,
            output: &self.quantities.output,
            /// True for cycles of a model that was driven.
            of_model: self.of_model,
            table: files.table.as_deref(),
            page: files.page.as_deref(),
            /// Further tables by the name of their contents.
            tables: &files.further,
            /// Unit of each figure, where the units of the columns are known.
            units: named.collect::<BTreeMap<_, _>>(),
            #[serde(flatten)]
            cycles: &self.table,
            reversal_curves: self.curves.as_ref(),
        })?)
    }

    /// Summary of the cycles, in a sentence without full stop.
    pub fn headline(&self) -> String {
        let complete = self.table.complete().count();
        let rest = self.table.cycles.len() - complete;
        let incomplete =
            if rest == 0 { String::new() } else { format!(" and {}", count(rest, "incomplete part")) };
        let whose = if self.of_model { " of the model, not of measured data" } else { "" };
        format!(
            "{}{incomplete}{whose}: {} over {}",
            count(complete, "cycle"),
            clipped(&self.quantities.output),
            clipped(&self.quantities.input),
        )
    }
}

/// The files that are written, if they are.
#[derive(Debug, Default)]
pub struct Files {
    pub table: Option<PathBuf>,
    pub page: Option<PathBuf>,
    /// Further tables by the name of their contents.
    pub further: BTreeMap<&'static str, PathBuf>,
}

/// Drive of a model, label and text.
fn understood(file: &str, model: &Model, driven: &ModelCycles) -> Vec<(String, String)> {
    let (low, high) = driven.probing.input;
    let input = &model.names().inputs[0];
    let value = |value: f64, name: &str| {
        let unit = hysid::data::unit::suffix(hysid::data::unit::of_column(name).as_deref());
        format!("{:.4}{unit}", hysid_core::significant::Significant(value))
    };
    let mut lines = vec![
        ("file".to_string(), file.to_string()),
        ("model".to_string(), format!("{}: {} parameters", model.name().name(), model.parameters())),
        (
            "driven".to_string(),
            format!(
                "{input} from {:.4} to {}, the trained range",
                hysid_core::significant::Significant(low),
                value(high, input)
            ),
        ),
    ];
    let speeds = &driven.probing.speeds;
    if !speeds.is_empty() {
        let unit = hysid::data::unit::of_column(&Quantities::of(model.names()).as_speed("speed"));
        let unit = hysid::data::unit::suffix(unit.as_deref());
        let number = |speed: f64| format!("{:.3}", hysid_core::significant::Significant(speed));
        let others: Vec<String> = speeds.iter().map(|&speed| number(speed)).collect();
        let slow = number(driven.probing.vanishing_speed);
        lines.push((
            "speed".to_string(),
            format!(
                "record \"slow\" at {slow}{unit}, an extrapolation unless the training was as slow; the others at {}{unit}",
                others.join(", ")
            ),
        ));
    }
    for (name, &held) in model.names().inputs.iter().skip(1).zip(&driven.probing.held) {
        lines.push(("input".into(), format!("{name}: held at {}", value(held, name))));
    }
    lines.extend(driven.probing.outside.clone().map(|outside| ("outside".to_string(), outside)));
    lines
}
