"""The minimiser of functions that need not be smooth."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hysid import _hysid

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Minimum:
    """The lowest point found.

    Attributes
    ----------
    x : array of shape (n,)
        Where it is.
    value : float
        The function there.
    iterations, evaluations : int
        Outer iterations, and evaluations of the function.
    termination : str
        Why the search ended, in words.
    """

    x: np.ndarray
    value: float
    iterations: int
    evaluations: int
    termination: str


def minimise(
    function: Callable[[np.ndarray], tuple[float, ArrayLike]],
    x: ArrayLike,
    *,
    dilation: str = "difference",
    coefficient: float = 2.5,
    first_step: float = 1.0,
    shrinkage: float = 1.0,
    growth: float = 1.1,
    lower_bound: float = 0.0,
    iterations: int = 2000,
    target: float = -np.inf,
    stall: int = 0,
) -> Minimum:
    """Minimise a function that need not be smooth, by the sub-gradient method with space dilatation.

    Parameters
    ----------
    function : callable
        Takes an array of shape (n,), gives the value and a sub-gradient of shape (n,) there.
    x : array of shape (n,)
        Where to begin.
    dilation : str
        Along what the space is dilated: ``"difference"`` of two successive sub-gradients (the r-algorithm), or
        the ``"subgradient"`` itself.
    coefficient : float
        By which the space is dilated; above 1, usually 2 to 4.
    first_step : float
        About the distance to the minimum.
    shrinkage : float
        By which the step is multiplied when one inner step was enough: 1 for a function that is not smooth.
    growth : float
        By which the step is multiplied at every third inner step.
    lower_bound : float
        A value that the function does not fall below, for ``"subgradient"``.
    iterations : int
        Most outer iterations.
    target : float
        A value that is low enough.
    stall : int
        Iterations in a row without a relative fall of 1e-4 that end it; 0 for no such rule.

    Returns
    -------
    Minimum
        The lowest point found.

    Raises
    ------
    ValueError
        A setting outside its meaning.

    Examples
    --------
    >>> def kinked(x):
    ...     return abs(x[0] - 3) + 100 * abs(x[1] + 1), [np.sign(x[0] - 3), 100 * np.sign(x[1] + 1)]
    >>> minimum = hysid.minimise(kinked, [0.0, 0.0], iterations=200, target=1e-9)
    >>> bool(np.allclose(minimum.x, [3, -1], atol=1e-8))
    True
    """
    options = {
        "dilation": dilation,
        "coefficient": float(coefficient),
        "first_step": float(first_step),
        "shrinkage": float(shrinkage),
        "growth": float(growth),
        "lower_bound": float(lower_bound),
    }
    start = np.array(x, dtype=np.float64, ndmin=1)

    def value(at: np.ndarray) -> tuple[float, np.ndarray]:
        answer, slope = function(at)
        return float(answer), np.ascontiguousarray(slope, dtype=np.float64)

    if iterations < 0 or stall < 0:
        raise ValueError("iterations and stall must not be below 0")
    return Minimum(*_hysid.minimise(value, start, json.dumps(options), iterations, target, stall))
