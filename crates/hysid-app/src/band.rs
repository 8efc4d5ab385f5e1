//! The prediction band: what it was calibrated on, and how many measured outputs it holds.

use hysid_document::{Cell, Part, Table, count, number};

use crate::band_coverage::BandCoverage;
use crate::{BAND, Report, ReportSet};

/// The section on the band; `None` for a model without.
pub fn section(report: &Report) -> Option<Part> {
    let (inside, outside) = report.model.band()?.rows();
    let beyond = match outside {
        0 => "none outside, where the same width is used".to_string(),
        rows => format!("{rows} outside"),
    };
    let calibration = format!(
        "The band was calibrated on {} of held-out rows: {inside} inside the trained range, {beyond}. A row \
         in several folds counts once for each.",
        count(inside + outside, "prediction")
    );
    let probability = number(100.0 * BAND, 3);
    let columns = ["data".into(), "samples".into(), format!("within the {probability} % band (%)")];
    let table = Table::new(columns).with_rows(report.sets.iter().filter_map(row));
    let words = format!(
        "The band is wider where the members disagree, and outside the trained range if the error was \
         larger there. It is calibrated to contain {probability} % of the held-out rows (split conformal \
         prediction), and contains the same share of new rows if they resemble the held-out ones. The share \
         of training rows does not measure this, because the model was fitted to them. Other probabilities: \
         hysid simulate --band."
    );
    let parts = [Part::paragraph(calibration), Part::Table(table), Part::note(words)];
    Some(Part::section("The prediction band", parts))
}

fn row(set: &ReportSet) -> Option<Vec<Cell>> {
    let coverage = BandCoverage::counted(set.predicted.as_ref()?, set.data, BAND);
    Some(vec![set.name.as_str().into(), coverage.samples.into(), coverage.coverage_percent.into()])
}
