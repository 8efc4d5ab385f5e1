"""Plots of data and models with matplotlib. Every function returns its axes.

Plots of data take a model, or None for measured data alone, and the data as of `hysid.Model.evaluate`. Quantities on the
axes have the units of the columns' names, as in the reports: `H (A/m)`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from hysid import _hysid
from hysid._plot_cycles import backbone, cycles, energy, frequency
from hysid._plot_model import convergence, diagnosis, members, preisach_plane, thresholds
from hysid._plot_run import Run
from hysid._plot_style import BAND, ERROR, INPUT, MEASURED, MODEL, labelled_once, new_axes, paper

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Values
    from hysid.model import Model

__all__ = [
    "backbone",
    "convergence",
    "cycles",
    "diagnosis",
    "energy",
    "errors",
    "frequency",
    "histories",
    "loops",
    "members",
    "paper",
    "preisach_plane",
    "thresholds",
]


def loops(
    model: Model | None,
    x: Values,
    y: Values | str | None = None,
    time: ArrayLike | str | None = None,
    rate: ArrayLike | None = None,
    records: ArrayLike | str | None = None,
    *,
    ax: Axes | None = None,
) -> Axes:
    """Plot the output over the first input: measured, simulated by a model, or both.

    Parameters
    ----------
    model : Model or None
        Model whose free run is drawn; None draws measured data alone.
    x, y, time, rate, records
        Data, as of `hysid.Model.evaluate`; `y` may be left out if there is a model. Rows where it is NaN are not
        drawn.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        The axes with the plot.

    Examples
    --------
    >>> train, _ = hysid.specimen("terfenol-rod").data()
    >>> ax = hysid.plot.loops(None, {"H [kA/m]": train.x}, train.y)
    >>> ax.get_xlabel()
    'H (kA/m)'
    """
    run = Run(model, x, y, time, rate, records)
    ax = new_axes(ax)
    for rows in run.records():
        if run.y is not None:
            ax.plot(run.x[rows], run.y[rows], **MEASURED)
        if run.simulated is not None:
            ax.plot(run.x[rows], run.simulated[rows], **MODEL)
    ax.set(xlabel=run.input_label, ylabel=run.output_label)
    labelled_once(ax)
    return ax


def histories(
    model: Model | None,
    x: Values,
    y: Values | str | None = None,
    time: ArrayLike | str | None = None,
    rate: ArrayLike | None = None,
    records: ArrayLike | str | None = None,
    *,
    band: float | None = 0.9,
    ax: Axes | None = None,
) -> Axes:
    """Plot input and output over time, or over rows if there is no time; the output measured, simulated, or both.

    Parameters
    ----------
    model : Model or None
        Model whose free run is drawn, with its prediction band if it has one; None draws measured data alone.
    x, y, time, rate, records
        Data, as of `hysid.Model.evaluate`; `y` may be left out if there is a model. Rows where it is NaN are not
        drawn.
    band : float, optional
        Probability of the prediction band, as of `hysid.Model.predict`; None draws no band.
    ax : Axes, optional
        Axes to draw the output on; by default a new figure, with the input above the output.

    Returns
    -------
    Axes
        The axes with the output; those with the input are the first ones of a new figure.
    """
    run = Run(model, x, y, time, rate, records)
    edges = run.band(band)
    is_new = ax is None
    if ax is None:
        _, (above, ax) = plt.subplots(2, sharex=True, height_ratios=(3, 4), layout="constrained")
        for rows in run.records():
            above.plot(run.stamps(rows), run.x[rows], **INPUT)
        # Two lines, because this part of the figure is low.
        above.set_ylabel(run.input_label.replace(" (", "\n("))
        above.figure.align_ylabels()
    for rows in run.records():
        stamps = run.stamps(rows)
        if edges is not None:
            ax.fill_between(stamps, edges[0][rows], edges[1][rows], **{**BAND, "label": f"{100 * (band or 0):.3g} % band"})
        if run.y is not None:
            ax.plot(stamps, run.y[rows], **MEASURED)
        if run.simulated is not None:
            ax.plot(stamps, run.simulated[rows], **MODEL)
    ax.xaxis.set_major_locator(MaxNLocator(6))
    ax.set(xlabel=run.time_label, ylabel=run.output_label)
    # Histories fill their axes: a legend would lie on them.
    labelled_once(ax, above=is_new)
    return ax


def errors(
    model: Model,
    x: Values,
    y: Values | str,
    time: ArrayLike | str | None = None,
    rate: ArrayLike | None = None,
    records: ArrayLike | str | None = None,
    *,
    over: str = "time",
    ax: Axes | None = None,
) -> Axes:
    """Plot the error of a free run, simulated minus measured, over time (or rows) or over the first input.

    Parameters
    ----------
    model : Model
        The model.
    x, y, time, rate, records
        Data, as of `hysid.Model.evaluate`.
    over : {"time", "input"}
        What the error is drawn over.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        The axes with the plot; the title is the RMSE.
    """
    if over not in ("time", "input"):
        raise ValueError(f"over {over!r}: it is 'time' or 'input'")
    if model is None or y is None:
        raise ValueError("errors need a model and a measured output y")
    run = Run(model, x, y, time, rate, records)
    assert run.simulated is not None and run.y is not None
    ax = new_axes(ax)
    error = run.simulated - run.y
    for rows in run.records():
        places = run.x[rows] if over == "input" else run.stamps(rows)
        ax.plot(places, error[rows], **ERROR)
    ax.axhline(0.0, color="0.55", linewidth=0.8, zorder=0)
    rmse = np.sqrt(np.nanmean(error**2))
    percent = 100 * rmse / np.nanstd(run.y)
    if over == "time":
        ax.xaxis.set_major_locator(MaxNLocator(6))
    ax.set(xlabel=run.input_label if over == "input" else run.time_label, ylabel=run.error_label())
    unit = _hysid.name_and_unit(run.output)[1]
    in_unit = "" if unit is None else f" {unit}"
    ax.set_title(f"RMSE {rmse:.3g}{in_unit}, {percent:.3g} % of std", fontsize="medium")
    return ax
