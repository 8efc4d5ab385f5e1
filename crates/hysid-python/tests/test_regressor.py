"""The estimator, by scikit-learn's book."""

import pickle

import numpy as np
import pandas
import pytest
from sklearn.base import clone
from sklearn.model_selection import GridSearchCV, GroupKFold, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import MaxAbsScaler
from sklearn.utils.estimator_checks import parametrize_with_checks

import hysid
from hysid import HysteresisRegressor

REMEMBERS = "the output depends on the rows before: a model of hysteresis has memory"

EXPECTED_FAILURES = {
    "check_methods_subset_invariance": REMEMBERS,
    "check_methods_sample_order_invariance": REMEMBERS,
    "check_sample_weight_equivalence_on_dense_data": REMEMBERS,
    "check_sample_weights_not_overwritten": "networks take weights only if they are 0 or all alike",
}

SMALL = {"model": "xpnn+", "stops": 3, "hidden": 3, "starts": 1, "epochs": 5, "random_state": 0}


@parametrize_with_checks(
    [HysteresisRegressor(**SMALL)], expected_failed_checks=lambda estimator: EXPECTED_FAILURES
)
@pytest.mark.filterwarnings("ignore::hysid.HysidWarning")
def test_the_checks_of_scikit_learn(estimator, check):
    check(estimator)


@pytest.fixture(scope="module")
def actuator():
    """A rate-dependent actuator at ten rates, as a table."""
    train, test = hysid.specimen("piezo-actuator").data()
    return train, test, train.frame(), test.frame()


def regressor(**options):
    return HysteresisRegressor(time="t_s", record="record", **{**SMALL, **options})


def test_it_fits_what_fit_fits(actuator):
    train, test, frame, unseen = actuator
    fitted = regressor(random_state=5).fit(frame.drop(columns="displacement_um"), frame["displacement_um"])
    options = {name: value for name, value in SMALL.items() if name != "random_state"}
    model = hysid.fit(
        frame[["voltage_V"]], frame["displacement_um"], frame["t_s"], records=frame["record"], seed=5, **options
    )
    assert fitted.model_ == model
    assert fitted.n_iter_ == 5 and fitted.n_features_in_ == 3
    outputs = fitted.predict(unseen.drop(columns="displacement_um"))
    assert np.array_equal(outputs, model.simulate(test.x, test.time, records=test.records))
    by_place = HysteresisRegressor(time=1, record=0, **{**SMALL, "random_state": 5})
    labels = np.unique(train.records, return_inverse=True)[1]
    table = np.column_stack([labels, train.time, train.x])
    assert np.array_equal(by_place.fit(table, train.y).predict(table), fitted.model_.simulate(
        train.x, train.time, records=train.records
    ))


def test_blanks_drive_and_are_not_trained_on(actuator):
    _, _, frame, _ = actuator
    measured = frame["displacement_um"].copy()
    measured[1::3] = np.nan
    x = frame.drop(columns="displacement_um")
    fitted = regressor().fit(x, measured)
    assert fitted.model_.train.samples == measured.notna().sum() < len(frame)
    errors = fitted.model_.evaluate(frame["voltage_V"], measured, frame["t_s"], records=frame["record"])
    share = errors.nrmse_std_percent / 100
    assert fitted.score(x, measured) == pytest.approx(1 - share**2, rel=1e-9)


@pytest.mark.filterwarnings("ignore:pnn ignores hidden:hysid.HysidWarning")
def test_it_is_searched_over_records(actuator):
    _, _, frame, _ = actuator
    x, y = frame.drop(columns="displacement_um"), frame["displacement_um"]
    search = GridSearchCV(
        regressor(), {"model": ["xpnn", "pnn"], "stops": [2, 4]}, cv=GroupKFold(3), error_score="raise"
    )
    search.fit(x, y, groups=frame["record"])
    assert search.best_params_["model"] == "xpnn", "pnn does not see the rate"
    assert search.best_score_ > 0.9
    again = pickle.loads(pickle.dumps(search))
    assert np.array_equal(again.predict(x), search.predict(x))


def test_it_works_in_a_pipeline(spring_and_slider):
    x, y = spring_and_slider
    pipeline = make_pipeline(MaxAbsScaler(), HysteresisRegressor(model="masing"))
    assert pipeline.fit(x.reshape(-1, 1), y).score(x.reshape(-1, 1), y) > 0.99
    halves = np.repeat([0, 1], 300)
    with pytest.warns(hysid.HysidWarning, match="outside the trained range"):
        scores = cross_val_score(pipeline, x.reshape(-1, 1), y, groups=halves, cv=GroupKFold(2))
    assert len(scores) == 2 and np.isfinite(scores).all()


def test_parameters_are_stored_and_nothing_else():
    given = {"stops": np.int64(3), "thresholds": [1.0, 2.0], "time": "t", "random_state": None}
    estimator = HysteresisRegressor(**given)
    assert all(estimator.get_params()[name] is value for name, value in given.items())
    assert vars(clone(estimator)).keys() == estimator.get_params().keys()


def test_randomness_is_scikit_learn_s(spring_and_slider):
    x, y = spring_and_slider
    table = x.reshape(-1, 1)
    draws = [np.random.RandomState(3), np.random.RandomState(3), np.random.RandomState(4)]
    estimators = [HysteresisRegressor(**{**SMALL, "random_state": draw}) for draw in draws]
    models = [clone(estimator).fit(table, y).model_ for estimator in estimators]
    assert models[0] == models[1] != models[2]


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"time": "t"}, "time: X has no column 't'"),
        ({"record": 7}, "record: X has no column 7"),
        ({"model": "glass"}, 'model "glass": choose one of auto, pnn, gpnn'),
        ({"time": "x"}, "no column left for an input"),
    ],
)
def test_what_has_no_meaning_is_a_value_error(options, text, spring_and_slider):
    x, y = spring_and_slider
    with pytest.raises(ValueError, match=text):
        HysteresisRegressor(**options).fit(pandas.DataFrame({"x": x}), y)
