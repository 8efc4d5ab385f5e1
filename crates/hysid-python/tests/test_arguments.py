"""Errors name keywords and types in the words of Python."""

import re

import numpy as np
import pytest

import hysid
from hysid import classical, operators

X = np.sin(np.linspace(0.0, 20.0, 200))
LINEAR = {"model": "prandtl-ishlinskii", "operators": 4}


def model():
    return hysid.fit(X, X, **LINEAR)


def fit(**keywords):
    return hysid.fit(X, X, **{**LINEAR, **keywords})


@pytest.mark.parametrize(
    ("call", "kind", "text"),
    [
        (lambda: fit(threads="two"), TypeError, "threads 'two': a whole number is needed"),
        (lambda: fit(threads=1.5), TypeError, "threads 1.5: a whole number is needed"),
        (lambda: fit(threads=0), ValueError, "threads 0: choose 1 to 1024"),
        (lambda: fit(time_limit="1"), TypeError, "time_limit '1': a number is needed"),
        (lambda: fit(time_limit=-1), ValueError, "time_limit: a number of seconds above 0, below 1e9, is needed"),
        (lambda: fit(seed=object()), TypeError, "invalid option: "),
        (lambda: fit(rate=1.0), ValueError, "rate: a one-dimensional array is needed, not one of 0 dimensions"),
        (lambda: fit(rate="central"), ValueError, "rate='central' needs time stamps (give time, or use rate='none')"),
        (lambda: hysid.validate(X, X, folds=2.5), TypeError, "folds 2.5: a whole number is needed"),
        (lambda: hysid.validate(X, X, folds=1), ValueError, "folds 1: choose 2 or more"),
        (lambda: hysid.compare(X, X, threads=0), ValueError, "threads 0: choose 1 to 1024"),
        (lambda: hysid.compare(X, X, time_limit="1"), TypeError, "time_limit '1': a number is needed"),
        (lambda: hysid.diagnose(X, X, smoothing="yes"), TypeError, "smoothing 'yes': True or False is needed"),
        (
            lambda: hysid.diagnose(X, X, smallest_reversal="a"),
            TypeError,
            "smallest_reversal 'a': a number is needed",
        ),
        (lambda: operators.play(X, "1"), TypeError, "r '1': a number is needed"),
        (lambda: operators.relaxation(X, X, None), TypeError, "tau None: a number is needed"),
        (lambda: classical.masing(X, ["a"], [1.0]), TypeError, "thresholds: an array of numbers is needed"),
        (lambda: classical.bouc_wen(X, np.nan, 1.0, 1.0), ValueError, "elastic_stiffness nan: a finite number"),
        (lambda: classical.bouc_wen(X, "stiff", 1.0, 1.0), TypeError, "elastic_stiffness 'stiff': a number"),
        (
            lambda: classical.bouc_wen(X, 1.0, 1.0, 1.0, degradation={"p": 1.0}),
            ValueError,
            "degradation: a dict with the keys delta_a, delta_nu, ",
        ),
        (
            lambda: classical.generalized_prandtl_ishlinskii(X, [1.0], [1.0, 1.0, 0.0, 0.0], 0.1, [1.0]),
            ValueError,
            "left: a0, a1, a2, a3 are needed, not 1 numbers",
        ),
        (
            lambda: classical.generalized_prandtl_ishlinskii(
                X, [1.0] * 4, [1.0] * 4, 0.1, {"plays": 1.5, "rho": 1.0, "tau": 1.0}
            ),
            TypeError,
            "weights['plays'] 1.5: a whole number is needed",
        ),
        (lambda: hysid.specimen("concrete").data(seed=-1), ValueError, "seed -1: choose 0 or more"),
        (lambda: hysid.specimen("concrete").data(noise="loud"), TypeError, "noise 'loud': a number is needed"),
        (lambda: hysid.Model.from_json(3), TypeError, "text: the text of a model file is needed, not int"),
        (lambda: model().predict(X, probability="high"), TypeError, "probability 'high': a number is needed"),
        (lambda: model().step("a"), TypeError, "x: a number, or a sequence of numbers, is needed"),
        (lambda: model().step(None), TypeError, "x: a number, or a sequence of numbers, is needed"),
        (lambda: model().save("m.json", force="yes"), TypeError, "force 'yes': True or False is needed"),
        (
            lambda: model().evaluate(X, X, after_warm_up="yes"),
            TypeError,
            "after_warm_up 'yes': True or False is needed",
        ),
    ],
)
def test_a_wrong_argument_is_named_with_what_is_needed(call, kind, text):
    with pytest.raises(kind, match="^" + re.escape(text)):
        call()


@pytest.mark.parametrize(
    "keywords",
    [
        {"model": 3},
        {"members": "two"},
        {"operators": 1.5},
        {"operators": [4]},
        {"thresholds": "a"},
        {"thresholds": [["a"]]},
        {"sign": 1},
        {"compression": "x"},
        {"seed": -1},
        {"degradation": "yes", "model": "bouc-wen"},
        {"initial_state": "up"},
        {"initial_state": 1},
    ],
)
def test_a_wrong_option_is_named_without_types_of_the_native_module(keywords):
    with pytest.raises(ValueError) as raised:
        fit(**keywords)
    (name, *_) = keywords
    assert re.match(rf"{name}\b.*(choose|needed)", str(raised.value)), raised.value
    assert not re.search(r"usize|u64|f64|Vec|PyO|expected|line 1", str(raised.value)), raised.value


def test_a_model_says_whether_it_needs_time():
    time = np.arange(len(X), dtype=float)
    assert not model().needs_time
    relaxing = hysid.fit(X, X, time, model="xpnn+", stops=2, hidden=2, relaxation=1, starts=1, epochs=1)
    assert relaxing.needs_time
    with pytest.raises(ValueError, match="time"):
        relaxing.simulate(X)
    assert "needs time stamps" in hysid.Model.needs_time.__doc__
