#!/usr/bin/env python3
"""Many specimens, several models each, on as many processes or machines as there are: a study with Dask.

    python many_specimens.py                                  two worker processes on this machine
    python many_specimens.py --workers 1                      one, to compare the time
    python many_specimens.py --serial                         without Dask
    python many_specimens.py --scheduler tcp://10.0.0.1:8786  the workers of a cluster

The models do not depend on where they are fitted: the same data, options and seed give the same file.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import signal
import sys
import time

import numpy as np

import hysid

# Options of `hysid.fit`, by the name that the table shall have for them.
ARCHITECTURES = {
    "prandtl-ishlinskii": {"model": "prandtl-ishlinskii"},
    "xpnn, 4 stops": {"model": "xpnn", "stops": 4, "hidden": 4, "starts": 4, "epochs": 60},
    "xpnn, 10 stops": {"model": "xpnn", "stops": 10, "hidden": 10, "starts": 4, "epochs": 60},
}


def measured(specimen: int) -> tuple[np.ndarray, np.ndarray]:
    """Synthetic test record of a specimen: a spring beside sliders that wear out, and noise."""
    random = np.random.default_rng(specimen)
    angle = np.linspace(0, 16 * np.pi, 1600)
    displacement = (1 + 9 * angle / angle[-1]) * np.sin(angle)
    force = 0.1 * displacement
    for _ in range(3):
        strength, threshold, wear = random.uniform([0.5, 0.5, 100], [2.0, 4.0, 1000])
        force += strength * hysid.operators.deteriorating_stop(displacement, r=threshold, beta=wear)
    return displacement, force + 0.02 * force.std() * random.normal(size=len(force))


def identify(specimen: int, architecture: str) -> dict[str, object]:
    """One task. It takes numbers and gives text, so that next to nothing travels; one thread, as a worker has."""
    x, y = measured(specimen)
    model = hysid.fit(x, y, seed=specimen + 1, threads=1, **ARCHITECTURES[architecture])
    text = model.to_json()
    return {
        "specimen": specimen,
        "architecture": architecture,
        "error_percent": model.evaluate(x, y).nrmse_std_percent,
        "checksum": hashlib.sha256(text.encode()).hexdigest(),
        "model": text,
    }


def serial(tasks: list[tuple[int, str]]) -> list[dict[str, object]]:
    """One after the other, in this process."""
    return [identify(*task) for task in tasks]


def distributed(client, tasks, kill_one: bool = False) -> list[dict[str, object]]:
    """Side by side, on all workers of a cluster; what a worker had begun when it died is done by another.

    Each result is fetched as soon as it is there, and its future released: a worker that dies takes no finished result with it.
    """
    from dask.distributed import as_completed

    # Results have no side effects: a key that says what they are lets Dask do them again elsewhere.
    futures = client.map(identify, *zip(*tasks), pure=True)
    found = {}
    running = as_completed(futures, with_results=True)
    # No other reference to a future stays, so that releasing it makes Dask forget it.
    del futures
    for future, result in running:
        found[result["specimen"], result["architecture"]] = result
        future.release()
        if kill_one and len(found) == len(tasks) // 3:
            victim = next(iter(client.run(os.getpid).values()))
            os.kill(victim, signal.SIGKILL)
            print(f"killed the worker with process id {victim}", file=sys.stderr)
    return [found[task] for task in tasks]


def count_fits(dask_scheduler=None, prefix: str = "identify") -> None:
    """From now on the scheduler counts how often each task was finished, to see that none was done twice."""
    from distributed.diagnostics.plugin import SchedulerPlugin

    class Count(SchedulerPlugin):
        def __init__(self) -> None:
            self.finished = {}

        def transition(self, key, start, finish, *args, **kwargs) -> None:
            if finish == "memory" and str(key).startswith(prefix):
                self.finished[key] = self.finished.get(key, 0) + 1

    dask_scheduler.add_plugin(Count(), name="count")


def counted(dask_scheduler=None) -> tuple[int, int]:
    """How many tasks were finished, and how many of them more than once."""
    finished = dask_scheduler.plugins["count"].finished
    return len(finished), sum(1 for times in finished.values() if times > 1)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--serial", action="store_true", help="without Dask")
    where.add_argument("--workers", type=int, default=2, metavar="N", help="processes on this machine [default: 2]")
    where.add_argument("--scheduler", metavar="ADDRESS", help="of a cluster that runs already")
    parser.add_argument("--specimens", type=int, default=32, metavar="N", help="[default: 32]")
    parser.add_argument("--only", choices=ARCHITECTURES, help="one of the models [default: all]")
    parser.add_argument("--kill-one", action="store_true", help="kill a worker in the middle, to see what happens")
    parser.add_argument("--out", metavar="FILE.json", help="write all models")
    return parser.parse_args()


def main() -> None:
    given = arguments()
    names = [given.only] if given.only else list(ARCHITECTURES)
    tasks = [(specimen, name) for specimen in range(given.specimens) for name in names]
    if given.serial:
        began = time.perf_counter()
        found = serial(tasks)
    else:
        import dask
        from dask.distributed import Client, LocalCluster

        # Dask has its workers give memory back at once, of which a fit takes the same again at once: that costs a
        # quarter of the time. None leaves the allocator as it is.
        dask.config.set({"distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None})
        cluster = given.scheduler or LocalCluster(
            n_workers=given.workers, threads_per_worker=1, processes=True, dashboard_address=None
        )
        with Client(cluster) as client:
            # Workers import the package before the clock starts, as those of a cluster have long done.
            client.run(measured, 0)
            client.run_on_scheduler(count_fits)
            began = time.perf_counter()
            found = distributed(client, tasks, given.kill_one)
            print("{} fits finished, {} of them more than once".format(*client.run_on_scheduler(counted)))
        if not given.scheduler:
            cluster.close()
    seconds = time.perf_counter() - began
    for name in names:
        errors = [row["error_percent"] for row in found if row["architecture"] == name]
        print(f"{name:<20} median error {np.median(errors):6.2f} % of std over {len(errors)} specimens")
    print(f"{len(found)} models in {seconds:.1f} s")
    if given.out:
        with open(given.out, "w", encoding="utf-8") as file:
            json.dump(found, file)


if __name__ == "__main__":
    main()
