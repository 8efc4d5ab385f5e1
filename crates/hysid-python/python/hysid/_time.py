"""Dates, times, durations and ISO 8601 text as seconds."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date, timedelta
from typing import Any

import numpy as np

__all__ = ["are_stamps", "seconds"]

SECOND = np.timedelta64(1, "s")

ISO = re.compile(r"(\d{4}-\d\d-\d\d)(?:[T ](\d\d:\d\d(?::\d\d)?)(?:[.,](\d+))?\s*(Z|[+-]\d\d(?::?\d\d)?)?)?")
"""Date, time, decimals of the second, and time zone."""


def are_stamps(values: Any) -> bool:
    """Whether values are dates, times or durations, of NumPy, pandas or Python, or text that begins with an ISO 8601 date."""
    kind = getattr(getattr(values, "dtype", None), "kind", None)
    if kind in ("M", "m"):
        return True
    if kind is not None and kind not in "OUT":
        return False
    plain = np.asarray(values)
    if plain.dtype.kind in ("M", "m"):
        return True
    first = next(iter(plain.flat), None) if plain.dtype.kind in "OUT" else None
    return isinstance(first, (date, timedelta)) or isinstance(first, str) and ISO.match(first.strip()) is not None


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
        flat = list(stamps.flat)
        return _of_text(flat) if isinstance(flat[0], str) else _of_objects(flat)
    missing = np.flatnonzero(np.isnat(stamps))
    if len(missing):
        raise ValueError(f"row {missing[0] + 1} has no time stamp")
    if stamps.dtype.kind == "M" and len(stamps):
        # Months and years have no fixed number of seconds; dates have.
        stamps = stamps.astype("datetime64[D]") if np.datetime_data(stamps.dtype)[0] in "YMW" else stamps
        stamps = stamps - stamps[0]
    return np.ascontiguousarray(stamps / SECOND, dtype=np.float64)


def _of_text(stamps: Sequence[Any]) -> np.ndarray:
    """Whole seconds and decimals apart, so that no digit is lost."""
    whole, decimals, zoned = [], [], []
    for row, stamp in enumerate(map(_plain, stamps), 1):
        found = ISO.fullmatch(stamp.strip()) if isinstance(stamp, str) else None
        if found is None:
            raise ValueError(f"row {row}: {stamp!r} is no time of ISO 8601, such as 2024-05-31T12:00:00.25")
        day, clock, digits, zone = found.groups()
        try:
            time = np.datetime64(f"{day}T{clock or '00:00'}", "s")
        except ValueError as error:
            raise ValueError(f"row {row}: {stamp!r}: {error}") from None
        if zone not in (None, "Z"):
            minutes = 60 * int(zone[1:3]) + int(zone[3:].lstrip(":") or 0)
            time -= np.timedelta64(minutes if zone[0] == "+" else -minutes, "m")
        whole.append(time)
        decimals.append(float(f"0.{digits or 0}"))
        zoned.append(zone is not None)
    if any(zoned) and not all(zoned):
        raise ValueError(f"row {zoned.index(not zoned[0]) + 1}: some times have a time zone and others have none")
    since = (np.array(whole) - whole[0]) / SECOND
    return np.ascontiguousarray(since + (np.array(decimals) - decimals[0]), dtype=np.float64)


def _plain(stamp: Any) -> Any:
    """Text of NumPy as that of Python."""
    return str(stamp) if isinstance(stamp, str) else stamp


def _of_objects(stamps: Sequence[Any]) -> np.ndarray:
    durations = stamps if isinstance(stamps[0], timedelta) else [stamp - stamps[0] for stamp in stamps]
    try:
        return np.array([duration.total_seconds() for duration in durations], dtype=np.float64)
    except (AttributeError, TypeError) as error:
        raise ValueError(f"time stamps of different kinds: {error}") from None
