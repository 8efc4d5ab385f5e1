"""The comparison: ours and the peers in turns, round by round."""

import contextlib
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import case as cases
import hysid_program
import results
from hysid_program import Failure
from worker import ONE_CORE

HERE = Path(__file__).resolve().parent

TOLERANCE = 1e-9
"""Largest relative difference from the numpy reference."""

WORTH_REPEATING = 2.0
"""A formulation this many times slower than its peer's best in the first round is not run again."""

XLA_FLAGS = " ".join(
    [
        # Loops in scans become one compiled function each, not a chain of calls for every step.
        "--xla_backend_extra_options=xla_cpu_small_while_loop_byte_threshold=1000000000",
        # What fastmath is to numba.
        "--xla_cpu_enable_fast_math=true",
        "--xla_cpu_enable_fast_min_max=true",
        "--xla_cpu_prefer_vector_width=512",
    ]
)

WORK_STEALING = {
    # OpenMP waits for a thread that lost its core to another program; TBB gives its work to the other.
    "NUMBA_THREADING_LAYER_PRIORITY": "tbb workqueue omp",
    # Where pip puts libtbb, which numba looks for as a system library.
    "LD_LIBRARY_PATH": os.pathsep.join(
        filter(None, [str(Path(sys.prefix) / "lib"), os.environ.get("LD_LIBRARY_PATH")])
    ),
}

KEEP_MEMORY = {
    # glibc would give large arrays back to the system after each run, and fault them in again.
    "MALLOC_MMAP_MAX_": "0",
    "MALLOC_TRIM_THRESHOLD_": str(2**34),
}


class Worker:
    """A peer's process, see worker.py."""

    def __init__(self, peer, tasks, case_path, environment):
        self.peer = peer
        command = [sys.executable, str(HERE / "worker.py"), peer, str(case_path), *tasks]
        # A file: nobody would empty a pipe, and XLA may fill it.
        self.complaints = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.complaints,
            text=True,
            env=os.environ | KEEP_MEMORY | environment,
        )
        self.differences = self.answer()

    def answer(self):
        line = self.process.stdout.readline()
        if not line:
            self.complaints.seek(0)
            complaint = (self.complaints.read().strip() or "no message").splitlines()[-1]
            raise Failure(f"the {self.peer} process ended: {complaint}")
        return json.loads(line)

    def measure(self, wanted):
        """Runs the formulations wanted, names by task."""
        # A process that has ended has said why: `answer` finds it.
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.write(json.dumps(wanted) + "\n")
            self.process.stdin.flush()
        return self.answer()

    def close(self):
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()
        self.process.wait()


def start_workers(case_path):
    """Each is the peer's best setting for its tasks; what fits one task may not fit another."""
    cores = os.cpu_count()
    one_thread = {"XLA_FLAGS": XLA_FLAGS + " --xla_cpu_multi_thread_eigen=false", ONE_CORE: "1"}
    devices = {"XLA_FLAGS": f"{XLA_FLAGS} --xla_force_host_platform_device_count={cores}"}
    settings = [
        ("numba", cases.ONE_THREAD + cases.ALL_CORES, WORK_STEALING),
        ("JAX", cases.ONE_THREAD, one_thread),
        ("JAX", cases.ALL_CORES, {"XLA_FLAGS": XLA_FLAGS}),
        *([("JAX", cases.ALL_CORES, devices)] if cores > 1 else []),
    ]
    return [Worker(peer, tasks, case_path, environment) for peer, tasks, environment in settings]


def check(ours, workers):
    """All must compute the same."""
    compared = {"hysid": ours}
    for worker in workers:
        for task, ways in worker.differences.items():
            for name, difference in ways.items():
                compared[f"{worker.peer}, {name} ({task})"] = difference
    for name, difference in compared.items():
        if not difference <= TOLERANCE:
            raise Failure(f"{name} differs from the reference by {difference:.1e}, more than {TOLERANCE:.0e}")
    return {
        name: max(difference for key, difference in compared.items() if key.startswith(name))
        for name in ("hysid", *results.PEERS)
    }


def one_round(workers, wanted):
    """Our seconds by task, and the peers' by (peer, task, formulation)."""
    ours, peers = hysid_program.speeds(), {}
    for worker, names in zip(workers, wanted):
        for task, ways in worker.measure(names).items():
            for name, time in ways.items():
                if task in cases.ONE_THREAD and time["cores"] > 1.1:
                    raise Failure(f"{worker.peer}, {name} keeps {time['cores']:.1f} cores busy, not one")
                peers[worker.peer, task, name] = time["seconds"]
    return ours, peers


def worth_repeating(first_round, workers):
    """The formulations that may turn out the best of their peer, for each worker."""

    def best(peer, task):
        return min(seconds for key, seconds in first_round.items() if key[:2] == (peer, task))

    return [
        {
            task: [
                name
                for name in ways
                if first_round[worker.peer, task, name] < WORTH_REPEATING * best(worker.peer, task)
            ]
            for task, ways in worker.differences.items()
        }
        for worker in workers
    ]


def tell(text):
    print(text, file=sys.stderr, flush=True)


def compare(options, folder):
    tell("building hysid" if options.hysid is None else f"taking {options.hysid}")
    program = options.hysid.resolve() if options.hysid else hysid_program.build()
    model = hysid_program.fitted_model(program, folder)
    tell("running the numpy reference")
    cases.save(cases.build(model), folder / "case.npz")
    tell("compiling the peers")
    workers = start_workers(folder / "case.npz")
    try:
        differences = check(hysid_program.difference(program, model, folder), workers)
        load_before = os.getloadavg() if hasattr(os, "getloadavg") else None
        wanted = [{task: list(ways) for task, ways in worker.differences.items()} for worker in workers]
        rounds = []
        for number in range(options.rounds):
            tell(f"round {number + 1} of {options.rounds}")
            rounds.append(one_round(workers, wanted))
            if number == 0:
                wanted = worth_repeating(rounds[0][1], workers)
    finally:
        for worker in workers:
            worker.close()
    table = results.table(rounds)
    print(table)
    options.out.write_text(results.page(table, rounds, differences, program, load_before))
    tell(f"wrote {options.out}")


def run(options):
    """The whole comparison; returns the exit code."""
    try:
        with tempfile.TemporaryDirectory() as folder:
            compare(options, Path(folder))
    except Failure as failure:
        print(f"run.py: {failure}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0
