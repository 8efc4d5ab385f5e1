"""What all implementations are given, and what they must answer."""

from typing import NamedTuple

import numpy as np

import network as reference
from network import Network

ONE_THREAD = ("simulate", "evaluation")
ALL_CORES = ("population", "population_fit")


class Case(NamedTuple):
    """Inputs of the tasks, and the answers of the numpy reference."""

    network: Network
    x: np.ndarray
    rate: np.ndarray
    y: np.ndarray
    population: Network
    population_x: np.ndarray
    population_rate: np.ndarray
    population_y: np.ndarray
    target: np.ndarray
    features: np.ndarray
    weights: np.ndarray
    mean_squares: np.ndarray

    def difference(self, task, answer):
        """Largest difference from the reference, relative to the largest value."""
        if task == "simulate":
            return relative(answer, self.y)
        if task == "population":
            # Devices may have got some individuals twice, to have the same number each.
            return relative(np.asarray(answer)[: len(self.population_y)], self.population_y)
        # Of one individual: the first.
        answer = [np.asarray(part)[None] if task == "evaluation" else np.asarray(part) for part in answer]
        weights, mean_squares = (part[: len(self.weights)] for part in answer)
        features, expected_weights = self.features[: len(weights)], self.weights[: len(weights)]
        # Nearly parallel tanh neurons share a weight as rounding will have it: what counts is their sum.
        fitted = np.einsum("pnf,pf->pn", features, weights)
        expected = np.einsum("pnf,pf->pn", features, expected_weights)
        errors = mean_squares / self.mean_squares[: len(weights)] - 1
        return max(relative(fitted, expected), np.max(np.abs(errors)))


def relative(found, expected):
    found = np.asarray(found)
    if found.shape != expected.shape or not np.all(np.isfinite(found)):
        return np.inf
    return np.max(np.abs(found - expected)) / np.max(np.abs(expected))


def build(model):
    """The case of the network in a model file, and of a random population."""
    network = reference.from_model_file(model)
    _, x = reference.bench_input(reference.SAMPLES)
    # The rate that `bench` of the laboratory gives the network: any bounded function would do.
    rate = 1 - x * x
    time, population_x = reference.bench_input(reference.POPULATION_SAMPLES)
    population_rate = reference.central_rate(time, population_x)
    population_rate /= np.max(np.abs(population_rate))
    target = reference.bench_output(population_x)
    target = (target - target.mean()) / target.std()
    population = reference.random_population(seed=1)
    drive = population_x, population_rate
    features = reference.features(population, *drive)
    return Case(
        network,
        x,
        rate,
        reference.simulate(network, x, rate),
        population,
        *drive,
        reference.simulate_population(population, *drive),
        target,
        features,
        *reference.least_squares(features, target),
    )


def save(case, path):
    arrays = case._asdict()
    for owner in ("network", "population"):
        for name, values in arrays.pop(owner)._asdict().items():
            arrays[f"{owner}.{name}"] = values
    np.savez(path, **arrays)


def load(path):
    arrays = np.load(path)
    networks = {
        owner: Network(*(arrays[f"{owner}.{name}"] for name in Network._fields))
        for owner in ("network", "population")
    }
    return Case(**{name: networks.get(name) or arrays[name] for name in Case._fields})
