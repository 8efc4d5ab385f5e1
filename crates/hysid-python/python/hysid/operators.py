"""The elements that every model of hysteresis is built from, as functions on arrays.

All begin virgin: as if the input had rested at 0 for ever and the first sample were a jump from there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hysid import _hysid
from hysid._data import Column, columns

if TYPE_CHECKING:
    from hysid._data import Values
    import numpy as np
    from numpy.typing import ArrayLike

__all__ = ["deteriorating_stop", "play", "relaxation", "relay", "stop"]


def _signal(x: Any, time: Any = None) -> tuple[np.ndarray, Column | None]:
    taken = columns(x, None, time, None, None)
    if len(taken.inputs) != 1:
        raise ValueError(f"takes one input, not {len(taken.inputs)}")
    return taken.inputs[0].values, taken.time


def relay(x: Values, r: float, s: float = 0.0) -> np.ndarray:
    """Run a relay: a switch with two thresholds.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    r : float
        Half the distance of the thresholds, in the unit of the input; above 0.
    s : float
        Their middle, in the unit of the input.

    Returns
    -------
    array of shape (n,)
        -1 or +1: +1 once the input has passed ``s + r``, -1 once it has passed ``s - r``.

    Examples
    --------
    >>> hysid.operators.relay([-2, 0, 2, 0, -2], r=1.0)
    array([-1., -1.,  1.,  1., -1.])
    """
    return _hysid.relay(_signal(x)[0], r, s)


def play(x: Values, r: float) -> np.ndarray:
    """Run a play: a slider in a slot, the backlash of gears.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    r : float
        Half the width of the slot, in the unit of the input; 0 or more.

    Returns
    -------
    array of shape (n,)
        Where the slider is, in the unit of the input.

    Examples
    --------
    >>> hysid.operators.play([0, 3, 0], r=1.0)
    array([0., 2., 1.])
    """
    return _hysid.play(_signal(x)[0], r)


def stop(x: Values, r: float) -> np.ndarray:
    """Run a stop: a spring and a slider in series.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    r : float
        Elongation of the spring at which the slider gives way, in the unit of the input; above 0.

    Returns
    -------
    array of shape (n,)
        Elongation of the spring, in the unit of the input.

    Examples
    --------
    >>> hysid.operators.stop([0, 3, 0], r=1.0)
    array([ 0.,  1., -1.])
    """
    return _hysid.stop(_signal(x)[0], r)


def deteriorating_stop(x: Values, r: float, beta: float) -> np.ndarray:
    """Run a stop that wears out by sliding.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    r : float
        Threshold, in the unit of the input; above 0.
    beta : float
        The way that it can slide before it has no strength left, in the unit of the input; above 0.

    Returns
    -------
    array of shape (n,)
        What is left of the stop's elongation, in the unit of the input.

    Examples
    --------
    >>> hysid.operators.deteriorating_stop([0, 3, 0, 3], r=1.0, beta=8.0)
    array([ 0.   ,  0.75 , -0.625,  0.5  ])
    """
    return _hysid.deteriorating_stop(_signal(x)[0], r, beta)


def relaxation(x: Values, time: ArrayLike, tau: float) -> np.ndarray:
    """Run a relaxation element: a spring and a dashpot in series.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    time : array of shape (n,)
        Time stamps, not decreasing.
    tau : float
        Relaxation time, in the unit of time; above 0.

    Returns
    -------
    array of shape (n,)
        Stress, in the unit of the input.

    Examples
    --------
    >>> stress = hysid.operators.relaxation([0, 1, 1], time=[0, 1e-9, 1], tau=1.0)
    >>> bool(abs(stress[2] - np.exp(-1)) < 1e-8)
    True
    """
    values, stamps = _signal(x, time)
    if stamps is None:
        raise ValueError("time: an array is needed")
    return _hysid.relaxation(values, stamps.values, tau)
