"""Tables of what engineers read from hysteresis loops."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hysid import _hysid
from hysid._arguments import fraction, name_of, real, truth, whole
from hysid._data import columns
from hysid._warning import warn

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Columns, Values


FIRST = ("record", "cycle", "first_row", "last_row", "complete")
LAST = ("backbone_peak", "backbone_valley", "notes")

BACKBONE = ("record", "row", "direction", "input", "output")
LOSSES = (
    "amplitude",
    "output_amplitude",
    "frequency",
    "energy",
    "power",
    "power_per_mass",
    "hysteresis",
    "eddy",
    "excess",
    "cycles",
)
LEVELS = ("record", "level", "cycles")
FIGURES = ("record", "of", "name", "symbol", "value", "deviation", "low", "high", "source", "note")
NODES = ("reversal_input", "input", "output", "everett", "density", "density_deviation")


@dataclass(frozen=True, eq=False)
class Cycles(Mapping[str, np.ndarray]):
    """Cycles in figures: a mapping from the name of a column to an array with a value for each cycle.

    The columns are ``record``, ``cycle``, ``first_row`` and ``last_row`` (counted from 0 in the record), ``complete``, the
    figures that docs/cycles.md defines, such as ``energy``, and ``backbone_peak``, ``backbone_valley`` and ``notes``. A
    figure that the data do not give, or that another field reads, is NaN.

    Attributes
    ----------
    field : str
        The field of engineering: ``"structure"``, ``"magnet"``, ``"actuator"``, ``"thermal"``, ``"battery"``,
        ``"hydrology"`` or ``"general"``.
    division : str
        Where cycles begin: ``"zero"``, ``"mean"``, ``"reversals"`` or ``"start"``.
    rows : dict of arrays
        The columns.
    backbone : dict of arrays
        The turning points of the first cycle of each amplitude: record, row, direction, input, output.
    levels : dict of arrays
        The amplitude levels of structures: record, level, number of cycles, and the figures of docs/cycles.md, such as
        strength_loss_percent.
    figures : dict of arrays
        Figures of whole records, such as ductility: record, the part that each is of, name, symbol, value, deviation,
        low and high end of the 95 % interval, source, and a note.
    losses : dict of arrays
        Means by amplitude and frequency: amplitude, output_amplitude, frequency, energy, power, the separated parts
        hysteresis, eddy and excess of the energy, and the number of cycles.
    reversal_curves : dict of arrays or None
        The nodes of first-order reversal curves, if there are any: reversal_input, input, output, everett, density,
        density_deviation.
    smoothing_factor : int or None
        The smoothing factor of their density.
    notes : list of str
        What concerns the whole table.
    """

    field: str
    division: str
    rows: dict[str, np.ndarray]
    backbone: dict[str, np.ndarray]
    levels: dict[str, np.ndarray]
    figures: dict[str, np.ndarray]
    losses: dict[str, np.ndarray]
    reversal_curves: dict[str, np.ndarray] | None
    smoothing_factor: int | None
    notes: list[str]

    @classmethod
    def _of(cls, text: str) -> Cycles:
        told = json.loads(text)
        table, curves = told["table"], told["reversal_curves"]
        warn(told["changes"])
        cycles = [
            {**row, "first_row": row["rows"][0], "last_row": row["rows"][1], "notes": "; ".join(row["notes"])}
            for row in table["cycles"]
        ]
        figures = [
            {**figure, "low": low, "high": high}
            for figure in table["figures"]
            for low, high in [figure["interval"] or (None, None)]
        ]
        return cls(
            field=table["field"],
            division=table["division"],
            rows=_arrays(cycles, (*FIRST, *_hysid.figure_names(), *LAST)),
            backbone=_arrays(table["backbone"], BACKBONE),
            levels=_arrays(table["levels"], (*LEVELS, *_hysid.level_figure_names())),
            figures=_arrays(figures, FIGURES),
            losses=_arrays(table["losses"], LOSSES),
            reversal_curves=_arrays(curves["nodes"], NODES) if curves else None,
            smoothing_factor=curves["smoothing_factor"] if curves else None,
            notes=table["notes"],
        )

    def __getitem__(self, name: str) -> np.ndarray:
        return self.rows[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        complete = int(self.rows["complete"].sum())
        parts = len(self.rows["complete"]) - complete
        curves = ", with first-order reversal curves" if self.reversal_curves else ""
        return f"<{complete} cycles and {parts} incomplete parts, {self.field}, from {self.division}{curves}>"

    def to_frame(self) -> Any:
        """Give the cycles as a pandas table.

        Returns
        -------
        pandas.DataFrame
            A row for each cycle.
        """
        import pandas

        return pandas.DataFrame(self.rows)


def _arrays(rows: list[dict[str, Any]], names: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Columns of rows; None is NaN."""
    whole_numbers = {"cycle", "first_row", "last_row", "row", "cycles", "level"}
    truths = {"complete", "backbone_peak", "backbone_valley"}
    texts = {"record", "direction", "notes", "of", "name", "symbol", "source", "note"}

    def column(name: str) -> np.ndarray:
        values = [row[name] for row in rows]
        if name in texts:
            return np.array(values, dtype=object)
        if name in truths:
            return np.array(values, dtype=bool)
        if name in whole_numbers:
            return np.array(values, dtype=np.int64)
        return np.array([np.nan if value is None else value for value in values], dtype=np.float64)

    return {name: column(name) for name in names}


def named_options(
    division: str | None, field: str | None, smoothing_factor: int | None
) -> tuple[str | None, str | None, int | None]:
    """Arguments of the native module."""
    factor = None if smoothing_factor is None else whole("smoothing_factor", smoothing_factor, 1, 10)
    return name_of("division", division), name_of("field", field), factor


def cycles(
    x: Values,
    y: Values | str,
    time: ArrayLike | str | None = None,
    records: ArrayLike | str | None = None,
    *,
    division: str | None = None,
    field: str | None = None,
    smallest_reversal: float | None = None,
    smoothing: bool = True,
    smoothing_factor: int | None = None,
    smoothing_growth: float = 0.0,
    density: float | None = None,
    height: float | None = None,
) -> Cycles:
    """Read the figures of each cycle in measured data: energy, damping, stiffness, coercive field, losses, width, creep.

    Parameters
    ----------
    x : array of shape (n,) or (n, inputs)
        The inputs in the user's units; the loops are those of the output over the first input.
    y : array of shape (n,)
        The measured output; NaN for no measurement.
    time : array of shape (n,), optional
        Time stamps, increasing within each record.
    records : array of shape (n,), optional
        A label for each row.
    division : str, optional
        Where cycles begin: ``"zero"``, ``"mean"``, ``"reversals"`` or ``"start"``; as suits the data by default.
    field : str, optional
        What is read: ``"structure"``, ``"magnet"``, ``"actuator"``, ``"thermal"``, ``"battery"``, ``"hydrology"`` or
        ``"general"``; by default as names and units of pandas objects indicate.
    smallest_reversal : float, optional
        Reversals of the input below this share of its range are ignored; by default the noise of the input decides.
    smoothing : bool
        Smooth branches before outputs are read from them.
    smoothing_factor : int, optional
        Smoothing factor of the density of first-order reversal curves, 1 to 10; chosen by the noise by default.
    smoothing_growth : float
        Growth of the smoothing factor in each step away from the ridges of a FORC diagram, 0 to 1.
    density : float, optional
        Mass density in kg/m³, for losses of magnets per mass.
    height : float, optional
        Height of a structure in the unit of x, for the drift ratios of its levels.

    Returns
    -------
    Cycles
        A column for each figure, and first-order reversal curves if the data have them.

    Raises
    ------
    ValueError
        Data without loops, or an unknown name.

    Examples
    --------
    >>> import hysid
    >>> import numpy as np
    >>> x = 3 * np.sin(np.linspace(0, 6 * np.pi, 3001))
    >>> table = hysid.cycles(x, hysid.operators.stop(x, 1.0), field="structure")
    >>> table["energy"].round(2)
    array([7.5, 8. , 8. ])
    >>> table["residual_after_peak"].round(2)
    array([2., 2., 2.])
    """
    if smallest_reversal is not None:
        smallest_reversal = fraction("smallest_reversal", smallest_reversal)
    smoothing = truth("smoothing", smoothing)
    options = named_options(division, field, smoothing_factor)
    arranged = columns(x, y, time, None, records)
    if not 0 <= (smoothing_growth := real("smoothing_growth", smoothing_growth)) <= 1:
        raise ValueError(f"smoothing_growth: a number from 0 to 1 is needed, not {smoothing_growth}")
    return cycles_of(
        arranged,
        *options,
        smallest_reversal=smallest_reversal,
        smoothing=smoothing,
        smoothing_growth=smoothing_growth,
        density=above_zero("density", density),
        height=above_zero("height", height),
    )


def above_zero(name: str, value: float | None) -> float | None:
    """A number above 0 that is given, checked."""
    if value is not None and not (value := real(name, value)) > 0:
        raise ValueError(f"{name}: a number above 0 is needed, not {value}")
    return value


def cycles_of(
    arranged: Columns,
    division: str | None = None,
    field: str | None = None,
    smoothing_factor: int | None = None,
    *,
    smallest_reversal: float | None = None,
    smoothing: bool = True,
    smoothing_growth: float = 0.0,
    density: float | None = None,
    height: float | None = None,
) -> Cycles:
    """The figures of each cycle in columns; arguments as of `cycles`."""
    options = (division, field, smoothing_factor)
    rest = (*options, smoothing_growth, density, height)
    data = arranged.dataset()
    warn(data.value_warnings())
    return Cycles._of(_hysid.cycles(data, smallest_reversal, smoothing, *rest))
