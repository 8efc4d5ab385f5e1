"""Pictures show the numbers they are made of."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest

import hysid
from hysid import plot


SMALL = {"model": "xpnn+", "stops": 4, "hidden": 3, "starts": 2, "epochs": 5}


@pytest.fixture(autouse=True)
def _close_all():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def actuator():
    train, _ = hysid.specimen("piezo-actuator").data()
    parts = ({train.names["input"]: train.x}, {train.names["output"]: train.y}, {"t_s": train.time})
    model = hysid.fit(*parts[:2], train.time, records=train.records, **SMALL)
    return model, parts, train.records


def drawn(ax):
    return np.concatenate([line.get_ydata() for line in ax.lines if len(line.get_ydata()) > 2])


def test_loops_and_histories_show_measured_and_model(actuator):
    model, (x, y, time), records = actuator
    values = model.simulate(x, time, records=records)
    for draw, label in ((plot.loops, "voltage_V"), (plot.histories, "t_s")):
        ax = draw(x, y, time, records=records, model=model)
        assert (ax.get_xlabel(), ax.get_ylabel()) == (label, "displacement_um")
        assert [text.get_text() for text in ax.get_legend().get_texts()] == ["measured", "model"]
        assert len(ax.lines) == 2 * len(np.unique(records))
        measured = ~np.isnan(y["displacement_um"])
        assert np.isin(values[measured], drawn(ax)).all()
        assert not np.isin(values[~measured], drawn(ax)).any()
    own = plt.subplots()[1]
    assert plot.histories(x, y, records=records, ax=own) is own
    assert own.get_xlabel() == "row" and own.get_legend() is None
    assert len(plot.loops(x, None, time, records=records, model=model).lines) == 10


def test_errors_tell_their_root_mean_square(actuator):
    model, (x, y, time), records = actuator
    ax = plot.errors(model, x, y, time, records=records)
    judged = model.evaluate(x, y, time, records=records)
    assert ax.get_title() == f"RMSE {judged.rmse:.3g}, {judged.nrmse_std_percent:.3g} % of std"
    assert np.nanmax(np.abs(drawn(ax))) == pytest.approx(judged.max_abs_error, rel=1e-9)


def test_convergence_ends_where_the_training_ended(actuator):
    model, _, _ = actuator
    ax = plot.convergence(model)
    runs = model.description["training"]["runs"]
    assert len(ax.lines) == len(runs) and {run["phase"] for run in runs} == {"starts", "all-data"}
    assert ax.lines[-1].get_ydata()[-1] == pytest.approx(model.train.nrmse_std_percent, rel=0.05)


def test_thresholds_of_networks_and_of_plays(actuator, spring_and_slider):
    model, _, _ = actuator
    ax = plot.thresholds(model)
    swings = [abs(stop["weights"][0]) for stop in model.description["network"]["memory"]["stops"]]
    # The input goes from 0 to 80 V, and is measured from the middle.
    assert sorted(drawn(ax)) == pytest.approx(sorted(40 / np.array(swings)))
    for name in ("masing", "prandtl-ishlinskii", "modified-prandtl-ishlinskii"):
        fitted = hysid.fit(*spring_and_slider, model=name, thresholds=[0.5, 1.0, 2.0])
        line = plot.thresholds(fitted).lines[0]
        assert line.get_xdata().tolist() == [0.5, 1.0, 2.0]
    heaviest = np.argmax(np.abs(plot.thresholds(hysid.fit(
        *spring_and_slider, model="masing", thresholds=[0.5, 1.0, 2.0]
    )).lines[0].get_ydata()))
    assert heaviest == 1, "the slider gives way at 1"


def test_a_preisach_plane_holds_all_weights(spring_and_slider):
    model = hysid.fit(*spring_and_slider, model="preisach", operators=12)
    ax = plot.preisach_plane(model)
    density = ax.collections[0].get_array()
    law = model.description["law"]["preisach"]
    steps = np.diff(law["lines"])
    area = np.outer(steps, steps)
    area[np.diag_indices(12)] /= 2
    assert np.nansum(density * area) == pytest.approx(sum(law["cells"]))


def test_a_diagnosis_has_a_bar_or_a_word_for_each_property(spring_and_slider):
    found = hysid.diagnose(*spring_and_slider)
    ax = plot.diagnosis(found)
    assert [text.get_text() for text in ax.texts] == [f.verdict for f in reversed(found.properties)]


def test_what_a_model_does_not_have_is_not_drawn(quick_model, quick_ensemble, spring_and_slider):
    found_at_once = hysid.fit(*spring_and_slider, model="preisach", operators=5)
    for draw, model, text in [
        (plot.preisach_plane, quick_model, "has no Preisach plane"),
        (plot.thresholds, found_at_once, "has no thresholds"),
        (plot.convergence, found_at_once, "was fitted without iterations"),
        (plot.thresholds, quick_ensemble, "is an ensemble: only its [2-6] members have thresholds"),
        (plot.convergence, quick_ensemble, "is an ensemble: only its [2-6] members have training runs"),
    ]:
        with pytest.raises(ValueError, match=text):
            draw(model)
    companded = hysid.fit(*spring_and_slider, model="preisach", operators=5, companding=0.1)
    for draw in (plot.preisach_plane, plot.thresholds):
        with pytest.raises(ValueError, match="is companded"):
            draw(companded)
    assert plt.get_fignums() == []
