"""Docstrings are run; everything public has one."""

import doctest
import importlib
import inspect
import json
import pkgutil
import re
import typing
from pathlib import Path

import numpy as np
import pytest

import hysid
from hysid import _options

MODULES = ["hysid", *(f"hysid.{module.name}" for module in pkgutil.iter_modules(hysid.__path__))]


def is_ours(thing):
    return getattr(thing, "__module__", "").startswith("hysid") and not inspect.ismodule(thing)


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_docstrings_are_true(name):
    module = importlib.import_module(name)
    failures = []
    for test in doctest.DocTestFinder(exclude_empty=True).find(module, globs={"np": np, "hysid": hysid}):
        doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(test, out=failures.append)
    assert not failures, "".join(failures)


def test_everything_public_is_explained():
    """NumPy's style: a summary, and each parameter with its type or shape."""
    public = [getattr(hysid, name) for name in hysid.__all__]
    modules = [thing for thing in public if inspect.ismodule(thing)]
    public += [getattr(module, name) for module in modules for name in module.__all__]
    seen = 0
    for thing in public:
        classes = filter(is_ours, thing.__mro__) if inspect.isclass(thing) else ()
        for part in (thing, *(part for one in classes for part in vars(one).values())):
            if not is_ours(part) or not callable(part) or getattr(part, "__name__", "_").startswith("_"):
                continue
            text = inspect.getdoc(part)
            assert text and text.splitlines()[0].endswith((".", ":")), part
            if inspect.isfunction(part):
                explained = [line for line in text.splitlines() if " : " in line or line.startswith("x, y")]
                names = {name.strip("* ") for line in explained for name in line.split(" : ")[0].split(",")}
                names |= {line.strip("* ") for line in text.splitlines()}
                for parameter in inspect.signature(part).parameters:
                    assert parameter in ("self", "cls") or parameter in names, (part, parameter)
                seen += 1
    assert seen > 30


def test_options_of_a_fit_are_in_groups_with_their_names():
    text = inspect.getdoc(hysid.fit)
    groups = ["Parameters", "Model", "Training", "Classical models", "Run", "Returns", "Raises", "Examples"]
    places = [text.index(f"\n{group}\n{'-' * len(group)}\n") for group in groups]
    assert places == sorted(places)
    literals = [value for name, value in vars(_options).items() if name.endswith("Name")]
    names = [name for literal in literals for name in typing.get_args(literal)]
    assert len(literals) == 6 and "xpnn+" in names and "saturated-up" in names
    assert all(f'"{name}"' in text for name in names)


@pytest.mark.parametrize("page", ["docs/python.md", "docs/tutorials/data-science.md", "crates/hysid-python/README.md"])
@pytest.mark.filterwarnings("ignore::hysid.HysidWarning")
def test_pages_are_true(page, tmp_path, monkeypatch):
    """The Python blocks of a page, one after the other, in a folder of their own."""
    import matplotlib

    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    text = (Path(__file__).parents[3] / page).read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert blocks
    names = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)


@pytest.mark.filterwarnings("ignore::hysid.HysidWarning")
def test_the_checksum_of_the_page_on_model_files_is_that_of_a_file():
    """As docs/model-file.md computes it."""
    page = (Path(__file__).parents[3] / "docs/model-file.md").read_text(encoding="utf-8")
    names = {}
    exec(re.search(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)[1], names)
    x = np.sin(np.arange(60) / 5)
    text = hysid.fit(x, x**3, model="masing").to_json()
    assert names["checksum"](text) == json.loads(text)["checksum"]


def test_importing_takes_in_only_numpy():
    import subprocess
    import sys

    script = "import sys, hysid; print([name for name in sys.argv[1:] if name in sys.modules])"
    heavy = ["sklearn", "matplotlib", "pandas", "polars", "xarray", "tqdm", "dask", "scipy", "multiprocessing"]
    said = subprocess.run([sys.executable, "-c", script, *heavy], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"
