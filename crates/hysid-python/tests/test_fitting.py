"""How a fit behaves while it runs, and what it refuses."""

import signal
import subprocess
import sys
import textwrap
import threading
import time
import warnings

import numpy as np
import pytest

import hysid

pytestmark = pytest.mark.filterwarnings("ignore:.* parameters are fitted to:hysid.HysidWarning")
"""Fits that take long are of large networks."""

LONG = {"model": "xpnn+", "starts": 200, "epochs": 100_000, "stops": 30, "hidden": 30}
"""A fit that would take hours."""


@pytest.mark.parametrize(
    ("x", "y", "text"),
    [
        ([1.0, 2.0], [1.0], 'record "data", output: has 1 values where the first input has 2'),
        ([], [], 'record "data": has no rows'),
        (np.ones(50), np.arange(50.0), "is constant (1): there is nothing"),
        (np.arange(50.0), np.ones(50), "is constant (1): there is nothing to identify"),
        (np.arange(50.0), np.full(50, np.nan), "is blank in every row"),
        ([*range(20), np.nan], range(21), 'record "data", row 21, input: NaN is not a finite number'),
        ([*range(20), 1e200], range(21), "is too large: at most 1e100"),
        (range(5), [1, 4, 2, 5, 3], "has only 5 rows with an output: at least 10 are needed"),
        (["a", "b"], [1.0, 2.0], "input: could not convert string to float"),
        (np.zeros((2, 2, 2)), [1.0, 2.0], "input: a one- or two-dimensional array is needed, not one of 3 dimensions"),
        (np.zeros((2, 0)), [1.0, 2.0], "x has no columns"),
        ([1j, 2j], [1.0, 2.0], "complex numbers cannot be used"),
    ],
)
def test_bad_data_is_a_value_error_that_says_where(x, y, text):
    with pytest.raises(ValueError) as raised, warnings.catch_warnings():
        warnings.simplefilter("ignore", hysid.HysidWarning)
        hysid.fit(x, y)
    assert text in str(raised.value)


def test_time_must_increase_within_a_record(spring_and_slider):
    x, y = spring_and_slider
    stamps = np.tile(np.arange(300.0), 2)
    with pytest.raises(ValueError, match="row 301, time: time 0 does not come after 299"):
        hysid.fit(x, y, time=stamps)
    hysid.fit(x, y, time=stamps, records=np.repeat(["a", "b"], 300), model="masing")
    with pytest.raises(ValueError, match='record "a" continues after another record'):
        hysid.fit(x, y, records=np.tile(["a", "b"], 300))
    with pytest.raises(ValueError, match="one label for each of the 600 rows"):
        hysid.fit(x, y, records=["a"])


def test_a_poor_record_is_warned_of():
    x = np.linspace(0.0, 1.0, 50)
    with pytest.warns(hysid.HysidWarning, match="the input never turns"):
        hysid.fit(x, x**2, model="masing")


def test_any_number_of_threads_gives_the_same_model(spring_and_slider):
    models = [
        hysid.fit(*spring_and_slider, model="xpnn+", stops=3, hidden=2, starts=3, epochs=4, threads=threads)
        for threads in (1, 2, 3)
    ]
    assert models[0] == models[1] == models[2]


def test_progress_is_told_and_may_end_the_fit(spring_and_slider):
    told = []

    def enough(progress):
        told.append(progress)
        return len(told) == 3

    model = hysid.fit(*spring_and_slider, **LONG, progress=enough)
    assert model.termination == "stopped"
    assert 3 <= len(told) <= 5
    assert all(0 <= progress.done <= 1 and progress.phase in ("starts", "all-data") for progress in told)


def test_an_error_of_the_callback_ends_the_fit(spring_and_slider):
    class Broken(Exception):
        pass

    def callback(progress):
        raise Broken

    began = time.perf_counter()
    with pytest.raises(Broken):
        hysid.fit(*spring_and_slider, **LONG, progress=callback)
    assert time.perf_counter() - began < 20


def test_a_bar_of_tqdm_is_filled_and_closed(spring_and_slider, capsys):
    bar = hysid.tqdm_progress(mininterval=0)
    hysid.fit(*spring_and_slider, model="xpnn+", starts=2, epochs=30, progress=bar)
    assert "% of std" in capsys.readouterr().err
    assert bar._bar.disable, "tqdm says so of a bar that is closed"


def test_a_time_limit_keeps_the_best_model(spring_and_slider):
    model = hysid.fit(*spring_and_slider, **LONG, time_limit=0.5)
    assert model.termination == "stopped"
    assert model.evaluate(*spring_and_slider).nrmse_std_percent < 50


def test_others_work_while_a_fit_runs(spring_and_slider):
    """The lock of the interpreter is released: this thread goes on, and a second fit beside it."""
    models = {}

    def work(name):
        models[name] = hysid.fit(*spring_and_slider, **LONG, time_limit=1.0, threads=1)

    threads = [threading.Thread(target=work, args=(name,)) for name in "ab"]
    for thread in threads:
        thread.start()
    longest, last = 0.0, time.perf_counter()
    while any(thread.is_alive() for thread in threads):
        now = time.perf_counter()
        longest, last = max(longest, now - last), now
        time.sleep(0.001)
    assert set(models) == {"a", "b"}
    assert longest < 0.9, "nobody held the interpreter for the time of a fit"


INTERRUPTED = """
    import signal, sys, time, warnings
    import numpy as np
    import hysid

    # What runs in the background of a shell inherits that Ctrl-C is ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    x = 6 * np.linspace(0, 1, 600) * np.sin(np.linspace(0, 60, 600))
    y = 0.2 * x + hysid.operators.stop(x, r=1.0)
    begun = []

    def progress(told):
        if not begun:
            begun.append(told)
            print("begun", flush=True)

    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        model = hysid.fit(x, y, epochs=100_000, stops=30, hidden=30, progress=progress)
    ended = time.time()
    assert [warning.category for warning in warned] == [hysid.HysidWarning]
    assert "interrupted" in str(warned[0].message)
    assert model.termination == "stopped"
    assert np.isfinite(model.simulate(x)).all()
    print(ended)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT to send there")
def test_ctrl_c_keeps_the_best_model():
    script = textwrap.dedent(INTERRUPTED)
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n"
    time.sleep(0.3)
    pressed = time.time()
    process.send_signal(signal.SIGINT)
    ended = float(process.stdout.readline())
    assert process.wait(timeout=30) == 0
    assert ended - pressed < 5, "a second is promised; a busy machine may need longer"


LONG_RUN = """
    import signal
    import numpy as np
    import hysid

    signal.signal(signal.SIGINT, signal.default_int_handler)
    # Each row takes thousands of steps of the differential equation: the whole run a quarter of an hour or more.
    x = np.tile([1e6, -1e6], 5_000_000)
    print("begun", flush=True)
    try:
        hysid.classical.jiles_atherton(x, saturation=1.0, a=1.0, k=1.0, c=0.1)
    except KeyboardInterrupt:
        print("interrupted", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT to send there")
def test_ctrl_c_interrupts_a_long_run():
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(LONG_RUN)], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "begun\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=60) == ("interrupted\n", None)
    assert process.returncode == 0


@pytest.mark.filterwarnings("ignore:.* what the model was trained on:hysid.HysidWarning")
def test_models_are_compared(spring_and_slider):
    x, y = spring_and_slider
    names = ["masing", "jiles-atherton", "rate-dependent-prandtl-ishlinskii"]
    comparison = hysid.compare(x[:400], y[:400], test=(x, y), models=names, time_limit=2.0)
    assert [row.name for row in comparison][::3] == ["masing", "rate-dependent-prandtl-ishlinskii"]
    # A law is compared in all its variants.
    assert {row.name for row in comparison[1:3]} == {"jiles-atherton", "jiles-atherton (differential form)"}
    assert comparison[0].test.nrmse_std_percent < comparison[1].test.nrmse_std_percent
    assert "needs the rate" in comparison[3].error
    assert comparison.best is comparison[0].model
    assert list(comparison.to_frame()["model"]) == [row.name for row in comparison]
    assert "masing" in str(comparison) and "<table>" in comparison._repr_html_()
    with pytest.raises(ValueError, match="model `foo` is unknown"):
        hysid.compare(x, y, models=["foo"])


@pytest.mark.filterwarnings("ignore:.* what the model was trained on:hysid.HysidWarning")
def test_models_are_compared_after_a_known_beginning(spring_and_slider):
    x, y = spring_and_slider
    test = (x[300:], y[300:])
    comparison = hysid.compare(x, y, test=test, models=["masing"], known=50)
    errors = comparison[0].test
    assert (comparison.known, errors.samples, comparison[0].train.samples) == (50, 250, 550)
    assert errors == comparison.best.evaluate(*test, known=50)
    assert errors.rmse < comparison.best.evaluate(*test).rmse
    assert str(comparison).endswith("after a known beginning of each record: 50 rows.")
    for known, words in ((0, "known"), ("soon", "known"), ("0.5s", "no unit of time is known"), (300, "blank after")):
        with pytest.raises(ValueError, match=words):
            hysid.compare(x, y, test=test, models=["masing"], known=known)


def test_diagnoses_say_what_the_program_says(program, tmp_path):
    import json

    train, _ = hysid.specimen("reinforced-concrete-joint").data()
    train.frame().to_csv(tmp_path / "train.csv", index=False)
    said = json.loads(program("diagnose", "train.csv", "--json", "--no-report", folder=tmp_path).stdout)
    diagnosis = hysid.diagnose(train.x, train.y, train.time, train.records)
    for part in ("properties", "advice", "turning_points", "output_noise"):
        assert diagnosis.content[part] == said[part], part
    assert diagnosis["deterioration"].verdict == "yes"
    with pytest.raises(KeyError, match="there is no property 'wear'"):
        diagnosis["wear"]


def test_cycles_are_those_of_the_program(program, tmp_path):
    import json

    train, _ = hysid.specimen("reinforced-concrete-joint").data()
    frame = train.frame()
    frame.to_csv(tmp_path / "train.csv", index=False)
    said = json.loads(program("cycles", "train.csv", "--json", folder=tmp_path).stdout)
    names = train.names
    table = hysid.cycles(frame[names["input"]], frame[names["output"]], frame[names["time"]])
    assert (table.field, table.division) == (said["field"], said["division"]) == ("structure", "zero")
    for name in ("energy", "damping_percent", "residual_after_peak", "period"):
        expected = [np.nan if row[name] is None else row[name] for row in said["cycles"]]
        assert np.array_equal(table[name], expected, equal_nan=True), name
    assert list(table.backbone["input"]) == [point["input"] for point in said["backbone"]]
    def known(rows, name):
        return [np.nan if row[name] is None else row[name] for row in rows]

    assert np.array_equal(table.figures["value"], known(said["figures"], "value"), equal_nan=True)
    assert list(table.figures["name"]) == [figure["name"] for figure in said["figures"]]
    for name in ("amplitude", "strength_loss_percent", "cumulative_ductility"):
        assert np.array_equal(table.levels[name], known(said["levels"], name), equal_nan=True), name
    assert table["complete"].dtype == bool and table["notes"][-1].startswith("incomplete")
    assert table.reversal_curves is None
    assert list(table.to_frame()["cycle"]) == list(range(1, len(table["cycle"]) + 1))
    written = pandas_table(tmp_path / "train.cycles.csv")
    assert np.allclose(written["energy [J]"], table["energy"], rtol=1e-12, equal_nan=True)


def pandas_table(path):
    import pandas

    return pandas.read_csv(path)


def test_levels_of_structures_have_a_drift_with_a_height():
    x = np.repeat([1.0, 2.0], 400) * np.sin(np.linspace(0, 8 * np.pi, 800))
    table = hysid.cycles(x, hysid.operators.stop(x, 0.5), field="structure", height=200)
    assert np.allclose(table.levels["drift_percent"], table.levels["amplitude"] / 2)
    with pytest.raises(ValueError, match="height: a number above 0"):
        hysid.cycles(x, x, height=-1)


def test_losses_of_magnets_are_given_per_mass():
    time = np.linspace(0, 0.06, 1201)
    field, flux = 100 * np.sin(100 * np.pi * time), 1.2 * np.sin(100 * np.pi * time - 0.3)
    table = hysid.cycles(field, flux, time, field="magnet", density=7650)
    expected = np.pi * 100 * 1.2 * np.sin(0.3) * 50 / 7650
    assert np.allclose(table["power_per_mass"][table["complete"]], expected, rtol=2e-3)
    assert np.isnan(hysid.cycles(field, flux, time, field="magnet")["power_per_mass"]).all()
    with pytest.raises(ValueError, match="density: a number above 0"):
        hysid.cycles(field, flux, time, density=0)
    model = hysid.fit(field, flux, model="prandtl-ishlinskii")
    driven = model.cycles(field="magnet", density=7650)
    assert np.allclose(7650 * driven["energy_per_mass"], driven["energy"], equal_nan=True)
    assert np.isfinite(driven["energy_per_mass"]).any()
    with pytest.raises(ValueError, match="density: a number above 0"):
        model.cycles(density=-1)


def test_a_model_has_cycles_and_reversal_curves(spring_and_slider):
    model = hysid.fit(*spring_and_slider, model="prandtl-ishlinskii")
    table = model.cycles(field="structure")
    assert table["complete"].sum() >= 14 and (np.diff(table.backbone["output"][table.backbone["direction"] == "up"]) > 0).all()
    curves = table.reversal_curves
    assert curves["reversal_input"].shape == curves["density"].shape and table.smoothing_factor >= 1
    assert (curves["everett"] >= -1e-9).all()
    assert "first-order" in repr(table)
    with pytest.raises(ValueError, match="division `noon` is unknown|noon"):
        model.cycles(division="noon")
    with pytest.raises(ValueError, match="smoothing_factor 11: choose 1 to 10"):
        model.cycles(smoothing_factor=11)
    with pytest.raises(TypeError, match="field 3"):
        hysid.cycles(*spring_and_slider, field=3)


def test_warnings_are_those_of_the_caller(spring_and_slider, quick_model):
    x, y = spring_and_slider
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        quick_model.simulate(10 * x)
        quick_model.evaluate(10 * x, y)
    assert [warning.filename for warning in warned] == [__file__] * 2
    assert all("outside the trained range" in str(warning.message) for warning in warned)


def noisy_records(rows=400):
    """A spring and slider in three records, with noise, and whole weights."""
    random = np.random.default_rng(3)
    x = [size * np.sin(np.linspace(0, 20, rows)) for size in (2.0, 3.0, 4.0)]
    y = [0.2 * one + hysid.operators.stop(one, r=1.0) + 0.1 * random.normal(size=rows) for one in x]
    return x, y, [random.integers(0, 5, size=rows) for _ in x]


@pytest.mark.parametrize(
    ("options", "tolerance"),
    [
        ({"model": "masing", "thresholds": [0.5, 1.0, 2.0]}, 1e-9),
        ({"model": "prandtl-ishlinskii", "thresholds": [0.5, 1.0, 2.0]}, 1e-9),
        ({"model": "ramberg-osgood", "starts": 2, "epochs": 30}, 1e-5),
    ],
)
def test_a_weight_counts_a_row_as_many_times(options, tolerance):
    """A row that is repeated moves nothing in a rate-independent law: its fit is that with weights."""
    x, y, weights = noisy_records()
    # The first row stays, because the memory begins there.
    for weight in weights:
        weight[0] = 1
    weighted = hysid.fit(x, y, sample_weight=weights, **options)
    repeated = hysid.fit(
        [np.repeat(one, np.maximum(weight, 1)) for one, weight in zip(x, weights)],
        [np.repeat(np.where(weight > 0, one, np.nan), np.maximum(weight, 1)) for one, weight in zip(y, weights)],
        **options,
    )
    plain = hysid.fit(x, y, **options)
    outputs = [np.concatenate(model.simulate(x)) for model in (weighted, repeated, plain)]
    size = np.abs(outputs[0]).max()
    assert np.abs(outputs[0] - outputs[1]).max() < tolerance * size
    assert np.abs(outputs[0] - outputs[2]).max() > 1e-4 * size
    assert weighted.train.samples == sum(np.count_nonzero(weight) for weight in weights)
    assert "of rows, in the fit" in str(weighted.summary()) and "of rows, in the fit" not in str(plain.summary())
    blanked = [np.where(weight > 0, one, np.nan) for one, weight in zip(y, weights)]
    assert weighted.parameter_intervals(x, blanked) is None


def test_weights_that_only_choose_rows_are_for_every_model():
    x, y, weights = noisy_records()
    x, y, chosen = x[2], y[2], weights[2] > 0
    options = {"model": "xpnn", "stops": 3, "hidden": 2, "starts": 1, "epochs": 3}
    alike = hysid.fit(x, y, sample_weight=np.full(len(x), 7.0), **options)
    assert alike == hysid.fit(x, y, **options)
    assert hysid.fit(x, y, sample_weight=3.0 * chosen, **options) == hysid.fit(x, np.where(chosen, y, np.nan), **options)
    with pytest.raises(ValueError, match="xpnn takes no weights of rows: use one of masing, prandtl-ishlinskii, .*blank"):
        hysid.fit(x, y, sample_weight=weights[2], **options)
    with pytest.raises(ValueError, match="auto takes no weights of rows"):
        hysid.fit(x, y, sample_weight=weights[2])
    law = hysid.HysteresisRegressor(model="masing", thresholds=[0.5, 1.0])
    fitted = law.fit(x.reshape(-1, 1), y, sample_weight=weights[2]).model_
    same = hysid.fit(x, y, sample_weight=weights[2], model="masing", thresholds=[0.5, 1.0])
    assert fitted.description["law"] == same.description["law"]


@pytest.mark.parametrize(
    ("weights", "text"),
    [
        (np.ones(399), r"sample_weight: one weight for each of the 400 rows is needed, not \(399,\)"),
        (np.ones((400, 1)), r"sample_weight: one weight for each of the 400 rows is needed, not \(400, 1\)"),
        (np.r_[np.ones(399), -1], "sample_weight: row 400 has -1.0: a finite number, 0 or above, is needed"),
        (np.r_[np.nan, np.ones(399)], "sample_weight: row 1 has nan"),
        (np.zeros(400), "sample_weight: the weights of all rows with an output are zero"),
        (["a"] * 400, "sample_weight: a number for each row is needed"),
        (1.0, "sample_weight: a number for each row is needed"),
    ],
)
def test_weights_that_cannot_be_used_are_named(weights, text):
    x, y, _ = noisy_records()
    with pytest.raises(ValueError, match=text):
        hysid.fit(x[0], y[0], model="masing", sample_weight=weights)
