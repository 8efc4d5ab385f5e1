"""From arrays and columns of tables to numbers with names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from hysid._tables import is_frame, is_of_pandas, named_columns, table_name
from hysid._time import are_stamps, seconds

__all__ = ["Column", "column_of", "inputs_of", "place_of", "without_mask"]


_UNNAMED = {"input": "x", "output": "y", "time": "t", "rate": "rate"}
"""Names of columns that have a unit and no name."""


class Column(NamedTuple):
    """Numbers, and their name if they have one."""

    values: np.ndarray
    name: str | None


def inputs_of(x: Any, wanted: Sequence[str] = ()) -> list[Column]:
    """The inputs; of a table with more columns than wanted, those with the wanted names if it has them all."""
    named = named_columns(x)
    if named is not None:
        if not named:
            raise ValueError("x has no columns: there must be an input")
        by_name = dict(named)
        if len(named) > len(wanted) and wanted and all(name in by_name for name in wanted):
            named = [(name, by_name[name]) for name in wanted]
        return [Column(_numbers(values, "input", name=name), name) for name, values in named]
    values = _numbers(x, "input", dimensions=(1, 2))
    if values.ndim == 1:
        return [Column(values, _name_of(x, "input"))]
    if values.shape[1] == 0:
        raise ValueError("x has no columns: there must be an input")
    return [Column(np.ascontiguousarray(values[:, place]), None) for place in range(values.shape[1])]


def column_of(values: Any, what: str) -> Column | None:
    """One column, also of a table that has no other; None for None."""
    if values is None:
        return None
    name = _name_of(values, what)
    if isinstance(values, Mapping) or is_frame(values):
        columns = named_columns(values) or []
        if len(columns) != 1:
            raise ValueError(f"{what}: one column is needed, not {len(columns)}")
        ((name, values),) = columns
    if what == "time" and are_stamps(values):
        try:
            return Column(seconds(values), "t_s" if name is None else f"{name} [s]")
        except ValueError as error:
            raise ValueError(f"time: {error}") from None
    return Column(_numbers(values, what), name)


def place_of(what: str, column: str | int | None, names: Sequence[str], count: int) -> int | None:
    """The place of a column that is given by its name or number, in a table of `count` columns; None for None."""
    if column is None:
        return None
    if isinstance(column, str):
        if column not in names:
            raise ValueError(f"{what}: X has no column {column!r}")
        return list(names).index(column)
    if not -count <= column < count:
        raise ValueError(f"{what}: X has no column {column}")
    return int(column) % count


def _name_of(values: Any, what: str) -> str | None:
    """The name of a Series or DataArray; None if it has none, and for arrays."""
    name = getattr(values, "name", None)
    return table_name(values, None if name is None else str(name), _UNNAMED.get(what))


def _numbers(values: Any, what: str, dimensions: tuple[int, ...] = (1,), name: str | None = None) -> np.ndarray:
    """Contiguous float64; the very same array if it is that already."""
    values = without_mask(values, what)
    if are_stamps(values):
        raise ValueError(f"{what}: dates and times are not numbers (give them as time)")
    if hasattr(values, "collect") and not hasattr(values, "__array__"):
        raise ValueError(f"{what}: a lazy table has no numbers yet (collect it, as with {what}.collect())")
    try:
        if is_of_pandas(values):
            values = values.to_numpy(dtype=np.float64, na_value=np.nan)
        values = np.asarray(values)
        if np.iscomplexobj(values):
            raise ValueError("complex numbers cannot be used")
        numbers = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        other = "; other dates than ISO 8601 are read by pandas.to_datetime" if what == "time" else ""
        if name is not None:
            what, other = f"{what} {name!r}", " (labels of records are given as records; leave other text out of the table)"
        raise ValueError(f"{what}: {error}{other}") from None
    if numbers.ndim == 2 and 2 not in dimensions and numbers.shape[1] == 1:
        numbers = np.ascontiguousarray(numbers[:, 0])
    # `ascontiguousarray` makes an array of one value from a number.
    if values.ndim == 0 or values.ndim not in dimensions and numbers.ndim not in dimensions:
        expected = "one- or two-dimensional" if 2 in dimensions else "one-dimensional"
        raise ValueError(f"{what}: a {expected} array is needed, not one of {values.ndim} dimensions")
    return numbers


def without_mask(values: Any, what: str) -> Any:
    """Values with NaN where an output is masked; of anything else, nothing may be masked."""
    if not np.ma.isMaskedArray(values):
        return values
    mask = np.ma.getmaskarray(values)
    if not mask.any():
        return np.ma.getdata(values)
    if what != "output":
        row = int(np.argwhere(mask)[0][0])
        raise ValueError(f"{what}: row {row + 1} is masked (only the output may be blank)")
    return np.ma.filled(values.astype(np.float64), np.nan)
