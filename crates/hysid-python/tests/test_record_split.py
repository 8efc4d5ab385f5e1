"""Folds of scikit-learn are those of `hysid.validate`."""

import numpy as np
import polars
import pytest
from sklearn.model_selection import GridSearchCV, TimeSeriesSplit, cross_val_score

import hysid
from hysid import HysteresisRegressor, RecordSplit

# What follows in time has a larger input than what was fitted to.
pytestmark = pytest.mark.filterwarnings("ignore::hysid.HysidWarning")

NAMES = {"time": "t_s", "record": "record"}
LAW = {"model": "masing", "operators": 6}


def rmse(estimator, x, y):
    y = np.asarray(y, dtype=float)
    return float(np.sqrt(np.nanmean((estimator.predict(x) - y) ** 2)))


@pytest.fixture(scope="module")
def actuator():
    train, _ = hysid.specimen("piezo-actuator").data()
    return train.frame()


@pytest.mark.parametrize("folds", [2, 5])
def test_folds_of_records_are_those_of_validate(actuator, folds):
    x, y = actuator[["record", "t_s", "voltage_V"]], actuator["displacement_um"]
    validated = hysid.validate(actuator["voltage_V"], y, actuator["t_s"], records=actuator["record"], folds=folds, **LAW)
    split = RecordSplit(folds, **NAMES)
    regressor = HysteresisRegressor(**NAMES, **LAW)
    scores = cross_val_score(regressor, x, y, cv=split, scoring=rmse)
    assert scores.tolist() == pytest.approx([fold.unseen.rmse for fold in validated.folds], rel=1e-12)
    assert split.get_n_splits(x, y) == folds
    held = [list(dict.fromkeys(actuator["record"].to_numpy()[test])) for _, test in split.split(x, y)]
    assert [", ".join(names) for names in held] == [fold.held_out for fold in validated.folds]
    by_groups = RecordSplit(folds, time=0).split(actuator[["t_s", "voltage_V"]].to_numpy(), y, actuator["record"])
    for one, other in zip(split.split(x, y), by_groups):
        assert np.array_equal(one[0], other[0]) and np.array_equal(one[1], other[1])
    table = polars.DataFrame({name: actuator[name].tolist() for name in actuator})
    of_polars = cross_val_score(regressor, table.select(x.columns.tolist()), table[y.name], cv=split, scoring=rmse)
    assert np.array_equal(of_polars, scores)


def test_what_follows_in_time_is_that_of_validate_if_the_memory_is_carried_over(spring_and_slider):
    x, y = spring_and_slider
    time = 0.02 * np.arange(len(x))
    table = np.column_stack([time, x])
    forecasts = [fold.unseen.rmse for fold in hysid.validate(x, y, time, **LAW).folds[:3]]
    split = RecordSplit(time=0)
    assert split.get_n_splits(table, y) == 3
    carried = HysteresisRegressor(time=0, continue_records=True, **LAW)
    scores = cross_val_score(carried, table, y, cv=split, scoring=rmse)
    assert scores.tolist() == pytest.approx(forecasts, rel=1e-12)
    begun_anew = cross_val_score(HysteresisRegressor(time=0, **LAW), table, y, cv=split, scoring=rmse)
    assert begun_anew[0] > 1.05 * scores[0], "the memory at the beginning of the fold is missing"
    assert np.isfinite(cross_val_score(carried, table, y, cv=TimeSeriesSplit(3))).all()
    search = GridSearchCV(carried, {"operators": [2, 6]}, cv=split).fit(table, y)
    assert search.best_params_ == {"operators": 6}


def test_records_are_continued_only_behind_the_training(spring_and_slider):
    x, y = spring_and_slider
    time = 0.02 * np.arange(len(x))
    table = np.column_stack([time, x])
    fitted = HysteresisRegressor(time=0, continue_records=True, **LAW).fit(table[:300], y[:300])
    whole = fitted.model_.simulate(x, time)
    assert np.array_equal(fitted.predict(table[:300]), whole[:300])
    assert np.array_equal(fitted.predict(table[300:]), whole[300:])
    labelled = np.column_stack([np.repeat([1.0, 2.0], 300), time, x])
    other = HysteresisRegressor(record=0, time=1, continue_records=True, **LAW).fit(labelled[:300], y[:300])
    begun_anew = other.model_.simulate(x[300:], time[300:])
    assert np.array_equal(other.predict(labelled[300:]), begun_anew), "another record does not continue the first"
    with pytest.raises(ValueError, match="continue_records needs the time stamps"):
        HysteresisRegressor(continue_records=True, **LAW).fit(table[:, 1:], y)


def test_copies_stay_together(spring_and_slider):
    x, y = spring_and_slider
    table = np.concatenate([x, x, 1.1 * x])[:, None]
    labels = np.repeat([0, 1, 2], len(x))
    outputs = np.concatenate([y, y, 1.2 * y])
    folds = [set(labels[test]) for _, test in RecordSplit().split(table, outputs, labels)]
    assert folds == [{0, 1}, {2}]


def test_what_cannot_be_split_is_refused(spring_and_slider):
    x, y = spring_and_slider
    with pytest.raises(ValueError, match="too few data to hold any out"):
        next(RecordSplit().split(x[::20, None], y[::20]))
    with pytest.raises(ValueError, match="y: the measured output is needed"):
        next(RecordSplit().split(x))
    with pytest.raises(ValueError, match="depends on the data"):
        RecordSplit().get_n_splits()
    with pytest.raises(ValueError, match="record: X has no column 'test'"):
        next(RecordSplit(record="test").split(x[:, None], y))
    with pytest.raises(ValueError, match="continues after another record"):
        next(RecordSplit().split(x[:, None], y, np.arange(len(x)) % 2))
    with pytest.raises(ValueError, match="folds 1: choose 2 or more"):
        RecordSplit(1)
    assert repr(RecordSplit(3, time="t")) == "RecordSplit(folds=3, time='t', record=None)"
