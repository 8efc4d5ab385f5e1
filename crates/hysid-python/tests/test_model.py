"""Fitted models: files, free runs, single steps."""

import os
import pickle
import stat
import subprocess
import sys
import threading

import numpy as np
import pandas
import pytest

import hysid
from hysid._data import columns


def test_a_file_gives_the_same_model_back(quick_model, tmp_path):
    path = tmp_path / "model.json"
    quick_model.save(path)
    assert hysid.Model.load(path) == quick_model
    other = tmp_path / "other"
    other.touch()
    assert stat.S_IMODE(path.stat().st_mode) == stat.S_IMODE(other.stat().st_mode)
    path.chmod(0o600)
    quick_model.save(os.fspath(path))
    assert stat.S_IMODE(path.stat().st_mode) == 0o600, "permissions are not widened"
    assert sorted(os.listdir(tmp_path)) == ["model.json", "other"]


def test_only_a_model_is_replaced_and_it_is_kept(quick_model, quick_ensemble, tmp_path):
    path = tmp_path / "model.json"
    path.write_text("measured")
    with pytest.raises(FileExistsError, match="no model of Hysid: .* force=True"):
        quick_model.save(path)
    assert path.read_text() == "measured"
    quick_model.save(path, force=True)
    assert (tmp_path / "model.json.bak").read_text() == "measured"
    quick_model.save(path)
    assert sorted(os.listdir(tmp_path)) == ["model.json", "model.json.bak"], "the same again"
    quick_ensemble.save(path)
    assert hysid.Model.load(path) == quick_ensemble
    assert hysid.Model.load(tmp_path / "model.json.bak2") == quick_model
    assert (tmp_path / "model.json.bak").read_text() == "measured"
    with pytest.raises(FileNotFoundError):
        quick_model.save(tmp_path / "missing" / "model.json")
    with pytest.raises(IsADirectoryError):
        quick_model.save(tmp_path)


@pytest.mark.skipif(os.name != "posix", reason="links and pipes of Unix")
def test_an_export_is_compiled_and_passes_its_own_test(quick_model, tmp_path):
    folder = tmp_path / "piezo-stage"
    files = quick_model.export("c", folder)
    assert sorted(files) == sorted(os.listdir(folder))
    assert {"piezo_stage.c", "piezo_stage.h", "manifest.json", "README.md"} <= set(files)
    sources = ["piezo_stage.c", "piezo_stage_test.c"]
    subprocess.run(["cc", "-std=c99", "-ffp-contract=off", "-o", "test", *sources, "-lm"], cwd=folder, check=True)
    subprocess.run(["./test"], cwd=folder, check=True)
    (folder / "README.md").write_text("mine")
    with pytest.raises(FileExistsError, match="force=True"):
        quick_model.export("c", folder)
    quick_model.export("c", folder, name="stage", precision="f32", force=True)
    assert (folder / "README.md.bak").read_text() == "mine"
    assert {"stage.c", "test"} <= set(os.listdir(folder)) and "piezo_stage.c" not in os.listdir(folder)
    for arguments, message in [
        ({"to": "cobol"}, "target"),
        ({"name": "2 x"}, "identifier"),
        ({"precision": "f16"}, "precision 'f16'"),
        ({"rate": "central"}, "rate 'central'"),
    ]:
        with pytest.raises(ValueError, match=message):
            quick_model.export(**{"to": "c", "folder": tmp_path / "new", **arguments})
    assert not (tmp_path / "new").exists()


@pytest.mark.skipif(os.name != "posix", reason="a C compiler of Unix")
def test_an_inverse_is_compiled_and_passes_its_own_test(quick_model, tmp_path):
    folder = tmp_path / "stage"
    files = quick_model.export("c", folder, inverse=True, limits=(-0.5, 0.75), slew=20)
    assert {"stage_inverse.c", "stage_inverse.h", "inverse_vectors.csv"} <= set(files)
    header = (folder / "stage_inverse.h").read_text()
    assert "STAGE_INVERSE_LOW (-0.5)" in header and "STAGE_INVERSE_SLEW 20.0" in header
    sources = ["stage.c", "stage_inverse.c", "stage_test.c"]
    subprocess.run(["cc", "-std=c99", "-ffp-contract=off", "-o", "test", *sources, "-lm"], cwd=folder, check=True)
    subprocess.run(["./test"], cwd=folder, check=True)
    for error, arguments, message in [
        (ValueError, {"limits": (0, 1)}, "inverse=True"),
        (ValueError, {"slew": 1.0}, "inverse=True"),
        (ValueError, {"inverse": True, "limits": (3, 1)}, "limits of the input are 3 and 1"),
        (ValueError, {"inverse": True, "limits": (float("nan"), 1)}, "limits of the input"),
        (ValueError, {"inverse": True, "slew": 0}, "largest rate of the input is 0"),
        (ValueError, {"to": "python", "inverse": True}, "exports to python have no inverse"),
        (TypeError, {"inverse": True, "limits": 1.0}, "limits 1.0: two numbers are needed"),
        (TypeError, {"inverse": "yes"}, "inverse"),
    ]:
        with pytest.raises(error, match=message):
            quick_model.export(**{"to": "c", "folder": tmp_path / "new", **arguments})
    assert not (tmp_path / "new").exists()


def test_every_target_has_its_files(quick_model, tmp_path):
    for target, file in [
        ("fmu", "stage.fmu"),
        ("matlab", "stage.m"),
        ("opensees", "stageMaterial.cpp"),
        ("onnx", "stage_step.onnx"),
        ("python", "stage.py"),
    ]:
        assert file in quick_model.export(target, tmp_path / target, name="stage")
    subprocess.run([sys.executable, "stage_test.py"], cwd=tmp_path / "python", check=True)
    with pytest.raises(ValueError, match="fmi 1: it is 3 or 2"):
        quick_model.export("fmu", tmp_path / "new", fmi=1)
    with pytest.raises(ValueError, match="python computes in double precision"):
        quick_model.export("python", tmp_path / "new", name="stage", precision="f32")


def test_trials_leave_the_committed_state_as_it_is(quick_model):
    stepper, other = quick_model.stepper(), quick_model.stepper()
    for x in (0.1, 0.4, 0.2, -0.3):
        stepper.trial(x + 1.0)
        stepper.revert()
        y, slope = stepper.trial_tangent(x)
        assert (stepper.trial(x + 1e-3) - y) / 1e-3 == pytest.approx(slope, rel=0.1, abs=1e-3)
        assert stepper.trial(x) == y
        stepper.commit()
        assert other.step(x) == y


def test_measured_outputs_correct_a_stepper(quick_model):
    stepper, plain = quick_model.stepper(), quick_model.stepper()
    with pytest.raises(ValueError, match="no committed sample"):
        stepper.correct(1.0)
    assert stepper.tracking.residual is None and stepper.tracking.gain == 1.0
    for x in 0.5 * np.sin(0.1 * np.arange(1000)):
        corrected, output = stepper.step(x), plain.step(x)
        stepper.adapt(0.9 * output + 0.01, rows=100)
        stepper.correct(0.9 * output + 0.01)
    assert abs(corrected - 0.9 * output - 0.01) < 0.1 * abs(corrected - output)
    before = stepper.tracking
    assert (before.gain, before.offset) == pytest.approx((0.9, 0.01), abs=0.01) and before.memory_fits is None
    assert repr(before).startswith("Tracking(gain=0.9")
    for arguments, expected in [((np.nan,), "measured output is NaN"), ((1.0, 9), "at least 10"), ((1.0, -1), "at least")]:
        with pytest.raises(ValueError, match=expected):
            stepper.adapt(*arguments)
    assert stepper.tracking.gain == before.gain
    stepper.reset()
    assert stepper.tracking.residual is None


def test_links_and_pipes_stay_what_they_are(quick_model, tmp_path):
    link, path = tmp_path / "link.json", tmp_path / "model.json"
    link.symlink_to("model.json")
    quick_model.save(link)
    assert link.is_symlink() and hysid.Model.load(path) == quick_model
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text(encoding="utf-8")))
    reader.start()
    quick_model.save(pipe)
    reader.join()
    assert read == [quick_model.to_json()] and pipe.is_fifo()


def test_bad_files_are_value_errors(quick_model, tmp_path):
    path = tmp_path / "model.json"
    text = quick_model.to_json()
    for content, words in [
        ("", "is empty"),
        (text[:500], "cut off"),
        (text.replace('"samples": 600', '"samples": 601'), "checksum"),
        ("[]", "not a Hysid model file"),
    ]:
        path.write_text(content)
        with pytest.raises(ValueError, match=words) as raised:
            hysid.Model.load(path)
        assert str(raised.value).startswith(str(path))
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(ValueError, match="not a Hysid model file"):
        hysid.Model.load(path)
    with pytest.raises(FileNotFoundError):
        hysid.Model.load(tmp_path / "none.json")


def test_a_state_is_found_and_used(spring_and_slider, quick_ensemble):
    x, y = (values[330:] for values in spring_and_slider)
    single = hysid.fit(*spring_and_slider, model="masing")
    for model in (single, quick_ensemble):
        state = model.find_state(x, y[:80])
        simulated = model.simulate(x, state=state)
        # The error of the rows after the known ones.
        rmse = np.sqrt(np.mean((simulated - y)[80:] ** 2))
        assert model.evaluate(x, y, known=80).rmse == pytest.approx(rmse, rel=1e-12)
        padded = np.where(np.arange(len(x)) < 80, y, np.nan)
        assert np.array_equal(model.simulate(x, state=model.find_state(x, padded)), simulated)
        stepper = model.stepper(state)
        assert [stepper.step(value) for value in x[:150]] == simulated[:150].tolist()
    output, low, high = quick_ensemble.predict(x, state=state)
    assert np.array_equal(output, simulated) and (low < high).all()
    assert repr(state).startswith("RecordState(member 1: ") and "; member 2: " in repr(state)
    found = single.find_state(x, y[:80])
    assert repr(found).startswith("RecordState(") and "member" not in repr(found)

    frame = pandas.DataFrame({"x": x, "y": y})
    assert repr(single.find_state(frame, "y")) == repr(single.find_state(frame[["x"]], frame["y"]))
    refused = {
        "found by another model": lambda: single.simulate(x, state=state),
        "by another model": lambda: single.stepper(state),
        "cannot be used with initial_state": lambda: single.simulate(x, state=found, initial_state="virgin"),
        "cannot be used with initial": lambda: single.evaluate(x, y, known=5, initial_state="virgin"),
        "x has 2": lambda: single.simulate(x, records=["a", *["b"] * (len(x) - 1)], state=found),
        "list of records": lambda: single.find_state([x, x], [y, y]),
        "output: has 270 values": lambda: single.find_state(x[:9], y),
        "is blank in the first 0 rows": lambda: single.find_state(x, []),
        "is blank in the first 9 rows": lambda: single.find_state(x, np.full(9, np.nan)),
        "known 0": lambda: single.evaluate(x, y, known=0),
        "known soon": lambda: single.evaluate(x, y, known="soon"),
        "no unit of time": lambda: single.evaluate(x, y, known="0.5s"),
    }
    for words, call in refused.items():
        with pytest.raises(ValueError, match=words):
            call()
    with pytest.raises(TypeError, match="state"):
        single.simulate(x, state="virgin")


def test_a_known_beginning_is_a_time_too(spring_and_slider):
    x, y = spring_and_slider
    time = {"t_s": 0.5 * np.arange(len(x))}
    model = hysid.fit(x, y, time, model="masing", rate="none")
    assert model.evaluate(x, y, time, known="40s") == model.evaluate(x, y, time, known=81)


def test_models_are_pickled_and_compared(quick_model):
    again = pickle.loads(pickle.dumps(quick_model))
    assert again == quick_model and hash(again) == hash(quick_model)
    assert quick_model != hysid.Model.from_json(quick_model.to_json()).name


def test_what_a_model_says_of_itself(quick_model):
    assert (quick_model.name, quick_model.inputs, quick_model.output) == ("xpnn+", ["x"], "y")
    assert quick_model.rate is None and not quick_model.needs_time
    assert quick_model.train.samples == 600 and quick_model.validation is None
    assert "xpnn+: x -> y" in repr(quick_model)
    assert "<table>" in quick_model._repr_html_()


def test_steps_give_what_a_free_run_gives():
    train, test = hysid.specimen("piezo-actuator").data()
    model = hysid.fit(
        train.x, train.y, train.time, "backward", train.records, model="xpnn+", stops=4, hidden=3, starts=1, epochs=5
    )
    first = test.records == test.records[0]
    x, time = test.x[first], test.time[first]
    outputs = model.simulate(x, time)
    assert [model.step(x, time) for x, time in zip(x, time)] == outputs.tolist()
    with pytest.raises(ValueError, match="does not come after"):
        model.step(0.0, time[0])
    model.reset()
    stepper = model.stepper()
    assert model.step(x[0], time[0]) == stepper.step(x[0], time[0]) == outputs[0]
    with pytest.raises(ValueError, match="2 inputs where the model has 1"):
        stepper.step([1.0, 2.0], 1e9)
    with pytest.raises(ValueError, match="not a finite number"):
        stepper.step(np.nan, 1e9)
    with pytest.raises(TypeError):
        stepper.step("a", 1e9)
    with pytest.raises(TypeError):
        stepper.step({0.0: 1.0}, 1e9)
    endless = type("Endless", (), {"__len__": lambda self: 1, "__getitem__": lambda self, index: 0.0})()
    with pytest.raises(ValueError, match="inputs where the model has 1"):
        stepper.step(endless, 1e9)
    with pytest.raises(ValueError, match="no time column"):
        model.simulate(x)


def test_contiguous_columns_are_not_copied():
    x = np.arange(10.0)
    frame = pandas.DataFrame({"x": x})
    for given in (x, x.reshape(10, 1), {"x": x}, frame["x"]):
        taken = columns(given, None, x, None, None)
        assert np.shares_memory(taken.time.values, x)
        whole = frame["x"].to_numpy() if hasattr(given, "iloc") else x
        assert np.shares_memory(taken.inputs[0].values, whole)
    strided = columns(np.arange(20.0)[::2], None, None, None, None)
    assert strided.inputs[0].values.tolist() == list(range(0, 20, 2))


def test_anything_that_numpy_understands_is_taken(spring_and_slider, quick_model):
    x, _ = spring_and_slider
    expected = quick_model.simulate(x)
    frozen = x.copy()
    frozen.flags.writeable = False
    wide = np.empty(1200)
    wide[::2] = x
    for given in (x.tolist(), frozen, x.reshape(-1, 1), wide[::2], x.astype(">f8"), {"any": x}):
        assert np.array_equal(quick_model.simulate(given), expected)
    whole = np.trunc(x)
    expected = quick_model.simulate(whole)
    for given in (np.int32, np.float32, object):
        assert np.array_equal(quick_model.simulate(whole.astype(given)), expected)


def test_pandas_goes_in_and_comes_out(spring_and_slider, quick_model):
    x, y = spring_and_slider
    index = pandas.Index(range(5, 605), name="row")
    series = pandas.Series(x, index=index, name="u")
    output = quick_model.simulate(series)
    assert output.name == "y_model" and output.index.equals(index)
    measured = pandas.Series(y, dtype="Float64", index=index)
    measured.iloc[::2] = pandas.NA
    assert quick_model.evaluate(series, measured).samples == 300


def test_each_record_begins_virgin(spring_and_slider, quick_model):
    x, y = spring_and_slider
    twice = np.concatenate([x, x])
    labels = np.repeat(["a", "b"], 600)
    outputs = quick_model.simulate(twice, records=labels)
    assert np.array_equal(outputs[600:], quick_model.simulate(x))
    errors = quick_model.evaluate(twice, np.concatenate([y, y]), records=labels)
    assert errors.records == 2 and errors.rmse == pytest.approx(quick_model.evaluate(x, y).rmse, rel=1e-12)


def test_several_inputs():
    generator = np.random.default_rng(1)
    x = np.cumsum(generator.normal(size=(400, 2)), axis=0)
    y = hysid.operators.stop(x[:, 0], r=2.0) + 0.5 * x[:, 1]
    model = hysid.fit(x, y, model="xpnn+", starts=1, epochs=10, stops=4, hidden=3)
    assert model.inputs == ["x1", "x2"]
    outputs = model.simulate(x)
    assert [model.step(row) for row in x[:20]] == outputs[:20].tolist()
    with pytest.raises(ValueError, match="has 1 inputs where 2 are expected"):
        model.simulate(x[:, 0])
    with pytest.raises(ValueError, match="takes one input, not 2"):
        hysid.fit(x, y, model="masing")


def test_members_share_out_the_whole(quick_ensemble):
    members = quick_ensemble.members
    assert 2 <= len(members) <= 6 and quick_ensemble.name == "auto"
    assert len(members) == len(quick_ensemble.description["ensemble"]["members"])
    for shares in ([one.share for one in members], [one.share_outside for one in members]):
        assert sum(shares) == pytest.approx(1) and min(shares) >= 0
    assert {one.kind for one in members} <= {"classical", "networks", "random stops", "recurrent"}
    assert {one.model for one in members} <= set(hysid.models)
    # What was chosen of all candidates is told with the same shares; its names are those of the members.
    candidates = quick_ensemble.description["training"]["selection"]["candidates"]
    told = {one["name"]: one["members"] for one in candidates if one["members"]}
    assert {one.name for one in members} <= set(told)
    assert f"auto of {len(members)}" in repr(quick_ensemble)
    assert "ensemble of" in quick_ensemble._repr_html_()
    assert "error on the rows held out" in quick_ensemble._repr_html_()


def test_a_single_model_has_no_members_and_no_band(quick_model, spring_and_slider):
    assert quick_model.members == () and not quick_model.has_band
    with pytest.raises(ValueError, match="this model of xpnn\\+ has no prediction band"):
        quick_model.predict(spring_and_slider[0])


def test_members_of_one_model_answer_by_their_median(spring_and_slider):
    model = hysid.fit(
        *spring_and_slider, model="xpnn", members=3, stops=3, hidden=2, epochs=3, warm_up=0
    )
    assert [one.model for one in model.members] == ["xpnn"] * 3
    assert [one.share for one in model.members] == pytest.approx([1 / 3] * 3)


def test_a_band_widens_with_its_probability_and_holds_what_is_measured(quick_ensemble, spring_and_slider):
    x, y = spring_and_slider
    output, low, high = quick_ensemble.predict(x)
    assert np.array_equal(output, quick_ensemble.simulate(x))
    assert ((low < output) & (output < high)).all()
    wide = quick_ensemble.predict(x, probability=0.99)
    assert (wide.low <= low).all() and (wide.high >= high).all() and (wide.high > high).any()
    # The members have been trained on these very rows, so about as many of them as promised must be held.
    held = [np.mean((band.low <= y) & (y <= band.high)) for band in (quick_ensemble.predict(x), wide)]
    assert 0.8 < held[0] < held[1]
    twice = quick_ensemble.predict(np.concatenate([x, x]), records=np.repeat(["a", "b"], len(x)))
    assert np.array_equal(twice.low, np.concatenate([low, low]))
    series = quick_ensemble.predict(pandas.Series(x, index=range(7, 607)))
    assert [one.name for one in series] == ["y_model", "y_model_low", "y_model_high"]
    assert series.high.index[0] == 7 and np.array_equal(series.high, high)
    with pytest.raises(ValueError, match="0.5"):
        quick_ensemble.predict(x, probability=0.3)


def test_an_ensemble_is_saved_stepped_and_pickled(quick_ensemble, spring_and_slider, tmp_path):
    x, _ = spring_and_slider
    quick_ensemble.save(tmp_path / "model.json")
    again = hysid.Model.load(tmp_path / "model.json")
    assert again == pickle.loads(pickle.dumps(quick_ensemble)) == quick_ensemble
    outputs = again.simulate(x)
    stepper = again.stepper()
    assert [stepper.step(one) for one in x] == pytest.approx(outputs.tolist(), rel=1e-12, abs=1e-12)


def test_a_model_is_diagnosed(spring_and_slider):
    model = hysid.fit(*spring_and_slider, model="prandtl-ishlinskii")
    diagnosis = model.diagnose()
    assert diagnosis.verdict("masing") == "yes"
    assert diagnosis.content["model"] == "prandtl-ishlinskii"
    assert "<table>" in diagnosis._repr_html_() and "masing" in str(diagnosis)
    assert "verdicts from equations" in str(diagnosis) and "width of the loop over the whole range" in str(diagnosis)


def test_a_diagnosis_of_data_is_printed_as_the_program_prints_it(program, spring_and_slider, tmp_path):
    x, y = spring_and_slider
    pandas.DataFrame({"u_mm": x, "f_kN": y}).to_csv(tmp_path / "data.csv", index=False)
    found = hysid.diagnose({"u_mm": x}, {"f_kN": y})
    done = program("diagnose", "data.csv", "--no-report", folder=tmp_path)
    tables, _, _ = done.stdout.partition("\nnext:\n")
    assert str(found) == f"{tables}\nnext:\n  model = hysid.fit(x, y)"
    assert "advice\n    The simplest model" in tables
    (tmp_path / "model.json").write_text(hysid.fit({"u_mm": x}, {"f_kN": y}, model="masing").to_json())
    done = program("diagnose", "model.json", "--no-report", folder=tmp_path)
    assert done.stdout == str(hysid.Model.load(tmp_path / "model.json").diagnose()) + "\n"


def test_a_model_is_invertible_or_not(spring_and_slider):
    x, y = spring_and_slider
    found = hysid.fit(x, y, model="prandtl-ishlinskii").diagnose()["invertible"]
    assert (found.verdict, found.details["direction"]) == ("yes", "rising")
    low, high = found.details["always"]
    assert low < high and found.details["monotone_outputs"] == [low, high]
    assert found.details["worst"] is None and found.details["pasts"] > 100
    assert "after each of" in found.statement
    # Data do not have it.
    assert [other.name for other in hysid.diagnose(x, y).properties if other.name == "invertible"] == []
    assert hysid.diagnose(x, y)["masing"].details == {}


def test_a_record_begins_in_its_initial_state(spring_and_slider, tmp_path):
    x, y = spring_and_slider
    model = hysid.fit(x, y, model="prandtl-ishlinskii", initial_state="saturated-down")
    assert model.description["lead_in"] == [x.min()]
    own = model.simulate(x)
    assert np.array_equal(own, model.simulate(x, initial_state="saturated-down"))
    up = model.simulate(x, initial_state="saturated-up")
    assert not np.array_equal(own, up)
    # As rows before the record.
    led = np.concatenate([[x.max()], x])
    assert np.array_equal(model.simulate(led, initial_state="virgin")[1:], up)
    errors = model.evaluate(x, y)
    assert errors.rmse == model.train.rmse < model.evaluate(x, y, initial_state="saturated-up").rmse

    stepper = model.stepper()
    assert [stepper.step(one) for one in x] == own.tolist()
    stepper.reset("saturated-up")
    assert [stepper.step(one) for one in x] == up.tolist()
    stepper.reset()
    assert stepper.step(x[0]) == own[0]
    assert model.step(x[0]) == own[0]
    model.reset("saturated-up")
    assert model.step(x[0]) == up[0]
    model.reset()
    assert model.step(x[0]) == own[0]

    model.save(tmp_path / "model.json")
    assert np.array_equal(hysid.Model.load(tmp_path / "model.json").simulate(x), own)
    records = np.repeat(["a", "b"], len(x))
    twice = model.simulate(np.concatenate([x, x]), records=records, initial_state="saturated-up")
    assert np.array_equal(twice, np.concatenate([up, up]))
    with pytest.raises(ValueError, match="initial_state unknown: choose one of virgin, saturated-up"):
        model.simulate(x, initial_state="unknown")
    with pytest.raises(ValueError, match="initial state `up` is unknown: choose one of virgin"):
        model.evaluate(x, y, initial_state="up")
    with pytest.raises(TypeError, match="initial_state 3: a name is needed"):
        model.reset(3)

    # After one period of the record itself, which nobody knows sample by sample.
    x = np.sin(np.linspace(0, 2 * np.pi, 60, endpoint=False))
    led = np.concatenate([[1, -1], x])
    periodic = hysid.fit(x, y[:60], model="prandtl-ishlinskii", initial_state="periodic")
    expected = periodic.simulate(led, initial_state="virgin")[2:]
    assert np.array_equal(periodic.simulate(x), expected)
    assert np.array_equal(model.simulate(x, initial_state="periodic"), model.simulate(led, initial_state="virgin")[2:])
    with pytest.raises(ValueError, match="initial_state periodic: choose one of virgin"):
        periodic.reset("periodic")


@pytest.mark.parametrize("name", ["hysteretic-oscillator", "hysteretic-state-space"])
def test_a_model_with_inertia_steps_in_time_as_it_simulates(name, tmp_path):
    train, _ = hysid.specimen("duffing-oscillator").data(seed=3)
    x, y, time = (column[:400] for column in (train.x, train.y, train.time))
    model = hysid.fit(x, y, time, model=name, modes=2, states=1, hidden=2, starts=1, epochs=2)
    assert model.needs_time and model.rate is None
    own = model.simulate(x, time)
    path = tmp_path / "model.json"
    model.save(path)
    loaded = hysid.Model.load(path)
    assert loaded == model
    assert [loaded.step(*sample) for sample in zip(x, time)] == own.tolist()
    loaded.reset()
    assert loaded.step(x[0], time[0]) == own[0]
    with pytest.raises(ValueError, match="there is no time column, and the model needs one"):
        model.simulate(x)
    with pytest.raises(ValueError, match="the time of the sample is missing or not finite, and the model needs it"):
        model.stepper().step(x[0])


def test_the_seed_of_a_specimen_draws_its_excitation():
    specimen = hysid.specimen("duffing-oscillator")
    first, other = ([data.x for data in specimen.data(seed=seed)] for seed in (1, 2))
    assert all(np.array_equal(one, same.x) for one, same in zip(first, specimen.data(seed=1)))
    assert not any(np.array_equal(one, another) for one, another in zip(first, other))


def test_states_of_records_are_found():
    def record(past, size):
        x = size * np.sin(0.11 * np.arange(150))
        led = np.concatenate([[past], x])
        return x, 0.3 * x + hysid.operators.play(led, r=0.5)[1:]

    parts = [record(1.0, 0.45), record(-1.0, 0.42), record(1.0, 1.0), record(1.0, 0.4)]
    x, y = (np.concatenate(columns) for columns in zip(*parts))
    records = np.repeat(["a", "b", "c", "d"], 150)
    with pytest.warns(hysid.HysidWarning, match="3 records begin saturated-up, 1 record begins saturated-down"):
        model = hysid.fit(x, y, records=records, model="prandtl-ishlinskii", initial_state="unknown")
    found = {one["record"]: one["lead_in"] for one in model.description["training"]["lead_ins"]}
    assert found == {"a": [x.max()], "b": [x.min()], "c": [x.max()], "d": [x.max()]}
    new, measured = record(1.0, 0.43)
    assert model.evaluate(new, measured).nrmse_std_percent < 2


def test_a_band_for_nine_of_ten_data_sets_is_wider_by_one_factor(quick_ensemble, spring_and_slider):
    x, _ = spring_and_slider
    output, _, high = quick_ensemble.predict(x)
    assert np.array_equal(quick_ensemble.predict(x, of_ten=5).high, high)
    wide = quick_ensemble.predict(x, of_ten=9)
    assert np.array_equal(wide.output, output)
    factors = (wide.high - output) / (high - output)
    assert 1.5 < factors[0] < 3 and factors == pytest.approx(factors[0])
    with pytest.raises(ValueError, match="of_ten 10: choose 5 to 9"):
        quick_ensemble.predict(x, of_ten=10)


def test_a_model_driven_by_its_inverse_has_the_wanted_outputs(quick_model):
    low, high = 0.8, 4.0
    wanted_of = quick_model.stepper()
    drive = low + (high - low) * (0.5 + 0.4 * np.sin(0.07 * np.arange(300)) * np.cos(0.011 * np.arange(300)))
    wanted = np.array([wanted_of.step(x) for x in drive])
    inverse = quick_model.inverse(limits=(low, high))
    found = inverse.run(wanted)
    assert found.input.shape == found.output.shape == found.reach.shape == (300,)
    assert found.reached.mean() > 0.99
    driven = quick_model.stepper()
    outputs = np.array([driven.step(x) for x in found.input])
    assert np.array_equal(outputs, found.output)
    assert np.abs(outputs - wanted)[found.reached].max() <= 1e-9 * np.ptp(wanted)
    inverse.reset()
    one = inverse.step(wanted[0])
    assert (one.input, one.output, one.reach) == (found.input[0], found.output[0], found.reach[0])


def test_an_inverse_names_what_it_cannot_reach_and_refuses_what_is_invalid(quick_model):
    inverse = quick_model.inverse()
    assert {inverse.step(1e9).reach, inverse.step(-1e9).reach} == {"high-limit", "low-limit"}
    with pytest.raises(ValueError, match="NaN|finite"):
        inverse.step(float("nan"))
    with pytest.raises(ValueError, match="limits"):
        quick_model.inverse(limits=(1.0, 1.0))
    with pytest.raises(ValueError, match="positive"):
        quick_model.inverse(slew=0.0)
    with pytest.raises(ValueError, match="time"):
        inverse.run(np.zeros(3), time=np.zeros(2))
    with pytest.raises(ValueError, match="row 2: the wanted output is inf"):
        inverse.run(np.array([0.0, np.inf]))


def test_the_inverse_of_a_record_goes_straight_into_a_simulation(quick_model, spring_and_slider):
    wanted = 0.4 * spring_and_slider[1]
    found = quick_model.invert(wanted)
    assert (found.preview, found.low, found.high) == (0.0, None, None)
    assert found.reached.mean() > 0.95 and not found.extrapolated.any()
    simulated = quick_model.simulate(found.input)
    assert np.abs(simulated - found.output).max() <= 1e-9 * np.ptp(wanted)
    assert np.abs(simulated - wanted)[found.reached].max() <= 1e-9 * np.ptp(wanted)

    index = pandas.Index(np.arange(len(wanted)) + 7.0, name="t_s")
    series = quick_model.invert(pandas.Series(wanted, index=index))
    assert series.input.index.equals(index) and series.reach.index.equals(index)
    assert np.array_equal(series.input, found.input) and np.array_equal(series.reached, found.reached)


def test_bounds_of_an_inverse_of_a_record_are_kept(quick_model, spring_and_slider):
    wanted = 0.5 * spring_and_slider[1]
    time = 0.01 * np.arange(len(wanted))
    limited = quick_model.invert(wanted, limits=(-0.4, 0.5))
    assert limited.input.min() == -0.4 and limited.input.max() == 0.5
    assert {"low-limit", "high-limit", "reached"} <= set(limited.reach)
    slow = quick_model.invert(wanted, time, slew=2.0)
    assert np.abs(np.diff(slow.input)).max() <= 0.02 + 1e-12 and "slew" in slow.reach
    wide = quick_model.invert(1e3 * wanted, limits=(-100.0, 100.0))
    assert wide.extrapolated.any()


@pytest.fixture(scope="module")
def actuator():
    """A model whose output lags behind its input, and wanted outputs with their times."""
    train, test = hysid.specimen("magnetostrictive-actuator").data()
    model = hysid.fit(train.x, train.y, train.time, records=train.records, model="rate-dependent-prandtl-ishlinskii")
    rows = np.isfinite(test.y) & (test.records == test.records[0])
    return model, test.y[rows], test.time[rows]


def test_the_preview_of_a_model_that_lags_is_found(actuator):
    model, wanted, time = actuator
    found, without = model.invert(wanted, time), model.invert(wanted, time, preview=0)
    assert found.preview > 0 and without.preview == 0
    assert found.extrapolated.mean() < without.extrapolated.mean()
    assert np.std(found.output - wanted) < 0.02 * np.std(wanted)
    inverse = model.inverse()
    assert inverse.best_preview(wanted, time) == found.preview and inverse.preview == 0
    again = model.inverse(preview=found.preview).run(wanted, time)
    assert np.array_equal(again.input, found.input) and again.preview == found.preview
    stamps = pandas.Timestamp("2024-01-01") + pandas.to_timedelta(time, unit="s")
    assert np.allclose(model.invert(wanted, stamps).input, found.input, atol=1e-3)
    # Sample by sample, the wanted output is that at the end of the preview.
    inverse = model.inverse(preview=found.preview)
    ahead = np.interp(time + found.preview, time, wanted)
    steps = [inverse.step(wanted[0], time[0]), *(inverse.step(ahead[row], time[row]) for row in range(1, 50))]
    assert np.allclose([one.input for one in steps], found.input[:50], atol=1e-9)


def test_a_band_of_an_inverse_is_one_of_the_input(quick_ensemble, spring_and_slider):
    wanted = 0.3 * spring_and_slider[1][:200]
    found = quick_ensemble.invert(wanted, band=0.9)
    assert found.low.shape == found.high.shape == (200,)
    assert (found.low <= found.high).all() and (found.low < found.high).any()
    wide = quick_ensemble.invert(wanted, band=0.9, of_ten=9)
    assert (wide.high - wide.low).mean() > (found.high - found.low).mean()
    one = quick_ensemble.inverse(band=0.9).step(wanted[0])
    assert (one.low, one.high) == (found.low[0], found.high[0])
    assert quick_ensemble.inverse().step(wanted[0]).low is None


def test_units_of_a_wanted_output_are_converted():
    train, _ = hysid.specimen("terfenol-rod").data()
    model = hysid.fit({"H_kA": train.x}, {"u_um": train.y}, model="modified-prandtl-ishlinskii", thresholds=[1.0])
    wanted = 0.5 * train.y[:300]
    found = model.invert(pandas.Series(wanted, name="u_um"))
    assert found.input.name == "H_kA" and found.output.name == "u_um_reached"
    with pytest.warns(hysid.HysidWarning, match="u_mm is converted"):
        converted = model.invert(pandas.Series(wanted / 1000, name="u_mm"))
    assert np.allclose(converted.input, found.input)
    taken = model.invert(pandas.Series(wanted, name="u_mm"), same_units=True)
    assert np.array_equal(taken.input, found.input)


def test_an_inverse_of_a_record_refuses_what_is_invalid(actuator, quick_model):
    model, wanted, time = actuator
    for error, arguments, message in [
        (ValueError, {"time": None}, "there are no time stamps"),
        (ValueError, {"time": time[:-1]}, "time: 249 values for 250 rows of y"),
        (ValueError, {"time": time[::-1]}, "row 2: time .* does not come after"),
        (ValueError, {"others": wanted[:-1]}, "others: 249 rows for 250 rows of y"),
        (ValueError, {"others": wanted}, "row 1: 2 inputs where the model has 1"),
        (ValueError, {"y": None}, "the wanted output is needed"),
        (ValueError, {"y": np.where(time == time[3], np.nan, wanted)}, "row 4: the wanted output is NaN"),
        (ValueError, {"preview": "long"}, "preview 'long': 'auto' or a time is needed"),
        (ValueError, {"preview": -1.0}, "the preview is -1"),
        (TypeError, {"preview": None}, "preview None: a number is needed"),
        (TypeError, {"limits": 1.0}, "limits 1.0: two numbers are needed"),
        (ValueError, {"limits": (2, 1)}, "limits of the input are 2 and 1"),
        (TypeError, {"slew": "fast"}, "slew 'fast': a number is needed"),
        (ValueError, {"slew": -1}, "largest rate of the input is -1"),
        (ValueError, {"band": 0.9}, "no prediction band"),
        (ValueError, {"band": 0.9, "of_ten": 3}, "of_ten 3: choose 5 to 9"),
    ]:
        with pytest.raises(error, match=message):
            model.invert(**{"y": wanted, "time": time, **arguments})
    with pytest.raises(ValueError, match="y and time have different indexes"):
        quick_model.invert(pandas.Series([1.0, 2.0]), pandas.Series([0.0, 1.0], index=[1, 2]))
    assert quick_model.invert([]).input.shape == (0,)


def _hysid_number(value):
    return f"{value:.3g}"


def test_a_report_is_a_page_of_the_model_on_these_data(quick_model, spring_and_slider, tmp_path):
    x, y = spring_and_slider
    page = tmp_path / "page.html"
    quick_model.report(page, x, y, title="Spring & slider")
    text = page.read_text(encoding="utf-8")
    assert "<title>Spring &amp; slider" in text and "unseen" in text and "hysid.Model.report" in text
    # No command is shown for a model file that nobody wrote, and no time of a fit that the page does not know.
    assert "hysid evaluate" not in text and "Time taken" not in text
    error = quick_model.evaluate(x, y).nrmse_std_percent
    assert f"{error:.3g}" in text
    quick_model.report(page, x, y, name="training")
    text = page.read_text(encoding="utf-8")
    # Without a title, the quantities and the model.
    assert "<h1>Y over x: xpnn+</h1>" in text
    rmse = f"the simulated y is {_hysid_number(quick_model.train.rmse)} off (root mean square error)"
    assert rmse in text and "The error on new data was not measured, because none were held out." in text
    assert '<div class="columns">' in text and "Loops and histories: training data" in text
    assert "training" in page.read_text(encoding="utf-8")
    other = tmp_path / "other.html"
    other.write_text("mine", encoding="utf-8")
    with pytest.raises(FileExistsError, match="force=True"):
        quick_model.report(other, x, y)
    with pytest.raises(ValueError):
        quick_model.report(page, x, np.full_like(y, np.nan))
