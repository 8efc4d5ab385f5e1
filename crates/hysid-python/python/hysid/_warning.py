"""The category of all warnings of this package."""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Iterable, Iterator
from types import FrameType
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np


class HysidWarning(UserWarning):
    """A warning of Hysid: it says what is wrong, why, and what helps."""


_warned: WeakKeyDictionary[Any, set[str]] = WeakKeyDictionary()
"""Warnings of each cross-validation of scikit-learn that runs, without their numbers and names."""

_VARYING = re.compile(r'"[^"]*"|[-+]?\d[\d.,]*(?:e[-+]?\d+)?')


def warn(texts: Iterable[str]) -> None:
    """Warn of each text, at the caller's line outside of this package; in a cross-validation of scikit-learn, once of a text
    that differs from fold to fold only in numbers and names."""
    texts = list(texts)
    if not texts:
        return
    frame = sys._getframe()
    level = 1
    while frame.f_back is not None and frame.f_globals.get("__name__", "").split(".")[0] == "hysid":
        frame = frame.f_back
        level += 1
    validation = _cross_validation(frame)
    known = set() if validation is None else _warned.setdefault(validation, set())
    for text in texts:
        kind = _VARYING.sub("#", text)
        if validation is None or kind not in known:
            warnings.warn(text, HysidWarning, stacklevel=level)
        known.add(kind)


def _cross_validation(frame: FrameType | None) -> Any:
    """An object that lives as long as the outermost cross-validation of scikit-learn above a frame; None without one."""
    found = None
    for found in _of_scikit_learn(frame, "parallel"):
        pass
    return found


def training_rows(count: int) -> np.ndarray | None:
    """The rows that the innermost cross-validation of scikit-learn fits to, as their places in its data; None without one, or
    if these are not so many."""
    rows = np.asarray(next(_of_scikit_learn(sys._getframe(), "train"), []))
    return rows if rows.dtype.kind in "iu" and rows.shape == (count,) else None


def _of_scikit_learn(frame: FrameType | None, name: str) -> Iterator[Any]:
    """Variables of this name in the frames of scikit-learn's model selection, the innermost first."""
    while frame is not None:
        if frame.f_globals.get("__name__", "").startswith("sklearn.model_selection."):
            found = frame.f_locals.get(name)
            if found is not None:
                yield found
        frame = frame.f_back
