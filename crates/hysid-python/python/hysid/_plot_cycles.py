"""Plots of the figures of cycles: measured, and of a model that is driven by the same input."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from hysid import _hysid
from hysid._cycles import Cycles, cycles_of, named_options
from hysid._plot_run import Run
from hysid._plot_style import MEASURED, MODEL, labelled_once, new_axes

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Values
    from hysid.model import Model

__all__ = ["backbone", "cycles", "energy", "frequency"]

FIGURE = {
    "structure": "energy",
    "magnet": "energy",
    "actuator": "width_percent",
    "thermal": "thermal_width",
    "battery": "mean_gap",
    "hydrology": "hysteresis_index",
    "general": "energy",
}
"""The figure of a cycle that each field looks at first."""

IN_GENERAL = ("structure", "magnet", "actuator", "general")
"""Fields whose figures `general` has."""

DOTS: dict[str, dict[str, Any]] = {
    "measured": {"color": MEASURED["color"], "marker": "o", "markersize": 6.0, "label": "measured"},
    "model": {"color": MODEL["color"], "marker": ".", "markersize": 5.0, "label": "model"},
}


def _of_all_fields(run: Run, division: str | None) -> list[tuple[str, Cycles]]:
    """The cycles, measured and of the model, with the figures of all fields, divided as suits the field."""
    division, _, _ = named_options(division, None, None)
    (_, first), *_ = run.outputs()
    by = cycles_of(first, division)
    field = "general" if by.field in IN_GENERAL else by.field
    return [(kind, cycles_of(columns, by.division, field)) for kind, columns in run.outputs()]


def _check(figure: str) -> str:
    if figure not in _hysid.figure_names():
        raise ValueError(f"figure {figure!r}: choose one of {', '.join(_hysid.figure_names())}")
    return figure


def _whole(table: Cycles, figure: str, over: str) -> tuple[np.ndarray, np.ndarray]:
    """Abscissae and values of a figure, of the complete cycles that have both."""
    complete = table["complete"]
    places = np.arange(1, complete.sum() + 1) if over == "cycle" else table[over][complete]
    values = table[figure][complete]
    known = np.isfinite(places) & np.isfinite(values)
    return places[known], values[known]


def _reason(tables: list[tuple[str, Cycles]]) -> str:
    """Why a figure is missing, by the note on the first complete cycle that has one; another division may help."""
    table = tables[0][1]
    notes = [note for note in table["notes"][table["complete"]] if note]
    return f" ({notes[0]}; divided at {table.division}, see division)" if notes else ""


def _dots(run: Run, tables: list[tuple[str, Cycles]], figure: str, over: str, ax: Axes | None) -> Axes:
    found = [(kind, *_whole(table, figure, over)) for kind, table in tables]
    if not any(len(values) for _, _, values in found):
        raise ValueError(f"no complete cycle has {'' if over == 'cycle' else f'{over} and '}{figure}{_reason(tables)}")
    ax = new_axes(ax)
    for kind, places, values in found:
        ax.plot(places, values, linestyle="none", **DOTS[kind])
    ax.set_ylabel(run.figure_label(figure))
    labelled_once(ax)
    return ax


def cycles(
    model: Model | None,
    x: Values,
    y: Values | str | None = None,
    time: ArrayLike | str | None = None,
    rate: ArrayLike | None = None,
    records: ArrayLike | str | None = None,
    *,
    figure: str | None = None,
    over: str = "cycle",
    division: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Plot a figure of each cycle, such as its energy or its damping.

    Parameters
    ----------
    model : Model or None
        Model that is driven by the same input; None draws measured data alone.
    x, y, time, rate, records
        Data, as of `hysid.Model.evaluate`; `y` may be left out if there is a model.
    figure : str, optional
        A column of `hysid.cycles`, such as ``"energy"``, ``"damping_percent"`` or ``"coercive_input"``; by default the
        energy, for actuators the width.
    over : {"cycle", "amplitude"}
        What it is drawn over: the number of the cycle, or its amplitude.
    division : str, optional
        As of `hysid.cycles`.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        A dot for each complete cycle.

    Raises
    ------
    ValueError
        An unknown figure, or data without a complete cycle that has it.
    """
    if over not in ("cycle", "amplitude"):
        raise ValueError(f"over {over!r}: it is 'cycle' or 'amplitude'")
    run = Run(model, x, y, time, rate, records)
    if figure is None:
        figure = FIGURE[cycles_of(run.outputs()[0][1]).field]
    ax = _dots(run, _of_all_fields(run, division), _check(figure), over, ax)
    if over == "cycle":
        ax.xaxis.set_major_locator(MaxNLocator(6, integer=True))
    ax.set_xlabel("cycle" if over == "cycle" else run.figure_label("amplitude"))
    return ax


def frequency(
    model: Model | None,
    x: Values,
    y: Values | str | None = None,
    time: ArrayLike | str | None = None,
    rate: ArrayLike | None = None,
    records: ArrayLike | str | None = None,
    *,
    figure: str = "energy",
    division: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Plot a figure of each cycle over the frequency of the cycle.

    Parameters
    ----------
    model : Model or None
        Model that is driven by the same input; None draws measured data alone.
    x, y, time, rate, records
        Data, as of `hysid.Model.evaluate`, with time; `y` may be left out if there is a model.
    figure : str
        A column of `hysid.cycles`, such as ``"energy"``, ``"width"`` or ``"coercive_input"``.
    division : str, optional
        As of `hysid.cycles`.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        A dot for each complete cycle; the frequency is logarithmic if it varies by more than a factor of 5.

    Raises
    ------
    ValueError
        Data without time, an unknown figure, or data without a complete cycle that has it.
    """
    run = Run(model, x, y, time, rate, records)
    if run.time is None:
        raise ValueError("a cycle has no frequency without time: give time")
    tables = _of_all_fields(run, division)
    ax = _dots(run, tables, _check(figure), "frequency", ax)
    frequencies = np.concatenate([_whole(table, figure, "frequency")[0] for _, table in tables])
    if frequencies.max() > 5.0 * frequencies.min():
        ax.set_xscale("log")
    ax.set_xlabel(run.figure_label("frequency"))
    return ax


def energy(
    model: Model | None,
    x: Values,
    y: Values | str | None = None,
    time: ArrayLike | str | None = None,
    rate: ArrayLike | None = None,
    records: ArrayLike | str | None = None,
    *,
    division: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Plot the dissipated energy, summed up over the cycles of each record.

    Parameters
    ----------
    model : Model or None
        Model that is driven by the same input; None draws measured data alone.
    x, y, time, rate, records
        Data, as of `hysid.Model.evaluate`; `y` may be left out if there is a model.
    division : str, optional
        As of `hysid.cycles`.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        A line for each record over time (or rows), with a point at the end of each complete cycle.

    Raises
    ------
    ValueError
        Data without a complete cycle.
    """
    run = Run(model, x, y, time, rate, records)
    tables = _of_all_fields(run, division)
    found = [
        (kind, rows, ends[known], sums[known])
        for kind, table in tables
        for name, rows in run.columns.records
        for ends, sums in [_sums(table, name)]
        for known in [np.isfinite(sums)]
        if known.any()
    ]
    if not found:
        raise ValueError(f"no complete cycle has an energy{_reason(tables)}")
    ax = new_axes(ax)
    for kind, rows, ends, sums in found:
        ax.plot(run.stamps(rows)[ends], sums, linewidth=1.2 if kind == "measured" else 0.9, **DOTS[kind])
    ax.set(xlabel=run.time_label, ylabel=run.figure_label("cumulative_energy"))
    labelled_once(ax)
    return ax


def _sums(table: Cycles, record: str) -> tuple[np.ndarray, np.ndarray]:
    """Last row of each complete cycle of a record, and the energy up to there."""
    rows = (table["record"] == record) & table["complete"]
    return table["last_row"][rows], table["cumulative_energy"][rows]


def backbone(
    model: Model | None,
    x: Values,
    y: Values | str | None = None,
    time: ArrayLike | str | None = None,
    rate: ArrayLike | None = None,
    records: ArrayLike | str | None = None,
    *,
    division: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Plot the backbone: the peaks and valleys of the first cycle of each amplitude.

    Parameters
    ----------
    model : Model or None
        Model that is driven by the same input; None draws measured data alone.
    x, y, time, rate, records
        Data, as of `hysid.Model.evaluate`; `y` may be left out if there is a model.
    division : str, optional
        As of `hysid.cycles`.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        A line for each record from its lowest valley to its highest peak.

    Raises
    ------
    ValueError
        Data without a backbone.
    """
    run = Run(model, x, y, time, rate, records)
    found = []
    for kind, table in _of_all_fields(run, division):
        points = table.backbone
        for name in dict.fromkeys(points["record"]):
            own = points["record"] == name
            order = np.argsort(points["input"][own], kind="stable")
            found.append((kind, points["input"][own][order], points["output"][own][order]))
    if not found:
        raise ValueError("the data have no backbone")
    ax = new_axes(ax)
    for kind, inputs, outputs in found:
        ax.plot(inputs, outputs, linewidth=1.6 if kind == "measured" else 0.9, **DOTS[kind])
    ax.set(xlabel=run.input_label, ylabel=run.output_label)
    labelled_once(ax)
    return ax
