"""Tests of the residual, and confidence intervals of the parameters of laws."""

import json

import numpy as np
import pandas
import pytest

import hysid


def noisy(seed, rows=2000):
    """A Prandtl-Ishlinskii law with noise."""
    step = np.arange(rows)
    x = (0.3 + 0.7 * (3.0 * step / rows % 1.0)) * np.sin(0.06 * step)
    y = 0.2 + x + 0.8 * hysid.operators.play(x, r=0.1) + 0.5 * hysid.operators.play(x, r=0.3)
    return x, y + 0.05 * np.random.default_rng(seed).normal(size=rows)


@pytest.fixture(scope="module")
def law():
    return hysid.fit(*noisy(1), model="prandtl-ishlinskii", thresholds=[0.1, 0.3])


def test_the_noise_of_a_right_model_has_no_structure(law):
    residuals = law.residuals(*noisy(2))
    assert residuals.rms == pytest.approx(0.05, rel=0.1)
    assert len(residuals.found) <= 1
    assert residuals["whiteness"].verdict == "not found"
    assert residuals["whiteness"].p_value > 0.001
    assert "white up to lag" in residuals["whiteness"].statement
    assert "whiteness" in str(residuals) and "<table>" in residuals._repr_html_()
    with pytest.raises(KeyError, match="the tests are mean, whiteness"):
        residuals["colour"]


def test_structure_is_found_with_what_helps(law):
    x, y = noisy(3)
    residuals = law.residuals(x, y + 2.0 * np.gradient(x))
    rate = residuals["rate-correlation"]
    assert rate.verdict == "found" and rate.adjusted_p_value < 0.05
    assert "option rate" in rate.advice


def test_residuals_are_the_program_s(law, program, tmp_path):
    x, y = noisy(4)
    law.save(tmp_path / "model.json")
    pandas.DataFrame({"x": x, "y": y}).to_csv(tmp_path / "data.csv", index=False)
    done = program("evaluate", "model.json", "data.csv", "--residuals", "--json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    printed = json.loads(done.stdout)["residuals"]
    found = law.residuals(x, y)
    assert printed == found.content
    done = program("evaluate", "model.json", "data.csv", "--residuals", folder=tmp_path)
    errors, tests = str(law.evaluate(x, y)), str(found)
    assert done.stdout == f"{errors}\n\n{tests}\n"
    # The names in Python are those in the terminal and on pages.
    law.report(tmp_path / "page.html", x, y)
    page = (tmp_path / "page.html").read_text()
    for finding in found.findings:
        named = finding.test if finding.input is None else f"{finding.test}: {finding.input}"
        assert f"\n{named} " in tests and f">{named}</th>" in page


def test_too_few_rows_are_refused(law):
    x, y = noisy(5)
    with pytest.raises(ValueError, match="has only 20 rows with an output: tests of the residual need at least 50"):
        law.residuals(x[:20], y[:20])


def test_intervals_contain_the_parameters_and_mark_what_was_given(law):
    intervals = {interval.symbol: interval for interval in law.parameter_intervals(*noisy(1))}
    for symbol, value in {"c": 0.2, "w_0": 1.0, "w_1": 0.8, "w_2": 0.5}.items():
        interval = intervals[symbol]
        assert interval.status == "determined"
        # Four intervals of 95 %: three standard errors are beyond doubt.
        assert abs(interval.value - value) < 4 * interval.standard_error
        assert interval.low < interval.value < interval.high
    assert (intervals["r_1"].status, intervals["r_1"].low) == ("not fitted", None)


def test_intervals_need_the_training_data_of_a_law(law, quick_model, spring_and_slider):
    with pytest.raises(ValueError, match="intervals of parameters need the training data"):
        law.parameter_intervals(*noisy(9))
    assert quick_model.parameter_intervals(*spring_and_slider) is None
    again = hysid.Model.from_json(law.to_json())
    assert again.parameter_intervals(*noisy(1)) == law.parameter_intervals(*noisy(1))
