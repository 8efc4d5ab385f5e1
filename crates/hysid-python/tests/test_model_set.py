"""Several outputs of a record: a model of each, in one object and one file."""

import zipfile

import numpy as np
import pandas
import polars
import pytest

import hysid
from hysid import ModelSet

LAW = {"model": "masing", "operators": 4}


@pytest.fixture(scope="module")
def outputs(spring_and_slider):
    x, force = spring_and_slider
    slip = np.where(np.arange(len(x)) % 7 == 0, np.nan, hysid.operators.play(x, r=0.7))
    return x, {"force [kN]": force, "slip [mm]": slip}


@pytest.fixture(scope="module")
def models(outputs):
    return hysid.fit(*outputs, **LAW)


def test_each_output_has_the_model_of_its_own_fit(outputs, models):
    x, y = outputs
    assert isinstance(models, ModelSet) and list(models) == list(y)
    for name, column in y.items():
        assert models[name] == hysid.fit(x, {name: column}, **LAW)
    simulated = models.simulate(x)
    assert simulated.shape == (len(x), 2)
    assert np.array_equal(simulated[:, 1], models["slip [mm]"].simulate(x))
    errors = models.evaluate(x, y)
    assert errors == {name: model.evaluate(x, {name: y[name]}) for name, model in models.items()}
    assert repr(models).count("<hysid.Model masing") == 2
    with pytest.raises(KeyError, match="the outputs are force"):
        models["moment"]


def test_several_outputs_come_in_many_forms(outputs, models):
    x, y = outputs
    frame = pandas.DataFrame({"x": x, **y})
    named = hysid.fit(frame, list(y), **LAW)
    assert list(named) == list(y) and named["force [kN]"].inputs == ["x"]
    assert named == hysid.fit(frame[["x"]], frame[list(y)], **LAW)
    simulated = named.simulate(frame)
    assert simulated.columns.tolist() == ["force [kN]_model", "slip [mm]_model"]
    assert np.array_equal(simulated.to_numpy(), models.simulate(x)) and simulated.index.equals(frame.index)
    table = polars.DataFrame({name: frame[name].to_numpy() for name in frame})
    assert hysid.fit(table, list(y), **LAW) == named and list(named.simulate(table)) == list(y)
    array = np.column_stack(list(y.values()))
    unnamed = hysid.fit(x, array, **LAW)
    assert list(unnamed) == ["y1", "y2"] and hysid.fit(x, array.tolist(), **LAW) == unnamed
    assert unnamed.evaluate(x, array)["y2"].rmse == models.evaluate(x, array)["slip [mm]"].rmse
    # A single column is one output, and has no set.
    assert isinstance(hysid.fit(x, array[:, :1], **LAW), hysid.Model)
    assert list(hysid.fit(frame[["x", "force [kN]"]], ["force [kN]"], **LAW)) == ["force [kN]"]


def test_lists_of_records_have_several_outputs_too(outputs):
    x, y = outputs
    array = np.column_stack(list(y.values()))
    parts = [slice(0, 250), slice(250, 600)]
    labels = np.repeat(["1", "2"], [250, 350])
    of_list = hysid.fit([x[part] for part in parts], [array[part] for part in parts], **LAW)
    assert of_list == hysid.fit(x, array, records=labels, **LAW)
    frames = [pandas.DataFrame({"x": x[part], "a": array[part, 0], "b": array[part, 1]}) for part in parts]
    named = hysid.fit(frames, ["a", "b"], **LAW)
    simulated = named.simulate(frames)
    assert [len(one) for one in simulated] == [250, 350]
    assert np.array_equal(simulated[1].to_numpy(), of_list.simulate([x[part] for part in parts])[1])


def test_they_are_one_file_and_its_members_are_model_files(models, tmp_path, program):
    path = tmp_path / "models.zip"
    models.save(path)
    assert ModelSet.load(path) == models
    first = path.read_bytes()
    models.save(path)
    assert path.read_bytes() == first
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        archive.extractall(tmp_path)
    assert names[1:] == ["1-force_kN.json", "2-slip_mm.json"]
    assert hysid.Model.load(tmp_path / names[1]) == models["force [kN]"]
    assert program("models", names[2], folder=tmp_path).returncode == 0
    # Another set takes its place, and the one before is kept.
    other = ModelSet([models["slip [mm]"]])
    other.save(path)
    assert ModelSet.load(path) == other and ModelSet.load(tmp_path / "models.zip.bak") == models
    foreign = tmp_path / "foreign.zip"
    with zipfile.ZipFile(foreign, "w") as archive:
        archive.writestr("a.txt", "mine")
    with pytest.raises(FileExistsError, match="replace it with force=True"):
        models.save(foreign)
    models.save(foreign, force=True)
    assert ModelSet.load(foreign) == models


def test_a_file_of_something_else_is_named(models, tmp_path):
    path = tmp_path / "models.zip"
    models.save(path)
    with pytest.raises(ValueError, match="models.zip: an archive of several models is read by hysid.ModelSet.load"):
        hysid.Model.load(path)
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    for name, broken, text in [
        ("damaged.zip", bytes(content), "damaged.zip: "),
        ("cut.zip", bytes(content[:-40]), "cut.zip: File is not a zip file"),
        ("text.zip", b"text", "text.zip: File is not a zip file"),
    ]:
        (tmp_path / name).write_bytes(broken)
        with pytest.raises(ValueError, match=text):
            ModelSet.load(tmp_path / name)
    with zipfile.ZipFile(tmp_path / "other.zip", "w") as archive:
        archive.writestr("a.txt", "mine")
    with pytest.raises(ValueError, match="other.zip: it is no archive of models"):
        ModelSet.load(tmp_path / "other.zip")


def test_shapes_that_do_not_agree_are_refused(outputs, models):
    x, y = outputs
    array = np.column_stack(list(y.values()))
    frame = pandas.DataFrame({"x": x, **y})
    for call, text in [
        (lambda: hysid.fit(x, array[:-1], **LAW), "output: has 599 values where the first input has 600"),
        (lambda: hysid.fit(frame, ["force [kN]", "moment"], **LAW), r"y\[1\]: x has no column 'moment'"),
        (lambda: hysid.fit(frame, ["x", "x"], **LAW), "the names of the outputs x, x are not all different"),
        (lambda: hysid.fit([x, x], [array, y["force [kN]"]], **LAW), "y: all records need the same outputs"),
        (lambda: models.evaluate(x, y["force [kN]"]), "y: 2 outputs are needed"),
        (lambda: models.evaluate(x, {"force [kN]": x, "moment": x}), "y has the outputs force .*, moment"),
        (lambda: models.evaluate(x, np.column_stack([x, x, x])), "y has the outputs y1, y2, y3"),
        (lambda: hysid.validate(x, array, model="masing"), "output: a one-dimensional array is needed"),
        (lambda: ModelSet([]), "at least one is needed"),
        (lambda: ModelSet([models["slip [mm]"]] * 2), "each of another output"),
    ]:
        with pytest.raises(ValueError, match=text):
            call()
