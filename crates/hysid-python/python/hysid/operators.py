"""The operators that models of hysteresis are built from, as functions on arrays.

All start in the virgin state: the input was 0 before the first sample.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hysid import _hysid
from hysid._arguments import real
from hysid._columns import Column
from hysid._data import columns

if TYPE_CHECKING:
    from hysid._data import Values
    import numpy as np
    from numpy.typing import ArrayLike

__all__ = ["deteriorating_stop", "play", "relaxation", "relay", "stop"]


def _signal(x: Any, time: Any = None) -> tuple[np.ndarray, Column | None]:
    taken = columns(x, None, time, None, None)
    if len(taken.records) != 1:
        raise ValueError(f"takes one record, not a list of {len(taken.records)}")
    if len(taken.inputs) != 1:
        raise ValueError(f"takes one input, not {len(taken.inputs)}")
    return taken.inputs[0].values, taken.time


def relay(x: Values, r: float, s: float = 0.0) -> np.ndarray:
    """Simulate a relay: a switch with two thresholds.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    r : float
        Half the distance between the thresholds, in the unit of the input; above 0.
    s : float
        Mean of the thresholds, in the unit of the input.

    Returns
    -------
    array of shape (n,)
        -1 or +1: +1 once the input has passed ``s + r``, -1 once it has passed ``s - r``.

    Examples
    --------
    >>> hysid.operators.relay([-2, 0, 2, 0, -2], r=1.0)
    array([-1., -1.,  1.,  1., -1.])
    """
    return _hysid.relay(_signal(x)[0], real("r", r), real("s", s))


def play(x: Values, r: float) -> np.ndarray:
    """Simulate a play, such as the backlash of gears.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    r : float
        Threshold: half the width of the backlash, in the unit of the input; 0 or more.

    Returns
    -------
    array of shape (n,)
        Position of the driven part, in the unit of the input.

    Examples
    --------
    >>> hysid.operators.play([0, 3, 0], r=1.0)
    array([0., 2., 1.])
    """
    return _hysid.play(_signal(x)[0], real("r", r))


def stop(x: Values, r: float) -> np.ndarray:
    """Simulate a stop: a spring and a friction slider in series.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    r : float
        Threshold: elongation of the spring at which the slider slips, in the unit of the input; above 0.

    Returns
    -------
    array of shape (n,)
        Elongation of the spring, in the unit of the input.

    Examples
    --------
    >>> hysid.operators.stop([0, 3, 0], r=1.0)
    array([ 0.,  1., -1.])
    """
    return _hysid.stop(_signal(x)[0], real("r", r))


def deteriorating_stop(x: Values, r: float, beta: float) -> np.ndarray:
    """Simulate a deteriorating stop, whose strength decreases as it slides.

    Parameters
    ----------
    x : array of shape (n,)
        The input.
    r : float
        Threshold, in the unit of the input; above 0.
    beta : float
        Capacity: the slip after which no strength is left, in the unit of the input; above 0.

    Returns
    -------
    array of shape (n,)
        Output of the stop, in the unit of the input.

    Examples
    --------
    >>> hysid.operators.deteriorating_stop([0, 3, 0, 3], r=1.0, beta=8.0)
    array([ 0.   ,  0.75 , -0.625,  0.5  ])
    """
    return _hysid.deteriorating_stop(_signal(x)[0], real("r", r), real("beta", beta))


def relaxation(x: Values, time: ArrayLike, tau: float) -> np.ndarray:
    """Simulate a relaxation element: a spring and a dashpot in series.

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
    return _hysid.relaxation(values, stamps.values, real("tau", tau))
