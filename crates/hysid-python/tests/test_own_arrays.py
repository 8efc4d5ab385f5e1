"""Arrays and pandas objects of all kinds give the right numbers, or an error or a warning."""

import re
import warnings
from datetime import datetime, timedelta, timezone

import numpy as np
import pandas
import pytest
from sklearn.model_selection import GridSearchCV, KFold, ShuffleSplit, TimeSeriesSplit, cross_val_score

import hysid
from hysid import HysteresisRegressor

SMALL = {"model": "xpnn", "stops": 3, "hidden": 2, "starts": 1, "epochs": 3}

START = datetime(2024, 3, 1, 12, 0, 0)


@pytest.fixture(scope="module")
def plain(spring_and_slider):
    """Data with a row every 20 ms, and a model of them."""
    x, y = spring_and_slider
    time = 0.02 * np.arange(len(x))
    return x, y, time, hysid.fit(x, y, time, **SMALL)


def warned(work):
    """Warnings of the work."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        work()
    return [str(warning.message) for warning in caught if warning.category is hysid.HysidWarning]


def stamps():
    """The same time stamps in many forms."""
    numpy = np.datetime64(START) + np.arange(600) * np.timedelta64(20, "ms")
    series = pandas.Series(numpy, name="timestamp")
    return {
        "numpy": numpy,
        "nanoseconds": numpy.astype("datetime64[ns]"),
        "durations": np.arange(600) * np.timedelta64(20, "ms"),
        "series": series,
        "index": pandas.DatetimeIndex(numpy),
        "zone": series.dt.tz_localize("Europe/Berlin"),
        "python": [START + timedelta(milliseconds=20 * k) for k in range(600)],
        "python with a zone": [
            datetime(2024, 3, 1, tzinfo=timezone.utc) + timedelta(milliseconds=20 * k) for k in range(600)
        ],
        "text": [f"2024-03-01T12:00:{0.02 * k:09.6f}Z" for k in range(600)],
        "text of pandas": pandas.Series([f"2024-03-01 12:00:{0.02 * k:05.2f}+01:30" for k in range(600)]),
        "python durations": [timedelta(milliseconds=20 * k) for k in range(600)],
        "objects": series.astype(object),
    }


@pytest.mark.parametrize("kind", list(stamps()))
def test_dates_and_times_are_seconds(plain, kind):
    x, y, _, model = plain
    found = hysid.fit(x, y, stamps()[kind], **SMALL)
    assert np.allclose(found.simulate(x, stamps()[kind]), model.simulate(x, plain[2]), rtol=0, atol=1e-6)
    expected = "timestamp [s]" if kind in ("series", "zone", "objects") else "t_s"
    assert found.description["columns"]["time"] == expected


@pytest.mark.parametrize(
    ("times", "text"),
    [
        (["2024-03-01", "01.03.2024"], "row 2: '01.03.2024' is no time of ISO 8601, such as 2024-05-31T12:00:00.25"),
        (["2024-03-01", "2024-02-30"], "row 2: '2024-02-30': Day out of range"),
        (["2024-03-01T12:00Z", "2024-03-01T12:01"], "row 2: some times have a time zone and others have none"),
        (["2024-03-01", None], "row 2: None is no time"),
        (["01.03.2024", "02.03.2024"], "other dates than ISO 8601 are read by pandas.to_datetime"),
    ],
)
def test_text_that_is_no_time_is_named(times, text):
    with pytest.raises(ValueError, match="time: .*" + re.escape(text)):
        hysid.fit(np.arange(2.0), np.arange(2.0), times)


def test_dates_of_text_keep_their_seconds():
    """A day with a leap year, a time zone before midnight, and digits below those of a float's nanoseconds."""
    times = ["2024-02-28T23:00:00+02:00", "2024-02-29T00:00:00.123456789Z", "2024-03-01"]
    found = hysid._time.seconds(times[:2])
    assert found.tolist() == [0.0, 3 * 3600 + 0.123456789]
    assert hysid._time.seconds(["2024-02-28", times[2]]).tolist() == [0.0, 2 * 86400.0]


def test_dates_and_times_are_no_inputs(plain):
    x, y, time, _ = plain
    with pytest.raises(ValueError, match="input: dates and times are not numbers"):
        hysid.fit(stamps()["numpy"], y)
    frame = pandas.DataFrame({"timestamp": stamps()["series"], "x": x})
    with pytest.raises(ValueError, match="input: dates and times are not numbers"):
        hysid.fit(frame, y)
    missing = stamps()["numpy"].copy()
    missing[7] = np.datetime64("NaT")
    with pytest.raises(ValueError, match="time: row 8 has no time stamp"):
        hysid.fit(x, y, missing)


def test_masked_outputs_are_blank_and_masked_inputs_refused(plain):
    x, y, time, _ = plain
    hidden = np.arange(len(y)) % 7 == 3
    spoilt = np.where(hidden, 1e6, y)
    masked = np.ma.array(spoilt, mask=hidden)
    blank = np.where(hidden, np.nan, y)
    model = hysid.fit(x, masked, time, **SMALL)
    assert model == hysid.fit(x, blank, time, **SMALL)
    assert model.evaluate(x, masked, time) == model.evaluate(x, blank, time)
    with pytest.raises(ValueError, match="input: row 4 is masked"):
        hysid.fit(np.ma.array(x, mask=hidden), y)
    with pytest.raises(ValueError, match="time: row 4 is masked"):
        hysid.fit(x, y, np.ma.array(time, mask=hidden))
    assert hysid.fit(np.ma.array(x), y, time, **SMALL) == plain[3]
    estimator = HysteresisRegressor(**SMALL, random_state=0)
    fitted = estimator.fit(x.reshape(-1, 1), masked).model_
    assert fitted == HysteresisRegressor(**SMALL, random_state=0).fit(x.reshape(-1, 1), blank).model_
    with pytest.raises(ValueError, match="X: row 4 is masked"):
        estimator.fit(np.ma.array(x, mask=hidden).reshape(-1, 1), y)


def test_indexes_must_agree(plain):
    x, y, time, model = plain
    frame = pandas.DataFrame({"x": x, "y": y, "t": time})
    shuffled = frame["y"].sample(frac=1.0, random_state=1)
    for given in [(frame["x"], shuffled), (frame[["x"]], shuffled), ({"x": frame["x"]}, shuffled)]:
        with pytest.raises(ValueError, match="have different indexes, and rows are taken by position"):
            hysid.fit(*given, **SMALL)
    with pytest.raises(ValueError, match="x and time have different indexes"):
        model.simulate(frame["x"], frame["t"].iloc[::-1])
    with pytest.raises(ValueError, match="X and y have different indexes"):
        HysteresisRegressor(**SMALL).fit(frame[["x"]], shuffled)
    hysid.fit(frame["x"], frame["y"].to_numpy(), **SMALL)
    disordered = frame.sample(frac=1.0, random_state=1)
    told = warned(lambda: hysid.fit(disordered["x"], disordered["y"], **SMALL))
    assert any("not in the order of their index" in text for text in told)
    # Each record may begin its own index.
    twice = pandas.concat([frame, frame.assign(y=1.5 * frame["y"])])
    hysid.fit(twice["x"], twice["y"], records=np.repeat(["a", "b"], len(x)), **SMALL)


def test_shuffled_rows_are_warned_of(plain):
    x, y, _, _ = plain
    estimator = HysteresisRegressor(**SMALL, random_state=0)
    shuffled, _ = next(ShuffleSplit(1, test_size=0.3, random_state=0).split(x))
    with pytest.warns(hysid.HysidWarning, match="input jumps at random from row to row"):
        estimator.fit(x[shuffled].reshape(-1, 1), y[shuffled])
    frame = pandas.DataFrame({"x": x})
    told = warned(lambda: estimator.fit(frame.iloc[shuffled], y[shuffled]))
    assert any("not in the order of their index" in text for text in told)
    with pytest.warns(hysid.HysidWarning, match="not in the order of their index"):
        estimator.predict(frame.iloc[shuffled])
    in_order, _ = next(KFold(4).split(x))
    estimator.fit(frame.iloc[in_order], y[in_order])


def test_left_out_rows_are_warned_of_once_in_a_cross_validation(plain):
    x, y, time, _ = plain
    estimator = HysteresisRegressor(model="masing", operators=4)
    timed = HysteresisRegressor(model="masing", operators=4, time=1)
    shuffled = KFold(5, shuffle=True, random_state=0)
    for one, table in [
        (estimator, x.reshape(-1, 1)),
        (estimator, pandas.DataFrame({"x": x})),
        (timed, np.column_stack([x, time])),
    ]:
        # Twice, because each cross-validation has its own warnings.
        for _ in range(2):
            told = warned(lambda: cross_val_score(one, table, y, cv=shuffled))
            assert len([text for text in told if "rows are missing" in text]) == 1, told
        told = warned(lambda: GridSearchCV(one, {"operators": [3, 4]}, cv=shuffled).fit(table, y))
        assert len([text for text in told if "rows are missing" in text]) == 1, told
        told = warned(lambda: cross_val_score(one, table, y, cv=TimeSeriesSplit(4)))
        assert not any("rows are missing" in text for text in told)
        # The folds have larger inputs than those that were fitted to: the numbers of the warnings differ.
        assert len([text for text in told if "outside the trained range" in text]) == 1, told
    frame = pandas.DataFrame({"x": x, "y": y})
    told = warned(lambda: hysid.fit(frame.drop(index=range(50, 60)), "y", model="masing", operators=4))
    assert sum("rows are missing (1 gaps in the index)" in text for text in told) == 1
    regular = frame.iloc[::2]
    # Uneven numbers that are no multiples of a step, such as times in milliseconds, are no gaps.
    uneven = frame.set_index(np.cumsum(2 + np.arange(len(x)) % 3))
    for whole in (frame, regular, uneven):
        assert not warned(lambda: hysid.fit(whole, "y", model="masing", operators=4))


def test_units_are_converted_or_refused(spring_and_slider):
    x, y = spring_and_slider
    own = pandas.DataFrame({"disp_mm": x, "force_kN": y})
    model = hysid.fit(own["disp_mm"], own["force_kN"], **SMALL)
    errors = model.evaluate(own["disp_mm"], own["force_kN"])
    other = pandas.DataFrame({"u_m": x / 1000, "F_N": y * 1000})
    found = []
    told = warned(lambda: found.append(model.evaluate(other["u_m"], other["F_N"])))
    (found,) = found
    assert told == [
        "u_m is converted to the unit of the model's disp_mm (factor 1000)",
        "F_N is converted to the unit of the model's force_kN (factor 0.001)",
    ]
    assert found.output == "force_kN" and found.rmse == pytest.approx(errors.rmse)
    with pytest.raises(ValueError, match='"F_N" has another unit than the model\'s "disp_mm"'):
        model.simulate(other["F_N"])
    as_they_are = model.simulate(own["disp_mm"].rename("raw [counts]"), same_units=True)
    assert np.array_equal(as_they_are, model.simulate(x))


def test_copies_and_marks_are_warned_of(spring_and_slider):
    x, y = spring_and_slider
    records = np.repeat(["a", "b"], len(x))
    twice = np.concatenate([x, x]), np.concatenate([y, y])
    with pytest.warns(hysid.HysidWarning, match='record "b" is equal to record "a"'):
        validation = hysid.validate(*twice, records=records, model="masing")
    alone = hysid.validate(x, y, model="masing")
    assert validation.unseen == alone.unseen
    marked = y.copy()
    marked[[50, 51, 300]] = -999.0
    told = warned(lambda: hysid.fit(x, marked, model="masing"))
    assert any('"y" is -999 in 3 rows' in text and text.endswith("(put NaN in the place of -999)") for text in told)
    told = warned(lambda: hysid.fit(x[100:120], y[100:120], **{**SMALL, "stops": 20}))
    assert any("parameters are fitted to 20 rows" in text for text in told)
    told = warned(lambda: hysid.compare(x, y, test=(x[100:400], y[100:400]), models=["masing"]))
    assert any("is a part of what the model was trained on" in text for text in told)


def test_a_warning_names_the_argument_that_helps_and_not_an_option_of_the_program():
    x = np.concatenate([np.linspace(a, b, 50, endpoint=False) for a, b in [(0, 1), (1, -1), (-1, 1)]])
    time = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(x)))])
    told = warned(lambda: hysid.fit(x, np.tanh(x), np.round(time, 6), rate="backward", **SMALL))
    assert any(text.endswith("(rate='none' leaves the rate out)") for text in told), told
    assert not any("--" in text for text in told)


@pytest.mark.parametrize("options", [{"compression": np.nan}, {"thresholds": [0.1, np.inf]}, {"ridge": -np.inf}])
def test_options_must_be_finite(plain, options):
    (name,) = options
    with pytest.raises(ValueError, match=f"^{name} .*: a finite number is needed$"):
        hysid.validate(*plain[:2], model="xpnn", **options)
