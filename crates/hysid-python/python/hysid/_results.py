"""Results of a model: errors, predictions, members."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

from hysid import _hysid

__all__ = ["Errors", "Member", "Prediction"]


@dataclass(frozen=True)
class Errors:
    """Errors of a free run over all scored rows; ``print`` shows the table of `hysid evaluate`.

    Attributes
    ----------
    output : str
        Name of the output.
    samples, records : int
        Scored rows, and records with at least one.
    mse, rmse : float
        Mean square error in the output's unit squared, and its root in the output's unit.
    nrmse_std_percent, nrmse_range_percent : float or None
        ``rmse`` in percent of the measured output's standard deviation, and of its range; None if it does not
        vary.
    fit_percent : float or None
        100 - ``nrmse_std_percent``.
    max_abs_error : float
        Largest absolute error in the output's unit.
    """

    output: str
    samples: int
    records: int
    mse: float
    rmse: float
    nrmse_std_percent: float | None
    nrmse_range_percent: float | None
    fit_percent: float | None
    max_abs_error: float

    def as_dict(self) -> dict[str, Any]:
        """Give the errors as a dict."""
        return asdict(self)

    def __str__(self) -> str:
        return _hysid.errors_text(json.dumps(self.as_dict())).rstrip("\n")


class Prediction(NamedTuple):
    """A free run with its prediction band, in the unit of the training.

    Attributes
    ----------
    output : array or Series of shape (n,)
        The output, as `Model.simulate` gives it.
    low, high : array or Series of shape (n,)
        The edges of the band.
    """

    output: Any
    low: Any
    high: Any


@dataclass(frozen=True)
class Member:
    """A member of an ensemble.

    Attributes
    ----------
    name : str
        Its candidate, such as a network with its transform of the input; members with the same name are fits from
        different random starts.
    kind : str
        Its kind, such as ``"networks"``.
    model : str
        Which model, such as ``"xpnn+"``.
    share, share_outside : float
        Its weight in the ensemble before the input leaves the trained range, and after; the weights of all members
        add up to 1.
    """

    name: str
    kind: str
    model: str
    share: float
    share_outside: float
