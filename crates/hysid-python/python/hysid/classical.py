"""The classical models as functions on arrays: parameters in the user's units, with the symbols of the field.

All start in the virgin state. To fit one to data, name it in `hysid.fit`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hysid import _hysid
from hysid._arguments import real, whole
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
    "menegotto_pinto",
    "modified_prandtl_ishlinskii",
    "peak_oriented",
    "prandtl_ishlinskii",
    "preisach",
    "ramberg_osgood",
    "rate_dependent_prandtl_ishlinskii",
]

ENVELOPE = ("a0", "a1", "a2", "a3")
"""Parameters of an envelope of generalized plays."""

DEGRADATION = ("delta_a", "delta_nu", "delta_eta", "zeta_s", "p", "q", "psi_0", "delta_psi", "lambda")
"""Parameters of Baber and Noori's degradation and pinching."""

DETERIORATION = (
    "cap",
    "softening",
    "residual",
    "endurance",
    "pace",
    "strength_loss",
    "target_growth",
    "pinching_growth",
)
"""Parameters of the softening and deterioration of a peak-oriented law."""


def _run(law: str, parameters: dict[str, Any], x: Any, time: Any = None, rate: str | None = None) -> np.ndarray:
    taken = columns(x, None, time, None, None)
    if len(taken.records) != 1:
        raise ValueError(f"{law} takes one record, not a list of {len(taken.records)}")
    if len(taken.inputs) != 1:
        raise ValueError(f"{law} takes one input, not {len(taken.inputs)}")
    stamps = None if taken.time is None else taken.time.values
    output: np.ndarray = _hysid.law(json.dumps({law: parameters}), taken.inputs[0].values, stamps, rate)
    return output


def _number(name: str, value: Any) -> float:
    number = real(name, value)
    if not math.isfinite(number):
        raise ValueError(f"{name} {number}: a finite number is needed")
    return number


def _numbers(**values: Any) -> dict[str, float]:
    """Numbers by their names."""
    return {name: _number(name, value) for name, value in values.items()}


def _list(name: str, values: Any) -> list[float]:
    try:
        numbers = np.asarray(values, dtype=np.float64).ravel()
    except (TypeError, ValueError):
        raise TypeError(f"{name}: an array of numbers is needed") from None
    if not np.isfinite(numbers).all():
        raise ValueError(f"{name}: finite numbers are needed")
    return [float(number) for number in numbers]


def _named(name: str, values: Mapping[str, Any], keys: Sequence[str]) -> dict[str, float]:
    """Numbers of a dict, which has exactly these keys."""
    if set(values) != set(keys):
        raise ValueError(f"{name}: a dict with the keys {', '.join(keys)} is needed")
    return {key: _number(f"{name}[{key!r}]", values[key]) for key in keys}


def _symbols(name: str, values: Any, symbols: Sequence[str]) -> dict[str, float]:
    """Numbers of a sequence, which has one for each of these symbols."""
    numbers = _list(name, values)
    if len(numbers) != len(symbols):
        raise ValueError(f"{name}: {', '.join(symbols)} are needed, not {len(numbers)} numbers")
    return dict(zip(symbols, numbers))


def masing(x: Values, thresholds: ArrayLike, slopes: ArrayLike, constant: float = 0.0) -> np.ndarray:
    """Simulate a model by Masing's rule: every branch is the virgin curve, scaled by two.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    thresholds : array of shape (m,)
        Inputs at which the slope of the virgin curve changes, in the unit of the input; positive and increasing.
    slopes : array of shape (m + 1,)
        Slopes of the virgin curve below each threshold, and beyond the last.
    constant : float
        Constant added to the output, in its unit.

    Returns
    -------
    array of shape (n,)
        The output.

    Examples
    --------
    >>> hysid.classical.masing([0, 3, 0], thresholds=[1.0], slopes=[1.0, 0.0])
    array([ 0.,  1., -1.])
    """
    parts = {
        **_numbers(constant=constant),
        "thresholds": _list("thresholds", thresholds),
        "slopes": _list("slopes", slopes),
    }
    return _run("masing", parts, x)


def _plays(thresholds: Any, weights: Any, linear: float, constant: float, of: str = "") -> dict[str, Any]:
    """Plays, or dead zones: then `of` begins the names of the arguments."""
    return {
        "constant": _number(f"{of}constant", constant),
        "linear": _number(f"{of}linear", linear),
        "thresholds": _list(f"{of}thresholds", thresholds),
        "weights": _list(f"{of}weights", weights),
    }


def prandtl_ishlinskii(
    x: Values, thresholds: ArrayLike, weights: ArrayLike, linear: float = 0.0, constant: float = 0.0
) -> np.ndarray:
    """Simulate a Prandtl-Ishlinskii model: a weighted sum of plays.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    thresholds : array of shape (m,)
        Thresholds of the plays, in the unit of the input; positive and increasing.
    weights : array of shape (m,)
        Weights of the plays, in the unit of the output per unit of the input.
    linear : float
        Weight of the input itself.
    constant : float
        Constant added to the output, in its unit.

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
    """Simulate a modified Prandtl-Ishlinskii model: a sum of plays, then a sum of one-sided dead zones.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    thresholds, weights : array of shape (m,)
        Thresholds and weights of the plays, as of `prandtl_ishlinskii`.
    dead_zone_thresholds, dead_zone_weights : array of shape (k,)
        Thresholds of the dead zones, increasing and not 0; and the change of the slope there, away from 0.
    linear, constant : float
        Linear weight and constant of the plays, as of `prandtl_ishlinskii`.
    dead_zone_linear, dead_zone_constant : float
        Slope and value of the dead-zone function at 0.

    Returns
    -------
    array of shape (n,)
        The output.

    Examples
    --------
    >>> hysid.classical.modified_prandtl_ishlinskii([0, 3, 0], [1.0], [2.0], [3.0], [1.0])
    array([0., 5., 2.])
    """
    zones = _plays(dead_zone_thresholds, dead_zone_weights, dead_zone_linear, dead_zone_constant, "dead_zone_")
    parts = {"hysteresis": _plays(thresholds, weights, linear, constant), "superposition": zones}
    return _run("modified-prandtl-ishlinskii", parts, x)


def _play_weights(weights: Any) -> dict[str, Any]:
    if not isinstance(weights, Mapping):
        return {"free": _list("weights", weights)}
    law: dict[str, float] = _named("weights", weights, ("plays", "rho", "tau"))
    return {"exponential": {**law, "plays": whole("weights['plays']", weights["plays"], 1)}}


def generalized_prandtl_ishlinskii(
    x: Values,
    left: ArrayLike,
    right: ArrayLike,
    spacing: float,
    weights: ArrayLike | dict[str, float],
    initial: float = 0.0,
    offset: float = 0.0,
) -> np.ndarray:
    """Simulate a generalized Prandtl-Ishlinskii model: plays between two envelope functions.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    left, right : array of shape (4,)
        ``a0, a1, a2, a3`` of the envelopes ``a0 tanh(a1 x + a2) + a3``, for increasing and for decreasing input.
    spacing : float
        Distance between the thresholds of the plays; the first is 0.
    weights : array of shape (m,) or dict
        Weights of the plays, in the unit of the output; or ``plays``, ``rho`` and ``tau`` of ``rho exp(-tau r)``.
    initial : float
        Initial output of the plays.
    offset : float
        Constant added to the output, in its unit.

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
        **_numbers(offset=offset, initial=initial, spacing=spacing),
        "left": _symbols("left", left, ENVELOPE),
        "right": _symbols("right", right, ENVELOPE),
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
    """Simulate a rate-dependent Prandtl-Ishlinskii model: plays whose thresholds grow with the rate of the input.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    time : array of shape (n,)
        Time stamps, increasing.
    spacing : float
        Distance between the thresholds at rate 0, in the unit of the input.
    weights : array of shape (m,) or dict
        Weights of the plays; or ``plays``, ``rho`` and ``tau`` of ``rho exp(-tau r)``.
    beta : float
        Growth of every threshold with the rate, in the unit of time; with `growth`, the logarithm of `beta` is the
        factor at rate 0.
    growth : float, optional
        If given, thresholds grow with the logarithm of ``beta + growth |x'|^power`` instead of linearly.
    power : float
        Exponent of the rate in this logarithm.
    spring : float
        Weight of the input itself.
    offset : float
        Constant added to the output, in its unit.
    rate : str
        Method for the rate: central, backward or savitzky-golay.

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
    thresholds: dict[str, Any] = {"linear": _numbers(beta=beta)}
    if growth is not None:
        parameters = {"lambda": _number("growth", growth), "epsilon": _number("power", power)}
        thresholds = {"logarithmic": {**_numbers(beta=beta), **parameters}}
    parts = {
        **_numbers(offset=offset, spring=spring, spacing=spacing),
        "thresholds": thresholds,
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
    """Simulate the classical Preisach model on a plane of cells.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    lines : array of shape (m + 1,)
        Grid lines of both axes of the plane, in the unit of the input; increasing.
    cells : array of shape (m (m + 1) / 2,)
        Weights of the cells in the unit of the output, row by row: w00, w10, w11, w20, ... The first index is
        the interval of the upper threshold.
    reversible : array of shape (m,), optional
        Weights of the intervals in the reversible part.
    slope : float
        Slope of the reversible part, in the unit of the output per unit of the input.
    constant : float
        Constant added to the output, in its unit.

    Returns
    -------
    array of shape (n,)
        The output.

    Examples
    --------
    >>> hysid.classical.preisach([0, 1, -1, 1], lines=[-1.0, 1.0], cells=[2.0])
    array([ 0.,  2., -2.,  2.])
    """
    grid = _list("lines", lines)
    parts = {
        **_numbers(constant=constant, slope=slope),
        "lines": grid,
        "reversible": [0.0] * (len(grid) - 1) if reversible is None else _list("reversible", reversible),
        "cells": _list("cells", cells),
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
    """Simulate a Bouc-Wen law: a spring parallel to a hysteretic element that yields.

    Parameters
    ----------
    x : array of shape (n,)
        The input, such as a displacement.
    elastic_stiffness, hysteretic_stiffness : float
        Stiffness of the spring, and of the hysteretic element before it yields.
    yield_displacement : float
        Input at which the element yields, in its unit; above 0.
    b : float
        beta / (beta + gamma), 0.05 to 3.
    n : float
        Sharpness of yielding, 1 to 10.
    damping : float
        Coefficient of the rate in the output; needs `time`.
    offset : float
        Constant added to the output, in its unit.
    degradation : dict, optional
        Parameters of the degradation and pinching of Baber and Noori: ``delta_a``, ``delta_nu``, ``delta_eta``,
        ``zeta_s``, ``p``, ``q``, ``psi_0``, ``delta_psi``, ``lambda``.
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
        **_numbers(
            offset=offset,
            elastic_stiffness=elastic_stiffness,
            hysteretic_stiffness=hysteretic_stiffness,
            damping=damping,
            yield_displacement=yield_displacement,
            b=b,
            n=n,
        ),
        "degradation": None if degradation is None else _named("degradation", degradation, DEGRADATION),
    }
    return _run("bouc-wen", parts, x, time, None if time is None else "central")


def jiles_atherton(
    x: Values,
    saturation: float,
    a: float,
    k: float,
    alpha: float = 0.0,
    c: float = 0.0,
    permeability: float = 0.0,
    offset: float = 0.0,
    differential_form: bool = False,
) -> np.ndarray:
    """Simulate a Jiles-Atherton law: magnetisation by domain walls that are pinned.

    Parameters
    ----------
    x : array of shape (n,)
        The field.
    saturation : float
        Saturation magnetisation, in the unit of the output, above 0.
    a, k : float
        Width of the anhysteretic curve, and pinning; in the unit of the field, above 0.
    alpha : float
        Field that the magnetisation adds, 0 to 3 a / saturation; in the unit of the field divided by that of the output:
        a pure number if both are in A/m, and divided by 4e-7 pi if the output is in T.
    c : float
        Share of the reversible magnetisation, 0 to 0.99.
    permeability : float
        Coefficient of the field in the output.
    offset : float
        Constant added to the output, in its unit.
    differential_form : bool
        Use the differential form of 1992 instead of that of 1986.

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
        **_numbers(
            offset=offset, permeability=permeability, saturation=saturation, a=a, k=k, alpha=alpha, c=c
        ),
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
    """Simulate a LuGre law: friction of a contact whose bristles bend before they slip.

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
        Static friction divided by sliding friction, minus 1; 0 to 10.
    stribeck_velocity : float
        Rate at which friction decreases from static to sliding; above 0.
    bristle_damping : float
        Damping of the bristles, in the unit of the output multiplied by that of time.
    viscous : float
        Viscous friction, in the unit of the output per unit of the rate.
    spring : float
        Stiffness of a spring beside the contact, in the unit of the output per unit of the input.
    offset : float
        Constant added to the output, in its unit.

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
    parts = _numbers(
        offset=offset,
        spring=spring,
        sliding=sliding,
        presliding=presliding,
        stribeck=stribeck,
        stribeck_velocity=stribeck_velocity,
        bristle_damping=bristle_damping,
        viscous=viscous,
    )
    return _run("lugre", parts, x, time, "central")


def peak_oriented(
    x: Values,
    strength: float,
    yield_displacement: float,
    n: float = 20.0,
    hardening: float = 0.0,
    unloading: float = 0.0,
    curvature: float = 0.0,
    pinch_place: float = 0.5,
    pinch_height: float = 0.5,
    pinch_weight: float = 1.0,
    spring: float = 0.0,
    offset: float = 0.0,
    down: tuple[float, float] | None = None,
    degradation: dict[str, float] | None = None,
) -> np.ndarray:
    """Simulate a peak-oriented law: reloading leads to the largest displacement so far on that side.

    Parameters
    ----------
    x : array of shape (n,)
        The displacement.
    strength : float
        Yield force, in the unit of the output.
    yield_displacement : float
        Yield displacement, in the unit of the input; above 0.
    n : float
        Sharpness of yielding, 0.5 to 20.
    hardening : float
        Slope of the envelope after yielding divided by that at first, 0 to 1.
    unloading : float
        0 unloads with the initial stiffness, 1 towards the origin.
    curvature : float
        Curvature of unloading, 0 to 20.
    pinch_place, pinch_height : float
        Pinch point as shares of the way and of the force between zero force and the target, 0.01 to 0.99.
    pinch_weight : float
        How closely reloading follows the two lines through the pinch point, 0.1 to 30.
    spring : float
        Stiffness of a spring beside the member, in the unit of the output per unit of the input.
    offset : float
        Constant added to the output, in its unit.
    down : tuple of two floats, optional
        Yield force and yield displacement of the side of negative forces, where they differ.
    degradation : dict, optional
        Parameters of softening and deterioration: ``cap``, ``softening``, ``residual``, ``endurance``, ``pace``,
        ``strength_loss``, ``target_growth``, ``pinching_growth``.

    Returns
    -------
    array of shape (n,)
        The force.

    Examples
    --------
    >>> force = hysid.classical.peak_oriented([0.0, 20.0, 15.0, 10.0], strength=100.0, yield_displacement=10.0)
    >>> bool(np.allclose(force, [0.0, 100.0, 50.0, 0.0], atol=1e-3))
    True
    """
    parts = {
        **_numbers(
            offset=offset,
            spring=spring,
            n=n,
            hardening=hardening,
            unloading=unloading,
            curvature=curvature,
            pinch_place=pinch_place,
            pinch_height=pinch_height,
            pinch_weight=pinch_weight,
        ),
        "up": _numbers(strength=strength, yield_displacement=yield_displacement),
        "down": None if down is None else _symbols("down", down, ("strength", "yield_displacement")),
        "degradation": None if degradation is None else _named("degradation", degradation, DETERIORATION),
    }
    return _run("peak-oriented", parts, x)


def menegotto_pinto(
    x: Values,
    hardening_stiffness: float,
    strength: float,
    yield_displacement: float,
    roundness: float = 20.0,
    loss: float = 0.925,
    pace: float = 0.15,
    isotropic: float = 0.0,
    offset: float = 0.0,
    down: tuple[float, float] | None = None,
) -> np.ndarray:
    """Simulate a Menegotto-Pinto law: steel, by curves between two straight lines.

    Parameters
    ----------
    x : array of shape (n,)
        The strain or displacement.
    hardening_stiffness : float
        Slope of the hardening lines, in the unit of the output per unit of the input.
    strength : float
        Yield stress without the part of the hardening line, in the unit of the output.
    yield_displacement : float
        Yield strain or displacement, in the unit of the input; above 0.
    roundness : float
        Sharpness of the virgin bend, 0.5 to 50 (``R_0``).
    loss, pace : float
        Loss of sharpness after large excursions, 0 to 0.99, and the excursion in yield displacements at which half
        of it is lost (``a_1`` and ``a_2``, in OpenSees ``cR1`` and ``cR2``).
    isotropic : float
        Isotropic hardening, -1 to 10; negative for softening.
    offset : float
        Constant added to the output, in its unit.
    down : tuple of two floats, optional
        Yield stress downwards divided by that upwards, and isotropic hardening downwards, where they differ.

    Returns
    -------
    array of shape (n,)
        The stress or force.

    Examples
    --------
    >>> stress = hysid.classical.menegotto_pinto([0.0, 1.0, 50.0], 2.0, 396.0, yield_displacement=2.0)
    >>> bool(np.allclose(stress, [0.0, 200.0, 496.0], atol=1e-2))
    True
    """
    parts = {
        **_numbers(
            offset=offset,
            hardening_stiffness=hardening_stiffness,
            strength=strength,
            yield_displacement=yield_displacement,
            roundness=roundness,
            loss=loss,
            pace=pace,
            isotropic=isotropic,
        ),
        "down": None if down is None else _symbols("down", down, ("ratio", "isotropic")),
    }
    return _run("menegotto-pinto", parts, x)


def ramberg_osgood(
    x: Values, strength: float, yield_displacement: float, exponent: float, offset: float = 0.0
) -> np.ndarray:
    """Simulate a Ramberg-Osgood law: a power curve with Masing's rules.

    Parameters
    ----------
    x : array of shape (n,)
        The strain or displacement.
    strength : float
        Output at which the secant stiffness is half the initial one, in the unit of the output (``F``). The form with a
        factor ``alpha`` and a yield output has ``F = yield_output * alpha ** (-1 / (exponent - 1))``.
    yield_displacement : float
        Elastic part of the input there, in its unit; above 0. The initial stiffness is ``strength / yield_displacement``.
    exponent : float
        Exponent of the power curve, 1 (linear) to 100 (``r``).
    offset : float
        Constant added to the output, in its unit.

    Returns
    -------
    array of shape (n,)
        The stress or force.

    Examples
    --------
    >>> force = hysid.classical.ramberg_osgood([0.0, 4.0, 0.0], strength=100.0, yield_displacement=2.0, exponent=5.0)
    >>> bool(np.allclose(force[:2], [0.0, 100.0])), bool(force[2] < -50.0)
    (True, True)
    """
    parts = _numbers(
        offset=offset, strength=strength, yield_displacement=yield_displacement, exponent=exponent
    )
    return _run("ramberg-osgood", parts, x)
