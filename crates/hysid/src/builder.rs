//! Fits, validations and comparisons of models: options, rate, time limit and observer, each with its
//! default.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use serde_json::{Map, Value};

use crate::data::rate::RateMethod;
use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::progress::Progress;
use crate::fit::{cross_validate, identify};
use crate::model::Model;
use crate::options::FitSpec;
use crate::options::chosen::{NamedOptions, RateChoice};
use crate::validation::CrossValidation;

const FOLDS: usize = 5;

/// A fit with its options. Options have the names and ranges of the table in
/// [`options::table`](crate::options::table), as on the command line and in Python.
///
/// ```
/// use hysid::{Dataset, Fit};
/// # let x: Vec<f64> = (0..300).map(|k| 0.01 * k as f64 * (0.1 * k as f64).sin()).collect();
/// # let y = x.clone();
/// let data = Dataset::from_slices(&x, &y)?;
/// let model = Fit::new().model("prandtl-ishlinskii").option("operators", 8).seed(7).run(&data)?;
/// assert_eq!(model.name().name(), "prandtl-ishlinskii");
/// # Ok::<(), hysid::Error>(())
/// ```
#[derive(Default)]
pub struct Fit<'a> {
    options: Map<String, Value>,
    rate: RateChoice,
    time_limit: Option<Duration>,
    observer: Option<BoxedObserver<'a>>,
}

type BoxedObserver<'a> = Box<dyn FnMut(&Progress) -> ControlFlow<()> + Send + 'a>;

impl<'a> Fit<'a> {
    /// A fit with the defaults: the model `auto`.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the model by its name, such as `xpnn` or `bouc-wen`.
    pub fn model(self, name: &str) -> Self {
        self.option("model", name)
    }

    /// Sets the seed of all random numbers.
    pub fn seed(self, seed: u64) -> Self {
        self.option("seed", seed)
    }

    /// Sets any option by its name; [`Fit::run`] reports an unknown name or an invalid value.
    pub fn option(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.options.insert(name.into(), value.into());
        self
    }

    /// Sets the method of the rate of the first input; `None` for no rate. By default, a model that uses a
    /// rate takes backward differences if there are time stamps and the input passes its range at several speeds
    /// ([`Dataset::speeds`]): data with one speed at each place do not show a dependence on the rate.
    pub fn rate(mut self, method: Option<RateMethod>) -> Self {
        self.rate = method.map_or(RateChoice::None, RateChoice::Method);
        self
    }

    /// Ends the fit after this time with the best model so far, which then depends on the speed of the machine.
    pub fn time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = Some(limit);
        self
    }

    /// Calls `observer` after every epoch, and during long ones; [`ControlFlow::Break`] ends the fit with its best
    /// model so far.
    pub fn observer(mut self, observer: impl FnMut(&Progress) -> ControlFlow<()> + Send + 'a) -> Self {
        self.observer = Some(Box::new(observer));
        self
    }

    /// The options that are set and that the model ignores.
    ///
    /// # Errors
    /// An unknown option, or an invalid value.
    pub fn ignored(&self) -> Result<Vec<&'static str>> {
        Ok(self.chosen()?.ignored().into_iter().map(|ignored| ignored.option).collect())
    }

    /// Fits the model to data.
    ///
    /// # Errors
    /// An unknown option, or an invalid value; data from which no model, or not this model, can be
    /// identified; a stop before there was a model.
    pub fn run(mut self, data: &Dataset) -> Result<Model> {
        let request = self.request(data)?;
        Ok(identify(data, &request, &mut self.watched())?.model)
    }

    /// Cross-validates the model: fits it without one fold of the data, simulates that fold, and repeats this
    /// for every fold. A single record is divided in time into five folds; several records are divided into
    /// at most five.
    ///
    /// # Errors
    /// As [`Fit::run`], and too few data for two folds.
    pub fn validate(mut self, data: &Dataset) -> Result<CrossValidation> {
        let request = self.request(data)?;
        cross_validate(data, &request, FOLDS, &mut self.watched())
    }

    fn chosen(&self) -> Result<NamedOptions> {
        NamedOptions::of(self.options.clone())
    }

    fn request(&self, data: &Dataset) -> Result<FitSpec> {
        let chosen = self.chosen()?;
        let request = chosen.request_for(self.rate, data);
        chosen.model().check_data(data, request.rate())?;
        Ok(request)
    }

    /// The observer, which also keeps to the time limit.
    fn watched(&mut self) -> impl FnMut(&Progress) -> ControlFlow<()> + Send {
        let mut observer = self.observer.take();
        let end = self.time_limit.map(|limit| Instant::now() + limit);
        move |progress: &Progress| {
            let told = observer.as_mut().map_or(ControlFlow::Continue(()), |observer| observer(progress));
            if end.is_some_and(|end| Instant::now() >= end) { ControlFlow::Break(()) } else { told }
        }
    }
}
