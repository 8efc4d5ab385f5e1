"""Fitted models."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from hysid import _hysid
from hysid._data import columns
from hysid._diagnosis import ModelDiagnosis
from hysid._warning import warn

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Columns, Values

__all__ = ["Errors", "Model", "Stepper"]

Stepper = _hysid.Stepper


@dataclass(frozen=True)
class Errors:
    """Errors of a free run over all scored rows.

    Attributes
    ----------
    output : str
        Name of the output.
    samples, records : int
        Scored rows, and records with at least one.
    mse, rmse : float
        Mean square error in the output's unit squared, and its root in the output's unit.
    nrmse_std_percent, nrmse_range_percent : float or None
        ``rmse`` in percent of the measured output's standard deviation, and of its range; None if it does not
        vary.
    fit_percent : float or None
        100 - ``nrmse_std_percent``.
    max_abs_error : float
        Largest absolute error in the output's unit.
    """

    output: str
    samples: int
    records: int
    mse: float
    rmse: float
    nrmse_std_percent: float | None
    nrmse_range_percent: float | None
    fit_percent: float | None
    max_abs_error: float

    def as_dict(self) -> dict[str, Any]:
        """The errors by their names."""
        return asdict(self)


class Model:
    """A fitted model: it simulates in the units of the data it was trained on.

    Made by `hysid.fit`, or read from a file by `Model.load`. It can be pickled and compared.

    Attributes
    ----------
    name : str
        Which model, such as ``"xpnn+"``.
    inputs : list of str
        Names of the inputs.
    output : str
        Name of the output.
    rate : str or None
        How the rate of the first input is found: central, backward, savitzky-golay or given.
    parameters : int
        Number of parameters that were found from the data.
    needs_time : bool
        Whether it can run without time stamps.
    train, validation : Errors
        Errors on the data it was trained on; and of the chosen start on the data held out from it, None if
        there are none.
    termination : str
        Why the last training run ended.
    """

    def __init__(self, native: _hysid.Model) -> None:
        self._native = native
        self._stepper: _hysid.Stepper | None = None

    # Files

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Model:
        """Read a model file, of Python or of the program `hysid`.

        Parameters
        ----------
        path : path
            The file.

        Returns
        -------
        Model
            The model.

        Raises
        ------
        ValueError
            A file that is damaged, of a later version, or no model.
        """
        with open(path, encoding="utf-8") as file:
            try:
                text = file.read()
            except UnicodeDecodeError:
                text = "?"
        try:
            return cls.from_json(text)
        except ValueError as error:
            raise ValueError(f"{os.fspath(path)}: {error}") from None

    @classmethod
    def from_json(cls, text: str) -> Model:
        """Read the text of a model file.

        Parameters
        ----------
        text : str
            What `to_json` gave.

        Returns
        -------
        Model
            The model.
        """
        return cls(_hysid.Model.from_json(text))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the model file; an old one at this place survives a failed write.

        Parameters
        ----------
        path : path
            The file; it can be read by the program `hysid` too.
        """
        # Looked for here: it is slow to import, and only this method needs it.
        import tempfile

        folder, name = os.path.split(os.path.abspath(path))
        with tempfile.NamedTemporaryFile(
            "w", encoding="utf-8", newline="", dir=folder, prefix=f".{name}.", delete=False
        ) as file:
            try:
                file.write(self.to_json())
                file.flush()
                os.fsync(file.fileno())
            except BaseException:
                file.close()
                os.unlink(file.name)
                raise
        _readable(file.name)
        os.replace(file.name, path)

    def to_json(self) -> str:
        """Give the text of the model file.

        Returns
        -------
        str
            JSON with a version and a checksum.
        """
        return self._native.to_json()

    # What it is

    @cached_property
    def description(self) -> dict[str, Any]:
        """All that stands in the model file."""
        described: dict[str, Any] = json.loads(self.to_json())
        return described

    @property
    def name(self) -> str:
        """Which model it is."""
        return str(self.description["model"])

    @property
    def inputs(self) -> list[str]:
        """Names of the inputs."""
        return list(self.description["columns"]["inputs"])

    @property
    def output(self) -> str:
        """Name of the output."""
        return str(self.description["columns"]["output"])

    @property
    def rate(self) -> str | None:
        """How the rate of the first input is found."""
        rate: str | None = self.description["rate"]
        return rate

    @property
    def parameters(self) -> int:
        """Number of parameters that were found from the data."""
        return self._native.parameters()

    @property
    def needs_time(self) -> bool:
        """Whether it can run without time stamps."""
        return self._native.needs_time()

    @property
    def train(self) -> Errors:
        """Errors on the data it was trained on."""
        return Errors(**self.description["training"]["train"])

    @property
    def validation(self) -> Errors | None:
        """Errors of the chosen start on the data held out from it."""
        errors = self.description["training"]["validation"]
        return None if errors is None else Errors(**errors)

    @property
    def termination(self) -> str:
        """Why the last training run ended."""
        return str(self.description["training"]["termination"])

    # What it does

    def simulate(
        self,
        x: Values,
        time: ArrayLike | None = None,
        rate: ArrayLike | None = None,
        records: ArrayLike | None = None,
    ) -> Any:
        """Run freely over inputs, from the virgin state. Contiguous float64 columns are not copied.

        Parameters
        ----------
        x : array of shape (n,) or (n, inputs)
            The inputs, in the units of the training.
        time : array of shape (n,), optional
            Time stamps, for a model that needs them.
        rate : array of shape (n,), optional
            The rate of the first input, for a model that was trained with a given one.
        records : array of shape (n,), optional
            A label for each row: the memory starts afresh where the label changes.

        Returns
        -------
        array of shape (n,)
            The output, in the unit of the training; a Series with the index of `x` if that is a pandas object.

        Raises
        ------
        ValueError
            Inputs that the model cannot take.
        """
        output = self._simulated(columns(x, None, time, rate, records))
        index = getattr(x, "index", None)
        if not hasattr(x, "iloc"):
            return output
        import pandas

        return pandas.Series(output, index=index, name=f"{self.output}_model")

    def _simulated(self, arranged: Columns) -> np.ndarray:
        outputs = [
            self._native.simulate(
                name,
                arranged.time.values[rows] if arranged.time else None,
                [column.values[rows] for column in arranged.inputs],
                arranged.rate.values[rows] if arranged.rate else None,
            )
            for name, rows in arranged.records
        ]
        if self._leaves_trained_range(arranged):
            warn(self._native.range_warnings(arranged.dataset()))
        return outputs[0] if len(outputs) == 1 else np.concatenate(outputs)

    def _leaves_trained_range(self, arranged: Columns) -> bool:
        ranges = self.description["trained_ranges"]["inputs"]
        return any(
            column.values.min() < low or column.values.max() > high
            for column, (low, high) in zip(arranged.inputs, ranges)
        )

    def evaluate(
        self,
        x: Values,
        y: Values,
        time: ArrayLike | None = None,
        rate: ArrayLike | None = None,
        records: ArrayLike | None = None,
    ) -> Errors:
        """Judge a free run against the measured output.

        Parameters
        ----------
        x : array of shape (n,) or (n, inputs)
            The inputs, in the units of the training.
        y : array of shape (n,)
            The measured output; NaN is not scored.
        time, rate, records : array of shape (n,), optional
            As of `simulate`.

        Returns
        -------
        Errors
            Over all scored rows.

        Raises
        ------
        ValueError
            Inputs that the model cannot take, or no measured output at all.
        """
        return self._evaluated(columns(x, y, time, rate, records))

    def _evaluated(self, arranged: Columns) -> Errors:
        data = arranged.dataset()
        errors = Errors(**json.loads(self._native.evaluate(data)))
        if arranged.output is not None and arranged.output.name is None:
            errors = replace(errors, output=self.output)
        warn(self._native.range_warnings(data))
        return errors

    def step(self, x: Any, time: float | None = None, rate: float | None = None) -> float:
        """Take the next sample, from the virgin state on: for control loops and structural analyses.

        Parameters
        ----------
        x : float, or sequence of shape (inputs,)
            The inputs, in the units of the training.
        time : float, optional
            Time of the sample, for a model that needs it.
        rate : float, optional
            The rate of the first input, for a model with one; without it a backward difference is taken.

        Returns
        -------
        float
            The output.

        Raises
        ------
        ValueError
            Inputs that the model cannot take, or time that does not advance.
        """
        stepper = self._stepper
        if stepper is None:
            stepper = self._stepper = self._native.stepper()
        return stepper.step(x, time, rate)

    def reset(self) -> None:
        """Go back to the virgin state before the next `step`."""
        self._stepper = None

    def stepper(self) -> Stepper:
        """Give a stepper of its own, with the methods `step` and `reset`: several can run side by side.

        Returns
        -------
        Stepper
            In the virgin state.
        """
        return self._native.stepper()

    def diagnose(self) -> ModelDiagnosis:
        """Tell what kind of hysteresis the model has learnt.

        Returns
        -------
        ModelDiagnosis
            Found by driving the model, and from its weights.
        """
        return ModelDiagnosis(json.loads(self._native.diagnose()))

    # Manners

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Model) and self.to_json() == other.to_json()

    def __hash__(self) -> int:
        return hash(self.to_json())

    def __reduce__(self) -> tuple[Any, ...]:
        return Model.from_json, (self.to_json(),)

    def __repr__(self) -> str:
        inputs = ", ".join(self.inputs)
        percent = self.train.nrmse_std_percent
        error = "" if percent is None else f", training error {percent:.3g} % of std"
        return f"<hysid.Model {self.name}: {inputs} -> {self.output}, {self.parameters} parameters{error}>"

    def _repr_html_(self) -> str:
        from hysid._html import model_html

        return model_html(self)


def _readable(path: str) -> None:
    """Give a temporary file the permissions of any new file."""
    mask = os.umask(0)
    os.umask(mask)
    os.chmod(path, 0o666 & ~mask)
