"""The inverse of a model: the input for a wanted output."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hysid import _hysid

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
    trials : int
        Steps of the model that the search needed.
    """

    input: float
    output: float
    reach: str
    trials: int


@dataclass(frozen=True)
class Inversion:
    """An inverse over a whole record; arrays with a value for each row.

    Attributes
    ----------
    input : numpy.ndarray
        The first input, in its unit.
    output : numpy.ndarray
        The output of the model at this input.
    reach : numpy.ndarray of str
        As of `Inverted`.
    """

    input: np.ndarray
    output: np.ndarray
    reach: np.ndarray

    @property
    def reached(self) -> np.ndarray:
        """True where the model has the wanted output."""
        return np.asarray(self.reach == "reached")


class Inverse:
    """The inverse of a model, which has the memory of the model; see `Model.inverse`."""

    def __init__(self, native: _hysid.Inverse) -> None:
        self._native = native

    def step(self, y: float, time: float | None = None, others: Sequence[float] = ()) -> Inverted:
        """Give the input at which the model has the output `y`, and go on from there.

        Parameters
        ----------
        y : float
            The wanted output, in the unit of the training.
        time : float, optional
            Time of the sample, for a model that needs it and for a slew limit.
        others : sequence of float, optional
            The inputs of the model after the first one.

        Returns
        -------
        Inverted
            The input, and whether the output is reached.

        Raises
        ------
        ValueError
            A value that is not finite, another number of inputs, or time that does not advance. The state is then
            unchanged.
        """
        return Inverted(*self._native.step(float(y), time, [float(value) for value in others]))

    def run(self, y: Any, time: Any = None, others: Any = None) -> Inversion:
        """Give the inputs for a whole record of wanted outputs, after the samples so far.

        Parameters
        ----------
        y : array of shape (rows,)
            The wanted outputs, in the unit of the training.
        time : array of shape (rows,), optional
            Times of the rows, for a model that needs them and for a slew limit.
        others : array of shape (rows, inputs - 1), optional
            The inputs of the model after the first one.

        Returns
        -------
        Inversion
            Inputs and outputs, and which of them are reached.

        Raises
        ------
        ValueError
            As `step`; or arrays of other lengths. The rows before the invalid one have been taken.
        """
        wanted = np.ascontiguousarray(y, dtype=float)
        if wanted.ndim != 1:
            raise ValueError(f"y: an array of one dimension is needed, not of {wanted.ndim}")
        rows = len(wanted)
        times = None if time is None else np.ascontiguousarray(time, dtype=float)
        further = np.empty((rows, 0)) if others is None else np.asarray(others, dtype=float)
        if further.ndim == 1:
            further = further.reshape(-1, 1)
        if times is not None and times.shape != (rows,):
            raise ValueError(f"time: {times.shape} values for {rows} rows")
        if len(further) != rows:
            raise ValueError(f"others: {len(further)} rows for {rows} rows of y")
        given, outputs, reach = self._native.run(wanted, times, np.ascontiguousarray(further).ravel())
        return Inversion(given, outputs, np.array(reach))

    def reset(self) -> None:
        """Go back to the initial state of the model."""
        self._native.reset()
