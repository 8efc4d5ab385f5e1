#!/usr/bin/env python3
"""Speed of the Python package beside the library's own: free runs, single steps, import.

Run it with a Python that has the package: `target/python/bin/python benchmarks/python.py --program target/release/hysid`.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import hysid

SAMPLES = 1_000_000


def median_seconds(work, repetitions):
    """Of one call."""
    spent = []
    for _ in range(repetitions):
        began = time.perf_counter()
        work()
        spent.append(time.perf_counter() - began)
    return statistics.median(spent)


def fitted():
    """A model of the default size with rate and deterioration, of a spring and a slider."""
    time_stamps = np.linspace(0, 60, 1000)
    x = 6 * time_stamps / 60 * np.sin(time_stamps)
    y = 0.2 * x + hysid.operators.stop(x, r=1.0)
    return hysid.fit(x, y, time_stamps, model="xpnn", starts=1, epochs=5)


def library_nanoseconds(program, model):
    """What `hysid compare` and this have in common is the library: its own time for a sample, from the program."""
    said = subprocess.run([program, "bench", "--json"], capture_output=True, text=True, check=True).stdout
    return {name: measured["value"] for name, measured in json.loads(said).items() if "ns" in name}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True, metavar="PATH", help="the program hysid")
    program = parser.parse_args().program
    model = fitted()
    stamps = np.linspace(0, 60_000, SAMPLES)
    x = 5 * np.sin(stamps)
    rounds = []
    for _ in range(5):
        rounds.append(
            {
                **library_nanoseconds(program, model),
                "python simulate, ns a sample": 1e9 * median_seconds(lambda: model.simulate(x, stamps), 9) / SAMPLES,
                "python step, ns": 1e9 * median_seconds(lambda: steps(model, x[:20_000]), 9) / 20_000,
            }
        )
    imported = median_seconds(lambda: subprocess.run([sys.executable, "-c", "import hysid"], check=True), 15)
    bare = median_seconds(lambda: subprocess.run([sys.executable, "-c", "pass"], check=True), 15)
    for name in rounds[0]:
        print(f"{name:<40}{statistics.median(found[name] for found in rounds):9.1f}")
    print(f"{'import hysid, ms':<40}{1e3 * (imported - bare):9.1f}")


def steps(model, x):
    model.reset()
    step = model.step
    for place, value in enumerate(x.tolist()):
        step(value, place * 0.06)


if __name__ == "__main__":
    main()
