"""Types, as a type checker sees them."""

import inspect
import subprocess
import sys
from pathlib import Path

import hysid


def test_simulate_gives_what_it_takes():
    tests = Path(__file__).parent
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file", "pyproject.toml", "tests/types_of_simulate.py"]
    checked = subprocess.run(command, cwd=tests.parent, capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_dir_lists_what_is_public_and_nothing_else():
    listed = dir(hysid)
    assert set(listed) == {*hysid.__all__, "__version__"}
    assert "plot" in listed and "HysteresisRegressor" in listed
    assert not any(name.startswith("_") for name in hysid.__all__)
    assert inspect.ismodule(hysid.plot) and set(hysid.plot.__all__) <= set(dir(hysid.plot))
    script = "import sys, hysid; dir(hysid); print([name for name in ('matplotlib', 'sklearn') if name in sys.modules])"
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]", "to list names imports nothing"
