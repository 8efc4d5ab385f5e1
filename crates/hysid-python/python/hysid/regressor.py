"""The estimator for scikit-learn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.metrics import r2_score
from sklearn.utils import check_array, check_consistent_length, check_random_state
from sklearn.utils.validation import check_is_fitted, column_or_1d, validate_data

from hysid import _hysid
from hysid._columns import Column, place_of, without_mask
from hysid._data import Columns, check_indexes, continued, runs, warn_of_order, weighted
from hysid._fitting import identified
from hysid._tables import is_frame, with_column
from hysid._warning import training_rows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysid import _options

__all__ = ["HysteresisRegressor"]


class HysteresisRegressor(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """A model of hysteresis as an estimator of scikit-learn.

    Rows are samples in the order of time, because the output of a model with memory depends on earlier rows.
    `predict` is a free run over the rows in this order, from the initial state; it does not use measured outputs. Time
    stamps and labels of records are columns of `X`, named by `time` and `record`, so that they stay with their rows in
    a pipeline or a cross-validation. For cross-validation use `RecordSplit`, or ``GroupKFold`` over the records; `fit`
    warns of a shuffled split, such as ``ShuffleSplit``, because it destroys the order.

    Parameters
    ----------
    time : str or int, optional
        The column of `X` with the time stamps, increasing within each record: its name in a pandas object, or its
        index.
    record : str or int, optional
        The column of `X` with the labels of the records; where the label changes, a new record starts in the initial
        state.
    continue_records : bool, default False
        Carry the memory over from training: rows of `predict` whose label is that of a training record and whose time is
        behind it continue this record, so that the model runs over the training inputs first. For splits in time, such as
        those of `RecordSplit` and ``TimeSeriesSplit``; needs `time`.
    rate : str, default "auto"
        As of `hysid.fit`: auto, none, central, backward or savitzky-golay.
    model : str, optional
        As of `hysid.fit`; the default ``"auto"`` is accurate and slow. In a search or a cross-validation, name a
        model, which takes seconds.
    members, stops, hidden, relaxation, no_deterioration, history, compression, rate_compression, warm_up : optional
    initial_state, known, training, effort, starts, epochs, population, stall, validation, ridge, decay : optional
    operators, states, modes, thresholds, sign, dead_zones, free_weights, logarithmic_thresholds : optional
    degradation, asymmetric, differential_form, resonance, lagged_input, acceleration, odd, error : optional
    time_limit, threads : optional
        As of `hysid.fit`.
    random_state : int, RandomState instance or None, default None
        Seed of all random numbers; an int is the seed of `hysid.fit`.

    Attributes
    ----------
    model_ : Model
        The fitted model.
    n_iter_ : int
        Epochs of the longest training run of any member; 1 for a model fitted without iterations.
    n_features_in_ : int
        Number of columns of `X`.
    feature_names_in_ : array of shape (n_features_in_,)
        Names of the columns, if `X` had any.

    Examples
    --------
    >>> from hysid import HysteresisRegressor
    >>> train, test = hysid.specimen("terfenol-rod").data()
    >>> regressor = HysteresisRegressor(model="preisach").fit(train.x.reshape(-1, 1), train.y)
    >>> scored = ~np.isnan(test.y)
    >>> error = regressor.predict(test.x.reshape(-1, 1))[scored] - test.y[scored]
    >>> bool(error.std() < 0.05 * test.y[scored].std())
    True
    """

    def __init__(
        self,
        *,
        time: str | int | None = None,
        record: str | int | None = None,
        continue_records: bool = False,
        rate: str = "auto",
        model: _options.ModelName | None = None,
        members: int | None = None,
        stops: int | None = None,
        hidden: int | None = None,
        relaxation: int | None = None,
        no_deterioration: bool | None = None,
        history: bool | None = None,
        compression: float | None = None,
        rate_compression: float | None = None,
        warm_up: int | None = None,
        initial_state: _options.InitialStateName | None = None,
        known: int | str | None = None,
        training: _options.TrainingName | None = None,
        effort: _options.EffortName | None = None,
        starts: int | None = None,
        epochs: int | None = None,
        population: int | None = None,
        stall: int | None = None,
        validation: float | None = None,
        ridge: float | None = None,
        decay: float | None = None,
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
        time_limit: float | None = None,
        threads: int | None = None,
        random_state: Any = None,
    ) -> None:
        self.time = time
        self.record = record
        self.continue_records = continue_records
        self.rate = rate
        self.model = model
        self.members = members
        self.stops = stops
        self.hidden = hidden
        self.relaxation = relaxation
        self.no_deterioration = no_deterioration
        self.history = history
        self.compression = compression
        self.rate_compression = rate_compression
        self.warm_up = warm_up
        self.initial_state = initial_state
        self.known = known
        self.training = training
        self.effort = effort
        self.starts = starts
        self.epochs = epochs
        self.population = population
        self.stall = stall
        self.validation = validation
        self.ridge = ridge
        self.decay = decay
        self.operators = operators
        self.states = states
        self.modes = modes
        self.thresholds = thresholds
        self.sign = sign
        self.dead_zones = dead_zones
        self.free_weights = free_weights
        self.logarithmic_thresholds = logarithmic_thresholds
        self.degradation = degradation
        self.asymmetric = asymmetric
        self.differential_form = differential_form
        self.resonance = resonance
        self.lagged_input = lagged_input
        self.acceleration = acceleration
        self.odd = odd
        self.error = error
        self.time_limit = time_limit
        self.threads = threads
        self.random_state = random_state

    def fit(self, X: Any, y: Any, sample_weight: Any = None) -> HysteresisRegressor:  # noqa: N803 - scikit-learn's name
        """Identify a model.

        Parameters
        ----------
        X : array of shape (n, columns)
            Inputs in the user's units, and the columns of time and records if there are any; rows in order.
        y : array of shape (n,)
            The measured output. NaN means no measurement: such a row drives the memory, but is neither trained on
            nor scored.
        sample_weight : array of shape (n,), optional
            As of `hysid.fit`.

        Returns
        -------
        HysteresisRegressor
            This estimator.
        """
        if y is None:
            name = type(self).__name__
            raise ValueError(f"This {name} estimator requires y to be passed, but the target y is None.")
        if self.continue_records and self.time is None:
            raise ValueError("continue_records needs the time stamps: name their column with time")
        output_name = getattr(y, "name", None)
        check_indexes({"X": X, "y": y})
        y = without_mask(y, "output")
        values = self._validated(X, reset=True)
        measured = check_array(
            y, ensure_2d=False, ensure_all_finite="allow-nan", dtype=np.float64, input_name="y"
        )
        measured = column_or_1d(measured, warn=True)
        check_consistent_length(values, measured)
        output = Column(np.ascontiguousarray(measured), None if output_name is None else str(output_name))
        options = {name: getattr(self, name) for name in _hysid.option_names() if name != "seed"}
        columns = self._columns(X, values)
        time = None if columns.time is None else columns.time.values
        warn_of_order(X, [rows for _, rows in columns.records], time, training_rows(len(values)))
        self._trained = columns if self.continue_records else None
        self.model_ = identified(
            weighted(columns._replace(output=output), sample_weight),
            self.rate,
            {**options, "seed": self._seed()},
            time_limit=self.time_limit,
            threads=self.threads,
        )
        described = self.model_.description
        trained = [described, *(described.get("ensemble") or {"members": []})["members"]]
        runs = [run for one in trained for run in one["training"]["runs"]]
        self.n_iter_ = max([1, *(run["history"][-1]["epoch"] for run in runs if run["history"])])
        return self

    def predict(self, X: Any) -> np.ndarray:  # noqa: N803 - scikit-learn's name
        """Simulate the output for the rows in their order.

        Parameters
        ----------
        X : array of shape (n, columns)
            As of `fit`.

        Returns
        -------
        array of shape (n,)
            The output, in the unit of the training.
        """
        check_is_fitted(self)
        columns = self._columns(X, self._validated(X, reset=False))
        warn_of_order(X, [rows for _, rows in columns.records])
        if self._trained is None:
            return self.model_._simulated(columns)
        whole, own = continued(self._trained, columns)
        simulated: np.ndarray = self.model_._simulated(whole)[own]
        return simulated

    def score(self, X: Any, y: Any, sample_weight: Any = None) -> float:  # noqa: N803
        """Give the coefficient of determination of a free run; rows with NaN are not scored.

        Parameters
        ----------
        X : array of shape (n, columns)
            As of `fit`.
        y : array of shape (n,)
            The measured output.
        sample_weight : array of shape (n,), optional
            Weights of the rows.

        Returns
        -------
        float
            1 for a perfect model, 0 for one that is no better than the mean.
        """
        measured = np.asarray(without_mask(y, "output"), dtype=np.float64).ravel()
        scored = ~np.isnan(measured)
        weight = None if sample_weight is None else np.asarray(sample_weight)[scored]
        return float(r2_score(measured[scored], self.predict(X)[scored], sample_weight=weight))

    def _validated(self, X: Any, reset: bool) -> np.ndarray:  # noqa: N803
        X = without_mask(X, "X")  # noqa: N806
        if isinstance(self.record, str) and is_frame(X) and self.record in X.columns:
            # Labels may be words, which scikit-learn refuses; they are read from the table itself.
            numbers = np.unique(X[self.record].to_numpy(), return_inverse=True)[1]
            X = with_column(X, self.record, numbers)  # noqa: N806
        few = 2 if reset else 1
        return np.asarray(validate_data(self, X, dtype=np.float64, reset=reset, ensure_min_samples=few))

    def _columns(self, X: Any, values: np.ndarray) -> Columns:  # noqa: N803
        """Inputs, time stamps and records of a table."""
        names = list(getattr(self, "feature_names_in_", []))
        given = {"time": self.time, "record": self.record}
        place = {what: place_of(what, column, names, self.n_features_in_) for what, column in given.items()}
        set_apart = {column for column in place.values() if column is not None}
        inputs = [column for column in range(values.shape[1]) if column not in set_apart]
        if not inputs:
            raise ValueError("X has no column left for an input")

        def column(index: int) -> Column:
            return Column(np.ascontiguousarray(values[:, index]), str(names[index]) if names else None)

        records = [("data", slice(0, len(values)))]
        if place["record"] is not None:
            by_name = isinstance(self.record, str)
            labels = np.asarray(X[self.record].to_numpy() if by_name else values[:, place["record"]])
            records = [(str(labels[rows.start]), rows) for rows in runs(labels)]
        time = None if place["time"] is None else column(place["time"])
        return Columns([column(index) for index in inputs], time, None, None, records)

    def _seed(self) -> int:
        if isinstance(self.random_state, (int, np.integer)):
            return int(self.random_state)
        return int(check_random_state(self.random_state).randint(2**31 - 1))
