"""The examples of the repository: each prints what its Rust twin prints, which is in the text file of its name."""

import runpy
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.mark.parametrize("name", sorted(path.stem for path in EXAMPLES.glob("*.py")))
def test_an_example_prints_what_its_twin_prints(name):
    report = runpy.run_path(str(EXAMPLES / f"{name}.py"))["report"]
    assert report() == (EXAMPLES / f"{name}.txt").read_text()
    assert (EXAMPLES / f"{name}.rs").exists()
