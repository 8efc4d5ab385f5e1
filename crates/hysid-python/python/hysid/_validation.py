"""Judgement on data held out."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hysid import _hysid
from hysid._data import columns
from hysid._fitting import requested, told
from hysid._html import number, table
from hysid._warning import warn
from hysid.model import Errors

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Values
    from hysid._fitting import Progress


@dataclass(frozen=True)
class FoldErrors:
    """What came of a fold.

    Attributes
    ----------
    held_out : str
        What was held out, in words.
    train, unseen : Errors
        Errors on what was fitted to, and on what was held out.
    """

    held_out: str
    train: Errors
    unseen: Errors


@dataclass(frozen=True)
class Validation:
    """What came of all folds.

    Attributes
    ----------
    folds : tuple of FoldErrors
        Fold by fold; those that were not reached in time are missing.
    unseen : Errors
        Errors over all rows held out together; of a single record, rows are in several folds.
    unseen_nrmse_std_percent : float or None
        Geometric mean over the folds of the error on what was held out, in percent of the standard deviation
        there: one fold that goes far beyond the others does not decide it.
    """

    folds: tuple[FoldErrors, ...]
    unseen: Errors
    unseen_nrmse_std_percent: float | None

    def _repr_html_(self) -> str:
        head = ["held out", "unseen, % of std", "train, % of std"]
        rows = [
            [fold.held_out, number(fold.unseen.nrmse_std_percent), number(fold.train.nrmse_std_percent)]
            for fold in self.folds
        ]
        rows.append(["geometric mean", number(self.unseen_nrmse_std_percent), ""])
        return table(head, rows)


def validate(
    x: Values,
    y: Values,
    time: ArrayLike | None = None,
    rate: str | ArrayLike = "auto",
    records: ArrayLike | None = None,
    *,
    folds: int = 5,
    time_limit: float | None = None,
    threads: int | None = None,
    progress: Callable[[Progress], object] | None = None,
    **options: Any,
) -> Validation:
    """Fit to a part of the data and judge on the rest, in free run, several times.

    Of several records, some are held out in turn. A single record is cut in time: the model sees its beginning
    and predicts what follows, with the memory carried over; and blocks are held out from its beginning and
    middle. Ctrl-C ends it, warns, and returns the folds so far.

    Parameters
    ----------
    x, y, time, rate, records
        As of `hysid.fit`.
    folds : int
        Folds at most, of several records; of a single one there are always five.
    time_limit : float, optional
        Seconds after which to stop: the fold under way is judged with its best model so far.
    threads : int, optional
        As of `hysid.fit`.
    progress : callable, optional
        As of `hysid.fit`.
    **options
        Options of the model and its training, as of `hysid.fit`.

    Returns
    -------
    Validation
        Errors fold by fold, and over all.

    Raises
    ------
    ValueError
        Data too few to hold any out, and as `hysid.fit`.

    Examples
    --------
    >>> import hysid
    >>> train, _ = hysid.specimen("terfenol-rod").data()
    >>> validation = hysid.validate(train.x, train.y, model="prandtl-ishlinskii")
    >>> len(validation.folds)
    5
    """
    if folds < 2:
        raise ValueError(f"folds {folds}: choose 2 or more")
    named = isinstance(rate, str)
    arranged = columns(x, y, time, None if named else rate, records)
    data, request = requested(arranged, str(rate) if named else "given", options, threads)
    with told(progress) as tell:
        text, interrupted = _hysid.validate(data, request, folds, threads, time_limit, tell)
    if interrupted:
        warn(["interrupted: these are the folds so far"])
    found = json.loads(text)
    return Validation(
        tuple(
            FoldErrors(fold["held_out"], Errors(**fold["train"]), Errors(**fold["unseen"]))
            for fold in found["folds"]
        ),
        Errors(**found["unseen"]),
        found["unseen_nrmse_std_percent"],
    )
