#!/usr/bin/env python3
"""Speed of the Python package beside the library's own: free runs, single steps, import.

    cargo xtask python     builds the package
    target/python/bin/python lab/python.py
"""

import json
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import hysid

LABORATORY = Path(__file__).resolve().parent
SAMPLES = 1_000_000
STEPS = 100_000
ROUNDS = 3


def median_seconds(work, repetitions):
    """Of one call."""
    spent = []
    for _ in range(repetitions):
        began = time.perf_counter()
        work()
        spent.append(time.perf_counter() - began)
    return statistics.median(spent)


def fitted():
    """A network of the size and the parts that `bench` of the laboratory runs: xpnn with rate and deterioration."""
    stamps = np.linspace(0, 60, 1000)
    x = 6 * stamps / 60 * np.sin(stamps)
    return hysid.fit(x, 0.2 * x + hysid.operators.stop(x, r=1.0), stamps, model="xpnn", starts=1, epochs=5)


def run_steps(model, x, stamps):
    model.reset()
    step = model.step
    for value, stamp in zip(x, stamps):
        step(value, stamp)


def round_of(model):
    """The library's figures from the laboratory, then ours: in turns, as a shared machine is not always as fast."""
    bench = ["cargo", "run", "--release", "--quiet", "--", "bench", "--json"]
    said = subprocess.run(bench, cwd=LABORATORY, stdout=subprocess.PIPE, text=True, check=True).stdout
    library = json.loads(said)
    stamps = np.linspace(0, 60_000, SAMPLES)
    x = 5 * np.sin(stamps)
    few = x[:STEPS].tolist(), stamps[:STEPS].tolist()
    return {
        "simulate, library, ns a sample": library["simulate_record_ns_per_sample"]["value"],
        "simulate, Python, ns a sample": 1e9 * median_seconds(lambda: model.simulate(x, stamps), 15) / SAMPLES,
        "step, library, ns": library["step_ns"]["value"],
        "step, Python, ns": 1e9 * median_seconds(lambda: run_steps(model, *few), 5) / STEPS,
    }


def import_milliseconds():
    """Of `import hysid` with all that it takes in, a process without it taken off."""
    bare, whole = (
        median_seconds(lambda: subprocess.run([sys.executable, "-c", script], check=True), 15)
        for script in ("pass", "import hysid")
    )
    return 1e3 * (whole - bare)


def main():
    model = fitted()
    rounds = [round_of(model) for _ in range(ROUNDS)]
    for name in rounds[0]:
        print(f"{name:<32}{statistics.median(found[name] for found in rounds):8.1f}")
    ratios = [
        found["simulate, Python, ns a sample"] / found["simulate, library, ns a sample"] for found in rounds
    ]
    print(f"{'simulate, Python / library':<32}{statistics.median(ratios):8.3f}")
    print(f"{'import hysid, ms':<32}{import_milliseconds():8.1f}")


if __name__ == "__main__":
    main()
