"""Lists of findings: their table in a notebook, and how one is named."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape


def html_table(rows: Iterable[tuple[str, str, str]]) -> str:
    """A table of names, verdicts and statements."""
    cells = "".join(
        f'<tr><td style="text-align: left">{escape(name)}</td>'
        f'<td style="text-align: left"><b>{escape(verdict)}</b></td>'
        f'<td style="text-align: left">{escape(statement)}</td></tr>'
        for name, verdict, statement in rows
    )
    return f"<table><tbody>{cells}</tbody></table>"


def unknown(kind: str, kinds: str, name: str, names: Iterable[str]) -> KeyError:
    """The error of a finding that does not exist."""
    return KeyError(f"there is no {kind} {name!r}: the {kinds} are {', '.join(dict.fromkeys(names))}")
