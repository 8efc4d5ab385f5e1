"""Minimisation of functions that need not be smooth."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hysid import _hysid
from hysid._arguments import real, whole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Minimum:
    """The lowest point found.

    Attributes
    ----------
    x : array of shape (n,)
        The point.
    value : float
        Value of the function at the point.
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
        Takes an array of shape (n,); returns the value and a sub-gradient of shape (n,) there.
    x : array of shape (n,)
        Starting point.
    dilation : str
        Direction of the space dilatation: ``"difference"`` of two successive sub-gradients (the r-algorithm), or
        the ``"subgradient"`` itself.
    coefficient : float
        Coefficient of the space dilatation; above 1, usually 2 to 4.
    first_step : float
        First step; choose about the distance to the minimum.
    shrinkage : float
        Factor of the step size after an iteration with one inner step; 1 for a function that is not smooth.
    growth : float
        Factor of the step size at every third inner step.
    lower_bound : float
        Lower bound of the function, for ``"subgradient"``.
    iterations : int
        Maximum number of outer iterations.
    target : float
        Stop at this value of the function.
    stall : int
        Stop after this number of iterations without a relative decrease of 1e-4; 0 for never.

    Returns
    -------
    Minimum
        The lowest point found.

    Raises
    ------
    ValueError
        An invalid option.

    Examples
    --------
    >>> def kinked(x):
    ...     return abs(x[0] - 3) + 100 * abs(x[1] + 1), [np.sign(x[0] - 3), 100 * np.sign(x[1] + 1)]
    >>> minimum = hysid.minimise(kinked, [0.0, 0.0], iterations=200, target=1e-9)
    >>> bool(np.allclose(minimum.x, [3, -1], atol=1e-8))
    True
    """
    if dilation not in ("difference", "subgradient"):
        raise ValueError(f"dilation {dilation!r}: choose 'difference' or 'subgradient'")
    numbers = {
        "coefficient": coefficient,
        "first_step": first_step,
        "shrinkage": shrinkage,
        "growth": growth,
        "lower_bound": lower_bound,
    }
    options = {"dilation": dilation, **{name: _finite(name, value) for name, value in numbers.items()}}
    start = np.array(x, dtype=np.float64, ndmin=1)
    if start.ndim != 1:
        raise ValueError(f"x: a one-dimensional array is needed, not one of {start.ndim} dimensions")
    return Minimum(
        *_hysid.minimise(
            lambda at: _value_and_slope(function(at)),
            start,
            json.dumps(options),
            whole("iterations", iterations),
            real("target", target),
            whole("stall", stall),
        )
    )


def _finite(name: str, value: float) -> float:
    number = real(name, value)
    if not math.isfinite(number):
        raise ValueError(f"{name} {number}: a finite number is needed")
    return number


def _value_and_slope(returned: Any) -> tuple[float, np.ndarray]:
    """Value and sub-gradient, as the native module takes them."""
    try:
        value, slope = returned
        number, slopes = float(value), np.ascontiguousarray(slope, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"function: must return a number and an array, not {returned!r}") from None
    if slopes.ndim != 1:
        raise ValueError(f"function: a sub-gradient of one dimension is needed, not of {slopes.ndim}")
    return number, slopes
