//! How a model is fitted, validated and compared: the options, the rate, a time limit and an observer, each with its
//! default.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use serde_json::{Map, Value};

use crate::data::metrics::Errors;
use crate::data::rate::RateMethod;
use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::network::Progress;
use crate::fit::{cross_validate, identify};
use crate::model::Model;
use crate::options::chosen::{NamedOptions, RateChoice};
use crate::options::{FitSpec, ModelName};
use crate::validation::CrossValidation;

/// Records are divided into at most so many folds.
const FOLDS: usize = 5;

/// A fit with its options. Options have the names and ranges of the table in
/// [`options::table`](crate::options::table), which are those of the command line and of Python.
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
    /// A fit with the defaults: the model `auto`, which cross-validates networks and classical models and combines the
    /// best.
    pub fn new() -> Self {
        Self::default()
    }

    /// The model by its name, such as `xpnn` or `bouc-wen`.
    pub fn model(self, name: &str) -> Self {
        self.option("model", name)
    }

    /// The seed of all random numbers.
    pub fn seed(self, seed: u64) -> Self {
        self.option("seed", seed)
    }

    /// Any option by its name in the table of options. A name or a value that there is not is an error of
    /// [`Fit::run`].
    pub fn option(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.options.insert(name.into(), value.into());
        self
    }

    /// How the rate of the first input is found. By default, a model that uses it gets central differences where there
    /// are time stamps.
    pub fn rate(mut self, method: Option<RateMethod>) -> Self {
        self.rate = method.map_or(RateChoice::None, RateChoice::Method);
        self
    }

    /// Ends the fit after this time with the best model so far. This is the only thing in the library that reads a
    /// clock; a result that a limit has cut short depends on the machine.
    pub fn time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = Some(limit);
        self
    }

    /// Calls `observer` after every epoch, and in the midst of long ones; a fit ends with its best model so far if it
    /// returns [`ControlFlow::Break`].
    pub fn observer(mut self, observer: impl FnMut(&Progress) -> ControlFlow<()> + Send + 'a) -> Self {
        self.observer = Some(Box::new(observer));
        self
    }

    /// Options that the model ignores.
    ///
    /// # Errors
    /// An option, or a value of one, that there is not.
    pub fn ignored(&self) -> Result<Vec<&'static str>> {
        Ok(self.chosen()?.ignored().into_iter().map(|ignored| ignored.option).collect())
    }

    /// Fits the model to data.
    ///
    /// # Errors
    /// An option, or a value of one, that there is not; data that nothing can be identified from or that the model
    /// cannot be fitted to; a stop before there was any model.
    pub fn run(mut self, data: &Dataset) -> Result<Model> {
        let request = self.request(data)?;
        Ok(identify(data, &request, &mut self.watched())?.model)
    }

    /// Cross-validates the model: fits it without one fold of the data, simulates that fold, and so on with every fold.
    /// A single record is cut in time into five folds; several records are divided into at most five.
    ///
    /// # Errors
    /// As [`Fit::run`], and data too few for two folds.
    pub fn validate(mut self, data: &Dataset) -> Result<CrossValidation> {
        let request = self.request(data)?;
        cross_validate(data, &request, FOLDS, &mut self.watched())
    }

    fn chosen(&self) -> Result<NamedOptions> {
        NamedOptions::of(self.options.clone())
    }

    fn request(&self, data: &Dataset) -> Result<FitSpec> {
        let chosen = self.chosen()?;
        let model = chosen.model();
        let rate = self.rate.method(model, data.has_time());
        model.check_data(data, rate)?;
        Ok(chosen.request(rate, matches!(self.rate, RateChoice::Method(_))))
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

/// A model of a comparison.
#[derive(Debug, Clone)]
pub struct Compared {
    /// The model that was asked for, and its variant if it has more than one.
    pub label: String,
    /// The model with its errors on the test data, or why there is none.
    pub outcome: Result<(Model, Errors)>,
}

/// Fits models, each in all its variants, to the same data and evaluates them on data that none has seen; the lowest
/// error comes first. Without names, all models but `auto`, which is [`fit`](crate::fit()); models that cannot be
/// fitted to data like these are left out then.
///
/// # Errors
/// A name that is no model's.
pub fn compare(train: &Dataset, test: &Dataset, models: &[&str], seed: u64) -> Result<Vec<Compared>> {
    let models: Vec<ModelName> = match models {
        [] => ModelName::all().collect(),
        names => names.iter().map(|name| name.parse()).collect::<Result<_>>()?,
    };
    let rate = |model| RateChoice::Auto.method(model, train.has_time());
    let requests = models.into_iter().flat_map(|model| FitSpec::of(model, rate(model), seed).variants());
    let mut all: Vec<Compared> = requests.filter_map(|request| compared(train, test, &request)).collect();
    let error =
        |compared: &Compared| compared.outcome.as_ref().map_or(f64::INFINITY, |(_, errors)| errors.rmse);
    all.sort_by(|a, b| error(a).total_cmp(&error(b)));
    Ok(all)
}

/// A model on these data; `None` if it cannot be fitted to data like these.
fn compared(train: &Dataset, test: &Dataset, request: &FitSpec) -> Option<Compared> {
    if request.model().check_data(train, request.rate()).is_err() {
        return None;
    }
    let fitted = identify(train, request, &mut |_| ControlFlow::Continue(()));
    let outcome = fitted.and_then(|fitted| {
        let errors = fitted.model.evaluate(test)?;
        Ok((fitted.model, errors))
    });
    Some(Compared { label: request.variant_label(), outcome })
}
