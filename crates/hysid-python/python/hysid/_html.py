"""How models, diagnoses and comparisons show themselves in a notebook."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hysid._diagnosis import Finding
    from hysid._validation import Validation
    from hysid.model import Errors, Model


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    # Numbers stand under one another; the first column is words.
    def line(cells: Sequence[str], tag: str) -> str:
        aligned = (
            f'<{tag} style="text-align: {"left" if place == 0 else "right"}">{escape(cell)}</{tag}>'
            for place, cell in enumerate(cells)
        )
        return f"<tr>{''.join(aligned)}</tr>"

    body = "".join(line(row, "td") for row in rows)
    return f"<table><thead>{line(head, 'th')}</thead><tbody>{body}</tbody></table>"


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"


def model_html(model: Model) -> str:
    """A model at a glance: what it is, and its errors."""
    inputs = ", ".join(model.inputs)
    rate = "" if model.rate is None else f", rate by {model.rate} differences"
    if model.rate in ("given", "savitzky-golay"):
        rate = f", rate: {model.rate}"
    about = f"{inputs} → {model.output}{rate}; {model.parameters} parameters; {model.termination}"

    def row(name: str, errors: Errors) -> list[str]:
        percents = (errors.nrmse_std_percent, errors.nrmse_range_percent)
        return [name, *map(_number, percents), _number(errors.rmse), _number(errors.max_abs_error)]

    rows = [row("training", model.train)]
    if model.validation is not None:
        rows.append(row("held out", model.validation))
    head = ["", "% of std", "% of range", f"RMSE of {model.output}", "largest"]
    chosen = "".join(f"<p>{escape(line)}</p>" for line in model._native.selection() or ())
    return f"<p><b>{escape(model.name)}</b>: {escape(about)}</p>{_table(head, rows)}{chosen}"


def validation_html(validation: Validation) -> str:
    """Errors fold by fold."""
    head = ["held out", "unseen, % of std", "train, % of std"]
    rows = [
        [fold.held_out, _number(fold.unseen.nrmse_std_percent), _number(fold.train.nrmse_std_percent)]
        for fold in validation.folds
    ]
    rows.append(["geometric mean", _number(validation.unseen_nrmse_std_percent), ""])
    return _table(head, rows)


def diagnosis_html(findings: Sequence[Finding]) -> str:
    """Verdicts one under the other, with what was found."""
    rows = "".join(
        f'<tr><td style="text-align: left">{escape(finding.name)}</td>'
        f'<td style="text-align: left"><b>{escape(finding.verdict)}</b></td>'
        f'<td style="text-align: left">{escape(finding.statement)}</td></tr>'
        for finding in findings
    )
    return f"<table><tbody>{rows}</tbody></table>"


def comparison_html(cells: Sequence[dict[str, Any]]) -> str:
    """Models side by side."""
    head = ["model", "unseen %", "train %", "parameters", "fit s"]
    rows = []
    for row in cells:
        if row["error"] is not None:
            rows.append([row["model"], row["error"], "", "", ""])
            continue
        errors = (_number(row["unseen_percent"]), _number(row["train_percent"]))
        rows.append([row["model"], *errors, str(row["parameters"]), f"{row['fit_seconds']:.2g}"])
    return _table(head, rows)
