"""Progress of long computations: what is told."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeAlias, Union

__all__ = ["Listener", "Progress", "of_native"]


class Progress(NamedTuple):
    """Progress of a fit.

    Attributes
    ----------
    done : float
        Share of the work done, from 0 to 1; assumes that every start uses all its epochs.
    train_nrmse_percent : float
        Error on the training rows, in percent of the output's standard deviation; NaN if it is not known yet.
    start : int
        Number of the start, from 0.
    epoch : int
        Finished epochs of this start in this phase.
    phase : str
        ``"starts"`` or ``"all-data"``.
    model : str
        The model that is being fitted.
    is_part : bool
        Whether this is one of many fits: of a candidate of ``auto``, of a fold of `hysid.validate`, or of a model of
        `hysid.compare`. Then only ``done`` is about the whole work.
    """

    done: float
    train_nrmse_percent: float
    start: int
    epoch: int
    phase: str
    model: str
    is_part: bool


Listener: TypeAlias = Union[bool, Callable[[Progress], object], None]
"""Who is told of the progress: True for a line in a terminal or notebook, False or None for nobody, or a callback."""


def of_native(callback: Callable[[Progress], object] | None) -> Callable[..., object] | None:
    """A callback as the native module calls it."""
    return None if callback is None else lambda *values: callback(Progress(*values))
