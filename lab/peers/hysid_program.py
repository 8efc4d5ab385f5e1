"""Ours: the program, checked against the numpy reference, and the laboratory, which measures its speeds."""

import csv
import json
import subprocess
from pathlib import Path

import numpy as np

import network as reference

REPOSITORY = Path(__file__).resolve().parents[2]

SPEEDS = {
    "simulate": ("simulate_ns_per_sample", 1e-9 * reference.SAMPLES),
    "evaluation": ("genetic_evaluation_us", 1e-6),
    "population_fit": ("genetic_generation_ms", 1e-3),
}
"""For each task we measure: the key of `bench --json` of the laboratory, and the seconds of its unit."""


class Failure(Exception):
    """What to tell the user, in one line."""


def build():
    """Builds the program; returns its path."""
    command = ["cargo", "build", "--release", "-p", "hysid-cli", "--message-format=json-render-diagnostics"]
    try:
        built = subprocess.run(command, cwd=REPOSITORY, stdout=subprocess.PIPE, text=True)
    except FileNotFoundError:
        raise Failure("cargo is not installed: install Rust, or name a built program with --hysid") from None
    if built.returncode != 0:
        raise Failure("cargo build failed, see above; --hysid PATH takes a program that is built")
    # Cargo may have been told to put it anywhere.
    messages = [json.loads(line) for line in built.stdout.splitlines()]
    return Path(next(m["executable"] for m in messages if m.get("target", {}).get("kind") == ["bin"]))


def ask(program, *arguments, folder=None):
    """Runs the program; returns what it prints."""
    try:
        done = subprocess.run([program, *map(str, arguments)], cwd=folder, capture_output=True, text=True)
    except OSError as error:
        raise Failure(f"{program} does not run: {error.strerror}") from None
    if done.returncode != 0:
        complaint = (done.stderr.strip() or "no message").splitlines()[-1]
        raise Failure(f"`{Path(program).name} {arguments[0]}` failed: {complaint}")
    return done.stdout


def speeds():
    """Seconds of each task that the laboratory measures, with the library of this repository."""
    bench = json.loads(ask("cargo", "run", "--release", "--quiet", "--", "bench", "--json", folder=REPOSITORY / "lab"))
    return {task: bench[key]["value"] * seconds for task, (key, seconds) in SPEEDS.items() if key in bench}


def fitted_model(program, folder):
    """The network of a model of the record of `bench`, as that command fits it."""
    time, x = reference.bench_input(reference.POPULATION_SAMPLES)
    write_table(folder / "bench.csv", t=time, x=x, y=reference.bench_output(x))
    sizes = ["--stops", reference.STOPS, "--hidden", reference.HIDDEN]
    options = ["--model", "xpnn", *sizes, "--rate", "central", "--starts", 1, "--no-report"]
    ask(program, "fit", folder / "bench.csv", *options, "-o", folder / "model.json")
    model = json.loads((folder / "model.json").read_text())
    return model["network"]


def difference(program, model, folder):
    """Largest relative difference between `hysid simulate` and the reference on a random record."""
    draw = np.random.default_rng(2)
    time = np.cumsum(draw.uniform(0.005, 0.015, 5000))
    x = sum(0.5 * np.sin(draw.uniform(0.2, 5.0) * time + draw.uniform(0, 6)) for _ in range(4))
    write_table(folder / "drive.csv", t=time, x=x)
    table = ask(program, "simulate", folder / "model.json", folder / "drive.csv")
    found = np.array([float(row["y_model"]) for row in csv.DictReader(table.splitlines())])
    scaling = model["scaling"]
    rate = reference.central_rate(time, x) / scaling["rate"]
    scaled = reference.simulate(reference.from_model_file(model), x / scaling["inputs"][0], rate)
    expected = scaling["output_mean"] + scaling["output_deviation"] * scaled
    return float(np.max(np.abs(found - expected)) / np.max(np.abs(expected)))


def write_table(path, **columns):
    """A CSV file with every digit."""
    rows = zip(*(values.tolist() for values in columns.values()))
    path.write_text("\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows)]) + "\n")
