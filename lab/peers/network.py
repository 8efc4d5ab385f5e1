"""The network, what it is run on, and a plain numpy implementation that every other must agree with.

Equations: docs/theory.md (2.2), (2.3), (2.5), (2.6) and (3.2).
"""

from typing import NamedTuple

import numpy as np

STOPS = 10
HIDDEN = 10
FEATURES = 1 + HIDDEN
"""What the output weights multiply: the constant and the tanh neurons."""

SAMPLES = 1_000_000
POPULATION = 50
POPULATION_SAMPLES = 2000
RIDGE = 1e-6


class Network(NamedTuple):
    """Parameters of one network, or of a population: then each array has one more axis, the first."""

    stop_weights: np.ndarray
    """Weights of x and of its rate, a row for each stop."""
    beta: np.ndarray
    linear: np.ndarray
    hidden: np.ndarray
    """A row for each tanh neuron: bias, weight of the linear neuron, weights of the stops."""
    output: np.ndarray
    """Constant, then the weights of the tanh neurons."""


def from_model_file(model):
    """The network in a model file of `hysid fit`, parsed."""
    stops = model["memory"]["stops"]
    return Network(
        np.array([stop["weights"] for stop in stops]),
        np.exp([stop["ln_beta"] for stop in stops]),
        np.array(model["memory"]["linear"]),
        np.array(model["readout"]["hidden"]),
        np.array(model["readout"]["output"]),
    )


def random_population(seed):
    """Networks that slip, stick and wear out, as random starts of a search do."""
    draw = np.random.default_rng(seed)
    stop_weights = draw.normal(size=(POPULATION, STOPS, 2)) * [1.0, 0.3]
    stop_weights *= np.exp(draw.uniform(0.0, np.log(20.0), (POPULATION, STOPS, 1)))
    return Network(
        stop_weights,
        np.exp(draw.uniform(np.log(3.0), np.log(1e4), (POPULATION, STOPS))),
        draw.normal(size=(POPULATION, 2)),
        draw.normal(size=(POPULATION, HIDDEN, 2 + STOPS)) / np.sqrt(STOPS),
        draw.normal(size=(POPULATION, FEATURES)),
    )


def bench_input(samples):
    """Time and input of the record that `bench` of the laboratory makes."""
    time = 0.01 * np.arange(samples)
    return time, np.sin(3 * time) * (0.6 + 0.4 * np.sin(0.37 * time))


def bench_output(x):
    """Output of the specimen of `bench` of the laboratory: three stops and a cubic spring."""
    output = 0.1 * x**3
    for threshold in (0.1, 0.3, 0.7):
        play = 0.0
        for k, position in enumerate(x):
            play = min(max(play, position - threshold), position + threshold)
            output[k] += position - play
    return output


def central_rate(time, x):
    """theory.md (4.1) and (4.2)."""
    step = np.diff(time)
    slope = np.diff(x) / step
    share = step[:-1] / (step[:-1] + step[1:])
    inner = share * slope[1:] + (1 - share) * slope[:-1]
    return np.concatenate([slope[:1], inner, slope[-1:]])


def simulate(network, x, rate):
    """Output of one network."""
    return network.output[0] + features(one_as_population(network), x, rate)[0, :, 1:] @ network.output[1:]


def simulate_population(population, x, rate):
    """Outputs of every network, a row for each."""
    return np.einsum("pnf,pf->pn", features(population, x, rate), population.output)


def least_squares(features_of_all, target):
    """Output weights of every network, theory.md (3.2), and the mean square errors they leave."""
    weights, mean_squares = [], []
    # The constant bears no penalty.
    penalty = RIDGE * np.diag([0.0] + [1.0] * HIDDEN)
    for phi in features_of_all:
        weights.append(np.linalg.solve(phi.T @ phi / len(target) + penalty, phi.T @ target / len(target)))
        mean_squares.append(np.mean((phi @ weights[-1] - target) ** 2))
    return np.array(weights), np.array(mean_squares)


def features(population, x, rate):
    """Φ of every network: (individual, sample, feature)."""
    of_x, of_rate = np.moveaxis(population.stop_weights, -1, 0)
    z = np.empty((len(of_x), len(x), 1 + STOPS))
    z[:, :, 0] = population.linear[:, :1] * x + population.linear[:, 1:] * rate
    slip = np.zeros_like(of_x)
    for k in range(len(x)):
        v = of_x * x[k] + of_rate * rate[k]
        if k == 0:
            # The jump from the virgin state is no slip.
            play = np.clip(0.0, v - 1, v + 1)
        moved = np.minimum(np.maximum(play, v - 1), v + 1)
        slip += np.abs(moved - play)
        play = moved
        z[:, k, 1:] = (v - play) * np.maximum(0.0, 1 - slip / population.beta)
    bias, weights = population.hidden[:, None, :, 0], population.hidden[:, :, 1:]
    h = np.tanh(bias + z @ weights.swapaxes(1, 2))
    return np.concatenate([np.ones((*h.shape[:2], 1)), h], axis=2)


def one_as_population(network):
    """A population of one."""
    return Network(*(parameters[None] for parameters in network))
