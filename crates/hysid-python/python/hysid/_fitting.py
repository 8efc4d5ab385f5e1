"""Identification."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from hysid import _hysid
from hysid._arguments import real, whole
from hysid._data import columns, weighted
from hysid._model_set import fitted_set
from hysid._progress import Listener, of_native
from hysid._progress_line import told
from hysid._warning import warn
from hysid.model import Model

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid import _options
    from hysid._data import Columns, Values
    from hysid._types import RateName


def fit(
    x: Values,
    y: Values | str,
    time: ArrayLike | str | None = None,
    rate: RateName | ArrayLike = "auto",
    records: ArrayLike | str | None = None,
    *,
    # Model
    model: _options.ModelName | None = None,
    members: int | None = None,
    stops: int | None = None,
    hidden: int | None = None,
    relaxation: int | None = None,
    no_deterioration: bool | None = None,
    history: bool | None = None,
    compression: float | None = None,
    rate_compression: float | None = None,
    # Training
    warm_up: int | None = None,
    initial_state: _options.InitialStateName | None = None,
    known: int | str | None = None,
    training: _options.TrainingName | None = None,
    effort: _options.EffortName | None = None,
    starts: int | None = None,
    epochs: int | None = None,
    population: int | None = None,
    stall: int | None = None,
    seed: int | None = None,
    validation: float | None = None,
    ridge: float | None = None,
    decay: float | None = None,
    # Classical models
    operators: int | None = None,
    states: int | None = None,
    modes: int | None = None,
    thresholds: ArrayLike | None = None,
    sign: _options.SignName | None = None,
    dead_zones: int | None = None,
    free_weights: bool | None = None,
    logarithmic_thresholds: bool | None = None,
    degradation: bool | None = None,
    asymmetric: bool | None = None,
    differential_form: bool | None = None,
    resonance: bool | None = None,
    lagged_input: bool | None = None,
    acceleration: bool | None = None,
    odd: bool | None = None,
    error: _options.ErrorName | None = None,
    # Run
    time_limit: float | None = None,
    threads: int | None = None,
    progress: Listener = True,
    sample_weight: ArrayLike | None = None,
) -> Model:
    """Identify a model from measured data.

    Without `model`, Hysid cross-validates networks and classical models and combines the best in an ensemble, or takes
    one law that fits about as well as any. This is the most accurate choice and takes ten seconds to a
    minute. A single named model takes seconds.

    Options have the same names as on the command line of the program `hysid`; ``None`` is the default. A model warns
    of options that it ignores. The same data, options and seed give the same model file, byte by byte. Ctrl-C ends the
    fit with a warning and returns the best model so far.

    Parameters
    ----------
    x : array of shape (n,) or (n, inputs), or list of these
        The inputs in the user's units. The model takes the names of columns from objects of pandas, polars and xarray (with
        the unit from the attribute ``units``) and from a dict. A list has an array, table or dict of each record; then `y`,
        `time` and `rate` are lists too.
    y : array of shape (n,), name of a column, or list of arrays
        The measured output in the user's unit. Several outputs are an array of shape (n, outputs), a table, or a list of
        names of columns: each is fitted by itself, and the result is a `ModelSet`. NaN or a mask means no measurement: such a row drives the memory, but
        is neither trained on nor scored. Rows are taken by position: pandas objects must have the same index. A name is
        that of a column of the table `x`; the columns that are not named are the inputs.
    time : array of shape (n,), name of a column, or list of arrays, optional
        Time stamps, increasing within each record; dates and times, also as text of ISO 8601 such as
        ``"2024-05-31T12:00:00.25"``, become seconds since the first.
    rate : str or array of shape (n,), default "auto"
        Method for the rate of the first input: ``"auto"``, ``"none"``, ``"central"``, ``"backward"``,
        ``"savitzky-golay"``, or the measured rate itself.
    records : array of shape (n,), name of a column, or list of names, optional
        A label for each row; where the label changes, a new record starts in the initial state. Of a list of records, a
        name for each, by default ``"1"``, ``"2"`` and so on. A column `record` of a table has the labels if nothing else is given.

    Model
    -----
    model : str, optional
        Model to fit. `auto` cross-validates networks and classical models and combines the best. One of "auto", "pnn",
        "gpnn", "preisach-nn", "xpnn", "xpnn+", "masing", "prandtl-ishlinskii", "modified-prandtl-ishlinskii",
        "generalized-prandtl-ishlinskii", "rate-dependent-prandtl-ishlinskii", "dynamic-prandtl-ishlinskii", "preisach",
        "neuro-madelung", "bouc-wen", "peak-oriented", "menegotto-pinto", "ramberg-osgood", "jiles-atherton", "lugre",
        "duhem-nn", "hysteretic-oscillator", "hysteretic-state-space", "random-stops". Default: auto.
    members : int, optional
        Maximum ensemble size; 1 gives a single small model. With a named model, the number of random starts that are
        combined. Default: 6 for auto; otherwise 1.
    stops : int, optional
        Stop neurons of a network. Default: 10.
    hidden : int, optional
        Tanh neurons of a network, of neuro-madelung or duhem-nn (at most 100), of random-stops, or of each hysteretic
        element (at most 60). Default: 10 for networks; set by each candidate for auto; 8 for neuro-madelung and
        duhem-nn; 8 (4 with degradation) for hysteretic-oscillator and hysteretic-state-space; chosen by
        cross-validation for random-stops.
    relaxation : int, optional
        Relaxation neurons of each input of xpnn+, for data with time stamps (by default none for data of one speed), or
        relaxation elements of dynamic-prandtl-ishlinskii (at most 3); 0 for none. Default: 4 for networks; set by each
        candidate for auto; 2 for dynamic-prandtl-ishlinskii.
    no_deterioration : bool, optional
        Use stops that do not deteriorate. Default: off for networks; chosen by cross-validation for auto and
        random-stops.
    history : bool, optional
        Add the running peak and the travelled path of the input as inputs. Default: off for networks and random-stops;
        chosen by cross-validation for auto.
    compression : float, optional
        Expand the first input around zero by asinh: the scale, as a share of its largest magnitude, such as 0.1; 0 for
        off. Default: chosen by cross-validation for auto; otherwise off.
    rate_compression : float, optional
        Expand the rate of the first input around zero: the scale, as a share of the rate that 99.5 % of all rows stay
        below; 0 for off. Default: off.

    Training
    --------
    warm_up : int, optional
        Rows at the beginning of each record that drive the memory and are not trained on, for records that do not begin
        in the virgin state. Default: chosen by cross-validation for auto; otherwise 0.
    initial_state : str, optional
        State of the memory at the beginning of each record: without history, after a visit of the upper or the lower
        end of the input range, demagnetised, periodic (each record is a period of a steady state), unknown (one of 11
        pasts, found for each record before the fit), or free (found for each record during the fit, for records that
        are cut out of a longer past). With free, duhem-nn finds its internal states, models with inertia find
        displacements and velocities, and other models find up to three turning points before the first row. One of
        "virgin", "saturated-up", "saturated-down", "demagnetised", "periodic", "unknown", "free". Default: chosen by
        cross-validation for auto; otherwise virgin.
    known : int | str, optional
        Measured beginning of the records on which the model will be used, as in `hysid evaluate --known`. Errors are
        then those after this beginning of each record, and `auto` also tries initial_state free. Default with free: the
        first tenth of each record. Blocks that are held out of a single record have no known beginning. Default: off.
    training : {"subgradient", "levenberg-marquardt", "hybrid", "genetic"}, optional
        Trainer of a network: the sub-gradient method with space dilatation, Levenberg-Marquardt, the genetic algorithm,
        or the paper's hybrid of the genetic algorithm and the sub-gradient method. Default: subgradient.
    effort : {"quick", "normal", "thorough"}, optional
        How long `auto` searches: `quick` takes about half the normal time, `thorough` about five times as long.
        Default: normal.
    starts : int, optional
        Number of random starts: networks, populations or parameter sets from which the training begins. Default: 2 for
        subgradient and auto; 8 for levenberg-marquardt, dynamic-prandtl-ishlinskii, ramberg-osgood, jiles-atherton and
        lugre; 1 for hybrid and genetic; 32 for generalized-prandtl-ishlinskii; 16 for
        rate-dependent-prandtl-ishlinskii, neuro-madelung, peak-oriented and menegotto-pinto; 8 (16 with degradation)
        for bouc-wen; 6 for duhem-nn; 4 for hysteretic-oscillator and hysteretic-state-space.
    epochs : int, optional
        Epochs of each start: iterations of levenberg-marquardt, generations of the genetic algorithm, iterations of the
        sub-gradient method; the hybrid uses half of them for each. Default: 400 for subgradient; 2000 for hybrid and
        genetic; set by each candidate for auto; 60 for generalized-prandtl-ishlinskii and neuro-madelung; 45 for
        duhem-nn; 200 for hysteretic-oscillator and hysteretic-state-space; otherwise 40.
    population : int, optional
        Individuals of the genetic algorithm. Default: 50.
    stall : int, optional
        Epochs without a noticeable improvement after which the genetic algorithm or the sub-gradient method ends; 0 for
        never. Default: 50.
    seed : int, optional
        Seed of all random numbers; the same data, options and seed give the same model. Default: 1.
    validation : float, optional
        Share of the data held out to validate a network on, between 0 and 1; the final network is trained on all data.
        Default: the folds of a cross-validation.
    ridge : float, optional
        Penalty on the squared output weights of a network, in scaled units; 0 for plain least squares, as in the paper.
        Default: 1e-6 (nearly 0 where that lowers the cross-validation error) for networks; chosen by cross-validation
        for auto.
    decay : float, optional
        Penalty on the squared weights of stops and tanh neurons. Default: 1e-7 (nearly 0 where that lowers the
        cross-validation error) for networks; chosen by cross-validation for auto.

    Classical models
    ----------------
    operators : int, optional
        Plays, breakpoints, intervals of each axis of a Preisach plane (at most 200), random stops, stops of duhem-nn
        (at most 100, 0 for none), or stops of each hysteretic element (at most 60, 0 for none). Default: set by each
        candidate for auto; 30 for masing, prandtl-ishlinskii and preisach; 20 for modified-prandtl-ishlinskii; 10 for
        generalized-prandtl-ishlinskii, rate-dependent-prandtl-ishlinskii and dynamic-prandtl-ishlinskii; 6 for
        duhem-nn; 0 (6 with degradation) for hysteretic-oscillator and hysteretic-state-space; 300 for random-stops.
    states : int, optional
        States of duhem-nn, driven by the input and by time (1 to 20), or memory states of each hysteretic element,
        which change only when its displacement changes (0 to 10; an element without memory states and stops has no
        hysteresis). Default: 3 for duhem-nn; 2 (0 with degradation) for hysteretic-oscillator and
        hysteretic-state-space.
    modes : int, optional
        Modes of vibration of hysteretic-oscillator and hysteretic-state-space. Default: set by each candidate for auto;
        1 for hysteretic-oscillator; 2 for hysteretic-state-space.
    thresholds : array of numbers, optional
        Thresholds of the plays of masing, prandtl-ishlinskii or modified-prandtl-ishlinskii, in the unit of the input.
        Default: chosen by cross-validation.
    sign : {"any", "non-negative", "non-positive"}, optional
        Sign of the weights of plays, or of the cells of a Preisach plane. Default: chosen by cross-validation.
    dead_zones : int, optional
        Dead zones on each side of modified-prandtl-ishlinskii or dynamic-prandtl-ishlinskii. Default: 6 for
        modified-prandtl-ishlinskii; 2 for dynamic-prandtl-ishlinskii.
    free_weights : bool, optional
        Give each play of generalized-prandtl-ishlinskii or rate-dependent-prandtl-ishlinskii a weight of its own, in
        place of an exponential law. Default: true.
    logarithmic_thresholds : bool, optional
        Let the thresholds of rate-dependent-prandtl-ishlinskii grow with the logarithm of the rate. Default: off.
    degradation : bool, optional
        Use bouc-wen with the degradation and pinching of Baber and Noori, peak-oriented with softening and
        deterioration, or hysteretic-oscillator and hysteretic-state-space with stops that deteriorate. Default: off.
    asymmetric : bool, optional
        Use peak-oriented or menegotto-pinto with different strengths upwards and downwards. Default: off.
    differential_form : bool, optional
        Use jiles-atherton in its differential form of 1992 in place of that of 1986. Default: off.
    resonance : bool, optional
        Use dynamic-prandtl-ishlinskii with a resonance behind its plays. Default: off.
    lagged_input : bool, optional
        Use dynamic-prandtl-ishlinskii with a lag before its plays and the input beside them, for an output that follows
        the integral of the input, as the voltage of a cell follows its charge. Default: off.
    acceleration : bool, optional
        Add the second derivative of the input as an input of duhem-nn; needs time stamps, a rate and little noise in
        the input. Default: off.
    odd : bool, optional
        Use duhem-nn without constants: opposite inputs from opposite initial states give the opposite output; slow
        further inputs, such as a temperature, stay the same. Default: off.
    error : {"row", "record"}, optional
        Error that the fit of duhem-nn minimises: `row`, the mean square error of all rows; `record`, the mean over the
        records of the error relative to the record's root mean square output. Default: record with free initial states,
        or if the root mean squares of the records differ by more than 5 times; otherwise row.

    Run
    ---
    time_limit : float, optional
        Time in seconds after which to stop and keep the best model so far.
    threads : int, optional
        Number of threads; the model does not depend on it. By default one for each processor.
    progress : bool or callable, default True
        True shows one line with the share done and the remaining time while the fit runs, if stderr is a terminal or in a
        notebook; False shows nothing. A callable is called with a `Progress` up to twenty times a second. If it returns
        true, the fit ends with the best model so far. `hysid.tqdm_progress` shows a progress bar of tqdm.
    sample_weight : array of shape (n,), or list of arrays, optional
        Weight of each row in the sum of squares that the fit minimises: a weight of 2 counts as the row twice, and a row
        with 0 only drives the memory. Every model takes weights that are 0 or all alike; others are for classical models
        fitted by least squares, and an error names them. The errors in `Model.train` count all rows alike.

    Returns
    -------
    Model
        The fitted model; of several outputs a `ModelSet`.

    Raises
    ------
    ValueError
        Data that no model can be identified from, or an invalid option.

    Examples
    --------
    >>> import numpy as np
    >>> import hysid
    >>> x = np.linspace(0, 6, 600) * np.sin(np.linspace(0, 60, 600))
    >>> y = 0.2 * x + hysid.operators.stop(x, r=1.0)
    >>> model = hysid.fit(x, y, model="prandtl-ishlinskii", operators=8)
    >>> model.evaluate(x, y).nrmse_std_percent < 5
    True

    A table with time stamps and a unit in each name, and the records in one of its columns:

    >>> frame = hysid.specimen("piezo-actuator").data()[0].frame()
    >>> list(frame)
    ['record', 't_s', 'voltage_V', 'displacement_um']
    >>> stage = hysid.fit(frame, "displacement_um", "t_s", records="record", model="masing")
    >>> stage.inputs, stage.output
    (['voltage_V'], 'displacement_um')

    Several outputs, and rows that count more than others:

    >>> models = hysid.fit(x, {"force": y, "slip": x - y}, model="masing")
    >>> list(models)
    ['force', 'slip']
    >>> weighted = hysid.fit(x, y, model="masing", sample_weight=np.where(abs(x) > 3, 4.0, 1.0))
    """
    keywords = locals()
    models = fitted_set(x, y, lambda x, y: fit(**{**keywords, "x": x, "y": y}))
    if models is not None:
        return models  # type: ignore[return-value]  # The type of `y` does not tell how many columns it has.
    given = {name: keywords[name] for name in _hysid.option_names()}
    named = isinstance(rate, str)
    arranged = weighted(columns(x, y, time, None if named else rate, records), sample_weight)
    return identified(
        arranged,
        str(rate) if named else "given",
        given,
        time_limit=time_limit,
        threads=threads,
        progress=progress,
    )


def identified(
    arranged: Columns,
    rate: str,
    options: Mapping[str, Any],
    *,
    time_limit: float | None,
    threads: int | None,
    progress: Listener = None,
) -> Model:
    """Fits with warnings before and after."""
    data, request = requested(arranged, rate, options, threads)
    return fitted(data, request, time_limit=time_limit, threads=threads, progress=progress)


def fitted(
    data: _hysid.Dataset,
    request: _hysid.FitSpec,
    *,
    time_limit: float | None,
    threads: int | None,
    progress: Listener = None,
) -> Model:
    """Fits with warnings afterwards."""
    limit = None if time_limit is None else real("time_limit", time_limit)
    with told(progress, limit) as callback:
        native, _, interrupted = _hysid.identify(data, request, threads, limit, of_native(callback))
    model = Model(native)
    warn(model.notes + (["interrupted: the best model so far is returned"] if interrupted else []))
    return model


def requested(
    arranged: Columns, rate: str, options: Mapping[str, Any], threads: int | None
) -> tuple[_hysid.Dataset, _hysid.FitSpec]:
    """Data and request for the native module; checks them and warns before the work."""
    if rate in ("central", "backward", "savitzky-golay") and arranged.time is None:
        raise ValueError(f"rate='{rate}' needs time stamps (give time, or use rate='none')")
    if threads is not None:
        whole("threads", threads, 1, 1024)
    data = arranged.dataset()
    request = _hysid.FitSpec(as_json(options), rate, data)
    warn(request.warnings(data) + data.warnings())
    return data, request


def as_json(options: Mapping[str, Any]) -> str:
    """Options for the native module; options that are None have their defaults."""
    given = {name: _plain(value) for name, value in options.items() if value is not None}
    for name, value in given.items():
        for number in value if isinstance(value, list) else [value]:
            if isinstance(number, float) and not math.isfinite(number):
                raise ValueError(f"{name} {number}: a finite number is needed")
    try:
        return json.dumps(given)
    except TypeError as error:
        raise TypeError(f"invalid option: {error}") from None


def _plain(value: Any) -> Any:
    """NumPy's numbers and arrays as Python's."""
    if isinstance(value, np.generic):
        return value.item()
    if hasattr(value, "tolist"):
        return value.tolist()
    return list(value) if isinstance(value, tuple) else value
