"""Comparison of models."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hysid import _hysid
from hysid._arguments import real, whole
from hysid._data import columns, in_units_of
from hysid._fitting import as_json
from hysid._html import number, table
from hysid._progress import Listener, of_native
from hysid._progress_line import told
from hysid._warning import warn
from hysid._results import Errors
from hysid.model import Model

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Values
    from hysid._options import ModelName
    from hysid._types import RateName

@dataclass(frozen=True)
class Compared:
    """A model of a comparison, or the reason why there is none.

    Attributes
    ----------
    name : str
        Which model and variant, such as ``"bouc-wen (degradation)"``.
    model : Model or None
        The fitted model.
    train, test : Errors or None
        Errors of free runs on the training data, and on unseen data.
    fit_seconds : float or None
        Time of the fit on one thread, in seconds.
    error : str or None
        Why there is no model.
    """

    name: str
    model: Model | None = None
    train: Errors | None = None
    test: Errors | None = None
    fit_seconds: float | None = None
    error: str | None = None

    @property
    def judged(self) -> float:
        """Error on unseen data (without such data, on the training data), in percent of std."""
        errors = self.test or self.train
        percent = None if errors is None else errors.nrmse_std_percent
        return float("inf") if percent is None else percent


class Comparison(Sequence[Compared]):
    """Results of all models, the lowest error on unseen data first.

    Attributes
    ----------
    known : int or str or None
        Known beginning of each record: all errors are those after it.
    """

    def __init__(self, rows: list[Compared], known: int | str | None = None) -> None:
        self.known = known
        self._rows = sorted(rows, key=lambda row: row.judged)

    def __getitem__(self, place: Any) -> Any:
        return self._rows[place]

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def best(self) -> Model:
        """The model with the lowest error."""
        model: Model | None = self._rows[0].model
        if model is None:
            raise ValueError("no model could be fitted")
        return model

    def to_frame(self) -> Any:
        """Give the comparison as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            A row for each model.
        """
        import pandas

        return pandas.DataFrame(self.cells())

    def cells(self) -> list[dict[str, Any]]:
        """Give the comparison as a list of plain rows.

        Returns
        -------
        list of dict
            Errors in percent of the output's standard deviation.
        """
        return [
            {
                "model": row.name,
                "unseen_percent": None if row.test is None else row.test.nrmse_std_percent,
                "train_percent": None if row.train is None else row.train.nrmse_std_percent,
                "parameters": None if row.model is None else row.model.parameters,
                "fit_seconds": row.fit_seconds,
                "error": row.error,
            }
            for row in self._rows
        ]

    def __str__(self) -> str:
        lines = [f"{'model':<34}{'unseen %':>9}{'train %':>9}{'parameters':>11}{'fit s':>8}"]
        for row in self.cells():
            if row["error"] is not None:
                lines.append(f"{row['model']:<34} {row['error']}")
                continue
            errors = "".join(
                f"{'' if row[name] is None else format(row[name], '.3g'):>9}"
                for name in ("unseen_percent", "train_percent")
            )
            lines.append(f"{row['model']:<34}{errors}{row['parameters']:>11}{row['fit_seconds']:>8.2g}")
        if self.known is not None:
            rows = "" if isinstance(self.known, str) else " rows"
            lines.append(f"Errors are those after a known beginning of each record: {self.known}{rows}.")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        head = ["model", "unseen %", "train %", "parameters", "fit s"]
        rows = []
        for row in self.cells():
            if row["error"] is not None:
                rows.append([row["model"], row["error"], "", "", ""])
                continue
            errors = (number(row["unseen_percent"]), number(row["train_percent"]))
            rows.append([row["model"], *errors, str(row["parameters"]), f"{row['fit_seconds']:.2g}"])
        return table(head, rows)


def compare(
    x: Values,
    y: Values | str,
    time: ArrayLike | str | None = None,
    rate: RateName | ArrayLike = "auto",
    records: ArrayLike | str | None = None,
    *,
    test: Any = None,
    models: Sequence[ModelName] | None = None,
    known: int | str | None = None,
    time_limit: float | None = None,
    seed: int | None = None,
    threads: int | None = None,
    progress: Listener = True,
) -> Comparison:
    """Fit all models, in all their variants, to the same data and compare their errors on unseen data.

    Parameters
    ----------
    x, y, time, rate, records
        Data to fit to, as of `hysid.fit`.
    test : tuple, dict or Records, optional
        Test data, which no model is fitted to: x, y and, if there are any, time, rate, records. Without it,
        the models are compared on the training data.
    models : sequence of str, optional
        Names of the models, also ``"auto"``; by default all of `hysid.models`.
    known : int or str, optional
        Measured beginning of each record, from which each model finds its state: a number of rows, or a time with its unit
        such as ``"0.5s"``. Errors are those after it, and ``"auto"`` also tries free initial states.
    time_limit : float, optional
        Time for each model in seconds, after which its best fit so far is used; by default 20, and no limit for
        ``"auto"``.
    seed : int, optional
        Seed of all random numbers.
    threads : int, optional
        Number of models fitted at the same time; fewer models share the threads. By default one for each processor.
    progress : bool or callable, default True
        As of `hysid.fit`. If a callable returns true, the models that are being fitted end with their best fit so far, and
        the others are not fitted.

    Returns
    -------
    Comparison
        The lowest error on unseen data first.

    Raises
    ------
    ValueError
        Invalid data or options, or a known beginning that leaves nothing to score or has no output.

    Examples
    --------
    >>> import hysid
    >>> train, test = hysid.specimen("terfenol-rod").data()
    >>> chosen = ["prandtl-ishlinskii", "generalized-prandtl-ishlinskii"]
    >>> comparison = hysid.compare(train.x, train.y, test=test, models=chosen)
    >>> comparison[0].name
    'generalized-prandtl-ishlinskii'
    """
    limit = None if time_limit is None else real("time_limit", time_limit)
    named = isinstance(rate, str)
    arranged = columns(x, y, time, None if named else rate, records)
    unseen = None if test is None else columns(*_parts(test))
    data = arranged.dataset()
    warn(data.warnings() + ([] if unseen is None else unseen.dataset().copies_of(data)))
    names = _hysid.model_names() if models is None else list(models)
    for name in names:
        if name not in ("auto", *_hysid.model_names(), "epnn"):
            raise ValueError(f"model `{name}` is unknown: choose one of auto, {', '.join(_hysid.model_names())}")

    _hysid.FitSpec.check(as_json({"seed": seed, "known": known}))
    rows: list[Compared] = []
    requests: list[_hysid.FitSpec] = []
    for name in names:
        try:
            options = as_json({"model": name, "seed": seed, "known": known})
            requests += _hysid.FitSpec.variants(options, str(rate) if named else "given", data)
        except ValueError as error:
            rows.append(Compared(name, error=str(error)))

    if unseen is not None:
        unseen = in_units_of(unseen, dict(zip(("time", "inputs", "rate", "output"), data.names())))
    workers = None if threads is None else whole("threads", threads, 1, 1024)
    with told(progress) as callback:
        tested = None if unseen is None else unseen.dataset()
        fitted, interrupted = _hysid.compare(data, requests, tested, workers, limit, of_native(callback))
    if interrupted:
        raise KeyboardInterrupt
    return Comparison(rows + [_compared(*row) for row in fitted], known)


def _compared(
    name: str, native: _hysid.Model | None, test: str | None, seconds: float | None, error: str | None
) -> Compared:
    if native is None:
        return Compared(name, error=error)
    model = Model(native)
    unseen = None if test is None else Errors(**json.loads(test))
    return Compared(name, model, model.train, unseen, seconds)


def _parts(test: Any) -> tuple[Any, ...]:
    """x, y, time, rate, records."""
    order = ("x", "y", "time", "rate", "records")
    if isinstance(test, dict):
        unknown = set(test) - set(order)
        if unknown or not {"x", "y"} <= set(test):
            raise ValueError(f"test: a dict with the keys {', '.join(order)} is needed")
        return tuple(test.get(name) for name in order)
    if isinstance(test, (tuple, list)):
        if not 2 <= len(test) <= 5:
            raise ValueError(f"test: {', '.join(order)} are needed, at least the first two")
        return (*test, *[None] * (5 - len(test)))
    return tuple(getattr(test, name, None) for name in order)
