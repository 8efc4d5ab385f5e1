"""Cross-validation."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from hysid import _hysid
from hysid._arguments import real, whole
from hysid._data import columns
from hysid._fitting import requested
from hysid._html import number, table
from hysid._progress import Listener, of_native
from hysid._progress_line import told
from hysid._warning import warn
from hysid._results import Errors

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from hysid._data import Values
    from hysid._options import Options
    from hysid._types import RateName


@dataclass(frozen=True)
class FoldErrors:
    """Result of a fold.

    Attributes
    ----------
    held_out : str
        The rows held out, in words.
    train, unseen : Errors
        Errors on the training rows and on the held-out rows.
    """

    held_out: str
    train: Errors
    unseen: Errors


@dataclass(frozen=True)
class Validation:
    """Result of all folds; ``print`` shows the table of `hysid validate`.

    Attributes
    ----------
    folds : tuple of FoldErrors
        The folds; those that were not reached in time are missing.
    unseen : Errors
        Errors over the held-out rows of all folds; a row that is held out several times counts once.
    """

    folds: tuple[FoldErrors, ...]
    unseen: Errors
    _text: str = field(default="", repr=False, compare=False)

    def __str__(self) -> str:
        return self._text.rstrip("\n")

    def _repr_html_(self) -> str:
        head = ["held out", "unseen, % of std", "train, % of std"]
        rows = [
            [fold.held_out, number(fold.unseen.nrmse_std_percent), number(fold.train.nrmse_std_percent)]
            for fold in self.folds
        ]
        rows.append(["all folds", number(self.unseen.nrmse_std_percent), ""])
        return table(head, rows)


def validate(
    x: Values,
    y: Values | str,
    time: ArrayLike | str | None = None,
    rate: RateName | ArrayLike = "auto",
    records: ArrayLike | str | None = None,
    *,
    folds: int = 5,
    time_limit: float | None = None,
    threads: int | None = None,
    progress: Listener = True,
    **options: Unpack[Options],
) -> Validation:
    """Cross-validate a model: fit to a part of the data, evaluate free runs on the rest, fold by fold.

    Several records are held out in turn. A single record is cut in time: the model is fitted to its beginning and
    simulates what follows, with the memory carried over; two further folds hold out its beginning and its middle.
    Ctrl-C ends the validation with a warning and returns the finished folds.

    Parameters
    ----------
    x, y, time, rate, records
        As of `hysid.fit`.
    folds : int
        Maximum number of folds of several records; a single record always gives five.
    time_limit : float, optional
        Time in seconds after which to stop; the current fold is evaluated with its best model so far.
    threads : int, optional
        As of `hysid.fit`.
    progress : bool or callable, default True
        As of `hysid.fit`.
    **options
        Options of the model and its training, as of `hysid.fit`.

    Returns
    -------
    Validation
        Errors of each fold, and over all folds.

    Raises
    ------
    ValueError
        Too few data to hold any out, and as of `hysid.fit`.

    Examples
    --------
    >>> import hysid
    >>> train, _ = hysid.specimen("terfenol-rod").data()
    >>> validation = hysid.validate(train.x, train.y, model="prandtl-ishlinskii")
    >>> len(validation.folds)
    5
    """
    folds = whole("folds", folds, 2)
    named = isinstance(rate, str)
    arranged = columns(x, y, time, None if named else rate, records)
    data, request = requested(arranged, str(rate) if named else "given", options, threads)
    limit = None if time_limit is None else real("time_limit", time_limit)
    with told(progress) as callback:
        content, text, interrupted = _hysid.validate(data, request, folds, threads, limit, of_native(callback))
    if interrupted:
        warn(["interrupted: only the finished folds are returned"])
    found = json.loads(content)
    return Validation(
        tuple(
            FoldErrors(fold["held_out"], Errors(**fold["train"]), Errors(**fold["unseen"]))
            for fold in found["folds"]
        ),
        Errors(**found["unseen"]),
        text,
    )
