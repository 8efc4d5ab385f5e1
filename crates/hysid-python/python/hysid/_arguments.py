"""Checks of arguments, with errors in the words of Python: the native module speaks of its own types."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np

__all__ = ["real", "truth", "whole"]

LARGEST = 2**64 - 1
"""The largest whole number that the native module takes."""


def real(name: str, value: Any) -> float:
    """A number as a float.

    Raises
    ------
    TypeError
        Something else, also text with a number.
    """
    if not isinstance(value, (str, bytes)):
        try:
            return float(value)
        except (TypeError, ValueError):
            pass
    raise TypeError(f"{name} {value!r}: a number is needed")


def fraction(name: str, value: Any) -> float:
    """A number above 0 and below 1.

    Raises
    ------
    TypeError
        Something else.
    ValueError
        A number outside these bounds.
    """
    number = real(name, value)
    if not 0.0 < number < 1.0:
        raise ValueError(f"{name} {number}: a number between 0 and 1 is needed")
    return number


def pair(name: str, value: Any) -> tuple[float, float]:
    """Two numbers as floats.

    Raises
    ------
    TypeError
        Something else.
    """
    try:
        low, high = value
    except (TypeError, ValueError):
        raise TypeError(f"{name} {value!r}: two numbers are needed") from None
    return real(name, low), real(name, high)


def whole(name: str, value: Any, low: int = 0, high: int = LARGEST) -> int:
    """A whole number within bounds.

    Raises
    ------
    TypeError
        Something else, such as a number with decimals.
    ValueError
        A number outside the bounds.
    """
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} {value!r}: a whole number is needed") from None
    if not low <= number <= high:
        bounds = f"{low} or more" if high == LARGEST else f"{low} to {high}"
        raise ValueError(f"{name} {number}: choose {bounds}")
    return number


def truth(name: str, value: Any) -> bool:
    """True or False.

    Raises
    ------
    TypeError
        Something else.
    """
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} {value!r}: True or False is needed")
    return bool(value)


def name_of(what: str, value: Any) -> str | None:
    """A name, or None.

    Raises
    ------
    TypeError
        Something else.
    """
    if value is not None and not isinstance(value, str):
        raise TypeError(f"{what} {value!r}: a name is needed")
    return value
