"""Content of plots: measured data, a free run of a model, and labels of the axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hysid import _hysid
from hysid._columns import Column
from hysid._data import Columns, columns

if TYPE_CHECKING:
    from hysid.model import Model

__all__ = ["Run"]


class Run:
    """Measured data and a model's free run over them, in the units of the model."""

    def __init__(self, model: Model | None, x: Any, y: Any, time: Any, rate: Any, records: Any) -> None:
        if not (model is None or hasattr(model, "simulate")):
            raise TypeError(f"model: a Model, or None for measured data alone, comes first, not {type(model).__name__}")
        if model is None and y is None:
            raise ValueError("there is nothing to draw: give a model, or a measured output y")
        self.model = model
        if model is None:
            self.columns: Columns = columns(x, y, time, rate, records)
        else:
            self.columns = model._converted(model._columns(x, y, time, rate, records), same_units=False)
        taken = self.columns
        self.x = taken.inputs[0].values
        self.y = taken.output.values if taken.output else None
        self.input = taken.inputs[0].name or (model.inputs[0] if model else "x")
        self.output = (taken.output.name if taken.output else None) or (model.output if model else "y")
        self.time = (taken.time.name or "time") if taken.time else None
        self._shifts = self._shifts_of_records()
        self._free_run = None if model is None else model._simulated(taken)
        self.simulated = None if self._free_run is None else self._measured_rows(self._free_run)

    @property
    def input_label(self) -> str:
        return _hysid.axis_label(self.input)

    @property
    def output_label(self) -> str:
        return _hysid.axis_label(self.output)

    @property
    def time_label(self) -> str:
        if self.time is None:
            return "row"
        return _hysid.axis_label(self.time) + (", record after record" if self._shifts else "")

    def figure_label(self, figure: str) -> str:
        """The name of a figure of a cycle with its unit."""
        return _hysid.figure_label(figure, self.input, self.output, self.time)

    def error_label(self) -> str:
        """The name of the error with its unit."""
        name, unit = _hysid.name_and_unit(self.output)
        return f"error of {name}" + ("" if unit is None else f" ({unit})")

    def records(self) -> list[slice]:
        return [rows for _, rows in self.columns.records]

    def stamps(self, rows: slice) -> np.ndarray:
        """Times of a record, behind those of the record before; without time, the numbers of the rows."""
        if self.columns.time is None:
            return np.arange(rows.start, rows.stop)
        return self.columns.time.values[rows] + self._shifts.get(rows.start, 0.0)

    def band(self, probability: float | None) -> tuple[np.ndarray, np.ndarray] | None:
        """The edges of the prediction band, if the model has one."""
        if probability is None or self.model is None or not self.model.has_band:
            return None
        _, low, high = self.model._predicted(self.columns, probability)
        return self._measured_rows(low), self._measured_rows(high)

    def outputs(self) -> list[tuple[str, Columns]]:
        """The columns with the measured output, and with that of the model, which has no blanks."""
        both = [("measured", self.y), ("model", self._free_run)]
        name = self.output
        return [(kind, self.columns._replace(output=Column(y, name))) for kind, y in both if y is not None]

    def _shifts_of_records(self) -> dict[int, float]:
        """Offsets to add to the times of each record, by its first row, if the times of records overlap."""
        records = [rows for rows in self.records() if rows.stop > rows.start]
        if self.columns.time is None:
            return {}
        times = [self.columns.time.values[rows] for rows in records]
        if all(before[-1] <= after[0] for before, after in zip(times, times[1:])):
            return {}
        shifts = {}
        end = 0.0
        for rows, own in zip(records, times):
            shifts[rows.start] = end - own[0]
            length = own[-1] - own[0]
            end += length + length / max(1, len(own) - 1)
        return shifts

    def _measured_rows(self, values: np.ndarray) -> np.ndarray:
        """Without the rows that were not measured: the simulated ones before the first measured one would confuse."""
        return values if self.y is None else np.where(np.isnan(self.y), np.nan, values)
