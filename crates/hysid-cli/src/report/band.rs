//! The prediction band: what it was calibrated on, and how many measured outputs it holds.

use hysid_document::{Cell, Part, Table, count, number};

use super::{BAND, Report, ReportSet};
use crate::band_coverage::BandCoverage;

/// The section on the band; `None` for a model without.
pub fn section(report: &Report) -> Option<Part> {
    let (inside, outside) = report.model.band()?.rows();
    let beyond = match outside {
        0 => "none beyond it, where the same width is used".to_string(),
        rows => format!("{rows} beyond it"),
    };
    let calibration = format!(
        "The band was calibrated on {} of rows held out from the fit: {inside} inside the range that was fitted to, \
         {beyond}. A row that was in several folds counts once for each.",
        count(inside + outside, "prediction")
    );
    let probability = number(100.0 * BAND, 3);
    let columns = ["data".into(), "samples".into(), format!("within the {probability} % band (%)")];
    let table = Table::new(columns).with_rows(report.sets.iter().filter_map(row));
    let words = format!(
        "The band is wider where the members disagree, and beyond the trained range if the error was larger there. It \
         is calibrated to hold {probability} % of the rows held out (split conformal prediction); it holds as many new \
         rows if they resemble these. The share of the training rows says little, because the model was fitted to \
         them. Other probabilities: hysid simulate --band."
    );
    let parts = [Part::paragraph(calibration), Part::Table(table), Part::note(words)];
    Some(Part::section("The prediction band", parts))
}

fn row(set: &ReportSet) -> Option<Vec<Cell>> {
    let coverage = BandCoverage::counted(set.predicted.as_ref()?, set.data, BAND);
    Some(vec![set.name.as_str().into(), coverage.samples.into(), coverage.coverage_percent.into()])
}
