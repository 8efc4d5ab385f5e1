"""The inverse of a model: the input for a wanted output."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hysid import _hysid
from hysid._columns import Column, column_of, inputs_of
from hysid._data import check_indexes, warn_of_order

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Values

__all__ = ["Inverse", "Inversion", "Inverted"]


@dataclass(frozen=True)
class Inverted:
    """One sample of an inverse.

    Attributes
    ----------
    input : float
        The first input, in its unit.
    output : float
        The output of the model at this input: the wanted one, or the nearest that is possible.
    reach : str
        ``"reached"`` if the model has the wanted output. Otherwise the reason: ``"low-limit"`` or ``"high-limit"`` of
        the input, ``"slew"`` (the input cannot change so quickly), ``"not-monotone"`` (no input within the limits has
        the output), ``"jump"`` (the output jumps over it).
    extrapolated : bool
        True if the input, or its rate for a model with a rate, is outside the range of the training data.
    low, high : float or None
        Lowest and highest input whose prediction band contains the wanted output; None without a band.
    trials : int
        Steps of the model that the search needed.
    """

    input: float
    output: float
    reach: str
    extrapolated: bool
    low: float | None
    high: float | None
    trials: int


@dataclass(frozen=True)
class Inversion:
    """An inverse over a whole record, with a value for each row.

    `Inverse.run` gives arrays; `Model.invert` gives Series if the wanted output is a pandas object.

    Attributes
    ----------
    input : array or Series of shape (rows,)
        The first input, in its unit.
    output : array or Series of shape (rows,)
        The output of the model at this input.
    reach : array or Series of str
        As of `Inverted`.
    extrapolated : array or Series of bool
        As of `Inverted`.
    low, high : array or Series of shape (rows,), or None
        As of `Inverted`.
    preview : float
        Time by which the search looked ahead.
    """

    input: Any
    output: Any
    reach: Any
    extrapolated: Any
    low: Any = None
    high: Any = None
    preview: float = 0.0

    @property
    def reached(self) -> np.ndarray:
        """True where the model has the wanted output."""
        return np.asarray(self.reach == "reached")


class Reference:
    """Wanted outputs, times and further inputs of the same rows."""

    def __init__(self, y: Any, time: Any, others: Any) -> None:
        check_indexes({"y": y, "time": time, "others": others})
        wanted = column_of(y, "output")
        if wanted is None:
            raise ValueError("y: the wanted output is needed")
        self.wanted: Column = wanted
        self.time: Column | None = column_of(time, "time")
        self.others: list[Column] = [] if others is None else inputs_of(others)
        rows = len(wanted.values)
        if self.time is not None and len(self.time.values) != rows:
            raise ValueError(f"time: {len(self.time.values)} values for {rows} rows of y")
        for column in self.others:
            if len(column.values) != rows:
                raise ValueError(f"others: {len(column.values)} rows for {rows} rows of y")
        warn_of_order(y, [slice(0, rows)])

    def native(self) -> tuple[np.ndarray, np.ndarray | None, list[np.ndarray]]:
        """As the native module takes it."""
        times = None if self.time is None else self.time.values
        return self.wanted.values, times, [column.values for column in self.others]


class Inverse:
    """The inverse of a model, which has the memory of the model; see `Model.inverse`."""

    def __init__(self, native: _hysid.Inverse, preview: float = 0.0) -> None:
        self._native = native
        self._preview = preview

    @property
    def preview(self) -> float:
        """Time by which the search looks ahead."""
        return self._preview

    def step(self, y: float, time: float | None = None, others: Sequence[float] = ()) -> Inverted:
        """Give the input at which the model has the output `y`, and go on from there.

        With a preview, `y` is the wanted output at `time` + `preview`, except in the first sample.

        Parameters
        ----------
        y : float
            The wanted output, in the unit of the training.
        time : float, optional
            Time of the sample, for a model that needs it, a slew limit or a preview.
        others : sequence of float, optional
            The inputs of the model after the first one.

        Returns
        -------
        Inverted
            The input, and whether the output is reached.

        Raises
        ------
        ValueError
            A value that is not finite, another number of inputs, a time that is missing or does not advance. The state
            is then unchanged.
        """
        return Inverted(*self._native.step(float(y), time, [float(value) for value in others]))

    def run(self, y: ArrayLike, time: ArrayLike | None = None, others: Values | None = None) -> Inversion:
        """Give the inputs for a whole record of wanted outputs, after the samples so far.

        With a preview, the wanted output ahead is taken from the rows to come.

        Parameters
        ----------
        y : array of shape (rows,)
            The wanted outputs, in the unit of the training.
        time : array of shape (rows,), optional
            Times of the rows, for a model that needs them, a slew limit or a preview.
        others : array of shape (rows,) or (rows, inputs - 1), optional
            The inputs of the model after the first one.

        Returns
        -------
        Inversion
            Inputs and outputs, and which of them are reached.

        Raises
        ------
        ValueError
            As `step`, with the row, counted from 1; or arrays of other lengths. No row has been taken if a length or a
            wanted output is invalid, otherwise those before the invalid one.
        """
        return self._run(Reference(y, time, others))

    def _run(self, reference: Reference) -> Inversion:
        given, outputs, reach, extrapolated, low, high = self._native.run(*reference.native())
        return Inversion(given, outputs, np.array(reach, dtype=str), extrapolated, low, high, self._preview)

    def best_preview(self, y: ArrayLike, time: ArrayLike | None = None, others: Values | None = None) -> float:
        """Give the preview with which the model follows the wanted outputs best.

        0 and powers of two up to an eighth of the record are tried, from the initial state of the model, on at most
        20,000 rows. The best one has small deviations, while the input stays within the trained range and rates, and
        seldom turns where the wanted output does not. The state of the inverse stays as it is.

        Parameters
        ----------
        y, time, others : array
            As of `run`.

        Returns
        -------
        float
            In the unit of time; 0 without `time`, and for a model that does not need time.

        Raises
        ------
        ValueError
            As `run`.
        """
        return self._best_preview(Reference(y, time, others))

    def _best_preview(self, reference: Reference) -> float:
        return self._native.best_preview(*reference.native())

    def reset(self) -> None:
        """Go back to the initial state of the model."""
        self._native.reset()
