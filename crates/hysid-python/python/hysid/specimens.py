"""Synthetic specimens with known laws, to learn with and to test with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from hysid import _hysid
from hysid._arguments import real, whole

__all__ = ["Records", "Specimen", "specimen", "specimens"]


@dataclass(frozen=True)
class Records:
    """Data of a specimen.

    Attributes
    ----------
    x, y : array of shape (n,)
        Input and output; NaN in `y` means no measurement.
    time : array of shape (n,) or None
        Time stamps.
    records : array of shape (n,)
        The name of each row's record.
    names : dict
        Names of the columns with their units: ``input``, ``output``, ``time``.
    """

    x: np.ndarray
    y: np.ndarray
    time: np.ndarray | None
    records: np.ndarray
    names: dict[str, str]

    def frame(self) -> Any:
        """Give the data as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            With the columns ``record``, time if there is any, input and output, by their names.
        """
        import pandas

        content: dict[str, Any] = {"record": self.records}
        if self.time is not None:
            content[self.names["time"]] = self.time
        return pandas.DataFrame({**content, self.names["input"]: self.x, self.names["output"]: self.y})


@dataclass(frozen=True)
class Specimen:
    """A synthetic specimen: the source of its law, and training and test data.

    Attributes
    ----------
    name : str
        Its name.
    example : str or None
        The example of the paper whose measured specimen it replaces; None for a further specimen.
    summary : str
        Description in one line.
    published, designed : str
        The laws and values that are published, and those that we designed.
    training, testing : str
        How the data are made.
    """

    name: str
    example: str | None
    summary: str
    published: str
    designed: str
    training: str
    testing: str

    def data(self, noise: float = 0.0, seed: int = 1) -> tuple[Records, Records]:
        """Make the data that `hysid generate` writes.

        Parameters
        ----------
        noise : float
            Standard deviation of Gaussian noise on the output, in percent of that of the output.
        seed : int
            Seed of the noise and of random excitations; training and test data get different ones.

        Returns
        -------
        train, test : Records
            If the test data begin with NaN outputs, the input of these rows only sets the memory for the test.
        """
        percent, number = real("noise", noise), whole("seed", seed)
        return self._records(False, percent, number), self._records(True, percent, number)

    def _records(self, test: bool, noise: float, seed: int) -> Records:
        data = _hysid.specimen(self.name, test, noise, seed)
        time_name, (input_name,), _, output_name = data.names()
        parts = data.records()
        names = {"input": input_name, "output": output_name}
        if time_name is not None:
            names["time"] = time_name
        stamps = [time for _, time, _, _, _ in parts if time is not None]
        return Records(
            x=np.concatenate([inputs[0] for _, _, inputs, _, _ in parts]),
            y=np.concatenate([output for _, _, _, _, output in parts]),
            time=np.concatenate(stamps) if stamps else None,
            records=np.concatenate([np.full(len(output), name) for name, _, _, _, output in parts]),
            names=names,
        )


def specimens() -> list[Specimen]:
    """List all specimens: those of the paper's examples, in their order, then further ones.

    Returns
    -------
    list of Specimen
        All specimens.

    Examples
    --------
    >>> [specimen.name for specimen in hysid.specimens()][:2]
    ['ferromagnet', 'reinforced-concrete-joint']
    """
    return [Specimen(*described) for described in _hysid.specimens()]


def specimen(name: str) -> Specimen:
    """Find a specimen by its name.

    Parameters
    ----------
    name : str
        One of `specimens`.

    Returns
    -------
    Specimen
        The specimen; its method `data` makes training and test data.

    Raises
    ------
    ValueError
        There is no specimen with this name.

    Examples
    --------
    >>> train, test = hysid.specimen("piezo-actuator").data(noise=1.0)
    >>> train.x.shape == train.y.shape
    True
    """
    for known in specimens():
        if known.name == name:
            return known
    names = ", ".join(known.name for known in specimens())
    raise ValueError(f"specimen `{name}` is unknown: choose one of {names}")
