"""What kind of hysteresis is this?"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

from hysid import _hysid
from hysid._data import columns

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Columns, Values


@dataclass(frozen=True)
class Finding:
    """A property, and what data or a model say about it.

    Attributes
    ----------
    name : str
        The property, such as ``"wiping-out"``.
    verdict : str
        ``"yes"``, ``"no"`` or ``"not testable"``.
    index, threshold, noise : float or None
        The measure that decides, where it decides otherwise, and what noise alone would give.
    comparisons : int
        How many comparisons the index is the largest of.
    statement : str
        What was found, in words.
    experiment : str or None
        Where the data do not tell: the experiment that would.
    evidence : list of dict
        The rows that show it, the strongest first.
    """

    name: str
    verdict: str
    index: float | None
    threshold: float | None
    noise: float | None
    comparisons: int
    statement: str
    experiment: str | None
    evidence: list[dict[str, Any]]


class _Findings:
    """What diagnoses of data and of models have in common."""

    def __init__(self, content: dict[str, Any]) -> None:
        self.content = content

    @cached_property
    def properties(self) -> list[Finding]:
        """All findings."""
        return [Finding(**finding) for finding in self.content["properties"]]

    def __getitem__(self, name: str) -> Finding:
        for finding in self.properties:
            if finding.name == name:
                return finding
        names = ", ".join(finding.name for finding in self.properties)
        raise KeyError(f"there is no property {name!r}: the properties are {names}")

    def verdict(self, name: str) -> str:
        """Give the verdict on a property: yes, no or not testable.

        Parameters
        ----------
        name : str
            The property, such as ``"wiping-out"``.

        Returns
        -------
        str
            The verdict.
        """
        return self[name].verdict

    def __str__(self) -> str:
        return "\n".join(f"{finding.name:<18}{finding.verdict}" for finding in self.properties)

    def _repr_html_(self) -> str:
        rows = "".join(
            f'<tr><td style="text-align: left">{escape(finding.name)}</td>'
            f'<td style="text-align: left"><b>{escape(finding.verdict)}</b></td>'
            f'<td style="text-align: left">{escape(finding.statement)}</td></tr>'
            for finding in self.properties
        )
        return f"<table><tbody>{rows}</tbody></table>"


class Diagnosis(_Findings):
    """Everything that measured data say about their hysteresis.

    Attributes
    ----------
    properties : list of Finding
        Ten properties, each with its verdict and evidence; ``diagnosis["masing"]`` is one of them.
    doctor : list of dict
        What in the data would mislead a fit, warnings first.
    advice : dict
        The simplest model that can hold what was found.
    content : dict
        What the program prints with ``hysid diagnose --json``.
    """

    def __init__(self, content: dict[str, Any], data: Columns) -> None:
        super().__init__(content)
        self.data = data

    @property
    def doctor(self) -> list[dict[str, Any]]:
        """What in the data would mislead a fit."""
        return list(self.content["doctor"])

    @property
    def advice(self) -> dict[str, Any]:
        """The simplest model that can hold what was found."""
        return dict(self.content["advice"])


class ModelDiagnosis(_Findings):
    """Everything that can be said about the hysteresis of a fitted model.

    Attributes
    ----------
    properties : list of Finding
        Ten properties, found by driving the model.
    content : dict
        Beside them what its equations promise, its weights say, the widths of its loops, and what is certain
        of its memory.
    """


def diagnose(
    x: Values,
    y: Values,
    time: ArrayLike | None = None,
    records: ArrayLike | None = None,
    *,
    smallest_reversal: float = 0.02,
    smoothing: bool = True,
) -> Diagnosis:
    """Tell what kind of hysteresis measured data have.

    Parameters
    ----------
    x : array of shape (n,) or (n, inputs)
        The inputs in the user's units; how the output follows the first is diagnosed.
    y : array of shape (n,)
        The measured output; NaN is a blank.
    time : array of shape (n,), optional
        Time stamps, increasing within each record.
    records : array of shape (n,), optional
        A label for each row.
    smallest_reversal : float
        Reversals of the input below this share of its range are no turning points.
    smoothing : bool
        Smooth noise out of branches before they are compared.

    Returns
    -------
    Diagnosis
        Ten properties with their evidence, what is wrong with the data, and what to do.

    Raises
    ------
    ValueError
        Data that nothing can be said about.

    Examples
    --------
    >>> import hysid
    >>> train, _ = hysid.specimen("reinforced-concrete-joint").data()
    >>> hysid.diagnose(train.x, train.y, time=train.time).verdict("deterioration")
    'yes'
    """
    if not 0.0 < smallest_reversal < 1.0:
        raise ValueError(f"smallest_reversal {smallest_reversal}: a number between 0 and 1 is needed")
    arranged = columns(x, y, time, None, records)
    content = json.loads(_hysid.diagnose(arranged.dataset(), smallest_reversal, smoothing))
    return Diagnosis(content, arranged)
