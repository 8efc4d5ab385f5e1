"""From arrays and pandas objects to columns with names, and to records."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike

from hysid import _hysid
from hysid._time import are_stamps, seconds
from hysid._warning import warn

Values: TypeAlias = Union[ArrayLike, Mapping[str, ArrayLike]]
"""Numbers, or columns by their names; pandas objects are among the former."""

RECORD = "data"
"""Name of the record if `records` is not given."""


class Column(NamedTuple):
    """Numbers, and their name if they have one."""

    values: np.ndarray
    name: str | None


class Columns(NamedTuple):
    """All measured columns, and the rows of each record."""

    inputs: list[Column]
    time: Column | None
    rate: Column | None
    output: Column | None
    records: list[tuple[str, slice]]

    @property
    def rows(self) -> int:
        return len(self.inputs[0].values)

    def dataset(self) -> _hysid.Dataset:
        """As the native module takes it; without an output, all of it is blank."""
        blank = np.full(self.rows, np.nan)
        output = self.output.values if self.output else blank
        return _hysid.Dataset(
            (
                (self.time.name or "t") if self.time else None,
                self._input_names(),
                (self.rate.name or "rate") if self.rate else None,
                (self.output.name if self.output else None) or "y",
            ),
            [
                (
                    name,
                    self.time.values[rows] if self.time else None,
                    [column.values[rows] for column in self.inputs],
                    self.rate.values[rows] if self.rate else None,
                    output[rows],
                )
                for name, rows in self.records
            ],
        )

    def _input_names(self) -> list[str]:
        if len(self.inputs) == 1:
            return [self.inputs[0].name or "x"]
        return [column.name or f"x{place + 1}" for place, column in enumerate(self.inputs)]


def columns(x: Any, y: Any, time: Any, rate: Any, records: Any) -> Columns:
    """Splits the arguments into columns, and refuses columns of different length."""
    given = {"x": x, "y": y, "time": time, "rate": rate, "records": records}
    check_indexes(given)
    inputs = _inputs(x)
    arranged = Columns(
        inputs,
        _column(time, "time"),
        _column(rate, "rate"),
        _column(y, "output"),
        _records(records, len(inputs[0].values)),
    )
    for what, column in (("time", arranged.time), ("rate", arranged.rate), ("output", arranged.output)):
        if column is not None and len(column.values) != arranged.rows:
            raise ValueError(
                f'record "{RECORD}", {what}: has {len(column.values)} values '
                f"where the first input has {arranged.rows}"
            )
    warn_of_order(x, [rows for _, rows in arranged.records])
    return arranged


def check_indexes(given: Mapping[str, Any]) -> None:
    """Refuse pandas objects of different indexes: rows are taken by position."""
    indexed = {name: values for name, values in given.items() if _is_indexed(values)}
    for name, values in given.items():
        if isinstance(values, Mapping):
            columns = {f"{name}[{key!r}]": column for key, column in values.items()}
            indexed.update((key, column) for key, column in columns.items() if _is_indexed(column))
    first, *others = indexed or {"": None}
    for other in others:
        if not indexed[first].index.equals(indexed[other].index):
            raise ValueError(
                f"{first} and {other} have different indexes, and rows are taken by position: bring them into the same "
                f"order, as with {other}.reindex({first}.index), or give arrays, as with {other}.to_numpy()"
            )


def warn_of_order(x: Any, records: list[slice]) -> None:
    """Warn of a pandas object whose index does not grow from row to row within a record."""
    if not _is_indexed(x) or getattr(x.index.dtype, "kind", "O") not in "iufMm":
        return
    if not all(x.index[rows].is_monotonic_increasing for rows in records):
        warn(
            [
                "the rows are not in the order of their index: a model with memory needs them in the order of time "
                "(sort them, as with sort_index(); a shuffled split, such as ShuffleSplit, destroys it)"
            ]
        )


def _is_indexed(values: Any) -> bool:
    return hasattr(values, "iloc") and hasattr(values, "index")


def _inputs(x: Any) -> list[Column]:
    if isinstance(x, Mapping):
        if not x:
            raise ValueError("x has no columns: there must be an input")
        return [Column(_numbers(values, "input"), str(name)) for name, values in x.items()]
    if hasattr(x, "columns") and hasattr(x, "iloc"):
        if len(x.columns) == 0:
            raise ValueError("x has no columns: there must be an input")
        return [
            Column(_numbers(x.iloc[:, place], "input"), str(name)) for place, name in enumerate(x.columns)
        ]
    if hasattr(x, "iloc"):
        column = _column(x, "input")
        assert column is not None
        return [column]
    values = _numbers(x, "input", dimensions=(1, 2))
    if values.ndim == 1:
        return [Column(values, None)]
    if values.shape[1] == 0:
        raise ValueError("x has no columns: there must be an input")
    return [Column(np.ascontiguousarray(values[:, place]), None) for place in range(values.shape[1])]


def _column(values: Any, what: str) -> Column | None:
    if values is None:
        return None
    name = getattr(values, "name", None)
    if isinstance(values, Mapping):
        if len(values) != 1:
            raise ValueError(f"{what}: one column is needed, not {len(values)}")
        ((name, values),) = values.items()
    if hasattr(values, "columns") and hasattr(values, "iloc"):
        if len(values.columns) != 1:
            raise ValueError(f"{what}: one column is needed, not {len(values.columns)}")
        values, name = values.iloc[:, 0], values.columns[0]
    name = None if name is None else str(name)
    if what == "time" and are_stamps(values):
        try:
            return Column(seconds(values), "t_s" if name is None else f"{name} [s]")
        except ValueError as error:
            raise ValueError(f"time: {error}") from None
    return Column(_numbers(values, what), name)


def _numbers(values: Any, what: str, dimensions: tuple[int, ...] = (1,)) -> np.ndarray:
    """Contiguous float64; the very same array if it is that already."""
    values = without_mask(values, what)
    if are_stamps(values):
        raise ValueError(f"{what}: dates and times are not numbers (give them as time)")
    try:
        if hasattr(values, "iloc"):
            values = values.to_numpy(dtype=np.float64, na_value=np.nan)
        values = np.asarray(values)
        if np.iscomplexobj(values):
            raise ValueError("complex numbers cannot be used")
        numbers = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{what}: {error}") from None
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


def _records(records: Any, rows: int) -> list[tuple[str, slice]]:
    if records is None:
        return [(RECORD, slice(0, rows))]
    labels = np.asarray(records)
    if labels.shape != (rows,):
        raise ValueError(f"records: one label for each of the {rows} rows is needed")
    if rows == 0:
        return [(RECORD, slice(0, 0))]
    found = []
    begun = set()
    for piece in runs(labels):
        name = str(labels[piece.start])
        if name in begun:
            raise ValueError(f'record "{name}" continues after another record (keep its rows together)')
        begun.add(name)
        found.append((name, piece))
    return found


def runs(labels: np.ndarray) -> list[slice]:
    """Where labels stay the same."""
    changes = np.flatnonzero(labels[1:] != labels[:-1]) + 1
    edges = [0, *changes.tolist(), len(labels)]
    return [slice(begin, end) for begin, end in zip(edges[:-1], edges[1:])]
