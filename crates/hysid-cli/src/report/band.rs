//! The prediction band: what it was calibrated on, and how many measured outputs it holds.

use super::{BAND, Report, ReportSet};
use crate::band_coverage::BandCoverage;
use crate::page::{count, note, number, paragraph, section as section_of, table};

/// The section on the band; empty for a model without.
pub fn section(report: &Report) -> String {
    let Some(band) = report.model.band() else { return String::new() };
    let (inside, outside) = band.rows();
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
    let headings = ["data".into(), "samples".into(), format!("within the {probability} % band (%)")];
    let rows: Vec<Vec<String>> = report.sets.iter().filter_map(row).collect();
    let words = format!(
        "The band is wider where the members disagree, and beyond the trained range if the error was larger there. It \
         is calibrated to hold {probability} % of the rows held out (split conformal prediction); it holds as many new \
         rows if they resemble these. The share of the training rows says little, because the model was fitted to \
         them. Other probabilities: hysid simulate --band."
    );
    section_of("The prediction band", &(paragraph(&calibration) + &table(&headings, &rows) + &note(&words)))
}

fn row(set: &ReportSet) -> Option<Vec<String>> {
    let coverage = BandCoverage::counted(set.predicted.as_ref()?, set.data, BAND);
    Some(vec![set.name.clone(), coverage.samples.to_string(), number(coverage.coverage_percent, 3)])
}
