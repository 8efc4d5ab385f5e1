//! Restoring forces from measured motion and force.

use hysid::restoring_force::{Acceleration, Filter, Motion, RestoringForce};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::data::{Column, NewColumn};
use crate::failure::refused;

/// A record: time, displacement, velocity, acceleration, acceleration of the base, applied force.
type Parts<'py> = (
    Column<'py>,
    Column<'py>,
    Option<Column<'py>>,
    Option<Column<'py>>,
    Option<Column<'py>>,
    Option<Column<'py>>,
);

/// Velocity and force of each record; degree and window of the filters of velocity and acceleration; deviation, noise and
/// smoothing of the force.
type Found<'py> =
    (Vec<(NewColumn<'py>, NewColumn<'py>)>, Option<(usize, usize)>, Option<(usize, usize)>, (f64, f64, f64));

/// The restoring force in records of the motion of a mass.
#[pyfunction]
#[pyo3(signature = (records, mass, is_absolute, window))]
pub fn restoring_force<'py>(
    py: Python<'py>,
    records: Vec<Parts<'py>>,
    mass: f64,
    is_absolute: bool,
    window: Option<usize>,
) -> PyResult<Found<'py>> {
    let motions: Vec<Motion<'_>> =
        records.iter().map(|parts| motion(parts, is_absolute)).collect::<PyResult<_>>()?;
    let RestoringForce { records, velocity_filter, acceleration_filter, deviation, noise, smoothing } =
        py.detach(|| hysid::restoring_force(&motions, mass, window)).map_err(refused)?;
    let column = |values: Vec<f64>| PyArray1::from_vec(py, values);
    let filter = |filter: Filter| (filter.degree, filter.window());
    Ok((
        records.into_iter().map(|record| (column(record.velocity), column(record.force))).collect(),
        velocity_filter.map(filter),
        acceleration_filter.map(filter),
        (deviation, noise, smoothing),
    ))
}

fn motion<'a>(parts: &'a Parts<'_>, is_absolute: bool) -> PyResult<Motion<'a>> {
    let (time, displacement, velocity, acceleration, base_acceleration, applied_force) = parts;
    let values = |column: &'a Option<Column<'_>>| column.as_ref().map(|column| column.as_slice()).transpose();
    let acceleration = match values(acceleration)? {
        None => Acceleration::Computed,
        Some(values) if is_absolute => Acceleration::Absolute(values),
        Some(values) => Acceleration::Relative(values),
    };
    Ok(Motion {
        time: time.as_slice()?,
        displacement: displacement.as_slice()?,
        velocity: values(velocity)?,
        acceleration,
        base_acceleration: values(base_acceleration)?,
        applied_force: values(applied_force)?,
    })
}
