#!/usr/bin/env python3
"""Identifies the same synthetic specimens with our package and with three peers, and writes a table of errors.

Needs Python 3.11 or later, cargo, and the first time the network: it makes its own virtual environment.
"""

import argparse
import importlib
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
FOLDER = HERE / "identification"
PEERS = {
    "hysid": "hysid_peer",
    "SysIdentPy": "sysidentpy_peer",
    "jax-sysid": "jax_sysid_peer",
    "scikit-learn MLP": "mlp_peer",
}
VERSIONS = ("hysid", "sysidentpy", "jax-sysid", "jax", "scikit-learn", "numpy")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--out", type=Path, default=HERE / "identification.md", metavar="FILE", help="[default: identification.md here]"
    )
    parser.add_argument("--one", nargs=3, metavar=("PEER", "FORMULATION", "SPECIMEN"), help=argparse.SUPPRESS)
    return parser.parse_args()


def one(peer, formulation, specimen):
    """Identifies one specimen in this process; prints what became of it."""
    sys.path.insert(0, str(FOLDER))
    cases = importlib.import_module("case")
    module = importlib.import_module(PEERS[peer])
    case = cases.load(specimen)
    began = time.perf_counter()
    note, train, test = module.identify(case, formulation)
    seconds = time.perf_counter() - began
    errors = [cases.percent_of_std(*pair) for pair in ((case.y, train), (case.test_y, test))]
    print(json.dumps({"train": errors[0], "test": errors[1], "seconds": seconds, "note": note}))


def identified(peer, formulation, specimen):
    """The same in a process of its own."""
    found = own_process.result(__file__, peer, formulation, specimen)
    print(f"{specimen:<16}{peer:<18}{formulation:<46}{found['test']:9.3g} %{found['seconds']:8.1f} s", file=sys.stderr)
    return found


def everything():
    sys.path.insert(0, str(FOLDER))
    cases = importlib.import_module("case")
    for specimen in cases.SPECIMENS:
        rows = []
        for peer, module in PEERS.items():
            for formulation in importlib.import_module(module).FORMULATIONS:
                rows.append((peer, formulation, identified(peer, formulation, specimen)))
        yield specimen, sorted(rows, key=lambda row: row[2]["test"])


def page():
    from importlib.metadata import version

    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    versions = ", ".join(f"{name} {version(name)}" for name in VERSIONS)
    lines = [
        "# Identification beside peers",
        "",
        "Made by `python3 lab/peers/identify.py`; what is compared, and how: [README.md](README.md).",
        "",
        f"{date.today()}, {os.cpu_count()} cores, {platform.system()}, load {load:.1f} at the beginning; Python",
        f"{platform.python_version()}, {versions}.",
        "",
        "Errors of free runs in % of the measured output's standard deviation; seconds with the choice among all candidates.",
        "The best on unseen data comes first.",
    ]
    for specimen, rows in everything():
        lines += ["", f"## {specimen}", "", "| | | unseen % | training % | seconds | chosen |", "|---|---|---:|---:|---:|---|"]
        for peer, formulation, found in rows:
            shown = [f"{found[name]:.3g}" for name in ("test", "train", "seconds")]
            lines.append(f"| {peer} | {formulation} | {' | '.join(shown)} | {found['note']} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    options = arguments()
    package = ROOT / "crates" / "hysid-python"
    environment.enter(HERE / ".venv-identification", FOLDER / "requirements.txt", [package])
    if options.one:
        one(*options.one)
    else:
        options.out.write_text(page())
