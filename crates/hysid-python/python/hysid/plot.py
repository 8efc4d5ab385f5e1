"""Plots of data and models with matplotlib. Every function returns its axes, and `diagnostics` its figure.

Plots of data take a model, or None for measured data alone, and the data as of `hysid.Model.evaluate`. Quantities on the
axes have the units of the columns' names, as in the reports: `H (A/m)`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
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
    "diagnostics",
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
    return _draw_loops(Run(model, x, y, time, rate, records), new_axes(ax))


def _draw_loops(run: Run, ax: Axes) -> Axes:
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
    _draw_outputs(run, edges, band, ax)
    # Histories fill their axes: a legend would lie on them.
    labelled_once(ax, above=is_new)
    return ax


def _draw_outputs(run: Run, edges: tuple[np.ndarray, np.ndarray] | None, band: float | None, ax: Axes) -> None:
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
    return _draw_errors(Run(model, x, y, time, rate, records), over, new_axes(ax))


def _draw_errors(run: Run, over: str, ax: Axes) -> Axes:
    assert run.simulated is not None and run.y is not None
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


def diagnostics(
    model: Model,
    x: Values,
    y: Values | str,
    time: ArrayLike | str | None = None,
    rate: ArrayLike | None = None,
    records: ArrayLike | str | None = None,
) -> Figure:
    """Plot what a model represents and what it leaves unexplained, in one figure.

    Parameters
    ----------
    model : Model
        The model.
    x, y, time, rate, records
        Data, as of `hysid.Model.evaluate`, with at least 50 measured rows.

    Returns
    -------
    Figure
        Loops, output over time, error over time and over the input, and the autocorrelation of the residual with the 95 %
        bound of white noise. The title names the tests of the residual that found structure.

    Raises
    ------
    ValueError
        As of `hysid.Model.residuals`.

    Examples
    --------
    >>> train, test = hysid.specimen("terfenol-rod").data()
    >>> model = hysid.fit(train.x, train.y, model="preisach")
    >>> figure = hysid.plot.diagnostics(model, test.x, test.y)
    >>> len(figure.axes)
    5
    """
    if model is None or y is None:
        raise ValueError("diagnostics need a model and a measured output y")
    run = Run(model, x, y, time, rate, records)
    residuals = model._residuals(run.columns)
    figure, axes = plt.subplot_mosaic("ABB;ACC;DEE", figsize=(11.0, 8.0), layout="constrained")
    _draw_loops(run, axes["A"])
    _draw_outputs(run, run.band(0.9), 0.9, axes["B"])
    _draw_errors(run, "time", axes["C"])
    _draw_errors(run, "input", axes["D"]).set_title("")
    whiteness = residuals.content["whiteness"]
    correlations = whiteness["autocorrelation"]
    axes["E"].axhspan(-whiteness["bound"], whiteness["bound"], **{**BAND, "label": "95 % of white noise"})
    axes["E"].vlines(range(1, len(correlations) + 1), 0.0, correlations, color=ERROR["color"])
    axes["E"].set(xlabel="lag (measured rows)", ylabel="autocorrelation of the residual")
    axes["E"].legend(frameon=False)
    found = ", ".join(dict.fromkeys(finding.test for finding in residuals.found))
    figure.suptitle(f"{model.name}; structure in the residual: {found or 'not found'}")
    return figure
