"""The case that all identify, and how all are judged."""

from typing import NamedTuple

import numpy as np

import hysid

SPECIMENS = ("ferromagnet", "terfenol-rod")
NOISE_PERCENT = 0.5
HELD_OUT = 0.25
"""Share of the training record, its end, by which a peer chooses among its candidates."""


class Case(NamedTuple):
    """Training and test record; a blank output of the test is NaN, and not scored."""

    x: np.ndarray
    y: np.ndarray
    test_x: np.ndarray
    test_y: np.ndarray
    test_start: np.ndarray
    """Outputs without noise: the first of them are where a free run of a NARX model begins."""


def load(specimen):
    train, test = hysid.specimen(specimen).data(noise=NOISE_PERCENT)
    # Both records begin where the specimen is virgin, so that the first rows of one are those of the other.
    return Case(train.x, train.y, test.x, test.y, train.y)


def percent_of_std(measured, simulated):
    """Root mean square error in percent of the measured output's standard deviation; infinite for a run that
    left all bounds."""
    scored = ~np.isnan(measured)
    if not np.all(np.isfinite(simulated[scored])):
        return np.inf
    with np.errstate(over="ignore"):
        return 100 * np.sqrt(np.mean((simulated[scored] - measured[scored]) ** 2)) / measured[scored].std()


class Scaling:
    """Inputs to -1 ... 1, outputs to mean 0 and deviation 1, by the training data."""

    def __init__(self, x, y):
        self.largest, self.step = np.abs(x).max(), np.abs(np.diff(x)).max()
        self.mean, self.deviation = y.mean(), y.std()

    def inputs(self, x, with_direction):
        """The input, and if asked for its increment and the sign of it: with them a NARX model can tell rising
        from falling (Martins and Aguirre 2016)."""
        if not with_direction:
            return (x / self.largest)[:, None]
        increment = np.diff(x, prepend=x[0])
        return np.column_stack([x / self.largest, increment / self.step, np.sign(increment)])

    def output(self, y):
        return (y - self.mean) / self.deviation

    def back(self, y):
        return self.mean + self.deviation * y


def choose(candidates, case, fit, simulate):
    """Fits every candidate to the first part of the training record, and the one whose free run over all of it is best
    on the rest to the whole.

    `fit(x, y, candidate)` gives a model; `simulate(model, x, start)` runs it freely, `start` being measured
    outputs of which as many may be used as the model has lags. Gives the model and the candidate.
    """
    end = round((1 - HELD_OUT) * len(case.x))
    errors: list[float] = []
    for candidate in candidates:
        try:
            model = fit(case.x[:end], case.y[:end], candidate)
            run = simulate(model, case.x, case.y)
            errors.append(percent_of_std(case.y[end:], run[end:]))
        except (FloatingPointError, np.linalg.LinAlgError, ValueError):
            # What cannot be computed loses.
            errors.append(np.inf)
    # A model that was stable on the part may not be on the whole: then the next has its turn.
    for place in np.argsort(errors, kind="stable"):
        model = fit(case.x, case.y, candidates[place])
        if np.isfinite(percent_of_std(case.y, simulate(model, case.x, case.y))):
            break
    return model, candidates[place]
