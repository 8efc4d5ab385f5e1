"""A summary shows the numbers of the model."""

import numpy as np

import hysid


def test_a_law_is_summarised_with_its_parameters(spring_and_slider):
    x, y = spring_and_slider
    model = hysid.fit({"disp_mm": x}, {"force_kN": y}, model="masing", thresholds=[0.5, 1.0])
    text = str(model.summary())
    lines = text.splitlines()
    assert lines[0].split() == ["model", "masing:", "classical", "law"]
    assert f"disp (mm) from {x.min():.4g} to {x.max():.4g}" in text
    (line,) = [line for line in lines if line.startswith("RMSE of force (kN)")]
    assert line.split()[-1] == f"{model.train.rmse:.4g}"
    (line,) = [line for line in lines if line.startswith("NRMSE, % of the std of force")]
    assert line.split()[-1] == f"{model.train.nrmse_std_percent:.4g}"
    rows = [line.split() for line in lines if line.startswith("m_")]
    slopes = model.description["law"]["masing"]["slopes"]
    assert [row[1] for row in rows] == [f"{slope:.5g}" for slope in slopes]
    assert all(row[2] == "kN/mm" for row in rows)
    assert f"RMSE {model.train.rmse:.3g} kN ({model.train.nrmse_std_percent:.3g} % of std) in training" in repr(model)
    assert repr(model.summary()) == text


def test_a_network_is_summarised_with_its_held_out_errors(spring_and_slider):
    x, y = spring_and_slider
    model = hysid.fit(x, {"deflection_um": y}, model="xpnn", stops=3, hidden=2, starts=2, epochs=5)
    text = str(model.summary())
    assert "xpnn: network of 3 stops, 2 tanh neurons" in text
    (line,) = [line for line in text.splitlines() if line.startswith("RMSE of deflection (µm)")]
    assert line.split()[-2:] == [f"{model.train.rmse:.4g}", f"{model.validation.rmse:.4g}"]
    assert "in training" in repr(model) and "held out" in repr(model)
    assert f"{model.validation.rmse:.3g} µm" in repr(model)


def test_an_ensemble_is_summarised_with_its_choice_and_members(quick_ensemble):
    text = str(quick_ensemble.summary())
    words = " ".join(text.split())
    chosen, why = quick_ensemble._native.selection()
    assert f"chosen {chosen}" in words and f"why {why}" in words
    weights = [f"{100 * member.share:.3g}" for member in quick_ensemble.members]
    for member, weight in zip(quick_ensemble.members, weights):
        assert any(member.name in line and weight in line.split() for line in text.splitlines())
    assert all(len(line) <= 100 for line in text.splitlines())


def test_a_notebook_shows_the_same(quick_model, quick_ensemble):
    for model in (quick_model, quick_ensemble):
        html = model._repr_html_()
        assert html == model.summary()._repr_html_()
        assert f"<td style=\"text-align: right\">{model.train.rmse:.4g}</td>" in html
        assert html.count("<table>") == (2 if model.members else 1)


def test_names_are_escaped(spring_and_slider):
    x, y = spring_and_slider
    model = hysid.fit({"<x>": x}, {"<y>": np.asarray(y)}, model="masing", thresholds=[1.0])
    assert "<x>" not in model._repr_html_() and "&lt;y&gt;" in model._repr_html_()
