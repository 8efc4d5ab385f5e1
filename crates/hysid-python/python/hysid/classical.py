"""The classical models as functions on arrays: parameters in the user's units and the field's symbols.

All begin virgin. To fit one to data, name it in `hysid.fit`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from hysid import _hysid
from hysid._data import columns

if TYPE_CHECKING:
    from hysid._data import Values
    from numpy.typing import ArrayLike

__all__ = [
    "bouc_wen",
    "generalized_prandtl_ishlinskii",
    "jiles_atherton",
    "lugre",
    "masing",
    "modified_prandtl_ishlinskii",
    "prandtl_ishlinskii",
    "preisach",
    "rate_dependent_prandtl_ishlinskii",
]


def _run(law: str, parameters: dict[str, Any], x: Any, time: Any = None, rate: str | None = None) -> np.ndarray:
    taken = columns(x, None, time, None, None)
    if len(taken.inputs) != 1:
        raise ValueError(f"{law} takes one input, not {len(taken.inputs)}")
    stamps = None if taken.time is None else taken.time.values
    description = json.dumps({law: parameters}, default=float)
    output: np.ndarray = _hysid.law(description, taken.inputs[0].values, stamps, rate)
    return output


def _list(values: Any) -> list[float]:
    return [float(value) for value in np.asarray(values, dtype=np.float64).ravel()]


def masing(x: Values, thresholds: ArrayLike, slopes: ArrayLike, constant: float = 0.0) -> np.ndarray:
    """Run a model by Masing's rule: every branch is the virgin curve, twice as large.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    thresholds : array of shape (m,)
        Where the virgin curve bends, in the unit of the input; positive and rising.
    slopes : array of shape (m + 1,)
        Slopes of the virgin curve below each threshold, and beyond the last.
    constant : float
        In the unit of the output.

    Returns
    -------
    array of shape (n,)
        The output.

    Examples
    --------
    >>> hysid.classical.masing([0, 3, 0], thresholds=[1.0], slopes=[1.0, 0.0])
    array([ 0.,  1., -1.])
    """
    parts = {"constant": constant, "thresholds": _list(thresholds), "slopes": _list(slopes)}
    return _run("masing", parts, x)


def _plays(thresholds: Any, weights: Any, linear: float, constant: float) -> dict[str, Any]:
    return {
        "constant": constant,
        "linear": linear,
        "thresholds": _list(thresholds),
        "weights": _list(weights),
    }


def prandtl_ishlinskii(
    x: Values, thresholds: ArrayLike, weights: ArrayLike, linear: float = 0.0, constant: float = 0.0
) -> np.ndarray:
    """Run a Prandtl-Ishlinskii model: a sum of plays.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    thresholds : array of shape (m,)
        Of the plays, in the unit of the input; positive and rising.
    weights : array of shape (m,)
        Of the plays, output for input.
    linear : float
        Weight of the input itself.
    constant : float
        In the unit of the output.

    Returns
    -------
    array of shape (n,)
        The output.

    Examples
    --------
    >>> hysid.classical.prandtl_ishlinskii([0, 3, 0], thresholds=[1.0], weights=[2.0])
    array([0., 4., 2.])
    """
    return _run("prandtl-ishlinskii", _plays(thresholds, weights, linear, constant), x)


def modified_prandtl_ishlinskii(
    x: Values,
    thresholds: ArrayLike,
    weights: ArrayLike,
    dead_zone_thresholds: ArrayLike,
    dead_zone_weights: ArrayLike,
    linear: float = 0.0,
    constant: float = 0.0,
    dead_zone_linear: float = 1.0,
    dead_zone_constant: float = 0.0,
) -> np.ndarray:
    """Run a modified Prandtl-Ishlinskii model: plays, then one-sided dead zones that bend their sum.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    thresholds, weights : array of shape (m,)
        Of the plays, as of `prandtl_ishlinskii`.
    dead_zone_thresholds, dead_zone_weights : array of shape (k,)
        Of the dead zones, rising and not 0; and by how much the slope changes there, going away from 0.
    linear, constant : float
        Of the plays, as of `prandtl_ishlinskii`.
    dead_zone_linear, dead_zone_constant : float
        Slope of the polygon at 0, and its value there.

    Returns
    -------
    array of shape (n,)
        The output.

    Examples
    --------
    >>> hysid.classical.modified_prandtl_ishlinskii([0, 3, 0], [1.0], [2.0], [3.0], [1.0])
    array([0., 5., 2.])
    """
    zones = _plays(dead_zone_thresholds, dead_zone_weights, dead_zone_linear, dead_zone_constant)
    parts = {"hysteresis": _plays(thresholds, weights, linear, constant), "superposition": zones}
    return _run("modified-prandtl-ishlinskii", parts, x)


def _play_weights(weights: Any) -> dict[str, Any]:
    if isinstance(weights, Mapping):
        return {"exponential": dict(weights)}
    return {"free": _list(weights)}


def generalized_prandtl_ishlinskii(
    x: Values,
    left: ArrayLike,
    right: ArrayLike,
    spacing: float,
    weights: ArrayLike | dict[str, float],
    initial: float = 0.0,
    offset: float = 0.0,
) -> np.ndarray:
    """Run a generalized Prandtl-Ishlinskii model: plays between two bent envelopes.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    left, right : array of shape (4,)
        ``a0, a1, a2, a3`` of the envelopes ``a0 tanh(a1 x + a2) + a3``, followed upwards and downwards.
    spacing : float
        Distance of the plays' thresholds, of which the first is 0.
    weights : array of shape (m,) or dict
        Of the plays, in the unit of the output; or ``plays``, ``rho`` and ``tau`` of ``rho exp(-tau r)``.
    initial : float
        Where the plays begin.
    offset : float
        In the unit of the output.

    Returns
    -------
    array of shape (n,)
        The output.

    Examples
    --------
    >>> envelope = [6.0, 0.4, 0.0, 0.0]
    >>> y = hysid.classical.generalized_prandtl_ishlinskii([0, 5], envelope, envelope, 0.45, [1.0])
    >>> bool(np.isclose(y[1], 6 * np.tanh(2.0)))
    True
    """
    parts = {
        "offset": offset,
        "left": dict(zip(("a0", "a1", "a2", "a3"), _list(left))),
        "right": dict(zip(("a0", "a1", "a2", "a3"), _list(right))),
        "initial": initial,
        "spacing": spacing,
        "weights": _play_weights(weights),
    }
    return _run("generalized-prandtl-ishlinskii", parts, x)


def rate_dependent_prandtl_ishlinskii(
    x: Values,
    time: ArrayLike,
    spacing: float,
    weights: ArrayLike | dict[str, float],
    beta: float,
    growth: float | None = None,
    power: float = 1.0,
    spring: float = 0.0,
    offset: float = 0.0,
    rate: str = "central",
) -> np.ndarray:
    """Run a rate-dependent Prandtl-Ishlinskii model: plays whose thresholds grow with the rate of the input.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    time : array of shape (n,)
        Time stamps, increasing.
    spacing : float
        Distance of the thresholds at rest, in the unit of the input.
    weights : array of shape (m,) or dict
        Of the plays; or ``plays``, ``rho`` and ``tau`` of ``rho exp(-tau r)``.
    beta : float
        Growth of every threshold with the rate, in the unit of time; with `growth`, its logarithm is the
        factor at rest.
    growth : float, optional
        Thresholds grow with the logarithm of ``beta + growth |x'|^power`` in place of linearly.
    power : float
        Power of the rate under that logarithm.
    spring : float
        Weight of the input itself.
    offset : float
        In the unit of the output.
    rate : str
        How the rate is found: central, backward or savitzky-golay.

    Returns
    -------
    array of shape (n,)
        The output.

    Examples
    --------
    >>> y = hysid.classical.rate_dependent_prandtl_ishlinskii([0, 3, 0], [0, 1, 2], 1.0, [1.0], beta=0.0)
    >>> y
    array([0., 2., 1.])
    """
    grown = {"beta": beta, "lambda": growth, "epsilon": power}
    parts = {
        "offset": offset,
        "spring": spring,
        "spacing": spacing,
        "thresholds": {"linear": {"beta": beta}} if growth is None else {"logarithmic": grown},
        "weights": _play_weights(weights),
    }
    return _run("rate-dependent-prandtl-ishlinskii", parts, x, time, rate)


def preisach(
    x: Values,
    lines: ArrayLike,
    cells: ArrayLike,
    reversible: ArrayLike | None = None,
    slope: float = 0.0,
    constant: float = 0.0,
) -> np.ndarray:
    """Run the classical Preisach model on a plane of cells.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    lines : array of shape (m + 1,)
        Where both axes of the plane are cut, in the unit of the input; rising.
    cells : array of shape (m (m + 1) / 2,)
        Weights of the cells in the unit of the output, row by row: w00, w10, w11, w20, ... The first index is
        the interval of the upper threshold.
    reversible : array of shape (m,), optional
        Weights of the intervals in the reversible part.
    slope : float
        Of the reversible part, output for input.
    constant : float
        In the unit of the output.

    Returns
    -------
    array of shape (n,)
        The output.

    Examples
    --------
    >>> hysid.classical.preisach([0, 1, -1, 1], lines=[-1.0, 1.0], cells=[2.0])
    array([ 0.,  2., -2.,  2.])
    """
    cut = _list(lines)
    parts = {
        "constant": constant,
        "slope": slope,
        "lines": cut,
        "reversible": [0.0] * (len(cut) - 1) if reversible is None else _list(reversible),
        "cells": _list(cells),
    }
    return _run("preisach", parts, x)


def bouc_wen(
    x: Values,
    elastic_stiffness: float,
    hysteretic_stiffness: float,
    yield_displacement: float,
    b: float = 0.5,
    n: float = 1.0,
    damping: float = 0.0,
    offset: float = 0.0,
    degradation: dict[str, float] | None = None,
    time: ArrayLike | None = None,
) -> np.ndarray:
    """Run a Bouc-Wen law: a spring beside a hysteretic element that yields.

    Parameters
    ----------
    x : array of shape (n,)
        The input, such as a displacement.
    elastic_stiffness, hysteretic_stiffness : float
        Of the spring, and of the element before it yields; output for input.
    yield_displacement : float
        In the unit of the input; above 0.
    b : float
        beta / (beta + gamma), 0.05 to 3.
    n : float
        Sharpness of yielding, 1 to 10.
    damping : float
        Share of the rate in the output; needs `time`.
    offset : float
        In the unit of the output.
    degradation : dict, optional
        Degradation and pinching of Baber and Noori by its parameters' names.
    time : array of shape (n,), optional
        Time stamps, increasing.

    Returns
    -------
    array of shape (n,)
        The output, such as a force.

    Examples
    --------
    >>> force = hysid.classical.bouc_wen([0, 40], 5.0, 100.0, yield_displacement=2.0)
    >>> bool(np.isclose(force[1], 5.0 * 40.0 + 100.0 * 2.0))
    True
    """
    if damping != 0.0 and time is None:
        raise ValueError("damping: needs time")
    parts = {
        "offset": offset,
        "elastic_stiffness": elastic_stiffness,
        "hysteretic_stiffness": hysteretic_stiffness,
        "damping": damping,
        "yield_displacement": yield_displacement,
        "b": b,
        "n": n,
        "degradation": degradation,
    }
    return _run("bouc-wen", parts, x, time, None if time is None else "central")


def jiles_atherton(
    x: Values,
    saturation: float,
    a: float,
    k: float,
    coupling: float = 0.0,
    c: float = 0.0,
    permeability: float = 0.0,
    offset: float = 0.0,
    differential_form: bool = False,
) -> np.ndarray:
    """Run a Jiles-Atherton law: domain walls that are pinned on their way.

    Parameters
    ----------
    x : array of shape (n,)
        The field.
    saturation : float
        Saturation magnetisation, in the unit of the output.
    a, k : float
        Width of the anhysteretic curve, and pinning; in the unit of the field, above 0.
    coupling : float
        The field that the saturated magnetisation adds, 0 to 3 a.
    c : float
        Share of the reversible magnetisation, 0 to 0.99.
    permeability : float
        Share of the field itself in the output.
    offset : float
        In the unit of the output.
    differential_form : bool
        The differential form of 1992 in place of that of 1986.

    Returns
    -------
    array of shape (n,)
        Magnetisation or flux density.

    Examples
    --------
    >>> m = hysid.classical.jiles_atherton([0, 1000, 0, -1000], saturation=1.5, a=50.0, k=80.0)
    >>> bool(m[2] > 0.5), bool(m[3] < -1.2)
    (True, True)
    """
    parts = {
        "offset": offset,
        "permeability": permeability,
        "saturation": saturation,
        "a": a,
        "k": k,
        "coupling": coupling,
        "c": c,
        "form": "differential" if differential_form else "original",
    }
    return _run("jiles-atherton", parts, x)


def lugre(
    x: Values,
    time: ArrayLike,
    sliding: float,
    presliding: float,
    stribeck: float = 0.0,
    stribeck_velocity: float = 1.0,
    bristle_damping: float = 0.0,
    viscous: float = 0.0,
    spring: float = 0.0,
    offset: float = 0.0,
) -> np.ndarray:
    """Run a LuGre law: friction of a contact whose bristles bend before they slip.

    Parameters
    ----------
    x : array of shape (n,)
        The displacement.
    time : array of shape (n,)
        Time stamps, increasing.
    sliding : float
        Friction at a high rate, in the unit of the output.
    presliding : float
        Displacement at which the contact slides, in the unit of the input; above 0.
    stribeck : float
        Static over sliding friction, less 1; 0 to 10.
    stribeck_velocity : float
        Rate at which static friction falls to sliding friction; above 0.
    bristle_damping : float
        Damping of the bristles, in the unit of the output multiplied by that of time.
    viscous : float
        Viscous friction, output for rate.
    spring : float
        Stiffness of a spring beside the contact, output for input.
    offset : float
        In the unit of the output.

    Returns
    -------
    array of shape (n,)
        The friction.

    Examples
    --------
    >>> friction = hysid.classical.lugre([0.0, 1.0, 2.0], [0.0, 1.0, 2.0], sliding=2.0, presliding=0.01)
    >>> bool(np.isclose(friction[2], 2.0))
    True
    """
    parts = {
        "offset": offset,
        "spring": spring,
        "sliding": sliding,
        "presliding": presliding,
        "stribeck": stribeck,
        "stribeck_velocity": stribeck_velocity,
        "bristle_damping": bristle_damping,
        "viscous": viscous,
    }
    return _run("lugre", parts, x, time, "central")
