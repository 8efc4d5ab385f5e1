"""Fitted models."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from hysid import _hysid
from hysid._arguments import name_of, pair, real, truth, whole
from hysid._columns import Column, column_of
from hysid._cycles import Cycles, above_zero, named_options
from hysid._data import Columns, columns, in_units_of, is_record_list, shaped_like
from hysid._diagnosis import ModelDiagnosis
from hysid._inverse import Inverse, Inversion, Reference
from hysid._residuals import ParameterInterval, Residuals, intervals_of
from hysid._results import Errors, Prediction
from hysid._stored_model import StoredModel
from hysid._tables import like
from hysid._types import AnySeries, Frame, Given, Numbers, Series
from hysid._warning import warn

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid._data import Values

__all__ = ["Model", "RecordState", "Stepper", "Tracking"]

RecordState = _hysid.RecordState
Stepper = _hysid.Stepper
Tracking = _hysid.Tracking


class Model(StoredModel):
    """A fitted model, which simulates in the units of its training data.

    `hysid.fit` and `Model.load` return models. Models can be pickled and compared.

    Attributes
    ----------
    name : str
        Which model, such as ``"xpnn+"``.
    inputs : list of str
        Names of the inputs.
    output : str
        Name of the output.
    rate : str or None
        Method for the rate of the first input: central, backward, savitzky-golay or given; None if the model does
        not use the rate.
    parameters : int
        Number of fitted parameters.
    needs_time : bool
        Whether it needs time stamps.
    members : tuple of Member
        Members of an ensemble; empty for a single model.
    has_band : bool
        Whether it has a prediction band, see `predict`.
    train, validation : Errors
        Errors on the training data, and on held-out data; `validation` is None if no data were held out.
    termination : str
        Why the last training run ended.
    """

    def __init__(self, native: _hysid.Model) -> None:
        super().__init__(native)
        self._stepper: _hysid.Stepper | None = None

    # Simulation

    @overload
    def simulate(
        self,
        x: AnySeries,
        time: Given = None,
        rate: Given = None,
        records: Given = None,
        *,
        initial_state: str | None = None,
        state: RecordState | None = None,
        same_units: bool = False,
    ) -> AnySeries: ...
    @overload
    def simulate(
        self,
        x: Frame,
        time: Given = None,
        rate: Given = None,
        records: Given = None,
        *,
        initial_state: str | None = None,
        state: RecordState | None = None,
        same_units: bool = False,
    ) -> Any: ...
    @overload
    def simulate(
        self,
        x: Sequence[AnySeries],
        time: Given = None,
        rate: Given = None,
        records: Given = None,
        *,
        initial_state: str | None = None,
        state: RecordState | None = None,
        same_units: bool = False,
    ) -> list[AnySeries]: ...
    @overload
    def simulate(
        self,
        x: Sequence[Frame],
        time: Given = None,
        rate: Given = None,
        records: Given = None,
        *,
        initial_state: str | None = None,
        state: RecordState | None = None,
        same_units: bool = False,
    ) -> list[Any]: ...
    @overload
    def simulate(
        self,
        x: Sequence[np.ndarray] | Sequence[Mapping[str, ArrayLike]],
        time: Given = None,
        rate: Given = None,
        records: Given = None,
        *,
        initial_state: str | None = None,
        state: RecordState | None = None,
        same_units: bool = False,
    ) -> list[np.ndarray]: ...
    @overload
    def simulate(
        self,
        x: Numbers,
        time: Given = None,
        rate: Given = None,
        records: Given = None,
        *,
        initial_state: str | None = None,
        state: RecordState | None = None,
        same_units: bool = False,
    ) -> np.ndarray: ...
    def simulate(
        self,
        x: Any,
        time: Given = None,
        rate: Given = None,
        records: Given = None,
        *,
        initial_state: str | None = None,
        state: RecordState | None = None,
        same_units: bool = False,
    ) -> Any:
        """Simulate the output from the inputs, from the initial state of the memory.

        Contiguous float64 columns are not copied.

        Parameters
        ----------
        x : array of shape (n,) or (n, inputs), or list of these
            The inputs, in the units of the training. Of a table with more columns, those with the names of the model's
            inputs are taken. A list has an array or table of each record; then `time` and `rate` are lists too.
        time : array of shape (n,), name of a column, or list of arrays, optional
            Time stamps, for a model that needs them. A name is that of a column of the table `x`.
        rate : array of shape (n,) or list of arrays, optional
            The rate of the first input, for a model that was trained with a given rate.
        records : array of shape (n,), name of a column, or list of names, optional
            A label for each row; where the label changes, a new record starts in the initial state.
        initial_state : str, optional
            State of the memory at the beginning of each record: ``"virgin"``, ``"saturated-up"`` (after a visit of the
            upper end of the trained input range), ``"saturated-down"``, ``"demagnetised"`` or ``"periodic"`` (after one
            period of the record itself). By default that of most training records, which is ``"virgin"`` unless the
            fit found or was given another.
        state : RecordState, optional
            State before the first row of `x`, as `find_state` found it; for a single record, in the place of `initial_state`.
        same_units : bool
            Do not convert units. Otherwise, units in the names of pandas objects are converted to those of the
            training, and a conversion that is not known is an error.

        Returns
        -------
        array of shape (n,)
            The output, in the unit of the training. A Series with the index of `x` for an object of pandas, a Series for
            one of polars, a DataArray with the coordinates of `x` and the attribute ``units`` for one of xarray; a list of
            these for a list.

        Raises
        ------
        ValueError
            Invalid inputs, or a state of another model.
        """
        arranged = self._converted(self._columns(x, None, time, rate, records), same_units)
        beginning = _beginning(arranged, initial_state, state)
        return shaped_like(x, self._simulated(arranged, *beginning), self.output, "_model")

    def predict(
        self,
        x: Values | Frame | Series,
        time: Given = None,
        rate: Given = None,
        records: Given = None,
        *,
        probability: float = 0.9,
        of_ten: int = 5,
        initial_state: str | None = None,
        state: RecordState | None = None,
        same_units: bool = False,
    ) -> Prediction:
        """Simulate with a prediction band that contains the measured output in a given share of the rows.

        The band was calibrated on held-out training data and assumes that new data resemble them. The share is right
        on average over data sets; in one of them it may be more or less.

        Parameters
        ----------
        x : array of shape (n,) or (n, inputs)
            The inputs, in the units of the training.
        time, rate, records : array of shape (n,), optional
            As of `simulate`.
        probability : float
            Probability of the band, from 0.5 to 0.99: the share of the rows that it contains.
        of_ten : int
            Data sets of ten in which the band contains at least that share, from 5, on average, to 9; 9 makes the band
            about twice as wide.
        initial_state : str, optional
            As of `simulate`.
        state : RecordState, optional
            As of `simulate`.
        same_units : bool
            As of `simulate`.

        Returns
        -------
        Prediction
            Output, lower edge and upper edge; each as `simulate` gives the output.

        Raises
        ------
        ValueError
            Invalid inputs, a state of another model, an invalid probability, or a model without a band: ``model="auto"``, or
            ``members`` above 1, calibrates one if there are enough data to hold some out.

        Examples
        --------
        >>> import hysid
        >>> train, test = hysid.specimen("terfenol-rod").data(noise=0.5)
        >>> options = {"model": "xpnn", "members": 2, "stops": 4, "hidden": 3, "epochs": 10}
        >>> model = hysid.fit(train.x, train.y, initial_state="virgin", **options)
        >>> output, low, high = model.predict(test.x, probability=0.95)
        >>> bool((low < output).all() and (output < high).all())
        True
        """
        probability = real("probability", probability)
        of_ten = whole("of_ten", of_ten, 5, 9)
        arranged = self._converted(self._columns(x, None, time, rate, records), same_units)
        beginning = _beginning(arranged, initial_state, state)
        predicted = self._predicted(arranged, probability, of_ten, *beginning)
        self._warn_of_range(arranged)
        suffixes = ("_model", "_model_low", "_model_high")
        return Prediction(*(shaped_like(x, values, self.output, suffix) for values, suffix in zip(predicted, suffixes)))

    def _predicted(
        self,
        arranged: Columns,
        probability: float,
        of_ten: int = 5,
        initial_state: str | None = None,
        state: RecordState | None = None,
    ) -> tuple[np.ndarray, ...]:
        """Output, lower and upper edge of the band."""
        runs = [
            self._native.predict(name, *driving, probability, of_ten, initial_state, state)
            for name, driving in _of_records(arranged)
        ]
        return tuple(np.concatenate(parts) for parts in zip(*runs))

    def _simulated(
        self, arranged: Columns, initial_state: str | None = None, state: RecordState | None = None
    ) -> np.ndarray:
        outputs = [
            self._native.simulate(name, *driving, initial_state, state) for name, driving in _of_records(arranged)
        ]
        self._warn_of_range(arranged)
        return outputs[0] if len(outputs) == 1 else np.concatenate(outputs)

    def _warn_of_range(self, arranged: Columns) -> None:
        if self._leaves_trained_range(arranged):
            warn(self._native.range_warnings(arranged.dataset()))

    def _leaves_trained_range(self, arranged: Columns) -> bool:
        ranges = self.description["trained_ranges"]["inputs"]
        return any(
            column.values.min() < low or column.values.max() > high
            for column, (low, high) in zip(arranged.inputs, ranges)
        )

    def find_state(
        self,
        x: Values,
        y: ArrayLike | str,
        *,
        time: Given = None,
        rate: Given = None,
        same_units: bool = False,
    ) -> RecordState:
        """Find the state of the memory before the first row of a record from the outputs of its first rows.

        For records that are cut out of a longer past. Free states of ``"duhem-nn"`` are found by least squares; for every
        other model and each member of an ensemble, the past of the input with the lowest error on these rows is searched,
        with up to three turning points.

        Parameters
        ----------
        x : array of shape (n,) or (n, inputs)
            The inputs of one record, in the units of the training.
        y : array of shape (m,), or name of a column
            The measured outputs of its first m rows, m ≤ n; NaN where the output is not known.
        time, rate : array of shape (n,), optional
            As of `simulate`.
        same_units : bool
            As of `simulate`.

        Returns
        -------
        RecordState
            For the argument `state` of `simulate`, `predict` and `stepper` of this model. They begin at the first row of `x`
            again, and give what a run with these known rows gives. If a rate depends on later rows (``"central"``), give
            some rows of `x` behind the known ones too.

        Raises
        ------
        ValueError
            Invalid inputs, more outputs than inputs, or no output at all.

        Examples
        --------
        >>> import hysid
        >>> train, test = hysid.specimen("terfenol-rod").data()
        >>> model = hysid.fit(train.x, train.y, model="preisach", operators=20)
        >>> x, y = test.x[5200:], test.y[5200:]
        >>> state = model.find_state(x, y[:60])
        >>> state
        RecordState(after -0.7, then 1.1)
        >>> output = model.simulate(x, state=state)
        >>> bool(abs(output - y)[60:].mean() < 0.5 * abs(model.simulate(x) - y)[60:].mean())
        True
        """
        if is_record_list(x):
            raise ValueError("x: a state is that of one record, and x is a list of records")
        is_column = isinstance(y, str)
        arranged = self._columns(x, y if is_column else None, time, rate, None)
        if not is_column:
            arranged = arranged._replace(output=column_of(y, "output"))
        arranged = self._converted(arranged, same_units)
        if arranged.output is None:
            raise ValueError("y: the outputs of the first rows are needed")
        ((name, driving),) = _of_records(arranged)
        return self._native.find_state(name, *driving, arranged.output.values)

    def evaluate(
        self,
        x: Values,
        y: Values | str,
        time: Given = None,
        rate: Given = None,
        records: Given = None,
        *,
        initial_state: str | None = None,
        known: int | str | None = None,
        same_units: bool = False,
        after_warm_up: bool = False,
    ) -> Errors:
        """Compute the errors of a free run.

        Parameters
        ----------
        x : array of shape (n,) or (n, inputs)
            The inputs, in the units of the training.
        y : array of shape (n,)
            The measured output; rows with NaN are not scored.
        time, rate, records : array of shape (n,), optional
            As of `simulate`.
        initial_state : str, optional
            As of `simulate`.
        known : int or str, optional
            Measured beginning of each record from which its state is found: a number of rows, or a time with its unit
            such as ``"0.5s"``. These rows are not scored. For records that are cut out of a longer past; in the place of
            `initial_state`.
        same_units : bool
            As of `simulate`.
        after_warm_up : bool
            Leave out the rows of the model's warm-up at the beginning of each record.

        Returns
        -------
        Errors
            Over all scored rows.

        Raises
        ------
        ValueError
            Invalid inputs, or no measured output.
        """
        state = name_of("initial_state", initial_state)
        if known is not None:
            _check_alone("known", initial_state)
            known = known if isinstance(known, str) else str(whole("known", known, 1))
        arranged = self._converted(self._columns(x, y, time, rate, records), same_units)
        after_warm_up = truth("after_warm_up", after_warm_up)
        return self._evaluated(arranged, after_warm_up=after_warm_up, initial_state=state, known=known)

    def residuals(
        self,
        x: Values,
        y: Values | str,
        time: Given = None,
        rate: Given = None,
        records: Given = None,
        *,
        initial_state: str | None = None,
        same_units: bool = False,
    ) -> Residuals:
        """Test the residual of a free run for structure: whiteness, correlation with the input, size and bias by place.

        Parameters
        ----------
        x, y, time, rate, records : array
            As of `evaluate`.
        initial_state : str, optional
            As of `simulate`.
        same_units : bool
            As of `simulate`.

        Returns
        -------
        Residuals
            A finding for each test, with its p-value and what helps.

        Raises
        ------
        ValueError
            Invalid inputs, or fewer than 50 rows with a measured output.
        """
        state = name_of("initial_state", initial_state)
        return self._residuals(self._converted(self._columns(x, y, time, rate, records), same_units), state)

    def _residuals(self, arranged: Columns, state: str | None = None) -> Residuals:
        data = arranged.dataset()
        found, text = self._native.residuals(data, state)
        content = json.loads(found)
        if arranged.output is not None and arranged.output.name is None:
            content["output"] = self.output
        warn(self._native.range_warnings(data))
        return Residuals(content, text)

    def report(
        self,
        path: str | os.PathLike[str],
        x: Values,
        y: Values | str,
        time: Given = None,
        rate: Given = None,
        records: Given = None,
        *,
        title: str | None = None,
        name: str | None = None,
        same_units: bool = False,
        force: bool = False,
    ) -> None:
        """Write an HTML report on the model and its free run over measured data: loops, errors, residual tests, limits.

        Parameters
        ----------
        path : path
            The report, an HTML file that needs no other file.
        x, y, time, rate, records : array
            As of `evaluate`.
        title : str, optional
            Title of the report; by default the quantities and the name of the model.
        name : str, optional
            Name of the data in the report, by default ``"unseen"``. Use ``"training"`` for the data that the model was
            fitted to: the report then has the intervals of the parameters too, for laws that have them.
        same_units : bool
            As of `simulate`.
        force : bool
            Replace a file even if it is not a page of Hysid.

        Raises
        ------
        ValueError
            Invalid inputs, or no measured output.
        FileExistsError
            The file exists, is not a page of Hysid, and `force` is False.

        Examples
        --------
        >>> import hysid, tempfile
        >>> train, test = hysid.specimen("terfenol-rod").data()
        >>> model = hysid.fit(train.x, train.y, model="prandtl-ishlinskii")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     model.report(folder + "/page.html", test.x, test.y)
        """
        arranged = self._converted(self._columns(x, y, time, rate, records), same_units)
        sets = [("unseen" if name is None else name, arranged.dataset())]
        self._native.report(path, title, sets, truth("force", force))

    def parameter_intervals(
        self,
        x: Values,
        y: Values | str,
        time: Given = None,
        rate: Given = None,
        records: Given = None,
    ) -> list[ParameterInterval] | None:
        """Compute 95 % confidence intervals of the parameters of a classical law from its training data.

        Parameters
        ----------
        x, y, time, rate, records : array
            The data that the model was fitted to, as of `fit`. The model file does not contain the intervals.

        Returns
        -------
        list of ParameterInterval or None
            One for each parameter of the law. None for networks, ensembles, and laws without intervals.

        Raises
        ------
        ValueError
            Data that the model was not fitted to.
        """
        printed = self._native.parameter_intervals(self._columns(x, y, time, rate, records).dataset())
        return None if printed is None else intervals_of(printed)

    def _converted(self, arranged: Columns, same_units: bool) -> Columns:
        """Columns in the units of the training, converted where names contain units; warns of conversions."""
        return arranged if same_units else in_units_of(arranged, self.description["columns"])

    def _evaluated(
        self,
        arranged: Columns,
        *,
        after_warm_up: bool = False,
        initial_state: str | None = None,
        known: str | None = None,
    ) -> Errors:
        data = arranged.dataset()
        errors = Errors(**json.loads(self._native.evaluate(data, after_warm_up, initial_state, known)))
        if arranged.output is not None and arranged.output.name is None:
            errors = replace(errors, output=self.output)
        warn(self._native.range_warnings(data))
        return errors

    def step(self, x: Any, time: float | None = None, rate: float | None = None) -> float:
        """Simulate one sample, for control loops and structural analyses; the first starts in the initial state.

        Parameters
        ----------
        x : float, or sequence of shape (inputs,)
            The inputs, in the units of the training.
        time : float, optional
            Time of the sample, for a model that needs it.
        rate : float, optional
            The rate of the first input, for a model that uses it; by default a backward difference.

        Returns
        -------
        float
            The output.

        Raises
        ------
        ValueError
            Invalid inputs, or a time that is missing or does not advance.
        """
        stepper = self._stepper
        if stepper is None:
            stepper = self._stepper = self._native.stepper(None)
        return stepper.step(x, time, rate)

    def reset(self, initial_state: str | None = None) -> None:
        """Go back to the initial state before the next `step`.

        Parameters
        ----------
        initial_state : str, optional
            As of `simulate`, but not ``"periodic"``: a model with periodic records begins in the virgin state here.
        """
        state = name_of("initial_state", initial_state)
        stepper = self._native.stepper(None)
        stepper.reset(state)
        self._stepper = stepper

    def stepper(self, state: RecordState | None = None) -> Stepper:
        """Give an independent stepper with the methods `step` and `reset`.

        Outputs that are measured in operation correct those of the model: after a `step`, `correct(y)` takes a
        disturbance from them that fades, `adapt(y, rows=1000)` a gain and an offset that drift; `tracking` has what was
        learned. The memory of the model is not corrected.

        Parameters
        ----------
        state : RecordState, optional
            State before the first sample, as `find_state` found it: the samples are those of its record, from the first row
            on. By default the initial state of the model.

        Returns
        -------
        Stepper
            Its `reset` goes to the initial state of the model, or to another one by its name.

        Raises
        ------
        ValueError
            A state of another model.

        Examples
        --------
        >>> import hysid
        >>> train, test = hysid.specimen("terfenol-rod").data()
        >>> model = hysid.fit(train.x, train.y, model="prandtl-ishlinskii")
        >>> stepper = model.stepper()
        >>> for x, measured in zip(test.x, 0.9 * model.simulate(test.x)):
        ...     output = stepper.step(x)
        ...     stepper.adapt(measured)
        >>> round(stepper.tracking.gain, 1)
        0.9
        """
        return self._native.stepper(state)

    def inverse(
        self,
        limits: tuple[float, float] | None = None,
        slew: float | None = None,
        preview: float = 0.0,
        band: float | None = None,
        of_ten: int = 5,
    ) -> Inverse:
        """Give the inverse of the model: from a wanted output, the input that gives it.

        It begins in the initial state of the model and has its memory, its rate and its wear. For a whole record,
        `invert` is simpler.

        Parameters
        ----------
        limits : tuple of two floats, optional
            Lowest and highest first input; by default those of the training data.
        slew : float, optional
            Largest change of the first input per unit of time; by default there is none.
        preview : float
            Time by which the search looks ahead, for models whose output lags behind the input.
        band : float, optional
            Also give the inputs whose prediction band of this probability (0.5 to 0.99) contains the wanted output.
        of_ten : int
            The band contains that share, or more, in so many of ten data sets (5 to 9).

        Returns
        -------
        Inverse
            With the methods `step` for one sample, `run` for a record, `best_preview`, and `reset`.

        Raises
        ------
        ValueError
            Limits that are not finite or not in order; a slew that is not positive; a preview that is negative or not
            finite; an invalid probability, or a model without a band.

        Examples
        --------
        ::

            inverse = model.inverse(limits=(0.0, 100.0))
            voltage = inverse.step(displacement, time).input
        """
        if limits is not None:
            limits = pair("limits", limits)
        if slew is not None:
            slew = real("slew", slew)
        preview = real("preview", preview)
        level = None if band is None else (real("band", band), whole("of_ten", of_ten, 5, 9))
        return Inverse(self._native.inverse(limits, slew, preview, level), preview)

    def invert(
        self,
        y: ArrayLike,
        time: ArrayLike | None = None,
        others: Values | None = None,
        *,
        limits: tuple[float, float] | None = None,
        slew: float | None = None,
        preview: float | str = "auto",
        band: float | None = None,
        of_ten: int = 5,
        same_units: bool = False,
    ) -> Inversion:
        """Give the inputs that drive the model along the wanted outputs of a record, from the initial state.

        The numbers are those of ``hysid invert``.

        Parameters
        ----------
        y : array of shape (rows,)
            The wanted output of each row, in the unit of the training.
        time : array of shape (rows,), optional
            Times of the rows, for a model that needs them, a slew limit or a preview.
        others : array of shape (rows,) or (rows, inputs - 1), optional
            The inputs of the model after the first one.
        limits : tuple of two floats, optional
            Lowest and highest first input; by default those of the training data.
        slew : float, optional
            Largest change of the first input per unit of time; by default there is none.
        preview : float or "auto"
            Time by which the search looks ahead. ``"auto"`` is the time with which the model follows the wanted output
            best, as of `Inverse.best_preview`.
        band : float, optional
            Also give the inputs whose prediction band of this probability (0.5 to 0.99) contains the wanted output.
        of_ten : int
            As of `inverse`.
        same_units : bool
            As of `simulate`.

        Returns
        -------
        Inversion
            Inputs and outputs, which of them are reached, and the preview. Columns are Series or DataArrays with the rows
            of `y` if that is an object of pandas, polars or xarray.

        Raises
        ------
        ValueError
            Invalid wanted outputs, with their row, counted from 1; missing time; bounds as of `inverse`.

        Examples
        --------
        >>> import hysid
        >>> train, test = hysid.specimen("terfenol-rod").data()
        >>> model = hysid.fit(train.x, train.y, model="prandtl-ishlinskii")
        >>> wanted = 10 + 0.5 * train.y
        >>> drive = model.invert(wanted)
        >>> simulated = model.simulate(drive.input)
        >>> bool(abs(simulated - wanted)[drive.reached].max() < 1e-9 * wanted.max())
        True
        """
        if isinstance(preview, str) and preview != "auto":
            raise ValueError(f"preview {preview!r}: 'auto' or a time is needed")
        given = Reference(y, time, others)
        # The first input is the one that is searched: its column only keeps the place.
        first = Column(given.wanted.values, None)
        columns = Columns([first, *given.others], given.time, None, given.wanted, [])
        converted = self._converted(columns, same_units)
        assert converted.output is not None
        given.wanted, given.time, given.others = converted.output, converted.time, converted.inputs[1:]

        def inverse(preview: float) -> Inverse:
            return self.inverse(limits, slew, preview, band, of_ten)

        if isinstance(preview, str):
            preview = inverse(0.0)._best_preview(given)
        found = inverse(preview)._run(given)
        drive = self.inputs[0]
        edges = {} if found.low is None else {
            "low": like(y, found.low, drive, "_low"),
            "high": like(y, found.high, drive, "_high"),
        }
        return replace(
            found,
            input=like(y, found.input, drive),
            output=like(y, found.output, self.output, "_reached"),
            reach=like(y, found.reach, "reach"),
            extrapolated=like(y, found.extrapolated, "extrapolated"),
            **edges,
        )

    def diagnose(self) -> ModelDiagnosis:
        """Determine the properties of the hysteresis of the model.

        Returns
        -------
        ModelDiagnosis
            Properties found by probing the model, and from its equations and weights.
        """
        content, text = self._native.diagnose()
        return ModelDiagnosis(json.loads(content), text)

    def cycles(
        self,
        *,
        division: str | None = None,
        field: str | None = None,
        smoothing_factor: int | None = None,
        density: float | None = None,
        height: float | None = None,
    ) -> Cycles:
        """Drive the model through cycles and first-order reversal curves over its trained range and read their figures.

        Parameters
        ----------
        division : str, optional
            Where cycles begin: ``"zero"``, ``"mean"`` or ``"reversals"``; as suits the data by default.
        field : str, optional
            What is read: ``"structure"``, ``"magnet"``, ``"actuator"``, ``"thermal"``, ``"battery"``, ``"hydrology"`` or
            ``"general"``; by default as the names and units of the columns indicate.
        smoothing_factor : int, optional
            Smoothing factor of the density of the reversal curves, 1 to 10; chosen by default.
        density : float, optional
            Mass density in kg/m³, for losses of magnets per mass.
        height : float, optional
            Height of a structure in the unit of the input, for the drift ratios of its levels.

        Returns
        -------
        Cycles
            The figures of the model's cycles, not of measured data.
        """
        options = named_options(division, field, smoothing_factor)
        return Cycles._of(self._native.cycles(*options, above_zero("density", density), above_zero("height", height)))

    def _columns(self, x: Any, y: Any, time: Any, rate: Any, records: Any) -> Columns:
        return columns(x, y, time, rate, records, self.inputs)


def _check_alone(name: str, initial_state: str | None) -> None:
    if initial_state is not None:
        raise ValueError(f"{name}: it cannot be used with initial_state")


def _beginning(
    arranged: Columns, initial_state: str | None, state: RecordState | None
) -> tuple[str | None, RecordState | None]:
    """Name of the initial state, and the state that was found; at most one of them is given."""
    if state is not None:
        _check_alone("state", initial_state)
        if len(arranged.records) != 1:
            raise ValueError(f"state: it is that of one record, and x has {len(arranged.records)}")
    return name_of("initial_state", initial_state), state


def _of_records(
    arranged: Columns,
) -> Iterator[tuple[str, tuple[np.ndarray | None, list[np.ndarray], np.ndarray | None]]]:
    """Name, and time, inputs and rate of each record."""
    for name, rows in arranged.records:
        yield name, (
            arranged.time.values[rows] if arranged.time else None,
            [column.values[rows] for column in arranged.inputs],
            arranged.rate.values[rows] if arranged.rate else None,
        )
