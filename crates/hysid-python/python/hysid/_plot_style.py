"""How figures look: colours, and the style of a paper."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties, findfont

__all__ = ["BAND", "ERROR", "INPUT", "MEASURED", "MODEL", "SERIES", "labelled_once", "new_axes", "paper"]

# The colours of the reports of Hysid.
MEASURED: dict[str, Any] = {"color": "#9aa5b1", "linewidth": 1.8, "label": "measured"}
MODEL: dict[str, Any] = {"color": "#0a5fd1", "linewidth": 0.9, "label": "model"}
BAND: dict[str, Any] = {"color": "#0a5fd1", "alpha": 0.18, "linewidth": 0.0, "label": "prediction band"}
INPUT: dict[str, Any] = {"color": "#1a7f4b", "linewidth": 1.0}
ERROR: dict[str, Any] = {"color": "#c2410c", "linewidth": 0.9}
SERIES = ("#0a5fd1", "#c2410c", "#1a7f4b", "#7d3fb0", "#a16207", "#0e7490")

MILLIMETRES = {"mm": 1.0, "cm": 10.0, "in": 25.4, "pt": 25.4 / 72.0}

GENERIC = ("serif", "sans-serif", "monospace")


def new_axes(ax: Axes | None) -> Axes:
    """The axes, or new ones."""
    return plt.subplots(layout="constrained")[1] if ax is None else ax


def labelled_once(ax: Axes, *, above: bool = False) -> None:
    """A legend that names each kind of line once, if there are several; inside the axes, or in a line above them."""
    handles, labels = ax.get_legend_handles_labels()
    first: dict[str, Any] = {}
    for handle, label in zip(handles, labels):
        first.setdefault(label, handle)
    if len(first) < 2:
        return
    beside: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "ncols": len(first), "borderaxespad": 0.2}
    ax.legend(list(first.values()), list(first), frameon=False, **(beside if above else {}))


@contextmanager
def paper(
    width: str | float = "90 mm", height: str | float | None = None, *, font: str = "serif", size: float = 8.0
) -> Iterator[None]:
    """Draw and save figures for a paper: its width, font and font size, with text that stays text in PDF and SVG.

    Parameters
    ----------
    width : str or float
        Width of new figures, such as ``"90 mm"``, ``"3.5 in"`` or ``"9 cm"``; a number is in millimetres.
    height : str or float, optional
        Height of new figures; by default two thirds of the width.
    font : str
        ``"serif"``, ``"sans-serif"``, ``"monospace"``, or the name of an installed font.
    size : float
        Size of the text in points. Ticks and legends are a point smaller, but not below 5.

    Yields
    ------
    None
        The settings of matplotlib hold inside of the ``with`` block: draw and save the figure there.

    Raises
    ------
    ValueError
        A length that cannot be read, or a font that is not installed.

    Examples
    --------
    >>> import io
    >>> train, _ = hysid.specimen("terfenol-rod").data()
    >>> with hysid.plot.paper(width="90 mm", font="serif", size=8):
    ...     figure = hysid.plot.loops(None, {"H_kA_per_m": train.x}, train.y).figure
    ...     figure.savefig(io.BytesIO(), format="pdf")
    >>> round(25.4 * figure.get_figwidth())
    90
    """
    wide = _millimetres("width", width)
    high = wide * 2.0 / 3.0 if height is None else _millimetres("height", height)
    if not size > 0.0:
        raise ValueError(f"size {size}: a size in points above 0 is needed")
    if font not in GENERIC:
        try:
            findfont(FontProperties(family=font), fallback_to_default=False)
        except ValueError:
            raise ValueError(f"font {font!r} is not installed: choose {', '.join(GENERIC)} or an installed font") from None
    small = max(size - 1.0, 5.0)
    line = size / 10.0
    settings: dict[Any, Any] = {
        "figure.figsize": (wide / 25.4, high / 25.4),
        "font.family": font,
        "font.size": size,
        "axes.labelsize": size,
        "axes.titlesize": size,
        "xtick.labelsize": small,
        "ytick.labelsize": small,
        "legend.fontsize": small,
        "mathtext.fontset": "dejavusans" if font == "sans-serif" else "stix",
        "axes.linewidth": 0.7 * line,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "xtick.major.width": 0.7 * line,
        "ytick.major.width": 0.7 * line,
        "xtick.major.size": 3.0 * line,
        "ytick.major.size": 3.0 * line,
        # Embedded fonts and letters, not outlines of letters.
        "pdf.fonttype": 42,
        "ps.fonttype": 42,
        "svg.fonttype": "none",
        "savefig.bbox": "standard",
    }
    with plt.rc_context(settings):
        yield


def _millimetres(what: str, length: str | float) -> float:
    if isinstance(length, str):
        match = re.fullmatch(r"\s*([0-9]+(?:\.[0-9]+)?)\s*(mm|cm|in|pt)\s*", length)
        if match is None:
            raise ValueError(f"{what} {length!r}: a length such as '90 mm', '9 cm' or '3.5 in' is needed")
        value = float(match[1]) * MILLIMETRES[match[2]]
    else:
        value = float(length)
    if not 0.0 < value < 5000.0:
        raise ValueError(f"{what} {length!r}: a length between 0 and 5 m is needed")
    return value
