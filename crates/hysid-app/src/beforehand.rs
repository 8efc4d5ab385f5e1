//! Checks of training tables before the fit.

use anyhow::Result;
use hysid::data::summary::Summary;
use hysid::diagnosis::{DataIssueKind, before_a_fit};
use hysid::options::FitSpec;
use hysid_records::{Data, summarised, understanding};

use crate::Beforehand;
use crate::models::parts;

impl Beforehand {
    /// # Errors
    /// Data that the model cannot be fitted to.
    pub fn of(data: &Data, request: &FitSpec) -> Result<Self> {
        let model = match request {
            FitSpec::Network(options) => {
                let architecture = options.architecture(&data.set).map_err(|error| data.explain(error))?;
                format!(": {} parameters; {}", architecture.parameters(), parts(&architecture))
            }
            FitSpec::Auto(options) => understanding::choice(options),
            FitSpec::Classical(_) => String::new(),
        };
        request.model().check_data(&data.set, request.rate()).map_err(|error| data.explain(error))?;
        let summary = Summary::of(&data.set);
        let understood = understanding::understanding(data, &summary, request, &model);
        let mut warnings = data_warnings(data, &summary);
        warnings.extend(request.cautions(&data.set));
        Ok(Self { understood, warnings })
    }
}

/// Warnings on training data.
pub fn data_warnings(data: &Data, summary: &Summary) -> Vec<String> {
    // Data that cannot be looked at cannot be fitted to either: the fit says why.
    let doubtful = before_a_fit(&data.set).unwrap_or_default();
    let output = format!("\"{}\" ", data.roles.output);
    let statements = doubtful.into_iter().map(|issue| match (issue.kind, issue.value) {
        (DataIssueKind::MissingValueMark, Some(value)) if issue.statement.starts_with(&output) => {
            format!("{} (--missing {value})", issue.statement)
        }
        _ => issue.statement,
    });
    summarised(&summary.warnings(&data.set)).into_iter().chain(statements).collect()
}
