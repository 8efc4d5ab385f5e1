//! Wanted outputs of a table, and the inputs that drive a model along them.

mod drive;
mod page;
mod reference;

use std::collections::BTreeMap;

use hysid::data::metrics::{ErrorSums, Errors};
use hysid::error::InverseError;
use hysid::model::{BandLevel, Inverse, Inversion, Model, Reach};
use hysid_document::{Problem, Result};

pub use drive::DriveTable;
pub use page::page;
pub use reference::{ReferenceOutputs, WantedRecord};

/// Deviation of the driven model, in percent of the standard deviation of the wanted output, above which to warn.
const LARGE: f64 = 5.0;

/// How far an inverse looks ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Preview {
    /// As far as suits the model and the reference.
    Auto,
    /// This time.
    Time(f64),
}

/// Bounds of the search of the inputs.
#[derive(Debug, Clone, Copy)]
pub struct InputBounds {
    /// Lowest and highest input; `None` for the trained range.
    pub limits: Option<(f64, f64)>,
    /// Largest change of the input in a unit of time.
    pub slew: Option<f64>,
    /// How far the search looks ahead.
    pub preview: Preview,
    /// Band of the output that becomes one of the input.
    pub band: Option<BandLevel>,
}

impl InputBounds {
    /// True if the rows of a reference for this model need a time.
    pub fn need_time(&self, model: &Model) -> Result<bool> {
        let inverse = inverse(model, self)?;
        Ok(match self.preview {
            Preview::Auto => inverse.needs_time(),
            Preview::Time(time) => inverse.preview(time)?.needs_time(),
        })
    }
}

/// The inputs of all records.
pub struct Inverted {
    pub records: Vec<Inversion>,
    /// How far the search looked ahead in each.
    pub previews: Vec<f64>,
    /// Errors of the output of the driven model against the wanted one.
    pub errors: Errors,
}

impl Inverted {
    /// Inverts a model along all records, each from the initial state.
    pub fn of(model: &Model, wanted: &ReferenceOutputs, bounds: &InputBounds) -> Result<Self> {
        let (mut records, mut previews, mut sums) = (Vec::new(), Vec::new(), ErrorSums::default());
        for record in &wanted.records {
            let explained = |error: hysid::Error| explained(error, wanted, record);
            let columns = record.columns();
            let reference = record.reference(&columns);
            let inverse = inverse(model, bounds)?;
            let preview = match bounds.preview {
                Preview::Auto => inverse.best_preview(&reference).map_err(explained)?,
                Preview::Time(time) => time,
            };
            let inversion = inverse.preview(preview)?.run(&reference).map_err(explained)?;
            sums.add(&record.wanted, &inversion.output);
            records.push(inversion);
            previews.push(preview);
        }
        let errors = sums
            .errors(&model.names().output)
            .ok_or_else(|| Problem::from("there are no rows".to_string()))?;
        Ok(Self { records, previews, errors })
    }

    pub fn rows(&self) -> usize {
        self.records.iter().map(|record| record.input.len()).sum()
    }

    /// Number of rows with this reach.
    pub fn count(&self, reach: Reach) -> usize {
        self.records.iter().map(|record| record.count(reach)).sum()
    }

    /// Number of rows that were reached.
    pub fn reached(&self) -> usize {
        self.count(Reach::Reached)
    }

    /// Number of rows by each other reach.
    pub fn not_reached(&self) -> BTreeMap<&'static str, usize> {
        let others = Reach::ALL.into_iter().filter(|reach| *reach != Reach::Reached);
        others.map(|reach| (reach.word(), self.count(reach))).filter(|(_, count)| *count > 0).collect()
    }

    /// Rows with an input, or a rate of it, outside the trained range.
    pub fn extrapolated(&self) -> usize {
        let rows = self.records.iter().flat_map(|record| &record.is_extrapolated);
        rows.filter(|is_extrapolated| **is_extrapolated).count()
    }

    /// Warnings on the drive.
    pub fn warnings(&self) -> Vec<String> {
        let rows = self.rows();
        let mut all = Vec::new();
        let missed = self.not_reached();
        if !missed.is_empty() {
            let counts: Vec<String> = missed.iter().map(|(word, count)| format!("{word} {count}")).collect();
            let total = rows - self.reached();
            all.push(format!(
                "{total} of {rows} rows do not reach the wanted output: {} (column reach)",
                counts.join(", ")
            ));
        }
        let extrapolated = self.extrapolated();
        if extrapolated > 0 {
            all.push(format!(
                "{extrapolated} of {rows} rows have an input or a rate outside the range of the training data (column extrapolated)"
            ));
        }
        if let Some(percent) = self.errors.nrmse_std_percent.filter(|percent| *percent > LARGE) {
            all.push(format!(
                "the RMS deviation of the model output is {percent:.1} % of the standard deviation of the wanted output: \
                 within these bounds the model does not follow the reference"
            ));
        }
        all
    }

    /// Lowest and highest input.
    pub fn range(&self) -> (f64, f64) {
        let inputs = self.records.iter().flat_map(|record| &record.input);
        inputs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
    }
}

pub fn meaning(reach: Reach) -> &'static str {
    match reach {
        Reach::Reached => "the model has the wanted output",
        Reach::LowLimit => "the wanted output is beyond that of the lowest input",
        Reach::HighLimit => "the wanted output is beyond that of the highest input",
        Reach::Slew => "the input cannot change so quickly, and is on its way",
        Reach::NotMonotone => "no input within the limits has the output: the model is not monotone there",
        Reach::Jump => "the output of the model jumps over the wanted one",
    }
}

/// An inverse at the initial state of the model.
fn inverse<'m>(model: &'m Model, bounds: &InputBounds) -> Result<Inverse<'m>> {
    let mut inverse = model.inverse();
    if let Some((low, high)) = bounds.limits {
        inverse = inverse.limits(low, high)?;
    }
    if let Some(rate) = bounds.slew {
        inverse = inverse.slew(rate)?;
    }
    if let Some(level) = bounds.band {
        inverse = inverse.band(level)?;
    }
    Ok(inverse)
}

/// An error of a row with its line.
fn explained(error: hysid::Error, wanted: &ReferenceOutputs, record: &WantedRecord) -> Problem {
    match error {
        hysid::Error::Inverse(InverseError::Row { row, problem }) => {
            Problem::at(&wanted.file, wanted.lines[record.rows.start + row], problem.to_string())
        }
        other => Problem::in_file(&wanted.file, other.to_string()),
    }
}
