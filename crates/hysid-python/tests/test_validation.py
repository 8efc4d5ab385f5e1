"""Judgement on data held out."""

import numpy as np
import pandas
import pytest

import hysid


# A fold's largest input may be one that was not fitted to.
@pytest.mark.filterwarnings("ignore::hysid.HysidWarning")
def test_each_fold_is_fitted_and_judged_as_by_hand():
    train, _ = hysid.specimen("piezo-actuator").data()
    found = hysid.validate(
        train.x, train.y, train.time, records=train.records, folds=2, model="masing", operators=6
    )
    # Records are dealt out in their order.
    names = list(dict.fromkeys(train.records))
    assert [fold.held_out for fold in found.folds] == [", ".join(names[place::2]) for place in (0, 1)]
    squares = 0.0
    for fold in found.folds:
        held = np.isin(train.records, fold.held_out.split(", "))
        taught = (train.x[~held], train.y[~held], train.time[~held])
        model = hysid.fit(*taught, records=train.records[~held], model="masing", operators=6)
        unseen = model.evaluate(train.x[held], train.y[held], train.time[held], records=train.records[held])
        assert fold.train == model.train and fold.unseen == unseen
        squares += unseen.mse * unseen.samples
    assert found.unseen.samples == np.count_nonzero(~np.isnan(train.y))
    assert found.unseen.mse == pytest.approx(squares / found.unseen.samples)
    assert "all folds" in found._repr_html_()


def test_a_validation_may_be_ended(spring_and_slider):
    told = []

    def enough(progress):
        told.append(progress)
        return True

    found = hysid.validate(*spring_and_slider, model="xpnn", starts=1, epochs=100_000, stall=0, progress=enough)
    assert len(found.folds) == 1
    assert all(progress.is_part and progress.model == "xpnn" and progress.done <= 0.2 for progress in told)


def test_print_shows_the_table_of_the_program(program, spring_and_slider, tmp_path):
    x, y = spring_and_slider
    pandas.DataFrame({"u_mm": x, "f_kN": y}).to_csv(tmp_path / "data.csv", index=False)
    found = hysid.validate({"u_mm": x}, {"f_kN": y}, model="masing")
    done = program("validate", "data.csv", "--model", "masing", folder=tmp_path)
    assert done.stdout.startswith(f"{found}\n\nmasing: 5 folds in ")
    assert "all folds" in str(found) and "unseen kN" in str(found)


@pytest.mark.parametrize(
    ("keywords", "text"),
    [
        ({"folds": 1}, "folds 1: choose 2 or more"),
        ({"stop": 3}, "there is no option `stop`"),
        ({"model": "rate-dependent-prandtl-ishlinskii"}, "needs the rate of the input"),
        ({"threads": 0}, "threads 0: choose 1 to 1024"),
    ],
)
def test_what_has_no_meaning_is_a_value_error(keywords, text, spring_and_slider):
    with pytest.raises(ValueError, match=text):
        hysid.validate(*spring_and_slider, **keywords)


def test_data_too_few_to_hold_any_out_are_refused(spring_and_slider):
    x, y = spring_and_slider
    with pytest.raises(ValueError, match="too few data to hold any out"):
        hysid.validate(x[::20], y[::20], model="masing")
