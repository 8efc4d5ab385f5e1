"""The category of all warnings of the package."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable


class HysidWarning(UserWarning):
    """Something to know that is no error: each says what, why, and what helps."""


def warn(texts: Iterable[str]) -> None:
    """Warn of each, as of the line outside of this package that called it."""
    frame = sys._getframe()
    level = 1
    while frame.f_back is not None and frame.f_globals.get("__name__", "").split(".")[0] == "hysid":
        frame = frame.f_back
        level += 1
    for text in texts:
        warnings.warn(text, HysidWarning, stacklevel=level)
