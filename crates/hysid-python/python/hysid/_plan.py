"""Plans of experiments: what to measure next."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from hysid import _hysid
from hysid._arguments import name_of, pair, real, whole
from hysid._data import columns

if TYPE_CHECKING:
    import os

    from numpy.typing import ArrayLike

    from hysid._data import Values


@dataclass(frozen=True)
class Segment:
    """A segment of a drive.

    Attributes
    ----------
    kind : str
        What is run, such as ``"minor-loop"``.
    rows : slice
        Its rows in the drive.
    amplitude, mean : float
        Half the difference and half the sum of its largest and smallest input, behind the way to its first turning point.
    rate : float
        Largest rate of the input there.
    turning_points : list of float
        The turning points, the end included.
    reason : str
        Why it is run.
    """

    kind: str
    rows: slice
    amplitude: float
    mean: float
    rate: float
    turning_points: list[float]
    reason: str

    @classmethod
    def _of(cls, told: dict[str, Any]) -> Segment:
        first, last = told["rows"]
        return cls(**{**told, "rows": slice(first, last + 1)})


@dataclass(frozen=True, eq=False)
class Plan:
    """A drive, and why it is so.

    Attributes
    ----------
    drive : array of shape (n,)
        The input of each row.
    time : array of shape (n,) or None
        The time of each row; None for data without time.
    segments : list of Segment
        What is run and why; the first row belongs to none.
    gaps : dict
        What the data do not cover: statements by their subject.
    limits : dict
        What the drive keeps: range, start, step, max_rate, rows.
    names : dict
        Names of the columns.
    sources : list of str
        Sources of the protocol of a kind.
    """

    drive: np.ndarray
    time: np.ndarray | None
    segments: list[Segment]
    gaps: dict[str, str]
    limits: dict[str, Any]
    names: dict[str, Any]
    sources: list[str]
    _native: _hysid.Plan | None = field(default=None, repr=False)

    @classmethod
    def _of(cls, native: _hysid.Plan) -> Plan:
        told = json.loads(native.to_json())
        return cls(
            drive=np.array(told["input"]),
            time=None if told["time"] is None else np.array(told["time"]),
            segments=[Segment._of(segment) for segment in told["segments"]],
            gaps={gap["what"]: gap["statement"] for gap in told["gaps"]},
            limits=told["limits"],
            names=told["names"],
            sources=told["sources"],
            _native=native,
        )

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_native": None}

    def __repr__(self) -> str:
        low, high = self.limits["range"]
        return f"<plan of {len(self.drive)} rows from {low:g} to {high:g}, {len(self.segments)} segments>"

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the drive as a table of time, if there is one, and input.

        Parameters
        ----------
        path : path
            The file; one that is there is replaced.
        """
        given = [] if self.time is None else [(self.names["time"] or "t", self.time)]
        given.append((self.names["inputs"][0], self.drive))
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow([name for name, _ in given])
            writer.writerows(zip(*(values.tolist() for _, values in given), strict=True))

    def report(self, path: str | os.PathLike[str], *, title: str | None = None, force: bool = False) -> None:
        """Write the plan as an HTML page: the drive, its segments and their reasons, what the data do not cover.

        Parameters
        ----------
        path : path
            The page, an HTML file that needs no other file.
        title : str, optional
            Title of the page.
        force : bool
            Replace a file even if it is not a page of Hysid.

        Raises
        ------
        ValueError
            The plan was pickled or copied: plan again.
        FileExistsError
            The file exists, is not a page of Hysid, and `force` is False.

        Examples
        --------
        >>> import hysid, tempfile
        >>> plan = hysid.plan(kind="damper", range=(-1, 1))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     plan.report(folder + "/plan.html")
        """
        if self._native is None:
            raise ValueError("a plan that was pickled or copied has no page: plan again")
        self._native.report(path, title, force)


def plan(
    x: Values | None = None,
    y: Values | str | None = None,
    time: ArrayLike | str | None = None,
    records: ArrayLike | str | None = None,
    *,
    kind: str | None = None,
    range: tuple[float, float] | None = None,
    length: int | None = None,
    step: float | None = None,
    max_rate: float | None = None,
    wave: str | None = None,
    seed: int = 1,
) -> Plan:
    """Plan what to measure next: tests of properties that the data cannot test, then random reversals.

    Parameters
    ----------
    x : array of shape (n,), optional
        The measured input; not for a kind.
    y : array of shape (n,), optional
        The measured output; NaN for no measurement.
    time : array of shape (n,), optional
        Time stamps, increasing within each record.
    records : array of shape (n,), optional
        A label for each row.
    kind : str, optional
        In the place of data: a kind of specimen, for a first test. ``"structure"``, ``"damper"``, ``"rubber"``,
        ``"actuator"``, ``"magnet"``, or words such as ``"piezo stage"``.
    range : pair of float, optional
        Lowest and highest input; that of the data by default, needed for a kind.
    length : int, optional
        Most rows; as many as the data by default, 2000 for a kind.
    step : float, optional
        Time between rows; that of the data by default.
    max_rate : float, optional
        Largest rate of the input, without time from row to row; that of the data by default.
    wave : str, optional
        ``"smooth"`` or ``"triangle"``; smooth if there is time by default.
    seed : int
        Seed of all random numbers.

    Returns
    -------
    Plan
        The drive and its segments with their reasons.

    Raises
    ------
    ValueError
        Data without anything to identify, limits that leave no drive, an unknown kind.

    Examples
    --------
    >>> import hysid
    >>> import numpy as np
    >>> x = 3 * np.sin(np.linspace(0, 6 * np.pi, 601))
    >>> plan = hysid.plan(x, hysid.operators.stop(x, 1.0))
    >>> bool(abs(plan.drive).max() <= 3 and plan.drive[0] == plan.drive[-1] == x[0])
    True
    >>> plan.gaps["amplitudes"]
    'no swing of 0 % to 38 % of the range was run'
    """
    limits = (
        None if range is None else pair("range", range),
        None if length is None else whole("length", length),
        None if step is None else real("step", step),
        None if max_rate is None else real("max_rate", max_rate),
        name_of("wave", wave),
        whole("seed", seed),
    )
    if (kind is None) == (x is None and y is None):
        raise ValueError("give measured data, x and y, or a kind of specimen")
    if kind is not None:
        return Plan._of(_hysid.plan(None, name_of("kind", kind), *limits))
    if x is None or y is None:
        raise ValueError("x and y are needed")
    arranged = columns(x, y, time, None, records)
    return Plan._of(_hysid.plan(arranged.dataset(), None, *limits))
