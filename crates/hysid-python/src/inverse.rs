//! The inverse of a model.

use hysid::model;
use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::data::Column;
use crate::failure::refused;

/// Input, output, reach and trials of a sample.
type Sample = (f64, f64, &'static str, usize);

/// Inputs, outputs and reaches of rows.
type Rows<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Vec<&'static str>);

/// The inverse of a model, sample by sample.
#[pyclass(module = "hysid._hysid")]
pub struct Inverse {
    inverse: model::Inverse<'static>,
}

impl Inverse {
    /// With limits and a largest rate of the input, if they are given.
    pub fn of(model: model::Model, limits: Option<(f64, f64)>, slew: Option<f64>) -> hysid::Result<Self> {
        let mut inverse = model.into_inverse();
        if let Some((low, high)) = limits {
            inverse = inverse.limits(low, high)?;
        }
        if let Some(rate) = slew {
            inverse = inverse.slew(rate)?;
        }
        Ok(Self { inverse })
    }
}

#[pymethods]
impl Inverse {
    /// Takes one sample.
    fn step(&mut self, y: f64, time: Option<f64>, others: Vec<f64>) -> PyResult<Sample> {
        let found = self.inverse.step(y, &others, time.unwrap_or(f64::NAN)).map_err(refused)?;
        Ok((found.input, found.output, found.reach.word(), found.trials))
    }

    /// Takes rows; the other inputs come row by row.
    fn run<'py>(
        &mut self,
        py: Python<'py>,
        y: Column<'py>,
        time: Option<Column<'py>>,
        others: Column<'py>,
    ) -> PyResult<Rows<'py>> {
        let (y, others) = (y.as_slice()?, others.as_slice()?);
        let time = time.as_ref().map(|time| time.as_slice()).transpose()?;
        let width = others.len() / y.len().max(1);
        let inverse = &mut self.inverse;
        let found = py.detach(|| {
            y.iter()
                .enumerate()
                .map(|(row, &y)| {
                    let others = &others[row * width..(row + 1) * width];
                    inverse
                        .step(y, others, time.map_or(f64::NAN, |time| time[row]))
                        .map_err(|error| format!("row {row}: {error}"))
                })
                .collect::<Result<Vec<_>, String>>()
        });
        let found = found.map_err(PyValueError::new_err)?;
        let column = |value: fn(&model::Inverted) -> f64| {
            found.iter().map(value).collect::<Vec<f64>>().into_pyarray(py)
        };
        let reach = found.iter().map(|found| found.reach.word()).collect();
        Ok((column(|found| found.input), column(|found| found.output), reach))
    }

    /// Goes back to the initial state of the model.
    fn reset(&mut self) {
        self.inverse.reset();
    }
}
