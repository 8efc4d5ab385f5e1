"""Properties of hysteresis, from data or of a model."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any

from hysid import _hysid
from hysid._arguments import fraction, truth
from hysid._data import columns
from hysid._findings import html_table, unknown

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Columns, Values


@dataclass(frozen=True)
class Finding:
    """A property of the hysteresis, with its verdict and evidence.

    Attributes
    ----------
    name : str
        The property, such as ``"wiping-out"``.
    verdict : str
        ``"yes"``, ``"no"`` or ``"not testable"``.
    index, threshold, noise : float or None
        The measure of the property, the value that separates yes from no, and the value from noise alone; shares,
        not percent.
    comparisons : int
        Number of comparisons; the index is the largest of them.
    statement : str
        The result in words.
    experiment : str or None
        If the property could not be tested: an experiment that tests it.
    evidence : list of dict
        The rows behind the index, the strongest evidence first.
    details : dict
        What only this property has. ``"invertible"`` has ``"always"`` and ``"monotone_outputs"`` (low and high, or
        None), ``"direction"``, ``"shortest_time_step"`` and others.
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
    details: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def _of(cls, printed: dict[str, Any]) -> Finding:
        common = {attribute.name for attribute in fields(cls)} - {"details"}
        details = {name: value for name, value in printed.items() if name not in common}
        return cls(**{name: printed[name] for name in common}, details=details)


class _Findings:
    """Base class of the diagnoses of data and of models."""

    def __init__(self, content: dict[str, Any], text: str) -> None:
        self.content = content
        self._text = text

    @cached_property
    def properties(self) -> list[Finding]:
        """All findings."""
        return [Finding._of(finding) for finding in self.content["properties"]]

    def __getitem__(self, name: str) -> Finding:
        for finding in self.properties:
            if finding.name == name:
                return finding
        raise unknown("property", "properties", name, (finding.name for finding in self.properties))

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
        return self._text.rstrip("\n")

    def _repr_html_(self) -> str:
        return html_table((finding.name, finding.verdict, finding.statement) for finding in self.properties)


class Diagnosis(_Findings):
    """Properties of the hysteresis in measured data; ``print`` shows the tables and the advice of `hysid diagnose`.

    Attributes
    ----------
    properties : list of Finding
        Ten properties, each with its verdict and evidence; ``diagnosis["masing"]`` is one of them.
    doctor : list of dict
        Data-quality issues that mislead a fit, warnings first.
    advice : dict
        The simplest model that can represent these properties.
    content : dict
        What the program prints with ``hysid diagnose --json``.
    """

    def __init__(self, content: dict[str, Any], text: str, data: Columns) -> None:
        super().__init__(content, text)
        self.data = data

    @property
    def doctor(self) -> list[dict[str, Any]]:
        """Data-quality issues that mislead a fit."""
        return list(self.content["doctor"])

    @property
    def advice(self) -> dict[str, Any]:
        """The simplest model that can represent these properties."""
        return dict(self.content["advice"])


class ModelDiagnosis(_Findings):
    """Properties of the hysteresis of a fitted model; ``print`` shows the tables of `hysid diagnose`.

    Attributes
    ----------
    properties : list of Finding
        Ten properties, found by probing the model, and ``"invertible"``: whether the next input follows from the
        wanted output. Only models have this one.
    content : dict
        The properties, the verdicts from equations, and the widths of the loops.
    """


def diagnose(
    x: Values,
    y: Values | str,
    time: ArrayLike | str | None = None,
    records: ArrayLike | str | None = None,
    *,
    smallest_reversal: float = 0.02,
    smoothing: bool = True,
) -> Diagnosis:
    """Determine the properties of the hysteresis in measured data.

    Parameters
    ----------
    x : array of shape (n,) or (n, inputs)
        The inputs in the user's units; the output over the first input is diagnosed.
    y : array of shape (n,)
        The measured output; NaN for no measurement.
    time : array of shape (n,), optional
        Time stamps, increasing within each record.
    records : array of shape (n,), optional
        A label for each row.
    smallest_reversal : float
        Reversals of the input below this share of its range are ignored.
    smoothing : bool
        Smooth branches before they are compared.

    Returns
    -------
    Diagnosis
        Ten properties with their evidence, data-quality issues, and advice on a model.

    Raises
    ------
    ValueError
        Data that cannot be diagnosed.

    Examples
    --------
    >>> import hysid
    >>> train, _ = hysid.specimen("reinforced-concrete-joint").data()
    >>> hysid.diagnose(train.x, train.y, time=train.time).verdict("deterioration")
    'yes'
    """
    smallest_reversal = fraction("smallest_reversal", smallest_reversal)
    smoothing = truth("smoothing", smoothing)
    arranged = columns(x, y, time, None, records)
    content, text = _hysid.diagnose(arranged.dataset(), smallest_reversal, smoothing)
    return Diagnosis(json.loads(content), text, arranged)
