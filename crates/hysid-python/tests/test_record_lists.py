"""A list with each record is the same as all rows with a label for each."""

import numpy as np
import pandas
import pytest

import hysid

SMALL = {"model": "xpnn", "stops": 3, "hidden": 2, "starts": 1, "epochs": 3}


@pytest.fixture(scope="module")
def records(spring_and_slider):
    """Three records of different lengths with time: as lists, and as columns with labels."""
    x, y = spring_and_slider
    cuts = [slice(0, 150), slice(150, 350), slice(350, 600)]
    lists = [[column[rows] for rows in cuts] for column in (x, y, 0.02 * np.arange(600))]
    return lists, [np.concatenate(parts) for parts in lists], np.repeat(["1", "2", "3"], [150, 200, 250])


# The comparison tests on the training data.
@pytest.mark.filterwarnings("ignore::hysid.HysidWarning")
def test_a_list_is_the_concatenation_with_labels(records):
    (xs, ys, times), (x, y, time), labels = records
    model = hysid.fit(xs, ys, time=times, **SMALL)
    assert model == hysid.fit(x, y, time, records=labels, **SMALL)
    outputs = model.simulate(xs, times)
    assert isinstance(outputs, list)
    assert np.array_equal(np.concatenate(outputs), model.simulate(x, time, records=labels))
    assert [len(output) for output in outputs] == [150, 200, 250]
    assert model.evaluate(xs, ys, times) == model.evaluate(x, y, time, records=labels)
    validated = hysid.validate(xs, ys, times, model="masing")
    assert validated == hysid.validate(x, y, time, records=labels, model="masing")
    assert [fold.held_out for fold in validated.folds] == ["1", "2", "3"]
    chosen = {"models": ["masing"], "test": (xs, ys, times)}
    assert hysid.compare(xs, ys, times, **chosen)[0].test == hysid.compare(x, y, time, records=labels, **chosen)[0].test
    table = hysid.cycles(xs, ys, times, records=["a", "b", "c"])
    assert list(dict.fromkeys(table["record"])) == ["a", "b", "c"]
    plan = hysid.plan(xs, ys, times)
    assert np.array_equal(plan.drive, hysid.plan(x, y, time, labels).drive)


def test_a_list_of_series_gives_a_list_of_series(records):
    (xs, ys, _), _, _ = records
    frames = [pandas.DataFrame({"u": x, "f": y}, index=np.arange(len(x)) + 7) for x, y in zip(xs, ys)]
    model = hysid.fit(frames, "f", **SMALL)
    assert (model.inputs, model.output) == (["u"], "f")
    assert model == hysid.fit([{"u": x} for x in xs], [{"f": y} for y in ys], **SMALL)
    outputs = model.simulate([frame["u"] for frame in frames])
    assert [output.index.equals(frame.index) for output, frame in zip(outputs, frames)] == [True] * 3
    assert all(output.name == "f_model" for output in outputs)


def test_predict_gives_lists(quick_ensemble, spring_and_slider):
    x, _ = spring_and_slider
    parts = [x[:200], x[200:]]
    together = quick_ensemble.predict(x, records=np.repeat([1, 2], [200, 400]))
    for whole, part in zip(together, quick_ensemble.predict(parts)):
        assert [len(one) for one in part] == [200, 400] and np.array_equal(np.concatenate(part), whole)


def test_a_list_of_lists_is_a_table(spring_and_slider):
    x, y = spring_and_slider
    rows = [[value] for value in x.tolist()]
    assert hysid.fit(rows, y.tolist(), **SMALL) == hysid.fit(x, y, **SMALL)


def test_operators_and_laws_take_one_record(records):
    (xs, _, _), _, _ = records
    with pytest.raises(ValueError, match="takes one record, not a list of 3"):
        hysid.operators.play(xs, 1.0)
    with pytest.raises(ValueError, match="masing takes one record, not a list of 3"):
        hysid.classical.masing(xs, [1.0], [1.0, 0.5])


def test_lists_that_do_not_agree_are_refused(records):
    (xs, ys, times), (x, y, _), _ = records
    for arguments, text in [
        ((xs, ys[:2]), "y: x is a list of 3 records, so a list of 3 arrays is needed"),
        ((xs, y), "y: x is a list of 3 records"),
        ((xs, ys, times[0]), "time: x is a list of 3 records"),
        ((xs, ys, [times[0], None, times[2]]), "time: it is missing in record 2"),
        ((x, ys), "y is a list of records, and x is not"),
        ((xs, [ys[0], ys[0], ys[2]]), 'record "2", output: has 150 values where the first input has 200'),
        (([{"a": xs[0]}, {"b": xs[1]}], ys[:2]), 'record "2" has the columns b, .*, and record "1" has a, '),
    ]:
        with pytest.raises(ValueError, match=text):
            hysid.fit(*arguments, **SMALL)
    for names in (["a", "b"], ["a", "a", "b"], "abc"):
        with pytest.raises(ValueError, match="records: x is a list of 3 records, so a list of 3 different names"):
            hysid.fit(xs, ys, records=names, **SMALL)
