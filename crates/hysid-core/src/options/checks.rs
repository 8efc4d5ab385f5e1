//! Checks of whole sets of options against the table of options.

use serde_json::json;

use crate::data::FEWEST_ROWS;
use crate::error::{OptionError, Result};
use crate::options::input_options::InputOptions;
use crate::options::network::{FitOptions, Regularisation};
use crate::options::table::check;

impl FitOptions {
    /// Rejects invalid options.
    pub fn check(&self) -> Result<()> {
        check([
            ("starts", json!(self.starts)),
            ("epochs", json!(self.epochs)),
            ("population", json!(self.population)),
        ])?;
        check(self.validation.map(|share| ("validation", json!(share))))?;
        if self.thin < FEWEST_ROWS {
            return Err(OptionError::value(
                "thin",
                self.thin,
                format!("at least {FEWEST_ROWS} rows are needed"),
            )
            .into());
        }
        self.shaping.check()?;
        self.penalties().check()
    }
}

impl Regularisation {
    pub(crate) fn check(&self) -> Result<()> {
        check([("ridge", json!(self.ridge)), ("decay", json!(self.decay))])
    }
}

impl InputOptions {
    pub(crate) fn check(&self) -> Result<()> {
        let shares = [("compression", self.compression), ("rate_compression", self.rate_compression)];
        check(shares.into_iter().filter_map(|(name, share)| Some((name, json!(share?)))))
    }
}
