//! The native half of the Python package `hysid`: thin, private, and without an opinion. What users see is
//! written in Python, in `python/hysid`.

mod cycles;
mod data;
mod elements;
mod failure;
mod folds;
mod identification;
mod interruption;
mod inverse;
mod labels;
mod model;
mod plan;
mod progress;
mod restoring_force;
mod specimens;

use pyo3::prelude::*;

/// Native module of the package `hysid`.
#[pymodule]
mod _hysid {
    #[pymodule_export]
    use crate::cycles::{cycles, figure_names, level_figure_names};
    #[pymodule_export]
    use crate::data::{Dataset, diagnose, unit_factor};
    #[pymodule_export]
    use crate::elements::{deteriorating_stop, law, play, relaxation, relay, stop};
    #[pymodule_export]
    use crate::folds::folds;
    #[pymodule_export]
    use crate::identification::{FitSpec, compare, identify, model_names, option_names, validate};
    #[pymodule_export]
    use crate::inverse::Inverse;
    #[pymodule_export]
    use crate::labels::{axis_label, errors_text, figure_label, name_and_unit};
    #[pymodule_export]
    use crate::model::{Model, RecordState, Stepper, Tracking, write_models};
    #[pymodule_export]
    use crate::plan::{Plan, plan};
    #[pymodule_export]
    use crate::progress::ProgressLine;
    #[pymodule_export]
    use crate::restoring_force::restoring_force;
    #[pymodule_export]
    use crate::specimens::{specimen, specimens};

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
