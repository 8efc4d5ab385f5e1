"""Who is told of the progress: a callback, or a line in a terminal or notebook, which is shown without being asked for."""

from __future__ import annotations

import math
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from time import monotonic
from typing import Any, TextIO

from hysid import _hysid
from hysid._progress import Listener, Progress

__all__ = ["told"]

BEFORE_SHOWN = 0.5
"""Seconds without a line: what is done by then needs none."""

COLUMNS = 80
"""Of a terminal that does not tell its width, and of a notebook."""


@contextmanager
def told(progress: Listener, time_limit: float | None = None) -> Iterator[Callable[[Progress], object] | None]:
    """The callback of a computation; afterwards it is closed if it has `close`."""
    if progress is None or isinstance(progress, bool):
        callback: Callable[[Progress], object] | None = progress_line(time_limit) if progress else None
    elif callable(progress):
        callback = progress
    else:
        raise TypeError(f"progress {progress!r}: True, False or a function is needed")
    try:
        yield callback
    finally:
        close = getattr(callback, "close", None)
        if close is not None:
            close()


def progress_line(time_limit: float | None = None) -> ProgressLine | None:
    """The line for where this program runs; None where nobody sees it, and in another thread or process than the first."""
    multiprocessing = sys.modules.get("multiprocessing")
    is_worker = multiprocessing is not None and multiprocessing.current_process().name != "MainProcess"
    if is_worker or threading.current_thread() is not threading.main_thread():
        return None
    place = _notebook() or _terminal()
    return None if place is None else ProgressLine(place, time_limit)


class ProgressLine:
    """Shows the progress of one computation; a callback of `hysid.fit`."""

    def __init__(self, place: _Terminal | _Notebook, time_limit: float | None) -> None:
        self._place = place
        self._limit = time_limit
        self._line = _hysid.ProgressLine()
        self._began = monotonic()
        self._error = math.inf

    def __call__(self, progress: Progress) -> None:
        elapsed = monotonic() - self._began
        if not progress.is_part and progress.phase == "all-data" and math.isfinite(progress.train_nrmse_percent):
            self._error = min(self._error, progress.train_nrmse_percent)
        most = None if self._limit is None else max(self._limit - elapsed, 0.0)
        error = self._error if math.isfinite(self._error) else None
        part = "cross-validation" if progress.phase == "starts" and not progress.is_part else f"fitting {progress.model}"

        def text(columns: int, bar: bool) -> str:
            return self._line.text(elapsed, progress.done, most, part, error, columns, bar)

        if elapsed >= BEFORE_SHOWN:
            self._place.show(text, progress.done)

    def close(self) -> None:
        """Take the line away."""
        self._place.close()


class _Terminal:
    """The last line of a terminal."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._written = 0

    def _columns(self) -> int:
        try:
            columns = os.get_terminal_size(self._stream.fileno()).columns
        except (OSError, ValueError):
            columns = COLUMNS
        # The last column stays free: some terminals wrap when it is filled.
        return max((columns or COLUMNS) - 1, 0)

    def show(self, text: Callable[[int, bool], str], done: float) -> None:
        columns = self._columns()
        line = text(columns, True)
        self._write("\r" + line.ljust(min(self._written, columns)))
        self._written = len(line)

    def close(self) -> None:
        if self._written:
            self._write("\r" + " " * min(self._written, self._columns()) + "\r")
            self._written = 0

    def _write(self, text: str) -> None:
        try:
            self._stream.write(text)
            self._stream.flush()
        except (OSError, ValueError):
            # The fit is worth more than its line.
            pass


class _Notebook:
    """An output of the cell that runs."""

    def __init__(self, display: Callable[..., Any]) -> None:
        self._display = display
        self._handle: Any = None

    def show(self, text: Callable[[int, bool], str], done: float) -> None:
        words = text(COLUMNS, False)
        bar = f'<progress value="{done:.4f}" max="1"></progress>'
        self._publish({"text/plain": words, "text/html": f"{bar} {escape(words)}"})

    def close(self) -> None:
        if self._handle is not None:
            self._publish({"text/plain": "", "text/html": ""})

    def _publish(self, content: dict[str, str]) -> None:
        if self._handle is None:
            self._handle = self._display(content, raw=True, display_id=True)
        else:
            self._handle.update(content, raw=True)


def _notebook() -> _Notebook | None:
    """The cell that runs, if a kernel of Jupyter runs this program."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    if ipython is None or getattr(shell, "kernel", None) is None:
        return None
    return _Notebook(ipython.display.display)


def _terminal() -> _Terminal | None:
    """The terminal behind stderr, if there is one that can go back in a line."""
    stream = sys.stderr
    if stream is None or os.environ.get("TERM") == "dumb":
        return None
    try:
        return _Terminal(stream) if stream.isatty() else None
    except ValueError:
        # It is closed.
        return None
