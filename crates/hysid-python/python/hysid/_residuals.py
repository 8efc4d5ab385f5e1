"""Tests of the residual of a model, and confidence intervals of the parameters of a law."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from hysid._findings import html_table, unknown


@dataclass(frozen=True)
class ResidualFinding:
    """The result of a test of the residual.

    Attributes
    ----------
    test : str
        The test, by the name that it has on pages and in the terminal: ``"mean"``, ``"whiteness"``,
        ``"input-correlation"``, ``"rate-correlation"``, ``"after-turning-points"``, ``"by-speed"``, ``"by-amplitude"``,
        ``"by-distance"``, ``"by-direction"`` or ``"over-time"``.
    verdict : str
        ``"found"`` (there is structure), ``"not found"`` or ``"not testable"``.
    p_value, adjusted_p_value : float or None
        Probability of as much without structure; the second is corrected for the number of tests, and decides.
    statement : str
        The result in a sentence.
    advice : str or None
        What helps; None if nothing was found.
    input : str or None
        The input that the test is about.
    """

    test: str
    verdict: str
    p_value: float | None
    adjusted_p_value: float | None
    statement: str
    advice: str | None
    input: str | None = None


class Residuals:
    """Tests of the residual of a model, measured minus simulated output, of `Model.residuals`.

    ``print`` shows the table of `hysid evaluate --residuals`, with what helps.

    Attributes
    ----------
    content : dict
        All results, as of `hysid evaluate --residuals --json`: ``"whiteness"`` with the autocorrelation, its bound and
        the statistic of Ljung and Box, ``"inputs"`` with correlations and their bounds, ``"places"`` with RMS and mean
        by place, and others.
    findings : list of ResidualFinding
        One for each test.
    rms, bias : float
        Root mean square and mean of the residual, in the unit of the output.
    """

    def __init__(self, content: dict[str, Any], text: str) -> None:
        self.content = content
        self._text = text

    @cached_property
    def findings(self) -> list[ResidualFinding]:
        """One for each test."""
        return [ResidualFinding(**finding) for finding in self.content["findings"]]

    @property
    def found(self) -> list[ResidualFinding]:
        """The findings of structure."""
        return [finding for finding in self.findings if finding.verdict == "found"]

    @property
    def rms(self) -> float:
        """Root mean square of the residual, in the unit of the output."""
        rms: float = self.content["rms"]
        return rms

    @property
    def bias(self) -> float:
        """Mean of the residual, in the unit of the output."""
        bias: float = self.content["bias"]
        return bias

    def __getitem__(self, test: str) -> ResidualFinding:
        for finding in self.findings:
            if finding.test == test:
                return finding
        raise unknown("test", "tests", test, (finding.test for finding in self.findings))

    def __str__(self) -> str:
        return self._text.rstrip("\n")

    def _repr_html_(self) -> str:
        return html_table(
            (finding.test, finding.verdict, f"{finding.statement} {finding.advice or ''}")
            for finding in self.findings
        )


@dataclass(frozen=True)
class ParameterInterval:
    """The 95 % confidence interval of a parameter of a law.

    Attributes
    ----------
    symbol : str
        The field's symbol.
    value : float
        Its value, in the units of the data.
    status : str
        ``"determined"``, ``"at a kink"`` (the interval is approximate), ``"at its bound"``, ``"not determined by the
        data"`` or ``"not fitted"``.
    low, high : float or None
        The ends of the interval; None without one.
    standard_error : float or None
        The standard error; None without an interval.
    """

    symbol: str
    value: float
    status: str
    low: float | None
    high: float | None
    standard_error: float | None


def intervals_of(printed: str) -> list[ParameterInterval]:
    """Intervals from the JSON of the native module."""
    return [ParameterInterval(**parameter) for parameter in json.loads(printed)["parameters"]]
