"""Tables of the results, as Markdown."""

import datetime
import os
import platform
import statistics
import subprocess
import sys
from importlib.metadata import version

import network as reference

PEERS = ("numba", "JAX")

TITLES = {
    "simulate": ("simulation, 1 thread", "ns a sample", 1e9 / reference.SAMPLES),
    "evaluation": ("one individual, least squares, 1 thread", "µs", 1e6),
    "population": ("50 individuals, output weights given, all cores", "ms", 1e3),
    "population_fit": ("50 individuals, least squares, all cores", "ms", 1e3),
}
"""For each task: title, unit, and its units in a second."""


def medians(rounds):
    """Our median seconds by task, and the peers' by (peer, task, formulation)."""

    def over(part):
        keys = {key for one in rounds for key in one[part]}
        return {key: statistics.median(one[part][key] for one in rounds if key in one[part]) for key in keys}

    return over(0), over(1)


def ratios(rounds, key):
    """Peer's seconds to ours, round by round."""
    return [peers[key] / ours[key[1]] for ours, peers in rounds if key in peers and key[1] in ours]


def best(rounds, peer, task):
    """The peer's fastest formulation of those that were run in every round."""
    _, peers = medians(rounds)
    always = set.intersection(*(set(peers) for _, peers in rounds))
    return min((key for key in always if key[:2] == (peer, task)), key=peers.get)


def figure(value):
    """Three digits."""
    return f"{value:.{max(0, 3 - len(str(int(value))))}f}"


def ratio(rounds, key):
    found = sorted(ratios(rounds, key))
    if not found:
        return "–"
    return f"**{statistics.median(found):.2f}** ({found[0]:.2f} to {found[-1]:.2f})"


def table(rounds):
    """Ours and each peer's best."""
    ours, peers = medians(rounds)
    lines = [
        "| task | unit | hysid | numba | numba / hysid | JAX | JAX / hysid |",
        "|---|---|---:|---:|---:|---:|---:|",
    ]
    for task, (title, unit, scale) in TITLES.items():
        mine = figure(scale * ours[task]) if task in ours else "not measured"
        cells = [title, unit, mine]
        for peer in PEERS:
            key = best(rounds, peer, task)
            cells += [figure(scale * peers[key]), ratio(rounds, key)]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def formulations(rounds):
    """Everything that was tried."""
    ours, peers = medians(rounds)
    lines = ["| task | peer | formulation | | / hysid |", "|---|---|---|---:|---:|"]
    for task, (title, unit, scale) in TITLES.items():
        for peer in PEERS:
            for key in sorted((key for key in peers if key[:2] == (peer, task)), key=peers.get):
                found = ratios(rounds, key)
                relation = f"{statistics.median(found):.2f}" if found else "–"
                lines.append(
                    f"| {title} | {peer} | {key[2]} | {figure(scale * peers[key])} {unit} | {relation} |"
                )
    return "\n".join(lines)


def first_line(*command):
    """What a program says of itself; empty if it is not there."""
    try:
        said = subprocess.run(command, capture_output=True, text=True).stdout
    except OSError:
        return ""
    return said.strip().split("\n")[0]


def processor():
    try:
        with open("/proc/cpuinfo") as lines:
            names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    except OSError:
        names = []
    return names[0] if names else first_line("sysctl", "-n", "machdep.cpu.brand_string") or platform.machine()


def page(table, rounds, differences, program, load):
    """The whole of results.md."""
    packages = ", ".join(
        f"{name} {version(name)}" for name in ("numba", "llvmlite", "jax", "jaxlib", "numpy")
    )
    program_version = first_line(str(program), "--version") or "hysid"
    rust = first_line("rustc", "--version") or "Rust unknown"
    agreement = ", ".join(f"{name} {difference:.0e}" for name, difference in differences.items())
    # Without it a reader cannot tell a quiet machine from a busy one.
    busy = f", load {load[0]:.1f} at the beginning" if load else ""
    return f"""# Results

Written by `{" ".join(["python3", "lab/peers/run.py", *sys.argv[1:]])}`; see [README.md](README.md) for what it means.

{datetime.date.today()}, {os.cpu_count()} cores of {processor()}, {platform.system()}{busy}; {program_version}, {rust};
Python {platform.python_version()}, {packages}.

Medians of {len(rounds)} rounds. Ratios are taken in each round: median, and least to largest. Above 1 hysid is faster.

{table}

Largest relative difference from the numpy reference: {agreement}.

## All that was tried

The table above has the first of each peer. Those far behind were run in the first round only.

{formulations(rounds)}
"""
