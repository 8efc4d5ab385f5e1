"""The summary of a model, as text and for a notebook."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from textwrap import fill

from hysid import _hysid
from hysid._html import number, table
from hysid._results import Errors

__all__ = ["Summary", "error_in_words"]

MOST_ROWS = 30
"""Rows of the table of members or parameters at most."""

WIDTH = 100
"""Characters in a line of text."""


@dataclass(frozen=True)
class Summary:
    """Summary of a model, its errors and its parameters: ``print`` it, or display it in a notebook.

    Attributes
    ----------
    facts : list of (str, str)
        What it is, by name.
    errors : list of (str, Errors)
        Errors of free runs over the data that are named: ``"training"``, ``"after warm-up"``, ``"held out"``.
    parts : (list of str, list of list of str) or None
        Heading and rows of a table: the members of an ensemble, or the parameters of a law.
    notes : list of str
        Limits of the model, in sentences.
    """

    facts: list[tuple[str, str]]
    errors: list[tuple[str, Errors]]
    parts: tuple[list[str], list[list[str]]] | None
    notes: list[str]

    def _error_table(self) -> tuple[list[str], list[list[str]]]:
        """A column for each set of data."""
        name, unit = _hysid.name_and_unit(self.errors[0][1].output)
        in_unit = "" if unit is None else f" ({unit})"
        measures: list[tuple[str, Callable[[Errors], str]]] = [
            (f"RMSE of {name}{in_unit}", lambda errors: number(errors.rmse)),
            (f"NRMSE, % of the std of {name}", lambda errors: number(errors.nrmse_std_percent)),
            (f"NRMSE, % of the range of {name}", lambda errors: number(errors.nrmse_range_percent)),
            (f"largest error{in_unit}", lambda errors: number(errors.max_abs_error)),
            ("rows", lambda errors: str(errors.samples)),
        ]
        head = ["error of a free run", *(name for name, _ in self.errors)]
        return head, [[label, *(measure(errors) for _, errors in self.errors)] for label, measure in measures]

    def _shown_parts(self) -> tuple[list[str], list[list[str]], str]:
        """Heading, rows, and what is left out."""
        head, rows = self.parts or ([], [])
        left = len(rows) - MOST_ROWS
        return head, rows[:MOST_ROWS], f"{left} more are in the model file" if left > 0 else ""

    def __str__(self) -> str:
        widest = max(len(name) for name, _ in self.facts) + 2
        facts = (
            fill(text, WIDTH, initial_indent=f"{name:<{widest}}", subsequent_indent=" " * widest)
            for name, text in self.facts
        )
        blocks = ["\n".join(facts), _aligned(*self._error_table())]
        head, rows, left = self._shown_parts()
        if rows:
            blocks.append("\n".join(filter(None, [_aligned(head, rows), left])))
        blocks += [fill(note, WIDTH) for note in self.notes]
        return "\n\n".join(blocks)

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        facts = "".join(f"<p><b>{escape(name)}</b>: {escape(text)}</p>" for name, text in self.facts)
        head, rows, left = self._shown_parts()
        parts = table(head, rows) + (f"<p>{left}</p>" if left else "") if rows else ""
        notes = "".join(f"<p>{escape(note)}</p>" for note in self.notes)
        return facts + table(*self._error_table()) + parts + notes


def error_in_words(errors: Errors) -> str:
    """The root mean square, with its unit and as a share of the standard deviation: `0.12 kN (1.5 % of std)`."""
    _, unit = _hysid.name_and_unit(errors.output)
    percent = "" if errors.nrmse_std_percent is None else f" ({errors.nrmse_std_percent:.3g} % of std)"
    return f"{errors.rmse:.3g}{'' if unit is None else f' {unit}'}{percent}"


def _aligned(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of text: the first column on the left, numbers on the right."""
    lines = [head, *rows]
    widths = [max(len(line[place]) for line in lines) for place in range(len(head))]
    is_number = [all(_is_number(row[place]) for row in rows) for place in range(len(head))]

    def padded(line: Sequence[str]) -> str:
        cells = (
            cell.rjust(width) if right else cell.ljust(width) for cell, width, right in zip(line, widths, is_number)
        )
        return "  ".join(cells).rstrip()

    return "\n".join(map(padded, lines))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return text == "–"
    return True
