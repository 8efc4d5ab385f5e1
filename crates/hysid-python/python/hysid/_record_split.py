"""Folds for scikit-learn: those of `hysid.validate`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from hysid import _hysid
from hysid._arguments import whole
from hysid._columns import place_of
from hysid._data import columns
from hysid._tables import named_columns

__all__ = ["RecordSplit"]


class RecordSplit:
    """Divide rows for cross-validation as `hysid.validate` does: whole records, or what follows in time.

    Several records are held out in turn, each from its beginning, so that the model has the input history that it needs.
    Copies of a record stay together. These folds are exactly those of `hysid.validate`.

    A single record is cut in time, three times: the model is fitted to its beginning and predicts what follows. A test
    fold has no rows before it, so an estimator begins there without memory, unless it carries the memory over from
    training: `HysteresisRegressor` does with ``continue_records=True``, and then the errors are those of `hysid.validate`.
    The two folds in which `hysid.validate` holds out a block from the beginning and from the middle do not exist here:
    there, the outputs of the block are blanked and its inputs are run, and a splitter can only leave rows out.

    Parameters
    ----------
    folds : int
        Maximum number of folds of several records; a single record always gives three.
    time : str or int, optional
        The column of `X` with the time stamps, as of `HysteresisRegressor`.
    record : str or int, optional
        The column of `X` with the labels of the records, as of `HysteresisRegressor`; by default `groups`, and without
        these all rows are one record.

    Examples
    --------
    >>> from sklearn.model_selection import cross_val_score
    >>> train, _ = hysid.specimen("piezo-actuator").data()
    >>> frame = train.frame()
    >>> names = {"time": "t_s", "record": "record"}
    >>> regressor = hysid.HysteresisRegressor(model="masing", **names)
    >>> split = hysid.RecordSplit(folds=2, **names)
    >>> cross_val_score(regressor, frame[["record", "t_s", "voltage_V"]], frame["displacement_um"], cv=split).round(1)
    array([1., 1.])
    """

    def __init__(self, folds: int = 5, *, time: str | int | None = None, record: str | int | None = None) -> None:
        self.folds = whole("folds", folds, 2)
        self.time = time
        self.record = record

    def split(self, X: Any, y: Any = None, groups: Any = None) -> Iterator[tuple[np.ndarray, np.ndarray]]:  # noqa: N803
        """Give the rows of each fold.

        Parameters
        ----------
        X : array of shape (n, columns)
            Inputs, and the columns of time and records if there are any; rows in order.
        y : array of shape (n,)
            The measured output; copies are found by it, and rows without a measurement are not counted.
        groups : array of shape (n,), optional
            A label of its record for each row, if `record` is not given.

        Yields
        ------
        train, test : arrays of int
            Rows to fit to and rows to test on.

        Raises
        ------
        ValueError
            Too few data to hold any out, or a record whose rows are not together.
        """
        if y is None:
            raise ValueError("y: the measured output is needed")
        inputs, time, records = self._parts(X)
        arranged = columns(inputs, y, time, None, groups if records is None else records)
        starts = [rows.start for _, rows in arranged.records]

        def rows(ranges: list[tuple[int, int, int]]) -> np.ndarray:
            return np.concatenate([np.arange(starts[record] + a, starts[record] + b) for record, a, b in ranges])

        for train, test in _hysid.folds(arranged.dataset(), self.folds):
            yield rows(train), rows(test)

    def get_n_splits(self, X: Any = None, y: Any = None, groups: Any = None) -> int:  # noqa: N803
        """Give the number of folds.

        Parameters
        ----------
        X, y, groups : array
            As of `split`; the number depends on them.

        Returns
        -------
        int
            The number of folds.
        """
        if X is None:
            raise ValueError("X: the number of folds depends on the data")
        return sum(1 for _ in self.split(X, y, groups))

    def __repr__(self) -> str:
        return f"RecordSplit(folds={self.folds}, time={self.time!r}, record={self.record!r})"

    def _parts(self, X: Any) -> tuple[Any, Any, Any]:  # noqa: N803
        """Inputs, time stamps and labels."""
        named = named_columns(X)
        if named is None:
            values = np.asarray(X)
            values = values.reshape(-1, 1) if values.ndim == 1 else values
            named = [(f"x{place}", values[:, place]) for place in range(values.shape[1])]
        names = [name for name, _ in named]
        given = {"time": self.time, "record": self.record}
        places = [place_of(what, column, names, len(names)) for what, column in given.items()]
        time, record = (None if place is None else np.asarray(named[place][1]) for place in places)
        inputs = {name: np.asarray(column) for place, (name, column) in enumerate(named) if place not in places}
        return inputs, time, record
