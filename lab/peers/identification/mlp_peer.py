"""Scikit-learn's multi-layer perceptron as a NARX model, in free run."""

import itertools
import warnings

import numpy as np
from case import Scaling, choose
from sklearn.neural_network import MLPRegressor

CANDIDATES = [
    {"lags": lags, "hidden": hidden, "seed": seed, "penalty": penalty}
    for lags, hidden, seed, penalty in itertools.product((1, 2, 4), ((10,), (20, 10)), (0, 1), (1e-4, 1e-2))
]
FORMULATIONS = {"of u": False, "of u, its increment and direction": True}

BEYOND = 10.0
"""A free run that goes farther than this, in deviations, is held there: it is lost anyway."""


def identify(case, formulation):
    warnings.simplefilter("ignore")
    with_direction = FORMULATIONS[formulation]
    scaling = Scaling(case.x, case.y)

    def fit(x, y, candidate):
        lags, inputs, outputs = candidate["lags"], scaling.inputs(x, with_direction), scaling.output(y)
        rows = [regressors(inputs, outputs, row, lags) for row in range(lags, len(x))]
        network = MLPRegressor(
            hidden_layer_sizes=candidate["hidden"],
            activation="tanh",
            solver="lbfgs",
            alpha=candidate["penalty"],
            max_iter=1000,
            max_fun=30_000,
            random_state=candidate["seed"],
        )
        return lags, network.fit(np.array(rows), outputs[lags:])

    def simulate(model, x, start):
        lags, network = model
        inputs, outputs = scaling.inputs(x, with_direction), np.empty(len(x))
        outputs[:lags] = scaling.output(start[:lags])
        layers = list(zip(network.coefs_, network.intercepts_))
        for row in range(lags, len(x)):
            # What network.predict computes, without the checks that it makes at every call.
            signal = regressors(inputs, outputs, row, lags)
            for weights, bias in layers[:-1]:
                signal = np.tanh(signal @ weights + bias)
            weights, bias = layers[-1]
            outputs[row] = np.clip((signal @ weights + bias)[0], -BEYOND, BEYOND)
        return scaling.back(outputs)

    model, best = choose(CANDIDATES, case, fit, simulate)
    hidden = " and ".join(map(str, best["hidden"]))
    note = f"{best['lags']} lags, {hidden} neurons, of {len(CANDIDATES)} candidates"
    return note, simulate(model, case.x, case.y), simulate(model, case.test_x, case.test_start)


def regressors(inputs, outputs, row, lags):
    """The present input, and earlier inputs and outputs."""
    return np.concatenate([inputs[row - lags : row + 1].ravel(), outputs[row - lags : row]])
