"""Types of the data that `Model.simulate` takes and gives, for type checkers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias, TypeVar, Union

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["AnySeries", "Frame", "Given", "Numbers", "RateName", "Series"]


RateName: TypeAlias = Literal["auto", "none", "central", "backward", "savitzky-golay"]
"""Methods for the rate of the first input."""


class Series(Protocol):
    """A Series of pandas or polars, or a DataArray of xarray."""

    @property
    def name(self) -> Any: ...
    def to_numpy(self, *args: Any, **keywords: Any) -> Any: ...


class Frame(Protocol):
    """A DataFrame of pandas or polars."""

    @property
    def columns(self) -> Any: ...
    def to_numpy(self, *args: Any, **keywords: Any) -> Any: ...


class SupportsArray(Protocol):
    """Objects that NumPy converts to an array."""

    def __array__(self) -> Any: ...


AnySeries = TypeVar("AnySeries", bound=Series)

Numbers: TypeAlias = Union[SupportsArray, Sequence[float], Sequence[Sequence[float]], Mapping[str, "ArrayLike"]]
"""Numbers that are no Series: arrays, lists of numbers, and arrays by the names of their columns."""

Given: TypeAlias = Union["ArrayLike", str, Sequence["ArrayLike"], None]
"""A value for each row, the name of a column of the table `x`, or a list for the records of a list `x`."""
