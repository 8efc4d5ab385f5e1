#!/usr/bin/env python3
"""Identifies the Bouc-Wen oscillator with our package and with jax-sysid, in turns, and writes a table of errors.

Needs Python 3.11 or later, cargo, and an internet connection at the first run: it makes its own virtual environment.
"""

import argparse
import contextlib
import io
import json
import os
import platform
import sys
import time
from datetime import date
from pathlib import Path

import environment
import own_process

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PERIOD = 8192
"""Rows of a period of the training multisine."""

NEURONS, STATES, ITERATIONS, STARTS = 16, 4, 7000, 2
"""Of jax-sysid: tanh neurons of each of its two layers, states, iterations of L-BFGS, and starts, which run side by
side. With these settings jax-sysid takes at least as long as `auto`."""

STARTS_OF_LINEAR_MODEL, EPOCHS_OF_LINEAR_MODEL = 4, (500, 1000)

OF_TESTS = 100
"""The seed of the tests is that of the training data plus this."""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    seeds = {"type": int, "nargs": "+", "default": range(1, 9), "metavar": "SEED"}
    parser.add_argument("--seeds", **seeds, help="of the training data [default: 1 to 8]")
    parser.add_argument("--out", type=Path, default=HERE / "oscillator.md", metavar="FILE", help="[default: %(default)s]")
    parser.add_argument("--one", nargs=2, metavar=("PACKAGE", "SEED"), help=argparse.SUPPRESS)
    return parser.parse_args()


def by_hysid(train):
    """Ours, without any option but the seed of the program's random numbers."""
    import hysid

    model = hysid.fit(train.x, train.y, train.time, records=train.records, seed=1, progress=False)
    return model.simulate


def by_jax_sysid(train):
    """A linear system with a tanh layer beside its state equation and one beside its output, from a linear model of
    its own. It gets the mean of the periods after the first, with their number as weight, as our fit does."""
    import jax
    import jax.numpy as jnp
    import numpy as np
    from jax_sysid.models import LinearModel, Model

    jax.config.update("jax_enable_x64", True)
    # Equal periods: the first, with its transient, and the mean of the others.
    periods = train.y.reshape(-1, PERIOD)
    outputs = np.concatenate([periods[0], periods[1:].mean(axis=0)])
    inputs = train.x[: 2 * PERIOD]
    weights = np.repeat([1.0, len(periods) - 1.0], PERIOD)[:, None]
    input_scale, output_scale = inputs.std(), outputs.std()
    u, y = (inputs / input_scale)[:, None], (outputs / output_scale)[:, None]

    def weighted(simulated, measured):
        return jnp.sum(weights * (simulated - measured) ** 2) / weights.sum()

    def prepared(model, adam_epochs, lbfgs_epochs):
        model.loss(output_loss=weighted, rho_x0=1e-8, rho_th=1e-8, train_x0=False)
        model.optimization(adam_eta=0.01, adam_epochs=adam_epochs, lbfgs_epochs=lbfgs_epochs, iprint=-1)
        return model

    def error(model):
        simulated, _ = model.predict(np.zeros(STATES), u)
        return float(weighted(simulated, y))

    linear = prepared(LinearModel(STATES, 1, 1, feedthrough=False), *EPOCHS_OF_LINEAR_MODEL)
    linear = min(linear.parallel_fit(y, u, seeds=range(STARTS_OF_LINEAR_MODEL)), key=error)
    a, b, c = balanced(*(np.asarray(matrix) for matrix in linear.ssdata()[:3]), u[:, 0])

    def layer(of_states, of_input, bias, states, input):
        return jnp.tanh(of_states @ states + of_input @ input + bias)

    def next_state(states, input, parameters):
        a, b, _, w, *first = parameters[:7]
        return a @ states + b @ input + w @ layer(*first, states, input)

    def output(states, input, parameters):
        c, (w, *second) = parameters[2], parameters[7:]
        return c @ states + w @ layer(*second, states, input)

    def first(seed):
        random = np.random.default_rng(seed)

        def of_layer(outputs):
            sizes = (outputs, NEURONS), (NEURONS, STATES), (NEURONS, 1), (NEURONS,)
            return [0.1 * random.normal(size=size) for size in sizes]

        return [a, b, c, *of_layer(STATES), *of_layer(1)]

    model = Model(STATES, 1, 1, state_fcn=jax.jit(next_state), output_fcn=jax.jit(output))
    model.init(params=first(0), x0=np.zeros(STATES))
    prepared(model, 0, ITERATIONS)
    with contextlib.redirect_stdout(io.StringIO()):
        models = model.parallel_fit(y, u, init_fcn=first, seeds=range(STARTS))
    model = min(models, key=error)

    def simulate(x, time):
        run, _ = model.predict(np.zeros(STATES), (x / input_scale)[:, None])
        return output_scale * np.asarray(run, dtype=float).ravel()

    return simulate


def balanced(a, b, c, inputs):
    """The same linear system in coordinates whose states are uncorrelated with variance 1 for these inputs, a suitable
    scale for the tanh layers."""
    import numpy as np

    states = np.zeros((len(inputs) + 1, len(a)))
    for row, input in enumerate(inputs):
        states[row + 1] = a @ states[row] + b[:, 0] * input
    forward = np.linalg.cholesky(np.cov(states.T))
    back = np.linalg.inv(forward)
    return back @ a @ forward, back @ b, c @ forward


PACKAGES = {"hysid": by_hysid, "jax-sysid": by_jax_sysid}


def one(package, seed):
    """Identifies one training record in this process and prints the errors on its tests."""
    import hysid
    import numpy as np

    specimen = hysid.specimen("bouc-wen-oscillator")
    (train, _), (_, test) = specimen.data(seed=seed), specimen.data(seed=seed + OF_TESTS)
    began = time.perf_counter()
    simulate = PACKAGES[package](train)
    seconds = time.perf_counter() - began
    errors = {}
    for record in dict.fromkeys(test.records):
        rows = test.records == record
        error = simulate(test.x[rows], test.time[rows]) - test.y[rows]
        errors[record] = float(np.sqrt(np.nanmean(error**2)))
    print(json.dumps({"errors": errors, "seconds": seconds}))


def identified(package, seed):
    found = own_process.result(__file__, package, str(seed))
    print(seed, package, found, file=sys.stderr)
    return found


def page(seeds):
    from importlib.metadata import version

    versions = ", ".join(f"{name} {version(name)}" for name in ("hysid", "jax-sysid", "jax"))
    lines = [
        "# Identification of an oscillator: Hysid and jax-sysid",
        "",
        "Made by `python3 lab/peers/oscillator.py`; what is compared, and how: [README.md](README.md).",
        "",
        f"{date.today()}, {os.cpu_count()} cores, {platform.system()}; Python {platform.python_version()}, {versions}.",
        "",
        "Root mean square errors of free runs in m, and those of Hysid divided by those of jax-sysid; seconds of the whole",
        "identification.",
        "",
        "| seed of training / tests | package | seconds | multisine | swept sine |",
        "|---|---|---:|---:|---:|",
    ]
    for seed in seeds:
        found = {package: identified(package, seed) for package in PACKAGES}
        for package, its in found.items():
            shown = [f"{its['seconds']:.0f}", *(f"{error:.2e}" for error in its["errors"].values())]
            lines.append(f"| {seed} / {seed + OF_TESTS} | {package} | {' | '.join(shown)} |")
        ours, theirs = (found[package]["errors"] for package in PACKAGES)
        ratios = " | ".join(f"{ours[record] / theirs[record]:.2f}" for record in ours)
        lines.append(f"| | ratio | | {ratios} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    options = arguments()
    package = ROOT / "crates" / "hysid-python"
    environment.enter(HERE / ".venv-identification", HERE / "identification" / "requirements.txt", [package])
    if options.one:
        one(options.one[0], int(options.one[1]))
    else:
        options.out.write_text(page(options.seeds))
