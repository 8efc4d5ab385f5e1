"""The same data, options and seed give the same model file, and the same texts."""

import inspect
import json
import re

import numpy as np
import pandas
import pytest

import hysid
from hysid import _hysid


def table(records, blank_every=None):
    frame = records.frame()
    output = records.names["output"]
    if blank_every:
        frame.loc[::blank_every, output] = np.nan
    return frame


def options(keywords):
    """Keywords as the program has them."""
    for name, value in keywords.items():
        flag = "--" + name.replace("_", "-")
        if isinstance(value, bool) and name != "free_weights":
            yield from [flag] * value
        elif isinstance(value, list):
            yield f"{flag}={','.join(map(str, value))}"
        else:
            yield f"{flag}={str(value).lower() if isinstance(value, bool) else value}"


SMALL = {"model": "xpnn+", "stops": 4, "hidden": 3, "starts": 2, "epochs": 6}

CASES = {
    "members of one model": ("terfenol-rod", {**SMALL, "members": 3, "seed": 2}, "auto", None),
    "few epochs": ("terfenol-rod", SMALL, "auto", None),
    "compressed, history, warm-up": (
        "piezo-actuator",
        {**SMALL, "compression": 0.1, "rate_compression": 0.2, "history": True, "warm_up": 5},
        "auto",
        None,
    ),
    "initial states": ("piezo-actuator", {**SMALL, "initial_state": "unknown"}, "auto", None),
    "rate-dependent, records, seed": ("piezo-actuator", {**SMALL, "model": "xpnn", "seed": 7}, "auto", None),
    "other rate": ("piezo-actuator", {**SMALL, "validation": 0.4, "seed": 3}, "backward", None),
    "blanks": ("reinforced-concrete-joint", {**SMALL, "no_deterioration": True}, "none", 3),
    "paper's training": (
        "terfenol-rod",
        {"model": "preisach-nn", "stops": 3, "hidden": 2, "training": "hybrid", "epochs": 8, "population": 6},
        "auto",
        None,
    ),
    "linear model": ("terfenol-rod", {"model": "masing", "thresholds": [0.5, 1.5]}, "auto", None),
    "searched model": (
        "terfenol-rod",
        {"model": "generalized-prandtl-ishlinskii", "starts": 1, "epochs": 5, "free_weights": True},
        "auto",
        None,
    ),
    "model with inertia": (
        "shear-building",
        {"model": "hysteretic-state-space", "modes": 1, "states": 1, "hidden": 2, "starts": 1, "epochs": 2},
        "auto",
        None,
    ),
    "deteriorating model with inertia": (
        "shear-building",
        {"model": "hysteretic-oscillator", "degradation": True, "operators": 2, "starts": 1, "epochs": 2},
        "auto",
        None,
    ),
}


@pytest.mark.filterwarnings("ignore:warm-up", "ignore:initial state")
@pytest.mark.parametrize("case", CASES)
def test_model_files_are_the_same_byte_by_byte(case, program, tmp_path):
    name, keywords, rate, blank_every = CASES[case]
    train, _ = hysid.specimen(name).data(noise=0.5)
    frame = table(train, blank_every)
    frame.to_csv(tmp_path / "train.csv", index=False)
    arguments = ["fit", "train.csv", "-o", "model.json", "--no-report", f"--rate={rate}", *options(keywords)]
    done = program(*arguments, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    names = train.names
    time = frame[names["time"]] if "time" in names else None
    model = hysid.fit(
        frame[names["input"]], frame[names["output"]], time, rate, frame["record"], threads=1, **keywords
    )
    model.save(tmp_path / "python.json")
    assert (tmp_path / "python.json").read_bytes() == (tmp_path / "model.json").read_bytes()


def test_what_validation_chooses_is_the_same_by_default(program, spring_and_slider, hasty, tmp_path):
    x, y = spring_and_slider
    frame = pandas.DataFrame({"u": x[::3], "f": y[::3]})
    frame.to_csv(tmp_path / "train.csv", index=False)
    # A flag of the program is there or is not: it cannot say that there shall be no history.
    hasty = {name: value for name, value in hasty.items() if value is not False}
    done = program("fit", "train.csv", "-o", "m.json", "--no-report", *options(hasty), folder=tmp_path)
    assert done.returncode == 0, done.stderr
    model = hysid.fit(frame["u"], frame["f"], records=["train"] * len(frame), **hasty)
    assert len(model.description["training"]["selection"]["candidates"]) > 1
    assert model.to_json() == (tmp_path / "m.json").read_text()


def test_a_measured_rate_gives_the_same_file(program, tmp_path):
    train, _ = hysid.specimen("piezo-actuator").data()
    frame = train.frame()
    frame["speed"] = np.gradient(train.x, train.time)
    frame.to_csv(tmp_path / "train.csv", index=False)
    arguments = ["--rate", "speed", "-o", "model.json", "--no-report", *options(SMALL)]
    done = program("fit", "train.csv", *arguments, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    model = hysid.fit(
        {train.names["input"]: train.x},
        {train.names["output"]: train.y},
        frame[train.names["time"]],
        frame["speed"],
        frame["record"],
        **SMALL,
    )
    assert model.to_json() == (tmp_path / "model.json").read_text()


def test_errors_of_a_free_run_are_the_program_s(program, tmp_path):
    train, test = hysid.specimen("terfenol-rod").data()
    frame = test.frame()
    frame.to_csv(tmp_path / "test.csv", index=False)
    model = hysid.fit({train.names["input"]: train.x}, {train.names["output"]: train.y}, **SMALL)
    model.save(tmp_path / "model.json")
    done = program("evaluate", "model.json", "test.csv", "--json", folder=tmp_path)
    errors = model.evaluate(test.x, test.y, test.time, records=test.records)
    assert json.loads(done.stdout) == errors.as_dict()


def test_the_inverse_of_a_record_is_the_program_s(program, tmp_path):
    train, test = hysid.specimen("magnetostrictive-actuator").data()
    names = train.names
    model = hysid.fit(
        {names["input"]: train.x},
        {names["output"]: train.y},
        pandas.Series(train.time, name=names["time"]),
        records=train.records,
        model="rate-dependent-prandtl-ishlinskii",
    )
    model.save(tmp_path / "model.json")
    rows = np.isfinite(test.y) & (test.records == test.records[0])
    wanted, time = test.y[rows], test.time[rows]
    pandas.DataFrame({names["time"]: time, names["output"]: wanted}).to_csv(tmp_path / "wanted.csv", index=False)
    done = program("invert", "model.json", "wanted.csv", "-o", "drive.csv", "--json", "--slew=1e4", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    found = model.invert(wanted, time, slew=1e4)
    drive = pandas.read_csv(tmp_path / "drive.csv", dtype=str)
    assert json.loads(done.stdout)["previews"] == [found.preview]
    assert np.array_equal(drive[names["input"]].astype(float), found.input)
    assert np.array_equal(drive[f"{names['output']}_reached"].astype(float), found.output)
    assert np.array_equal(drive["reach"], found.reach)
    assert np.array_equal(drive["extrapolated"] == "yes", found.extrapolated)


def test_options_have_the_program_s_names(program, tmp_path):
    """One name everywhere: what the program takes for a model and its training, `fit` takes too."""
    usage = program("fit", "--help", "options", folder=tmp_path).stdout
    offered = {name.replace("-", "_") for name in re.findall(r"^\s+(?:-\w, )?--([a-z-]+)", usage, re.M)}
    keywords = set(inspect.signature(hysid.fit).parameters)
    assert set(_hysid.option_names()) <= keywords
    # Names of columns and of files are not needed where the data are at hand.
    files = {"record", "time", "input", "output", "inverse", "out", "json", "no_report", "help", "checkpoint"}
    # How a file is read: Python takes arrays.
    files |= {"delimiter", "decimal", "skip", "no_header", "units_row", "missing", "encoding", "sheet"}
    files |= {"rows", "every", "zero", "quiet"}
    files |= {"resume", "force", "title"}
    assert offered - files == keywords - {"x", "y", "time", "records", "progress", "sample_weight"}


@pytest.mark.parametrize(
    "keywords",
    [{"model": "masing", "stops": 3}, {"model": "masing", "modes": 2}, {"model": "pnn", "population": 20, "epochs": 2, "starts": 1}],
)
def test_ignored_options_are_warned_of_in_the_same_words(keywords, program, tmp_path):
    train, _ = hysid.specimen("terfenol-rod").data()
    train.frame().to_csv(tmp_path / "train.csv", index=False)
    said = program("fit", "train.csv", *options(keywords), folder=tmp_path).stderr
    with pytest.warns(hysid.HysidWarning) as warned:
        hysid.fit(train.x, train.y, **keywords)
    assert warned
    for warning in warned:
        assert re.search(str(warning.message), said.replace("--", ""))
        assert warning.filename == __file__


@pytest.mark.parametrize(
    ("keywords", "text"),
    [
        ({"model": "masin"}, 'model "masin": choose one of auto, pnn, gpnn'),
        ({"starts": 0}, "starts 0: choose a whole number from 1 to 10000"),
        ({"validation": 2.0}, "a number between 0 and 1 is needed"),
        ({"training": "lm"}, 'training "lm": choose one of subgradient, levenberg-marquardt'),
        ({"thresholds": [1.0, 0.5], "model": "masing"}, "thresholds"),
        ({"time_limit": -1.0}, "a number of seconds above 0, below 1e9, is needed"),
        ({"threads": 0}, "threads 0: choose 1 to 1024"),
        ({"rate": "forward"}, "rate `forward` is unknown"),
        ({"rate": "central"}, "rate='central' needs time stamps"),
        ({"model": "rate-dependent-prandtl-ishlinskii"}, "needs the rate of the input"),
        ({"model": "hysteretic-oscillator"}, "hysteretic-oscillator needs the time of each row"),
        ({"modes": 11}, "modes 11: choose a whole number from 1 to 10"),
        ({"sign": "positive"}, 'sign "positive": choose one of any, non-negative'),
    ],
)
def test_options_outside_their_meaning_are_value_errors(keywords, text, spring_and_slider):
    with pytest.raises(ValueError, match=re.escape(text)):
        hysid.fit(*spring_and_slider, **keywords)


def test_an_unknown_option_is_refused(spring_and_slider):
    with pytest.raises(TypeError, match="stop"):
        hysid.fit(*spring_and_slider, stop=3)
    with pytest.raises(ValueError, match="there is no option `stop`: the options are model, members"):
        _hysid.FitSpec('{"stop": 3}', "auto", hysid._data.columns(*spring_and_slider, *[None] * 3).dataset())


def test_names_of_pandas_objects_become_columns_and_units():
    train, _ = hysid.specimen("terfenol-rod").data()
    frame = pandas.DataFrame({"H [kA/m]": train.x, "strain": train.y})
    model = hysid.fit(frame[["H [kA/m]"]], frame["strain"], model="masing")
    assert (model.inputs, model.output) == (["H [kA/m]"], "strain")
    assert model.description["units"]["inputs"] == ["kA/m"]
