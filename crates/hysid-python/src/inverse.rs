//! The inverse of a model.

use hysid::model::{self, BandLevel};
use hysid::model::{Reach, Reference};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use crate::data::{Column, NewColumn, values};
use crate::failure::refused;
use crate::interruption::interruptible;

/// Input, output, reach, whether it is extrapolated, lowest and highest input of the band, and trials of a sample.
type Sample = (f64, f64, &'static str, bool, Option<f64>, Option<f64>, usize);

/// The same of rows, without trials.
type Columns<'py> = (
    NewColumn<'py>,
    NewColumn<'py>,
    Vec<&'static str>,
    Bound<'py, PyArray1<bool>>,
    Option<NewColumn<'py>>,
    Option<NewColumn<'py>>,
);

/// The inverse of a model, sample by sample.
#[pyclass(module = "hysid._hysid")]
pub struct Inverse {
    inverse: model::Inverse<'static>,
}

/// Bounds of an inverse.
pub struct Bounds {
    /// Lowest and highest input.
    pub limits: Option<(f64, f64)>,
    /// Largest change of the input in a unit of time.
    pub slew: Option<f64>,
    /// How far the search looks ahead.
    pub preview: f64,
    /// Probability of the band, and data sets of ten.
    pub band: Option<(f64, usize)>,
}

impl Inverse {
    /// With these bounds.
    pub fn of(model: model::Model, bounds: &Bounds) -> hysid::Result<Self> {
        let mut inverse = model.into_inverse().preview(bounds.preview)?;
        if let Some((low, high)) = bounds.limits {
            inverse = inverse.limits(low, high)?;
        }
        if let Some(rate) = bounds.slew {
            inverse = inverse.slew(rate)?;
        }
        if let Some((probability, of_ten)) = bounds.band {
            inverse = inverse.band(BandLevel { probability, of_ten })?;
        }
        Ok(Self { inverse })
    }
}

/// A copy of rows: the wanted outputs, the other inputs and the time.
struct ReferenceRows {
    wanted: Vec<f64>,
    others: Vec<Vec<f64>>,
    time: Option<Vec<f64>>,
}

impl ReferenceRows {
    fn of(y: &Column<'_>, time: Option<&Column<'_>>, others: &[Column<'_>]) -> PyResult<Self> {
        let others = others.iter().map(values).collect::<PyResult<_>>()?;
        Ok(Self { wanted: values(y)?, others, time: time.map(values).transpose()? })
    }

    /// Runs something over them.
    fn along<T>(&self, run: impl FnOnce(&Reference<'_>) -> hysid::Result<T>) -> hysid::Result<T> {
        let others: Vec<&[f64]> = self.others.iter().map(Vec::as_slice).collect();
        run(&Reference { wanted: &self.wanted, others: &others, time: self.time.as_deref() })
    }
}

#[pymethods]
impl Inverse {
    /// Takes one sample.
    fn step(&mut self, y: f64, time: Option<f64>, others: Vec<f64>) -> PyResult<Sample> {
        let found = self.inverse.step(y, &others, time.unwrap_or(f64::NAN)).map_err(refused)?;
        let (low, high) = found.band.unzip();
        let reach = found.reach.word();
        Ok((found.input, found.output, reach, found.is_extrapolated, low, high, found.trials))
    }

    /// Takes rows; none of them after Ctrl-C.
    fn run<'py>(
        &mut self,
        py: Python<'py>,
        y: Column<'py>,
        time: Option<Column<'py>>,
        others: Vec<Column<'py>>,
    ) -> PyResult<Columns<'py>> {
        let (rows, mut inverse) = (ReferenceRows::of(&y, time.as_ref(), &others)?, self.inverse.clone());
        let run = move || rows.along(|reference| inverse.run(reference)).map(|found| (found, inverse));
        let (found, inverse) = interruptible(py, run)?;
        self.inverse = inverse;
        let edge = |values: Vec<f64>| (!values.is_empty()).then(|| values.into_pyarray(py));
        Ok((
            found.input.into_pyarray(py),
            found.output.into_pyarray(py),
            found.reach.into_iter().map(Reach::word).collect(),
            found.is_extrapolated.into_pyarray(py),
            edge(found.low),
            edge(found.high),
        ))
    }

    /// The best preview for rows.
    fn best_preview(
        &self,
        py: Python<'_>,
        y: Column<'_>,
        time: Option<Column<'_>>,
        others: Vec<Column<'_>>,
    ) -> PyResult<f64> {
        let (rows, inverse) = (ReferenceRows::of(&y, time.as_ref(), &others)?, self.inverse.clone());
        interruptible(py, move || rows.along(|reference| inverse.best_preview(reference)))
    }

    /// Goes back to the initial state of the model.
    fn reset(&mut self) {
        self.inverse.reset();
    }
}
