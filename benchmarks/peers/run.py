#!/usr/bin/env python3
"""Runs the same simulation and the same population evaluation here, in numba and in JAX.

Needs Python 3.11 or later, cargo, and the first time the network: it makes its own virtual environment.
"""

import argparse
import os
import subprocess
import sys
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
ENVIRONMENT = HERE / ".venv"
REQUIREMENTS = HERE / "requirements.txt"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hysid", type=Path, metavar="PATH", help="our program [default: built by cargo]")
    parser.add_argument("--rounds", type=int, default=5, metavar="N", help="rounds [default: 5]")
    parser.add_argument(
        "--out", type=Path, default=HERE / "results.md", metavar="FILE", help="[default: results.md here]"
    )
    given = parser.parse_args()
    if given.rounds < 1:
        parser.error("--rounds must be at least 1")
    return given


def enter_environment():
    """Goes on in the virtual environment with the pinned packages; makes it if need be."""
    if sys.version_info < (3, 11):
        sys.exit(f"run.py: Python 3.11 or later is needed, this is {sys.version.split()[0]}")
    python = ENVIRONMENT / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    installed = ENVIRONMENT / "installed.txt"
    if not installed.exists() or installed.read_text() != REQUIREMENTS.read_text():
        print("run.py: installing the peers into .venv", file=sys.stderr)
        try:
            venv.create(ENVIRONMENT, clear=True, with_pip=True)
        except (OSError, subprocess.CalledProcessError) as error:
            sys.exit(f"run.py: cannot make a virtual environment in {ENVIRONMENT}: {error}")
        install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        done = subprocess.run([*install, "-r", REQUIREMENTS], stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            complaint = (done.stderr.strip() or "no message").splitlines()[-1]
            sys.exit(f"run.py: cannot install the peers (is there a network?): {complaint}")
        installed.write_text(REQUIREMENTS.read_text())
    if Path(sys.prefix).resolve() != ENVIRONMENT:
        # Not exec: on Windows it would return to the shell at once.
        sys.exit(subprocess.run([python, *sys.argv]).returncode)


if __name__ == "__main__":
    options = arguments()
    enter_environment()
    import comparison

    sys.exit(comparison.run(options))
