"""One peer in a process of its own: `worker.py PEER CASE TASK...`.

Prepares every formulation and tells its difference from the reference; then, for each line of names on
stdin, runs these formulations and tells their times. Answers are lines of JSON.
"""

import importlib
import json
import math
import os
import statistics
import sys
import time

import case as cases

ONE_CORE = "PEERS_ONE_CORE"
"""Environment variable that keeps the process on one core. XLA has at least two threads, its own and the
caller's, and lets both compute."""

BATCHES = 9
"""A time is the median of this many batches of runs, as in `bench` of the laboratory."""

SECONDS = 0.02
"""A batch takes at least so long, or one run: a shorter one would slip between two of another program's
turns on the core, which ours does not."""


def measure(run):
    """Seconds of a run, and how many cores it kept busy."""
    began = time.perf_counter()
    run()
    runs = math.ceil(SECONDS / (time.perf_counter() - began))
    times, cores = [], []
    for _ in range(BATCHES):
        busy, began = time.process_time(), time.perf_counter()
        for _ in range(runs):
            run()
        times.append(time.perf_counter() - began)
        cores.append((time.process_time() - busy) / times[-1])
    # Medians: the tidying up of something earlier may fall into one batch.
    return {"seconds": statistics.median(times) / runs, "cores": statistics.median(cores)}


def formulations(peer, case):
    """All of a peer's formulations, by task and name."""
    if peer == "numba":
        return importlib.import_module("numba_peer").formulations(case)
    jax_peer = importlib.import_module("jax_peer")
    return {
        "simulate": jax_peer.simulations(case),
        "evaluation": jax_peer.evaluations(case),
        **jax_peer.population_formulations(case),
    }


def main():
    peer, path, *tasks = sys.argv[1:]
    if ONE_CORE in os.environ and hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    # Libraries may print: only answers go to the parent.
    answers, sys.stdout = sys.stdout, sys.stderr
    case = cases.load(path)
    every = formulations(peer, case)
    runs = {task: every[task] for task in tasks}
    differences = {
        # The first run compiles.
        task: {name: float(case.difference(task, run())) for name, run in ways.items()}
        for task, ways in runs.items()
    }
    print(json.dumps(differences), file=answers, flush=True)
    for line in sys.stdin:
        wanted = json.loads(line)
        times = {task: {name: measure(runs[task][name]) for name in names} for task, names in wanted.items()}
        print(json.dumps(times), file=answers, flush=True)


if __name__ == "__main__":
    main()
