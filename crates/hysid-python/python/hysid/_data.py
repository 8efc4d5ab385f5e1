"""From arrays and pandas objects to columns with names, and to records."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike

from hysid import _hysid

Values: TypeAlias = Union[ArrayLike, Mapping[str, ArrayLike]]
"""Numbers, or columns by their names; pandas objects are among the former."""

RECORD = "data"
"""What the one record is called if no records are told apart."""


class Column(NamedTuple):
    """Numbers and the name that came with them."""

    values: np.ndarray
    name: str | None


class Columns(NamedTuple):
    """All that was measured, column by column; and where one record ends and the next begins."""

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
    """Takes everything apart, and refuses columns of different length."""
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
    return arranged


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
    return Column(_numbers(values, what), None if name is None else str(name))


def _numbers(values: Any, what: str, dimensions: tuple[int, ...] = (1,)) -> np.ndarray:
    """Contiguous float64; the very same array if it is that already."""
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
    if values.ndim not in dimensions and numbers.ndim not in dimensions:
        expected = " or ".join(f"{dimension}" for dimension in dimensions)
        raise ValueError(f"{what}: an array of {expected} dimensions is needed, not {values.ndim}")
    return numbers


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
            raise ValueError(f'record "{name}" goes on after another began (keep its rows together)')
        begun.add(name)
        found.append((name, piece))
    return found


def runs(labels: np.ndarray) -> list[slice]:
    """Where labels stay the same."""
    changes = np.flatnonzero(labels[1:] != labels[:-1]) + 1
    edges = [0, *changes.tolist(), len(labels)]
    return [slice(begin, end) for begin, end in zip(edges[:-1], edges[1:])]
