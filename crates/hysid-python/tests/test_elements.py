"""Operators and classical models against plain Python that follows their definitions."""

import numpy as np
import pytest

import hysid
from hysid import classical, operators

X = np.cumsum(np.random.default_rng(2).normal(size=300))
"""A random walk."""


def plain_play(x, r):
    place, places = 0.0, []
    for value in x:
        place = max(value - r, min(value + r, place))
        places.append(place)
    return np.array(places)


@pytest.mark.parametrize("r", [0.3, 2.0, 50.0])
def test_play_and_stop(r):
    assert np.array_equal(operators.play(X, r), plain_play(X, r))
    assert operators.stop(X, r) == pytest.approx(X - plain_play(X, r), abs=1e-12)


def test_relay():
    state, states = -1.0, []
    for value in X:
        state = 1.0 if value >= 1.5 else -1.0 if value <= -0.5 else state
        states.append(state)
    assert np.array_equal(operators.relay(X, r=1.0, s=0.5), states)


def test_deteriorating_stop():
    elongation = X - plain_play(X, 1.0)
    slip = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(plain_play(X, 1.0))))])
    expected = elongation * np.maximum(0, 1 - slip / 40.0)
    assert operators.deteriorating_stop(X, r=1.0, beta=40.0) == pytest.approx(expected, abs=1e-12)


def test_relaxation_of_a_ramp():
    """A ramp of slope 1 through a Maxwell element: the stress is tau (1 - exp(-t / tau))."""
    time = np.linspace(0, 5, 200)
    stress = operators.relaxation(time, time, tau=0.7)
    assert stress == pytest.approx(0.7 * (1 - np.exp(-time / 0.7)), rel=1e-12)


def test_classical_models_are_sums_of_their_elements():
    thresholds, weights = [0.5, 1.5, 4.0], [0.4, -0.2, 0.7]
    plays = sum(w * plain_play(X, r) for r, w in zip(thresholds, weights))
    y = classical.prandtl_ishlinskii(X, thresholds, weights, linear=0.3, constant=2.0)
    assert y == pytest.approx(2.0 + 0.3 * X + plays, abs=1e-12)
    slopes = np.array([2.0, 1.2, 0.5, 0.1])
    stops = sum((slopes[j] - slopes[j + 1]) * operators.stop(X, r) for j, r in enumerate(thresholds))
    assert classical.masing(X, thresholds, slopes) == pytest.approx(stops + 0.1 * X, abs=1e-10)
    level = operators.play(X, 1.0)
    bent = classical.modified_prandtl_ishlinskii(X, [1.0], [1.0], [-1.0, 2.0], [0.5, -0.25])
    assert bent == pytest.approx(
        level + 0.5 * np.minimum(level + 1, 0) - 0.25 * np.maximum(level - 2, 0), abs=1e-12
    )
    time = np.arange(300.0)
    resting = classical.rate_dependent_prandtl_ishlinskii(X, time, 0.5, [0.4, 0.6], beta=0.0, spring=1.0)
    expected = X + 0.4 * plain_play(X, 0.5) + 0.6 * plain_play(X, 1.0)
    assert resting == pytest.approx(expected, abs=1e-12)


def test_a_generalized_play_between_lines_is_a_play():
    """An envelope in its linear part is the input."""
    line = [1e6, 1e-6, 0.0, 0.0]
    y = classical.generalized_prandtl_ishlinskii(X, line, line, spacing=2.0, weights=[0.0, 1.0])
    assert y == pytest.approx(plain_play(X, 2.0), abs=1e-6)
    law = {"plays": 3, "rho": 0.5, "tau": 0.1}
    free = [0.5, 0.5 * np.exp(-0.2), 0.5 * np.exp(-0.4)]
    exponential = classical.generalized_prandtl_ishlinskii(X, line, line, spacing=2.0, weights=law)
    assert exponential == pytest.approx(
        classical.generalized_prandtl_ishlinskii(X, line, line, spacing=2.0, weights=free), abs=1e-9
    )


def test_a_preisach_plane_of_one_cell_saturates():
    y = classical.preisach([0, 5, 0, -5, 0], lines=[-1.0, 1.0], cells=[3.0], constant=1.0)
    assert y == pytest.approx([1.0, 4.0, 1.0 + 3.0 * 0.5, -2.0, 1.0 - 3.0 * 0.5])


def test_bouc_wen_with_damping_and_degradation():
    time = np.linspace(0, 10, 400)
    x = 3 * np.sin(time)
    plain = classical.bouc_wen(x, 1.0, 10.0, 0.5)
    damped = classical.bouc_wen(x, 1.0, 10.0, 0.5, damping=2.0, time=time)
    assert (damped - plain)[5:-5] == pytest.approx(2.0 * 3 * np.cos(time)[5:-5], abs=0.01)
    with pytest.raises(ValueError, match="damping: needs time"):
        classical.bouc_wen(x, 1.0, 10.0, 0.5, damping=2.0)
    names = ["delta_a", "delta_nu", "delta_eta", "zeta_s", "p", "q", "psi_0", "delta_psi", "lambda"]
    worn = dict.fromkeys(names, 0.0) | {"delta_eta": 0.2, "psi_0": 0.1, "lambda": 0.1}
    weaker = classical.bouc_wen(x, 1.0, 10.0, 0.5, degradation=worn)
    assert np.abs(weaker).max() < np.abs(plain).max() + 1e-9


def test_jiles_atherton_saturates_and_remains():
    up = classical.jiles_atherton(np.linspace(0, 5000, 500), saturation=1.5, a=50.0, k=80.0, c=0.1)
    assert up[-1] == pytest.approx(1.5, rel=0.02)
    forms = [
        classical.jiles_atherton([0, 500, 0], 1.5, 50.0, 80.0, c=0.2, differential_form=form)
        for form in (False, True)
    ]
    assert forms[0][-1] != forms[1][-1]
    assert all(0 < remanence < 1.5 for _, _, remanence in forms)


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: operators.play(X, -1.0), "threshold r = -1 of a play"),
        (lambda: operators.stop(X, 0.0), "threshold r = 0"),
        (lambda: operators.stop([1.0, np.nan], 1.0), "row 2, input: not a finite number"),
        (lambda: operators.relaxation([1.0, 2.0], [1.0, 0.0], 1.0), "times must not decrease"),
        (lambda: operators.relaxation([1.0, 2.0], None, 1.0), "time: an array is needed"),
        (lambda: operators.play(np.ones((3, 2)), 1.0), "takes one input, not 2"),
        (lambda: classical.bouc_wen(X, 1.0, 1.0, -1.0), "yield displacement"),
        (lambda: classical.preisach(X, [0.0], []), "lines"),
        (lambda: classical.prandtl_ishlinskii([np.inf], [1.0], [1.0]), "not a finite number"),
        (lambda: hysid.specimen("glass"), "specimen `glass` is unknown: choose one of"),
        (lambda: hysid.specimen("terfenol-rod").data(noise=-1.0), "noise"),
    ],
)
def test_what_has_no_meaning_is_a_value_error(call, text):
    with pytest.raises(ValueError) as raised:
        call()
    assert text in str(raised.value)


def test_specimens_are_those_of_the_program(program, tmp_path):
    import pandas

    for specimen in hysid.specimens():
        train, test = specimen.data(noise=1.0, seed=4)
        done = program(
            "generate", specimen.name, "-o", "a.csv", "--test", "b.csv", "--noise=1", "--seed=4", "--force", folder=tmp_path
        )
        assert done.returncode == 0, done.stderr
        for records, file in ((train, "a.csv"), (test, "b.csv")):
            written = pandas.read_csv(tmp_path / file)
            names = records.names
            assert np.array_equal(records.x, written[names["input"]])
            assert np.array_equal(records.y, written[names["output"]], equal_nan=True)
            if "record" in written:
                assert records.frame()["record"].tolist() == written["record"].astype(str).tolist()
