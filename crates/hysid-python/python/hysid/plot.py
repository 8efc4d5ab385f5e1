"""Plots of data and models with matplotlib. Every function returns its axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from hysid._data import Columns, columns

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Values
    from hysid._diagnosis import Diagnosis, ModelDiagnosis
    from hysid.model import Model

__all__ = ["convergence", "diagnosis", "errors", "histories", "loops", "preisach_plane", "thresholds"]

MEASURED: dict[str, Any] = {"color": "0.55", "linewidth": 1.8, "label": "measured"}
SIMULATED: dict[str, Any] = {"color": "tab:red", "linewidth": 0.9, "label": "model"}


def _axes(ax: Axes | None) -> Axes:
    return plt.subplots(layout="constrained")[1] if ax is None else ax


class _Run:
    """Measured data and a model's free run over them, with names for the axes."""

    def __init__(self, model: Model | None, x: Any, y: Any, time: Any, rate: Any, records: Any) -> None:
        self.columns: Columns = columns(x, y, time, rate, records)
        taken = self.columns
        named = taken.inputs[0].name
        self.x_label = named or (model.inputs[0] if model else "x")
        self.y_label = (taken.output.name if taken.output else None) or (model.output if model else "y")
        time_name = (taken.time.name if taken.time else None) or "time"
        self.time_label = time_name if taken.time else "row"
        self.x = taken.inputs[0].values
        self.y = taken.output.values if taken.output else None
        self.simulated = None if model is None else model._simulated(taken)
        if self.simulated is not None and self.y is not None:
            # The simulated rows before the first measured one would only confuse.
            self.simulated = np.where(np.isnan(self.y), np.nan, self.simulated)

    def records(self) -> list[slice]:
        return [rows for _, rows in self.columns.records]

    def stamps(self, rows: slice) -> np.ndarray:
        """Time within a record; without time, the number of the row."""
        if self.columns.time is None:
            return np.arange(rows.start, rows.stop)
        return self.columns.time.values[rows]


def _legend(ax: Axes) -> None:
    handles, labels = ax.get_legend_handles_labels()
    first: dict[str, Any] = {}
    for handle, label in zip(handles, labels):
        first.setdefault(label, handle)
    if len(first) > 1:
        ax.legend(list(first.values()), list(first), frameon=False)


def loops(
    x: Values,
    y: Values | None = None,
    time: ArrayLike | None = None,
    rate: ArrayLike | None = None,
    records: ArrayLike | None = None,
    *,
    model: Model | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Plot the output over the first input: measured, simulated by a model, or both.

    Parameters
    ----------
    x, y, time, rate, records
        Data, as of `hysid.Model.evaluate`; `y` may be left out if there is a model. Rows where it is NaN are not
        drawn.
    model : Model, optional
        Model whose free run is drawn.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        The axes with the plot.

    Examples
    --------
    >>> train, _ = hysid.specimen("terfenol-rod").data()
    >>> ax = hysid.plot.loops({"H [kA/m]": train.x}, train.y)
    >>> ax.get_xlabel()
    'H [kA/m]'
    """
    ax = _axes(ax)
    run = _Run(model, x, y, time, rate, records)
    for rows in run.records():
        if run.y is not None:
            ax.plot(run.x[rows], run.y[rows], **MEASURED)
        if run.simulated is not None:
            ax.plot(run.x[rows], run.simulated[rows], **SIMULATED)
    ax.set(xlabel=run.x_label, ylabel=run.y_label)
    _legend(ax)
    return ax


def histories(
    x: Values,
    y: Values | None = None,
    time: ArrayLike | None = None,
    rate: ArrayLike | None = None,
    records: ArrayLike | None = None,
    *,
    model: Model | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Plot the output over time, or over rows if there is no time: measured, simulated, or both.

    Parameters
    ----------
    x, y, time, rate, records
        Data, as of `hysid.Model.evaluate`; `y` may be left out if there is a model. Rows where it is NaN are not
        drawn.
    model : Model, optional
        Model whose free run is drawn.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        The axes with the plot.
    """
    ax = _axes(ax)
    run = _Run(model, x, y, time, rate, records)
    for rows in run.records():
        if run.y is not None:
            ax.plot(run.stamps(rows), run.y[rows], **MEASURED)
        if run.simulated is not None:
            ax.plot(run.stamps(rows), run.simulated[rows], **SIMULATED)
    ax.xaxis.set_major_locator(MaxNLocator(6))
    ax.set(xlabel=run.time_label, ylabel=run.y_label)
    _legend(ax)
    return ax


def errors(
    model: Model,
    x: Values,
    y: Values,
    time: ArrayLike | None = None,
    rate: ArrayLike | None = None,
    records: ArrayLike | None = None,
    *,
    ax: Axes | None = None,
) -> Axes:
    """Plot the error of a free run, model minus measured, over time or rows.

    Parameters
    ----------
    model : Model
        The model.
    x, y, time, rate, records
        Data, as of `hysid.Model.evaluate`.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        The axes with the plot; the title is the RMSE.
    """
    ax = _axes(ax)
    run = _Run(model, x, y, time, rate, records)
    assert run.simulated is not None and run.y is not None
    error = run.simulated - run.y
    for rows in run.records():
        ax.plot(run.stamps(rows), error[rows], color="tab:red", linewidth=0.9)
    ax.axhline(0.0, color="0.55", linewidth=0.8, zorder=0)
    rmse = np.sqrt(np.nanmean(error**2))
    percent = 100 * rmse / np.nanstd(run.y)
    ax.xaxis.set_major_locator(MaxNLocator(6))
    ax.set(xlabel=run.time_label, ylabel=f"error of {run.y_label}")
    ax.set_title(f"RMSE {rmse:.3g}, {percent:.3g} % of std", fontsize="medium")
    return ax


def convergence(model: Model, *, ax: Axes | None = None) -> Axes:
    """Plot the training error over the epochs, run by run.

    Parameters
    ----------
    model : Model
        A model fitted by iterations.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        Error in percent of the output's standard deviation over epochs: thin lines for fits to a part of the data
        (cross-validation), thick lines for fits to all data.

    Raises
    ------
    ValueError
        A model fitted without iterations, or an ensemble.
    """
    runs = model.description["training"]["runs"]
    if model.members:
        raise ValueError(f"{model.name} is an ensemble: only its {len(model.members)} members have training runs")
    if not runs:
        raise ValueError(f"{model.name} was fitted without iterations")
    ax = _axes(ax)
    for run in runs:
        epochs = [point["epoch"] for point in run["history"]]
        error = [point["train_nrmse_percent"] for point in run["history"]]
        if run["phase"] == "starts":
            ax.plot(epochs, error, color="0.6", linewidth=0.8, label="a part of the data")
        else:
            ax.plot(epochs, error, color="tab:red", linewidth=2.0, label=f"all data, {run['method']}")
    ax.set(xlabel="epoch", ylabel="training error, % of std", yscale="log")
    _legend(ax)
    return ax


def _not_companded(model: Model) -> None:
    """Refuses thresholds that are not in the unit of the input."""
    if model.description.get("preprocessing", {}).get("companding") is not None:
        raise ValueError(f"the input of this {model.name} is companded: its thresholds have no unit")


def _play_weights(law: dict[str, Any], name: str) -> tuple[list[float], list[float], str]:
    if name == "masing":
        slopes = law["slopes"]
        return law["thresholds"], [a - b for a, b in zip(slopes, slopes[1:])], "weight of the stop"
    if name == "modified-prandtl-ishlinskii":
        law = law["hysteresis"]
    if "thresholds" in law and "weights" in law and isinstance(law["thresholds"], list):
        return law["thresholds"], law["weights"], "weight of the play"
    raise ValueError(f"{name} has no thresholds to draw")


def thresholds(model: Model, *, ax: Axes | None = None) -> Axes:
    """Plot the thresholds of a model's operators, in the unit of the first input.

    Parameters
    ----------
    model : Model
        A network, or one of masing, prandtl-ishlinskii and modified-prandtl-ishlinskii.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        For a classical model, weights over thresholds. For a network, the thresholds of its stops from small to
        large; the line is half the trained range: stops above it do not slip if the input is slow.

    Raises
    ------
    ValueError
        A model without thresholds, an ensemble, or a model whose input is companded.
    """
    described = model.description
    network = described.get("network")
    if model.members:
        raise ValueError(f"{model.name} is an ensemble: only its {len(model.members)} members have thresholds")
    _not_companded(model)
    if network is None:
        ((name, law),) = described["law"].items()
        places, weights, label = _play_weights(law, name)
        ax = _axes(ax)
        ax.vlines(places, 0.0, weights, color="tab:blue")
        ax.plot(places, weights, "o", color="tab:blue", markersize=4)
        ax.axhline(0.0, color="0.55", linewidth=0.8)
        ax.set(xlabel=f"threshold, {model.inputs[0]}", ylabel=label)
        return ax
    scale = network["scaling"]["inputs"][0]
    swings = [abs(stop["weights"][0]) for stop in network["memory"]["stops"]]
    found = sorted(scale / swing for swing in swings if swing > 0)
    low, high = described["trained_ranges"]["inputs"][0]
    ax = _axes(ax)
    ax.plot(range(1, len(found) + 1), found, "o", color="tab:blue", label="stops")
    ax.axhline((high - low) / 2, color="0.55", linewidth=0.8, label="half the trained range")
    ax.set(xlabel="stop, by threshold", ylabel=f"threshold, {model.inputs[0]}", yscale="log")
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    _legend(ax)
    return ax


def preisach_plane(model: Model, *, ax: Axes | None = None) -> Axes:
    """Plot the Preisach plane of a model: the density of relays over their thresholds.

    Parameters
    ----------
    model : Model
        Fitted with ``model="preisach"``.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        The density of relays, in the unit of the output over that of the input squared.

    Raises
    ------
    ValueError
        Another model, or one whose input is companded.
    """
    law = (model.description.get("law") or {}).get("preisach")
    if law is None:
        raise ValueError(f"{model.name} has no Preisach plane: fit one with model='preisach'")
    _not_companded(model)
    ax = _axes(ax)
    lines = np.array(law["lines"])
    steps = np.diff(lines)
    cells = np.full((len(steps), len(steps)), np.nan)
    cells[np.tril_indices(len(steps))] = law["cells"]
    area = np.outer(steps, steps)
    # On the diagonal a cell is a triangle.
    area[np.diag_indices(len(steps))] /= 2
    density = cells / area
    limit = np.nanmax(np.abs(density)) or 1.0
    mesh = ax.pcolormesh(lines, lines, density, cmap="RdBu_r", vmin=-limit, vmax=limit)
    ax.figure.colorbar(mesh, ax=ax, label="density of relays")
    name = model.inputs[0]
    ax.set(xlabel=f"down at, {name}", ylabel=f"up at, {name}", aspect="equal")
    return ax


COLOURS: dict[str, str] = {"yes": "tab:green", "no": "tab:red", "not testable": "0.7"}


def diagnosis(found: Diagnosis | ModelDiagnosis, *, ax: Axes | None = None) -> Axes:
    """Plot the verdicts of a diagnosis.

    Parameters
    ----------
    found : Diagnosis or ModelDiagnosis
        Of data, or of a model.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        A bar for each property: its index as a multiple of the threshold; green means yes.
    """
    ax = _axes(ax)
    findings = list(reversed(found.properties))
    for place, finding in enumerate(findings):
        colour = COLOURS[finding.verdict]
        length = 0.0
        if finding.index is not None and finding.threshold:
            # Larger multiples carry no information.
            length = float(np.clip(finding.index / finding.threshold, -5.0, 5.0))
            ax.barh(place, length, color=colour, height=0.6)
        text = finding.verdict
        ax.annotate(
            text,
            (max(length, 0.0), place),
            xytext=(5, 0),
            textcoords="offset points",
            va="center",
            color="0.25",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
        )
    ax.axvline(1.0, color="0.3", linewidth=0.8, linestyle=":")
    ax.set_yticks(range(len(findings)), [finding.name for finding in findings])
    ax.set(xlabel="index / threshold", ylim=(-0.6, len(findings) - 0.4))
    ax.margins(x=0.15)
    return ax
