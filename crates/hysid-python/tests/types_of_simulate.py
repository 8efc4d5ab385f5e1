"""Result types of `Model.simulate`, and types of options: `test_types.py` runs mypy over this file."""

import numpy as np
import polars
import xarray
from typing_extensions import assert_type

import hysid


def of_each_kind(model: hysid.Model, array: np.ndarray, series: polars.Series, field: xarray.DataArray) -> None:
    assert_type(model.simulate(array), np.ndarray)
    assert_type(model.simulate([1.0, 2.0]), np.ndarray)
    assert_type(model.simulate({"x": array}), np.ndarray)
    assert_type(model.simulate(series), polars.Series)
    assert_type(model.simulate(field, time=field), xarray.DataArray)
    assert_type(model.simulate([array, array]), list[np.ndarray])
    assert_type(model.simulate((array, array), time=[array, array]), list[np.ndarray])
    assert_type(model.simulate([series, series]), list[polars.Series])
    assert_type(model.simulate([{"x": array}]), list[np.ndarray])
    assert_type(model.simulate([[1.0], [2.0]]), np.ndarray)


def of_options(array: np.ndarray) -> None:
    hysid.fit(array, array, model="masing", sign="any", thresholds=[0.5, 1.0])
    hysid.fit(array, array, model="masin")  # type: ignore[arg-type]
    hysid.validate(array, array, model=hysid.models[0], operators=3)
    hysid.validate(array, array, operator=3)  # type: ignore[call-arg]
    hysid.validate(array, array, sign="positive")  # type: ignore[arg-type]
