"""The category of all warnings of this package."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable


class HysidWarning(UserWarning):
    """A warning of Hysid: it says what is wrong, why, and what helps."""


def warn(texts: Iterable[str]) -> None:
    """Warn of each text, at the caller's line outside of this package."""
    frame = sys._getframe()
    level = 1
    while frame.f_back is not None and frame.f_globals.get("__name__", "").split(".")[0] == "hysid":
        frame = frame.f_back
        level += 1
    for text in texts:
        warnings.warn(text, HysidWarning, stacklevel=level)
