"""The restoring force of an element from the measured motion of a mass and the force on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hysid import _hysid
from hysid._arguments import real, whole
from hysid._columns import Column, column_of
from hysid._data import columns

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Values


@dataclass(frozen=True, eq=False)
class RestoringForce:
    """A restoring force and how uncertain it is.

    Attributes
    ----------
    force : array of shape (n,)
        The restoring force; NaN where something was not measured, and with a computed acceleration within half a window
        of the ends of a record.
    velocity : array of shape (n,)
        The velocity relative to the base, as measured or computed.
    deviation : float
        Standard deviation of the force.
    noise : float
        Standard deviation of the noise of the force, in its unit; noise is taken to be independent from row to row.
    smoothing : float
        Smoothing error of the force, in its unit: the root mean square of the part of the motion that the filter of the
        acceleration does not follow, times the mass. An estimate, and 0 for a measured acceleration.
    velocity_filter, acceleration_filter : tuple of int or None
        Degree and window, in rows, of the Savitzky-Golay filter; None for a measured channel.
    """

    force: np.ndarray
    velocity: np.ndarray
    deviation: float
    noise: float
    smoothing: float
    velocity_filter: tuple[int, int] | None
    acceleration_filter: tuple[int, int] | None

    def __repr__(self) -> str:
        share = f", {100 * self.noise / self.deviation:.2g} % noise" if self.deviation > 0 else ""
        return f"<restoring force in {len(self.force)} rows, standard deviation {self.deviation:.4g}{share}>"


def restoring_force(
    displacement: Values,
    time: ArrayLike | str,
    mass: float,
    *,
    force: ArrayLike | str | None = None,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    absolute_acceleration: ArrayLike | None = None,
    base_acceleration: ArrayLike | None = None,
    records: ArrayLike | str | None = None,
    window: int | None = None,
) -> RestoringForce:
    """Compute the restoring force of an element: ``force - mass * (acceleration + base_acceleration)``.

    It is the force with which the element (spring, damper, isolator, column) pulls the mass back, positive for a positive
    displacement of a spring (Masri and Caughey 1979). What is not measured comes from Savitzky-Golay filters. All numbers
    are in consistent units, such as kg, m, s and N.

    Parameters
    ----------
    displacement : array of shape (n,)
        Displacement of the mass relative to the base.
    time : array of shape (n,)
        Time stamps, increasing within each record; steps need not be equal.
    mass : float
        The mass that moves.
    force : array of shape (n,), optional
        Force applied to the mass, positive in the direction of a positive displacement; NaN where it was not measured. None
        is applied by default.
    velocity : array of shape (n,), optional
        Velocity relative to the base; computed from the displacement by default.
    acceleration : array of shape (n,), optional
        Acceleration relative to the base, NaN where it was not measured; computed by default.
    absolute_acceleration : array of shape (n,), optional
        Absolute acceleration in the place of `acceleration`, as an accelerometer on the mass measures it.
    base_acceleration : array of shape (n,), optional
        Acceleration of the base; at rest by default.
    records : array of shape (n,), optional
        A label for each row.
    window : int, optional
        Rows of the window of the filters, an odd number from 5 on; chosen from the data by default.

    Returns
    -------
    RestoringForce
        The force, the velocity and how uncertain the force is.

    Raises
    ------
    ValueError
        Columns of different length, a mass that is not above 0, a window that is even or longer than a record, time that
        does not increase, values that are missing where they are needed.

    Examples
    --------
    >>> import hysid
    >>> import numpy as np
    >>> time = np.arange(500) * 0.01
    >>> displacement = 0.03 * np.cos(10 * time)           # 2 kg on a spring of 200 N/m vibrate freely
    >>> found = hysid.restoring_force(displacement, time, 2.0)
    >>> bool(np.nanmax(np.abs(found.force - 200 * displacement)) < 1e-3)
    True
    """
    if absolute_acceleration is not None and (acceleration is not None or base_acceleration is not None):
        raise ValueError("absolute_acceleration takes the place of acceleration and base_acceleration: give one or the other")
    taken = columns(displacement, force, time, velocity, records)
    if len(taken.inputs) != 1:
        raise ValueError(f"displacement: one column is needed, not {len(taken.inputs)}")
    if taken.time is None:
        raise ValueError("time is needed")
    measured = absolute_acceleration if acceleration is None else acceleration
    channels = [
        taken.time,
        taken.inputs[0],
        taken.rate,
        _channel("acceleration", measured, taken.rows),
        _channel("base_acceleration", base_acceleration, taken.rows),
        taken.output,
    ]
    found, velocity_filter, acceleration_filter, (deviation, noise, smoothing) = _hysid.restoring_force(
        [tuple(None if one is None else one.values[rows] for one in channels) for _, rows in taken.records],
        real("mass", mass),
        absolute_acceleration is not None,
        None if window is None else whole("window", window),
    )
    return RestoringForce(
        force=np.concatenate([force for _, force in found]),
        velocity=np.concatenate([velocity for velocity, _ in found]),
        deviation=deviation,
        noise=noise,
        smoothing=smoothing,
        velocity_filter=velocity_filter,
        acceleration_filter=acceleration_filter,
    )


def _channel(name: str, values: Any, rows: int) -> Column | None:
    """A channel that may be blank."""
    # Only of an output may values be masked.
    column = column_of(values, "output")
    if column is not None and len(column.values) != rows:
        raise ValueError(f"{name}: has {len(column.values)} values where the displacement has {rows}")
    return column
