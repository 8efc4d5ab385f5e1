"""Plots of models and diagnoses: training, thresholds, the Preisach plane, verdicts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogFormatter, MaxNLocator

from hysid import _hysid
from hysid._plot_style import SERIES, labelled_once, new_axes

if TYPE_CHECKING:
    from hysid._diagnosis import Diagnosis, ModelDiagnosis
    from hysid.model import Model

__all__ = ["convergence", "diagnosis", "members", "preisach_plane", "thresholds"]

LONGEST_NAME = 40
"""Letters of the name of a member below an axis."""


def _members(model: Model) -> Iterator[tuple[str, float, dict[str, Any]]]:
    """Name, weight and content of each member of an ensemble, the largest weight first; a single model is its only one."""
    if not model.members:
        yield model.name, 1.0, model.description
        return
    described = zip(model.members, model.description["ensemble"]["members"])
    for member, content in sorted(described, key=lambda one: -one[0].share):
        yield member.name, member.share, content


def convergence(model: Model, *, ax: Axes | None = None) -> Axes:
    """Plot the training error over the epochs, run by run; of an ensemble, the errors of its members.

    Parameters
    ----------
    model : Model
        A model fitted by iterations, or an ensemble.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        Error in percent of the output's standard deviation over epochs: thin lines for fits to a part of the data
        (cross-validation), thick lines for fits to all data. The model file of an ensemble has no training runs: the axes
        are those of `members`.

    Raises
    ------
    ValueError
        A single model fitted without iterations.
    """
    if model.members:
        return members(model, ax=ax)
    runs = model.description["training"]["runs"]
    if not runs:
        raise ValueError(f"{model.name} was fitted without iterations")
    ax = new_axes(ax)
    for run in runs:
        epochs = [point["epoch"] for point in run["history"]]
        error = [point["train_nrmse_percent"] for point in run["history"]]
        if run["phase"] == "starts":
            ax.plot(epochs, error, color="0.6", linewidth=0.8, label="a part of the data")
        else:
            ax.plot(epochs, error, color=SERIES[0], linewidth=2.0, label=f"all data, {run['method']}")
    ax.set(xlabel="epoch", ylabel="training error (% of std)", yscale="log")
    labelled_once(ax)
    return ax


def members(model: Model, *, ax: Axes | None = None) -> Axes:
    """Plot the members of an ensemble: their weights, training errors and cross-validation errors.

    Parameters
    ----------
    model : Model
        An ensemble.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        A row for each candidate, the largest weight first, with the training errors of its fits and the cross-validation
        error of the candidate alone, in percent of the output's standard deviation. The line is the cross-validation error
        of the ensemble.

    Raises
    ------
    ValueError
        A single model.
    """
    if not model.members:
        raise ValueError(f"{model.name} is a single model: an ensemble is needed")
    weights: dict[str, float] = {}
    trained: dict[str, list[float]] = {}
    for name, weight, content in _members(model):
        weights[name] = weights.get(name, 0.0) + weight
        trained.setdefault(name, []).append(content["training"]["train"]["nrmse_std_percent"] or np.nan)
    selection = model.description["training"].get("selection") or {"candidates": []}
    held_out = {one["name"]: one["error_percent"][0] for one in selection["candidates"]}
    ax = new_axes(ax)
    names = sorted(weights, key=lambda name: -weights[name])
    for place, name in enumerate(names):
        errors = trained[name]
        ax.plot(errors, [place] * len(errors), "o", color="#9aa5b1", markersize=6, label="training, each fit")
        if name in held_out:
            ax.plot(held_out[name], place, "D", color=SERIES[0], markersize=5, label="cross-validation")
    if "error_percent" in selection:
        ax.axvline(selection["error_percent"][0], color=SERIES[0], linewidth=0.9, label="ensemble, cross-validation")
    ax.set_yticks(range(len(names)), [f"{_short(name)}, {100 * weights[name]:.3g} %" for name in names])
    ax.set(xlabel="error (% of std)", ylabel="member, weight", ylim=(len(names) - 0.4, -0.6))
    ax.set_xlim(left=0.0)
    labelled_once(ax)
    return ax


def _short(name: str) -> str:
    return name if len(name) <= LONGEST_NAME else name[: LONGEST_NAME - 1] + "…"


def _is_compressed(content: dict[str, Any]) -> bool:
    """Whether the thresholds are not in the unit of the input."""
    return (content.get("preprocessing") or {}).get("compression") is not None


def _not_compressed(model: Model) -> None:
    if _is_compressed(model.description):
        raise ValueError(f"the input of this {model.name} is compressed: its thresholds have no unit")


def _play_weights(law: dict[str, Any], name: str) -> tuple[list[float], list[float], str] | None:
    """Thresholds, weights, and what the weights are; None for a law without thresholds."""
    if name == "masing":
        slopes = law["slopes"]
        return law["thresholds"], [a - b for a, b in zip(slopes, slopes[1:])], "weight of the stop"
    if name == "modified-prandtl-ishlinskii":
        law = law["hysteresis"]
    if "thresholds" in law and "weights" in law and isinstance(law["thresholds"], list):
        return law["thresholds"], law["weights"], "weight of the play"
    return None


def _stop_thresholds(network: dict[str, Any]) -> list[float]:
    """The thresholds of the stops of a network, from small to large."""
    scale = network["scaling"]["inputs"][0]
    swings = [abs(stop["weights"][0]) for stop in network["memory"]["stops"]]
    return sorted(scale / swing for swing in swings if swing > 0)


def _thresholds_of(content: dict[str, Any]) -> list[float]:
    """The thresholds of a model in the unit of its first input; empty if it has none."""
    if _is_compressed(content):
        return []
    if content.get("network") is not None:
        return _stop_thresholds(content["network"])
    ((name, law),) = content["law"].items()
    found = _play_weights(law, name)
    return [] if found is None else [threshold for threshold in found[0] if threshold > 0]


def thresholds(model: Model, *, ax: Axes | None = None) -> Axes:
    """Plot the thresholds of a model's operators, in the unit of the first input.

    Parameters
    ----------
    model : Model
        A network, one of masing, prandtl-ishlinskii and modified-prandtl-ishlinskii, or an ensemble with such members.
    ax : Axes, optional
        Axes to draw on; by default new ones.

    Returns
    -------
    Axes
        For a classical model, weights over thresholds. For a network, the thresholds of its stops from small to
        large. For an ensemble, the thresholds of each member that has any, the largest weight first. The line is half the
        trained range: operators above it do not slip if the input is slow.

    Raises
    ------
    ValueError
        A model without thresholds, or whose input is compressed.
    """
    described = model.description
    network = described.get("network")
    name, unit = _hysid.name_and_unit(model.inputs[0])
    label = f"threshold of {name}" + ("" if unit is None else f" ({unit})")
    if not model.members:
        _not_compressed(model)
        if network is None:
            return _of_law(model, label, ax)
    groups = [(name, _thresholds_of(content)) for name, _, content in _members(model)]
    groups = [(name, found) for name, found in groups if found]
    if not groups:
        raise ValueError(f"{model.name}: no member has thresholds in the unit of the input")
    ax = new_axes(ax)
    if model.members:
        for place, (name, found) in enumerate(groups):
            colour = SERIES[place % len(SERIES)]
            ax.plot(np.full(len(found), place), found, linestyle="none", marker="_", markersize=14, color=colour)
        names = [_short(name) for name, _ in groups]
        ax.set_xticks(range(len(names)), names, rotation=30, ha="right")
        ax.set_xlim(-0.6, len(names) - 0.4)
    else:
        ((_, found),) = groups
        ax.plot(range(1, len(found) + 1), found, "o", color=SERIES[0], label="stops")
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
        ax.set_xlabel("stop, by threshold")
    low, high = described["trained_ranges"]["inputs"][0]
    ax.axhline((high - low) / 2, color="0.55", linewidth=0.8, label="half the trained range")
    ax.set(ylabel=label, yscale="log")
    for axis in (ax.yaxis.set_major_formatter, ax.yaxis.set_minor_formatter):
        axis(LogFormatter(minor_thresholds=(1.5, 0.5)))
    if not model.members:
        labelled_once(ax)
    return ax


def _of_law(model: Model, label: str, ax: Axes | None) -> Axes:
    """Weights over thresholds."""
    ((name, law),) = model.description["law"].items()
    found = _play_weights(law, name)
    if found is None:
        raise ValueError(f"{name} has no thresholds to draw")
    places, weights, kind = found
    ax = new_axes(ax)
    ax.vlines(places, 0.0, weights, color=SERIES[0])
    ax.plot(places, weights, "o", color=SERIES[0], markersize=4)
    ax.axhline(0.0, color="0.55", linewidth=0.8)
    ax.set(xlabel=label, ylabel=kind)
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
        Another model, or one whose input is compressed.
    """
    law = (model.description.get("law") or {}).get("preisach")
    if law is None:
        raise ValueError(f"{model.name} has no Preisach plane: fit one with model='preisach'")
    _not_compressed(model)
    ax = new_axes(ax)
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
    name, unit = _hysid.name_and_unit(model.inputs[0])
    in_unit = "" if unit is None else f" ({unit})"
    ax.set(xlabel=f"down at {name}{in_unit}", ylabel=f"up at {name}{in_unit}", aspect="equal")
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
    ax = new_axes(ax)
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
