#!/usr/bin/env python3
"""Runs the same simulation and the same population evaluation here, in numba and in JAX.

Needs Python 3.11 or later, cargo, and the first time the network: it makes its own virtual environment.
"""

import argparse
import sys
from pathlib import Path

import environment

HERE = Path(__file__).resolve().parent


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


if __name__ == "__main__":
    options = arguments()
    environment.enter(HERE / ".venv", HERE / "requirements.txt")
    import comparison

    sys.exit(comparison.run(options))
