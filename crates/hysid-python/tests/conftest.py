"""Fixtures of several tests."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import hysid


class Program:
    """The program `hysid`, of the same sources."""

    def __init__(self, path):
        self.path = path

    def __call__(self, *arguments, folder):
        command = [self.path, *map(str, arguments)]
        return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture(scope="session")
def program():
    path = os.environ.get("HYSID_PROGRAM")
    if path is None or not Path(path).exists():
        pytest.fail("HYSID_PROGRAM must be the path of the program hysid (cargo xtask test sets it)")
    return Program(Path(path).resolve())


@pytest.fixture(scope="session")
def spring_and_slider():
    """Input and output of a spring beside a friction slider."""
    angle = np.linspace(0, 60, 600)
    x = 6 * angle / 60 * np.sin(angle)
    return x, 0.2 * x + hysid.operators.stop(x, r=1.0)


@pytest.fixture(scope="session")
def quick_model(spring_and_slider):
    """A small network fitted to the spring and slider."""
    return hysid.fit(*spring_and_slider, model="xpnn+", stops=4, hidden=3, starts=1, epochs=5)


@pytest.fixture(scope="session")
def hasty():
    """Decisions that leave `auto` little to try."""
    sizes = {"stops": 3, "hidden": 2, "starts": 2, "epochs": 2, "members": 6}
    return {**sizes, "no_deterioration": True, "compression": 0.0, "history": False, "warm_up": 0}


@pytest.fixture(scope="session")
def quick_ensemble(spring_and_slider, hasty):
    """Ensemble that validation chooses among few candidates with short training."""
    x, y = spring_and_slider
    return hysid.fit(x, np.where(np.arange(len(y)) % 3 == 0, y, np.nan), **hasty)
