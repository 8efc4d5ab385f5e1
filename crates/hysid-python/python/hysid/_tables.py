"""Columns of pandas, polars and xarray, recognised by what they can do: none of them is imported here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from hysid import _hysid

__all__ = ["is_frame", "like", "named_columns", "row_labels", "table_name", "with_column"]

UNITLESS = ("", "1", "-", "dimensionless")
"""Attributes of xarray that stand for no unit."""


def is_frame(values: Any) -> bool:
    """Whether values are a data frame: a table of columns with names that is no mapping."""
    return len(getattr(values, "shape", ())) == 2 and hasattr(values, "columns")


def is_of_pandas(values: Any) -> bool:
    """Whether values are a Series or DataFrame of pandas."""
    return hasattr(values, "iloc") and hasattr(values, "index")


def is_of_xarray(values: Any) -> bool:
    """Whether values are a DataArray or Dataset of xarray."""
    return hasattr(values, "dims") and hasattr(values, "coords")


def is_of_polars(values: Any) -> bool:
    """Whether values are a Series or DataFrame of polars."""
    return hasattr(values, "to_arrow") and hasattr(values, "with_columns" if is_frame(values) else "alias")


def named_columns(table: Any) -> list[tuple[str, Any]] | None:
    """The columns of a table with their names; None for arrays and single columns."""
    if isinstance(table, Mapping):
        return [(table_name(values, str(name)) or str(name), values) for name, values in table.items()]
    if not is_frame(table):
        return None
    if is_of_pandas(table):
        # Several columns may have the same name.
        return [(str(name), table.iloc[:, place]) for place, name in enumerate(table.columns)]
    return [(str(name), table[name]) for name in table.columns]


def table_name(values: Any, name: str | None, unnamed: str | None = None) -> str | None:
    """The name of a column, with the unit from its attributes if it has any: `H [A/m]`; `unnamed` takes the place of a name
    if there is a unit."""
    if not is_of_xarray(values):
        return name
    unit = str(values.attrs.get("units", "")).strip()
    if unit in UNITLESS:
        return name
    name = name or unnamed
    if name is None:
        return None
    _, known = _hysid.name_and_unit(name)
    if known is None:
        return f"{name} [{unit}]"
    if not _is_same(known, unit):
        raise ValueError(f"{name}: its name has the unit {known}, and its attribute units is {unit}: correct one of them")
    return name


def _is_same(one: str, other: str) -> bool:
    try:
        return _hysid.unit_factor(f"x [{one}]", f"x [{other}]") is None
    except ValueError:
        return False


def with_column(frame: Any, name: str, values: np.ndarray) -> Any:
    """A data frame with a column in the place of that of the same name."""
    if is_of_pandas(frame):
        return frame.assign(**{name: values})
    return frame.with_columns(type(frame[name])(name, values))


def row_labels(values: Any) -> Any:
    """The labels of rows as an index of pandas, of an object of pandas or xarray that has them; None without them."""
    if is_of_pandas(values):
        return values.index
    if is_of_xarray(values) and not isinstance(values, Mapping) and values.dims:
        return values.indexes.get(values.dims[0])
    return None


def like(x: Any, values: np.ndarray, column: str, suffix: str = "") -> Any:
    """Values as a column of the library that `x` is of, with its rows; an array if `x` is of none.

    The name is that of the model's column with the suffix. In xarray, the unit is an attribute.
    """
    if is_of_pandas(x):
        import pandas

        return pandas.Series(values, index=x.index, name=column + suffix)
    if is_of_polars(x):
        one = x.to_series(0) if is_frame(x) else x
        return type(one)(column + suffix, values)
    if is_of_xarray(x):
        return _data_array(x, values, column, suffix)
    return values


def _data_array(x: Any, values: np.ndarray, column: str, suffix: str) -> Any:
    one = next(iter(x.values())) if isinstance(x, Mapping) else x
    for dimension in one.dims[1:]:
        one = one.isel({dimension: 0}, drop=True)
    name, unit = _hysid.name_and_unit(column)
    result = one.copy(data=values).rename((name if column.endswith(("]", ")")) else column) + suffix)
    result.attrs = {} if unit is None else {"units": unit}
    return result
