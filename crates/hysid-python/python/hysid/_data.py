"""From arrays, tables and lists of records to columns with names, and to records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike

from hysid import _hysid
from hysid._columns import Column, column_of, inputs_of
from hysid._tables import is_frame, is_of_pandas, like, named_columns, row_labels
from hysid._warning import warn

Values: TypeAlias = Union[ArrayLike, Mapping[str, ArrayLike]]
"""Numbers, or columns by their names, or a list with these of each record; objects of pandas, polars and xarray are among
the first."""

RECORD = "data"
"""Name of the record if `records` is not given."""


class Columns(NamedTuple):
    """All measured columns, and the rows of each record."""

    inputs: list[Column]
    time: Column | None
    rate: Column | None
    output: Column | None
    records: list[tuple[str, slice]]
    weights: np.ndarray | None = None
    """Of each row in the sum of squares that a fit minimises."""

    @property
    def rows(self) -> int:
        return len(self.inputs[0].values)

    def dataset(self) -> _hysid.Dataset:
        """As the native module takes it; without an output, all of it is blank."""
        blank = np.full(self.rows, np.nan)
        output = self.output.values if self.output else blank
        return _hysid.Dataset(
            (
                (self.time.name or "t") if self.time else None,
                self._input_names(),
                (self.rate.name or "rate") if self.rate else None,
                (self.output.name if self.output else None) or "y",
            ),
            [
                (
                    name,
                    self.time.values[rows] if self.time else None,
                    [column.values[rows] for column in self.inputs],
                    self.rate.values[rows] if self.rate else None,
                    output[rows],
                )
                for name, rows in self.records
            ],
            None if self.weights is None else [self.weights[rows] for _, rows in self.records],
        )

    def names(self) -> list[str | None]:
        """The names of all columns: inputs, output, time, rate."""
        others = (self.output, self.time, self.rate)
        return [column.name for column in self.inputs] + [column.name for column in others if column is not None]

    def _input_names(self) -> list[str]:
        if len(self.inputs) == 1:
            return [self.inputs[0].name or "x"]
        return [column.name or f"x{place + 1}" for place, column in enumerate(self.inputs)]


def weighted(arranged: Columns, weights: Any) -> Columns:
    """The columns with a weight of each row; a row with the weight 0 loses its output.

    Weights that are all alike change nothing, so that every model takes them.
    """
    if weights is None or arranged.output is None:
        return arranged
    parts = weights if is_record_list(weights) else [weights]
    try:
        found = np.concatenate([np.asarray(part, dtype=np.float64) for part in parts])
    except (TypeError, ValueError):
        raise ValueError("sample_weight: a number for each row is needed") from None
    if found.shape != (arranged.rows,):
        raise ValueError(f"sample_weight: one weight for each of the {arranged.rows} rows is needed, not {found.shape}")
    if not np.isfinite(found).all() or (found < 0).any():
        row = int(np.flatnonzero(~np.isfinite(found) | (found < 0))[0])
        raise ValueError(f"sample_weight: row {row + 1} has {found[row]}: a finite number, 0 or above, is needed")
    counted = found > 0
    output = arranged.output._replace(values=np.where(counted, arranged.output.values, np.nan))
    used = found[counted & ~np.isnan(arranged.output.values)]
    if len(used) == 0:
        raise ValueError("sample_weight: the weights of all rows with an output are zero")
    if used.min() == used.max():
        return arranged._replace(output=output)
    return arranged._replace(output=output, weights=np.where(counted, found, 1.0))


def in_units_of(arranged: Columns, trained: Mapping[str, Any]) -> Columns:
    """The columns in the units of the training data, with a warning for each conversion.

    A column is converted if its name and that in `trained` contain units. `trained` maps ``time``, ``inputs``, ``rate`` and
    ``output`` to the names of the training data.
    """
    notes: list[str] = []

    def one(column: Column | None, name: str | None) -> Column | None:
        if column is None or column.name is None or name is None:
            return column
        factor = _hysid.unit_factor(column.name, name)
        if factor is None:
            return column
        notes.append(f"{column.name} is converted to the unit of the model's {name} (factor {factor:.6g})")
        return Column(factor * column.values, name)

    pairs = zip(arranged.inputs, trained["inputs"])
    converted = [one(column, name) or column for column, name in pairs]
    result = arranged._replace(
        inputs=[*converted, *arranged.inputs[len(converted) :]],
        time=one(arranged.time, trained["time"]),
        rate=one(arranged.rate, trained["rate"]),
        output=one(arranged.output, trained["output"]),
    )
    warn(notes)
    return result


def columns(x: Any, y: Any, time: Any, rate: Any, records: Any, inputs: Sequence[str] = ()) -> Columns:
    """Splits the arguments into columns, and refuses columns of different length.

    Of a table that has more columns than `inputs`, those of these names are taken if it has them all.
    """
    if is_record_list(x):
        return _of_list(x, {"y": y, "time": time, "rate": rate}, records, inputs)
    for what, values in (("y", y), ("time", time), ("rate", rate)):
        if is_record_list(values):
            raise ValueError(f"{what} is a list of records, and x is not: give x as a list of as many arrays")
    return _of_table(x, y, time, rate, records, inputs)


def outputs_of(x: Any, y: Any) -> tuple[Any, dict[str, Any]] | None:
    """`x` without the outputs, and each output by its name, as `columns` takes it; None if `y` is one output.

    Several outputs are a table or an array with several columns, a list of names of columns of `x`, or for a list of records
    a list of these.
    """
    if not is_record_list(x):
        return _outputs_of_table(x, y)
    each = [y] * len(x) if _are_names(y) else _for_each("y", y, len(x))
    found = [_outputs_of_table(table, outputs) for table, outputs in zip(x, each)]
    several = [one for one in found if one is not None]
    if not several:
        return None
    names = list(several[0][1])
    if len(several) < len(found) or any(list(outputs) != names for _, outputs in several):
        raise ValueError("y: all records need the same outputs")
    return [table for table, _ in several], {name: [outputs[name] for _, outputs in several] for name in names}


def _are_names(y: Any) -> bool:
    return isinstance(y, (list, tuple)) and len(y) > 0 and all(isinstance(name, str) for name in y)


def _outputs_of_table(x: Any, y: Any) -> tuple[Any, dict[str, Any]] | None:
    named = named_columns(y)
    if _are_names(y):
        names = list(y)
        x, outputs = _taken_by_name(x, {f"y[{place}]": name for place, name in enumerate(y)})
    elif named is not None:
        names, outputs = [name for name, _ in named], [{name: column} for name, column in named]
    else:
        is_nested = isinstance(y, (list, tuple)) and len(y) > 0 and isinstance(y[0], (list, tuple))
        values = np.asarray(y, dtype=np.float64) if is_nested else y
        count = values.shape[1] if len(getattr(values, "shape", ())) == 2 else 1
        names = [f"y{place + 1}" for place in range(count)]
        outputs = [{name: values[:, place]} for place, name in enumerate(names)] if count > 1 else [y]
    if len(set(names)) < len(names):
        raise ValueError(f"y: the names of the outputs {', '.join(names)} are not all different")
    return (x, dict(zip(names, outputs))) if len(names) > 1 or _are_names(y) else None


def is_record_list(values: Any) -> bool:
    """Whether values are a list of arrays, tables or mappings, one of each record. A list of lists is a table."""
    return (
        isinstance(values, (list, tuple))
        and len(values) > 0
        and all(isinstance(one, Mapping) or len(getattr(one, "shape", ())) >= 1 for one in values)
    )


def shaped_like(x: Any, values: np.ndarray, column: str, suffix: str = "") -> Any:
    """Values as `x` is: an array, a Series or DataArray with its rows, or a list of these."""
    if not is_record_list(x):
        return like(x, values, column, suffix)
    ends = np.cumsum([_rows(one) for one in x])
    return [like(one, part, column, suffix) for one, part in zip(x, np.split(values, ends[:-1]))]


def continued(before: Columns, after: Columns) -> tuple[Columns, np.ndarray]:
    """Each record that continues one of the same name in time, with the rows of that one before its own; and which rows are
    its own."""
    assert before.time is not None and after.time is not None
    known = dict(before.records)
    chosen: list[tuple[Columns, slice]] = []
    records = []
    own = []
    rows_so_far = 0
    for name, rows in after.records:
        parts = [(after, rows)]
        begun = known.get(name)
        if begun is not None and before.time.values[begun][-1] < after.time.values[rows][0]:
            parts.insert(0, (before, begun))
        for columns, some in parts:
            chosen.append((columns, some))
            own.append(np.full(some.stop - some.start, columns is after))
        count = sum(some.stop - some.start for _, some in parts)
        records.append((name, slice(rows_so_far, rows_so_far + count)))
        rows_so_far += count
    inputs = [
        Column(np.concatenate([columns.inputs[place].values[rows] for columns, rows in chosen]), column.name)
        for place, column in enumerate(after.inputs)
    ]
    times = np.concatenate([columns.time.values[rows] for columns, rows in chosen if columns.time is not None])
    return Columns(inputs, Column(times, after.time.name), None, None, records), np.concatenate(own)


def _rows(x: Any) -> int:
    return len(next(iter(x.values()))) if isinstance(x, Mapping) else len(x)


def _of_list(x: Sequence[Any], others: dict[str, Any], records: Any, inputs: Sequence[str]) -> Columns:
    """The columns of a list of records, one after the other."""
    names = _record_names(records, len(x))
    given = [_for_each(what, values, len(x)) for what, values in others.items()]
    parts: list[Columns] = []
    for name, one, y, time, rate in zip(names, x, *given):
        part = _of_table(one, y, time, rate, None, inputs, name)
        if parts and part.names() != parts[0].names():
            raise ValueError(
                f'record "{name}" has the columns {_listed(part)}, and record "{names[0]}" has {_listed(parts[0])}: '
                "give them the same names"
            )
        parts.append(part)
    ends = np.cumsum([part.rows for part in parts]).tolist()

    def joined(columns: Sequence[Column | None]) -> Column | None:
        present = [column for column in columns if column is not None]
        return Column(np.concatenate([column.values for column in present]), present[0].name) if present else None

    return Columns(
        [one for columns in zip(*(part.inputs for part in parts)) if (one := joined(columns)) is not None],
        joined([part.time for part in parts]),
        joined([part.rate for part in parts]),
        joined([part.output for part in parts]),
        [(name, slice(end - part.rows, end)) for name, part, end in zip(names, parts, ends)],
    )


def _for_each(what: str, values: Any, count: int) -> Sequence[Any]:
    """An argument of each record; a name of a column is the same for all."""
    if values is None or isinstance(values, str):
        return [values] * count
    if not isinstance(values, (list, tuple)) or len(values) != count:
        raise ValueError(f"{what}: x is a list of {count} records, so a list of {count} arrays is needed")
    if any(one is None for one in values):
        raise ValueError(f"{what}: it is missing in record {[one is None for one in values].index(True) + 1}")
    return values


def _record_names(records: Any, count: int) -> list[str]:
    if records is None:
        return [str(place + 1) for place in range(count)]
    names = [str(name) for name in records] if isinstance(records, (list, tuple)) else []
    if len(names) != count or len(set(names)) != count:
        raise ValueError(f"records: x is a list of {count} records, so a list of {count} different names is needed")
    return names


def _listed(part: Columns) -> str:
    return ", ".join(name or "(unnamed)" for name in part.names())


def _of_table(
    x: Any, y: Any, time: Any, rate: Any, records: Any, inputs: Sequence[str], name: str = RECORD
) -> Columns:
    """The columns of one array or table, with a label for each row or without any."""
    table = x
    if records is None:
        records = _record_column(x, inputs)
    x, (y, time, records) = _taken_by_name(x, {"y": y, "time": time, "records": records})
    given = {"x": x, "y": y, "time": time, "rate": rate, "records": records}
    check_indexes(given)
    found = inputs_of(x, inputs)
    arranged = Columns(
        found,
        column_of(time, "time"),
        column_of(rate, "rate"),
        column_of(y, "output"),
        _records(records, len(found[0].values), name),
    )
    for what, column in (("time", arranged.time), ("rate", arranged.rate), ("output", arranged.output)):
        if column is not None and len(column.values) != arranged.rows:
            raise ValueError(
                f'record "{name}", {what}: has {len(column.values)} values '
                f"where the first input has {arranged.rows}"
            )
    warn_of_order(table, [rows for _, rows in arranged.records])
    return arranged


def _record_column(x: Any, inputs: Sequence[str]) -> str | None:
    """The column `record` of a table, as in files, unless it is an input."""
    names = [name for name, _ in named_columns(x) or []]
    found = [name for name in names if name.lower() == "record" and name not in inputs]
    return found[0] if len(names) > 1 and len(found) == 1 else None


def _taken_by_name(x: Any, others: dict[str, Any]) -> tuple[Any, list[Any]]:
    """`x` without the columns that are given by name, and these columns."""
    named = {what: name for what, name in others.items() if isinstance(name, str)}
    if not named:
        return x, list(others.values())
    if not (is_frame(x) or isinstance(x, Mapping)):
        ((what, name), *_) = named.items()
        raise ValueError(f"{what} {name!r}: a name is that of a column of x, and x is no table")
    for what, name in named.items():
        if name not in (x if isinstance(x, Mapping) else list(x.columns)):
            raise ValueError(f"{what}: x has no column {name!r}")
    left = {name: values for name, values in (named_columns(x) or []) if name not in named.values()}
    if isinstance(x, Mapping):
        left = {name: values for name, values in x.items() if name not in named.values()}
    return left, [_named(x, value) if isinstance(value, str) else value for value in others.values()]


def _named(table: Any, name: str) -> Any:
    """A column that keeps its name: those of a mapping of arrays have none."""
    values = table[name]
    return values if hasattr(values, "name") else {name: values}


def check_indexes(given: Mapping[str, Any]) -> None:
    """Refuse objects of pandas or xarray with different labels of rows: rows are taken by position."""
    labels = {}
    for name, values in given.items():
        of_columns = {f"{name}[{key!r}]": column for key, column in values.items()} if isinstance(values, Mapping) else {}
        for key, one in {name: values, **of_columns}.items():
            index = row_labels(one)
            if index is not None:
                labels[key] = (is_of_pandas(one), index)
    first = next(iter(labels), "")
    for other in list(labels)[1:]:
        (is_pandas, one), (is_too, another) = labels[first], labels[other]
        if is_pandas == is_too and not one.equals(another):
            ordered = f"reindex({first}.index)" if is_pandas else f"reindex_like({first})"
            raise ValueError(
                f"{first} and {other} have different indexes, and rows are taken by position: bring them into the same "
                f"order, as with {other}.{ordered}, or give arrays, as with {other}.to_numpy()"
            )


def warn_of_order(
    x: Any, records: list[slice], time: np.ndarray | None = None, places: np.ndarray | None = None
) -> None:
    """Warn once of rows that are out of order or missing: by their labels, by their places in the whole data, or by their
    times."""
    index = row_labels(x)
    is_label = index is not None and getattr(index.dtype, "kind", "O") in "iufMm"
    if is_label and not all(index[rows].is_monotonic_increasing for rows in records):
        warn(
            [
                "the rows are not in the order of their index: a model with memory needs them in the order of time "
                "(sort them, as with sort_index(); a shuffled split, such as ShuffleSplit, destroys it)"
            ]
        )
        return
    if is_label and index.dtype.kind in "iu":
        places = index.to_numpy()
    if places is not None:
        missing, of = sum(_missing(places[rows]) for rows in records), "index"
    elif time is not None:
        missing, of = sum(_missing(time[rows], FEWEST_GAPS) for rows in records), "times"
    else:
        return
    if missing:
        warn(
            [
                f"rows are missing ({missing} gaps in the {of}): a model with memory needs every row of the input (keep rows "
                "without a measurement, with NaN as the output; split by records or in time, as with RecordSplit: "
                "KFold leaves rows out)"
            ]
        )


FEWEST_GAPS = 0.05
"""Share of the steps of time that are gaps where rows were left out; single ones are pauses of the measurement."""


def _missing(places: np.ndarray, fewest: float = 0.0) -> int:
    """Number of gaps in places that are otherwise even; 0 for fewer than this share of the steps."""
    steps = np.diff(places.astype(np.float64))
    steps = steps[steps > 0]
    if len(steps) == 0:
        return 0
    multiples = steps / steps.min()
    gaps = int(np.count_nonzero(multiples > 1.5))
    is_even = bool(np.all(np.abs(multiples - np.round(multiples)) < 0.02 * np.round(multiples)))
    return gaps if is_even and gaps >= fewest * len(steps) else 0


def _records(records: Any, rows: int, name: str) -> list[tuple[str, slice]]:
    if records is None:
        return [(name, slice(0, rows))]
    labels = np.asarray(next(iter(records.values())) if isinstance(records, Mapping) else records)
    if labels.shape != (rows,):
        raise ValueError(f"records: one label for each of the {rows} rows is needed")
    if rows == 0:
        return [(name, slice(0, 0))]
    found = []
    begun = set()
    for piece in runs(labels):
        label = str(labels[piece.start])
        if label in begun:
            raise ValueError(f'record "{label}" continues after another record (keep its rows together)')
        begun.add(label)
        found.append((label, piece))
    return found


def runs(labels: np.ndarray) -> list[slice]:
    """Where labels stay the same."""
    changes = np.flatnonzero(labels[1:] != labels[:-1]) + 1
    edges = [0, *changes.tolist(), len(labels)]
    return [slice(begin, end) for begin, end in zip(edges[:-1], edges[1:])]
