//! Tests of the residual in words.

use hysid::diagnosis::residuals::{ResidualFinding, ResidualVerdict};
use hysid_document::visible::clipped;

/// The test, with the input that it is about.
pub fn name(finding: &ResidualFinding) -> String {
    match &finding.input {
        None => finding.test.name().into(),
        Some(input) => format!("correlation with {}", clipped(input)),
    }
}

pub fn verdict(verdict: ResidualVerdict) -> &'static str {
    match verdict {
        ResidualVerdict::Found => "found",
        ResidualVerdict::NotFound => "not found",
        ResidualVerdict::NotTestable => "not testable",
    }
}

pub fn p_value(finding: &ResidualFinding) -> String {
    match finding.adjusted_p_value {
        None => "-".into(),
        Some(p) if p < 0.001 => "<0.001".into(),
        Some(p) => format!("{p:.3}"),
    }
}
