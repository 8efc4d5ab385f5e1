"""Dates, times and durations as seconds."""

from __future__ import annotations

from datetime import date, timedelta
from typing import Any

import numpy as np

__all__ = ["are_stamps", "seconds"]

SECOND = np.timedelta64(1, "s")


def are_stamps(values: Any) -> bool:
    """Whether values are dates, times or durations, of NumPy, pandas or Python."""
    kind = getattr(getattr(values, "dtype", None), "kind", None)
    if kind in ("M", "m"):
        return True
    if kind is not None and kind != "O":
        return False
    plain = np.asarray(values)
    if plain.dtype.kind in ("M", "m"):
        return True
    first = next(iter(plain.flat), None) if plain.dtype == object else None
    return isinstance(first, (date, timedelta))


def seconds(values: Any) -> np.ndarray:
    """Stamps as seconds since the first, and durations as seconds.

    Raises
    ------
    ValueError
        A stamp that is missing, or of another kind than the others.
    """
    kind = getattr(getattr(values, "dtype", None), "kind", None)
    if kind in ("M", "m") and hasattr(values, "to_numpy"):
        # Of a time zone, pandas gives the universal time.
        values = values.to_numpy(dtype="datetime64[ns]" if kind == "M" else "timedelta64[ns]")
    stamps = np.asarray(values)
    if stamps.dtype.kind not in ("M", "m"):
        return _of_objects(stamps)
    missing = np.flatnonzero(np.isnat(stamps))
    if len(missing):
        raise ValueError(f"row {missing[0] + 1} has no time stamp")
    if stamps.dtype.kind == "M" and len(stamps):
        # Months and years have no fixed number of seconds; dates have.
        stamps = stamps.astype("datetime64[D]") if np.datetime_data(stamps.dtype)[0] in "YMW" else stamps
        stamps = stamps - stamps[0]
    return np.ascontiguousarray(stamps / SECOND, dtype=np.float64)


def _of_objects(stamps: np.ndarray) -> np.ndarray:
    first = stamps.flat[0]
    durations = stamps if isinstance(first, timedelta) else [stamp - first for stamp in stamps.flat]
    try:
        return np.array([duration.total_seconds() for duration in durations], dtype=np.float64)
    except (AttributeError, TypeError) as error:
        raise ValueError(f"time stamps of different kinds: {error}") from None
