"""A progress bar for fits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hysid._progress import Progress

__all__ = ["tqdm_progress"]

_STEPS = 1000


class tqdm_progress:  # noqa: N801 - used like a function
    """A progress bar for `hysid.fit`, in a terminal or a notebook; needs tqdm.

    Parameters
    ----------
    **options
        Passed on to tqdm.

    Examples
    --------
    >>> import hysid
    >>> train, _ = hysid.specimen("terfenol-rod").data()
    >>> bar = hysid.tqdm_progress(disable=True)
    >>> model = hysid.fit(train.x, train.y, model="pnn", starts=1, epochs=2, progress=bar)
    """

    def __init__(self, **options: Any) -> None:
        from tqdm.auto import tqdm

        self._bar = tqdm(**{"total": _STEPS, "unit": "‰", "leave": False, **options})

    def __call__(self, progress: Progress) -> None:
        about = progress.model
        if progress.train_nrmse_percent == progress.train_nrmse_percent:
            about += f", error {progress.train_nrmse_percent:.3g} % of std"
        self._bar.set_postfix_str(about, refresh=False)
        self._bar.update(max(0, int(_STEPS * progress.done) - self._bar.n))

    def close(self) -> None:
        """Remove the bar."""
        self._bar.close()
