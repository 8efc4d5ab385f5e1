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
    for draw, label in ((plot.loops, "voltage (V)"), (plot.histories, "t (s), record after record")):
        ax = draw(model, x, y, time, records=records)
        assert (ax.get_xlabel(), ax.get_ylabel()) == (label, "displacement (µm)")
        assert [text.get_text() for text in ax.get_legend().get_texts()] == ["measured", "model"]
        assert len(ax.lines) == 2 * len(np.unique(records))
        measured = ~np.isnan(y["displacement_um"])
        assert np.isin(values[measured], drawn(ax)).all()
        assert not np.isin(values[~measured], drawn(ax)).any()
    above = ax.figure.axes[0]
    assert above.get_ylabel() == "voltage\n(V)" and np.isin(x["voltage_V"], drawn(above)).all()
    own = plt.subplots()[1]
    assert plot.histories(None, x, y, records=records, ax=own) is own
    assert own.get_xlabel() == "row" and own.get_legend() is None and len(own.figure.axes) == 1
    assert len(plot.loops(model, x, None, time, records=records).lines) == 10
    with pytest.raises(TypeError, match="a Model, or None for measured data alone, comes first, not ndarray"):
        plot.loops(x["voltage_V"], y["displacement_um"])
    with pytest.raises(ValueError, match="nothing to draw"):
        plot.loops(None, x)


def test_diagnostics_are_five_views_of_one_run(actuator):
    model, (x, y, time), records = actuator
    figure = plot.diagnostics(model, x, y, time, records=records)
    loops, outputs, errors, over_input, correlation = figure.axes
    residuals = model.residuals(x, y, time, records=records)
    found = {finding.test for finding in residuals.found}
    assert found and all(test in figure.get_suptitle() for test in found)
    whiteness = residuals.content["whiteness"]
    heights = [segment[1][1] for segment in correlation.collections[-1].get_segments()]
    assert heights == whiteness["autocorrelation"]
    measured = y["displacement_um"][~np.isnan(y["displacement_um"])]
    assert np.isin(measured, drawn(loops)).all() and np.isin(measured, drawn(outputs)).all()
    rms = np.sqrt(np.nanmean(drawn(errors) ** 2))
    assert rms == pytest.approx(residuals.rms) and f"RMSE {rms:.3g}" in errors.get_title()
    assert over_input.get_xlabel() == "voltage (V)"
    with pytest.raises(ValueError, match="diagnostics need a model and a measured output"):
        plot.diagnostics(None, x, y)


def test_records_follow_one_another_in_time(actuator):
    model, (x, y, time), records = actuator
    lines = plot.errors(model, x, y, time, records=records).lines
    spans = [(line.get_xdata()[0], line.get_xdata()[-1]) for line in lines if len(line.get_xdata()) > 2]
    assert all(before[1] < after[0] for before, after in zip(spans, spans[1:]))
    stamps = time["t_s"][records == records[0]]
    assert spans[0] == (0.0, stamps[-1] - stamps[0])


def test_the_band_of_an_ensemble_is_drawn(quick_ensemble, spring_and_slider):
    x, y = spring_and_slider
    (band,) = plot.histories(quick_ensemble, x, y, band=0.8).collections
    _, low, high = quick_ensemble.predict(x, probability=0.8)
    edges = band.get_paths()[0].vertices[:, 1]
    assert edges.min() == pytest.approx(low.min()) and edges.max() == pytest.approx(high.max())
    assert not plot.histories(quick_ensemble, x, y, band=None).collections


def test_the_members_of_an_ensemble_are_drawn(quick_ensemble):
    ax = plot.members(quick_ensemble)
    names = [label.get_text() for label in ax.get_yticklabels()]
    weights = {}
    for member in quick_ensemble.members:
        weights[member.name] = weights.get(member.name, 0.0) + member.share
    assert len(names) == len(weights)
    assert names[0].endswith(f"{100 * max(weights.values()):.3g} %")
    trained = [m["training"]["train"]["nrmse_std_percent"] for m in quick_ensemble.description["ensemble"]["members"]]
    dots = np.concatenate([line.get_xdata() for line in ax.lines if line.get_marker() == "o"])
    assert sorted(dots) == pytest.approx(sorted(trained))
    assert plot.convergence(quick_ensemble).get_xlabel() == "error (% of std)"


def test_the_thresholds_of_an_ensemble_are_drawn(spring_and_slider):
    ensemble = hysid.fit(*spring_and_slider, model="xpnn", members=2, stops=3, hidden=2, epochs=5)
    ax = plot.thresholds(ensemble)
    low, high = ensemble.description["trained_ranges"]["inputs"][0]
    expected = [
        network["scaling"]["inputs"][0] / abs(stop["weights"][0])
        for member in ensemble.description["ensemble"]["members"]
        for network in [member["network"]]
        for stop in network["memory"]["stops"]
    ]
    groups = [line.get_ydata() for line in ax.lines if len(line.get_ydata()) == 3]
    assert len(groups) == len(ensemble.members) >= 2
    assert sorted(np.concatenate(groups)) == pytest.approx(sorted(expected))
    assert ax.lines[-1].get_ydata()[0] == pytest.approx((high - low) / 2)


def cyclic():
    """A slider under cycles of growing amplitude, with time."""
    angle = np.linspace(0, 12 * np.pi, 2401)
    x = np.linspace(1.5, 4.0, len(angle)) * np.sin(angle)
    return {"disp_mm": x}, {"force_kN": hysid.operators.stop(x, 1.0)}, {"t_s": angle / (2 * np.pi)}


def test_cycles_show_the_figures_of_the_table():
    x, y, time = cyclic()
    model = hysid.fit(x, y, time, model="masing", thresholds=[1.0])
    table = hysid.cycles(x, y, time)
    whole = table["complete"]
    ax = plot.cycles(model, x, y, time)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("cycle", "energy (J)")
    measured, simulated = ax.lines
    assert measured.get_ydata() == pytest.approx(table["energy"][whole])
    assert simulated.get_ydata() == pytest.approx(table["energy"][whole], rel=1e-3)
    ax = plot.cycles(None, x, y, time, figure="damping_percent", over="amplitude")
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("amplitude (mm)", "equivalent damping (%)")
    assert ax.lines[0].get_xdata() == pytest.approx(table["amplitude"][whole])
    ax = plot.energy(model, x, y, time)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("t (s)", "cumulative energy (J)")
    assert ax.lines[0].get_ydata()[-1] == pytest.approx(np.nansum(table["energy"][whole]), rel=1e-9)
    ax = plot.backbone(model, x, y, time)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("disp (mm)", "force (kN)")
    assert ax.lines[0].get_ydata().max() == pytest.approx(1.0)
    with pytest.raises(ValueError, match="figure 'glow': choose one of start_time, period"):
        plot.cycles(None, x, y, figure="glow")
    with pytest.raises(ValueError, match="over 'time': it is 'cycle' or 'amplitude'"):
        plot.cycles(None, x, y, over="time")
    with pytest.raises(ValueError, match="no complete cycle has damping_percent .*anticlockwise"):
        plot.cycles(None, x, {"force_kN": -y["force_kN"]}, figure="damping_percent")


def test_frequency_shows_cycles_over_their_frequency(actuator):
    model, (x, y, time), records = actuator
    ax = plot.frequency(model, x, y, time, records=records, division="mean")
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_xscale()) == ("frequency (Hz)", "energy (µm V)", "log")
    table = hysid.cycles(x, y, time, records, field="general", division="mean")
    known = table["complete"] & np.isfinite(table["energy"])
    assert ax.lines[0].get_xdata() == pytest.approx(table["frequency"][known])
    assert ax.lines[0].get_ydata() == pytest.approx(table["energy"][known])
    with pytest.raises(ValueError, match="no frequency without time"):
        plot.frequency(None, x, y, records=records)


def test_a_figure_for_a_paper_has_its_size_and_text(actuator, tmp_path):
    model, (x, y, time), records = actuator
    before = dict(plt.rcParams)
    with plot.paper(width="90 mm", height="2 in", font="serif", size=7):
        figure = plot.loops(model, x, y, time, records=records).figure
        figure.savefig(tmp_path / "loops.svg")
        figure.savefig(tmp_path / "loops.pdf")
    assert dict(plt.rcParams) == before
    assert 25.4 * figure.get_size_inches() == pytest.approx([90, 50.8])
    svg = (tmp_path / "loops.svg").read_text(encoding="utf-8")
    assert ">voltage (V)</text>" in svg and 'width="255.1' in svg
    assert b"/Type3" not in (tmp_path / "loops.pdf").read_bytes(), "letters are no outlines"
    assert figure.axes[0].xaxis.label.get_size() == 7
    for arguments, text in [
        ({"width": "90"}, "width '90': a length such as '90 mm'"),
        ({"width": "0 mm"}, "a length between 0 and 5 m"),
        ({"font": "No Such Font"}, "font 'No Such Font' is not installed"),
        ({"size": 0}, "size 0: a size in points above 0"),
    ]:
        with pytest.raises(ValueError, match=text), plot.paper(**arguments):
            pass


def test_errors_tell_their_root_mean_square(actuator):
    model, (x, y, time), records = actuator
    ax = plot.errors(model, x, y, time, records=records)
    judged = model.evaluate(x, y, time, records=records)
    assert ax.get_title() == f"RMSE {judged.rmse:.3g} µm, {judged.nrmse_std_percent:.3g} % of std"
    assert ax.get_ylabel() == "error of displacement (µm)"
    assert plot.errors(model, x, y, time, records=records, over="input").get_xlabel() == "voltage (V)"
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
        (plot.members, quick_model, "is a single model: an ensemble is needed"),
    ]:
        with pytest.raises(ValueError, match=text):
            draw(model)
    compressed = hysid.fit(*spring_and_slider, model="preisach", operators=5, compression=0.1)
    for draw in (plot.preisach_plane, plot.thresholds):
        with pytest.raises(ValueError, match="is compressed"):
            draw(compressed)
    assert plt.get_fignums() == []
