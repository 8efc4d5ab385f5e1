//! Checks of training tables before the fit.

use hysid::data::record::Dataset;
use hysid::data::summary::Summary;
use hysid::diagnosis::before_a_fit;
use hysid::options::FitSpec;
use hysid_document::{Face, Problem};
use hysid_records::{Data, summarised, understanding};

use crate::Beforehand;
use crate::models::parts;

impl Beforehand {
    /// # Errors
    /// Data that the model cannot be fitted to.
    pub fn of(data: &Data, request: &FitSpec, face: Face) -> Result<Self, Problem> {
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
        let of_request = understanding::of_request(data, request, &model, face);
        let understood = [understanding::of_data(data, &summary, face), of_request.clone()].concat();
        let in_short = [understanding::in_short(data, &summary, face), of_request].concat();
        let mut warnings = data_warnings(data, &summary, face);
        warnings.extend(request.cautions(&data.set).iter().map(|caution| face.told(caution)));
        Ok(Self { understood, in_short, warnings })
    }
}

/// Warnings on training data.
pub fn data_warnings(data: &Data, summary: &Summary, face: Face) -> Vec<String> {
    summarised(&summary.warnings(&data.set)).into_iter().chain(value_warnings(&data.set, face)).collect()
}

/// Warnings of values that may not be measured: codes and clipped channels.
pub fn value_warnings(data: &Dataset, face: Face) -> Vec<String> {
    // Data that cannot be looked at cannot be used otherwise: that says why.
    let doubtful = before_a_fit(data).unwrap_or_default();
    doubtful.iter().map(|issue| face.told(&issue.words())).collect()
}
