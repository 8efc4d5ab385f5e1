"""Progress of long computations: what is told, and to whom."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple, TypeAlias, Union

from hysid._progress_line import progress_line

__all__ = ["Listener", "Progress", "told"]


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


@contextmanager
def told(progress: Listener, time_limit: float | None = None) -> Iterator[Callable[[Progress], object] | None]:
    """The callback of a computation; afterwards it is closed if it has `close`."""
    if progress is None or isinstance(progress, bool):
        callback: Callable[[Progress], object] | None = progress_line(time_limit) if progress else None
    elif callable(progress):
        callback = progress
    else:
        raise TypeError(f"progress {progress!r}: True, False or a function is needed")
    try:
        yield callback
    finally:
        close = getattr(callback, "close", None)
        if close is not None:
            close()


def of_native(callback: Callable[[Progress], object] | None) -> Callable[..., object] | None:
    """A callback as the native module calls it."""
    return None if callback is None else lambda *values: callback(Progress(*values))
