"""Plans of experiments."""

import json
import pickle

import numpy as np
import pytest

import hysid


@pytest.fixture(scope="module")
def cycles():
    time = np.arange(400) * 0.01
    return 5 * np.sin(10 * time), 100 * np.sin(10 * time - 0.3), time


def test_a_plan_is_that_of_the_program(cycles, program, tmp_path):
    x, y, time = cycles
    rows = "".join(f"{t!r},{a!r},{b!r}\n" for t, a, b in zip(time.tolist(), x.tolist(), y.tolist(), strict=True))
    (tmp_path / "data.csv").write_text("t,x,y\n" + rows)
    said = program("plan", "--like", "data.csv", "--json", "--no-report", folder=tmp_path)
    told = json.loads(said.stdout)
    plan = hysid.plan(x, y, time)
    assert len(plan.drive) == told["rows"] and plan.limits == told["limits"]
    assert [segment.reason for segment in plan.segments] == [segment["reason"] for segment in told["segments"]]
    plan.to_csv(tmp_path / "drive.csv")
    written, of_program = (
        np.loadtxt(tmp_path / name, delimiter=",", skiprows=1) for name in ("drive.csv", "data.drive.csv")
    )
    assert np.array_equal(written, of_program)
    assert np.array_equal(written[:, 1], plan.drive)


def test_a_plan_has_a_page_and_its_copy_keeps_the_drive(cycles, tmp_path):
    plan, path = hysid.plan(*cycles), tmp_path / "plan.html"
    plan.report(path)
    text = path.read_text(encoding="utf-8")
    assert "What to measure next" in text and plan.segments[0].reason in text and "hysid.Plan.report" in text
    path.write_text("mine")
    with pytest.raises(FileExistsError):
        plan.report(path)
    copied = pickle.loads(pickle.dumps(plan))
    assert np.array_equal(copied.drive, plan.drive)
    with pytest.raises(ValueError, match="plan again"):
        copied.report(tmp_path / "other.html")


def test_a_plan_has_at_most_the_wanted_rows(cycles):
    plan = hysid.plan(*cycles, length=300)
    assert len(plan.drive) <= 300 and repr(plan).startswith(f"<plan of {len(plan.drive)} rows")
    assert plan.segments[0].rows.start == 1 and plan.segments[-1].rows.stop == len(plan.drive)


def test_a_kind_has_a_protocol_and_nonsense_is_refused(cycles):
    plan = hysid.plan(kind="piezo stage", range=(0, 150), length=3000)
    assert plan.time is None and plan.sources and plan.drive.max() == 150
    x, y, time = cycles
    for arguments, words in [
        ({"kind": "jelly", "range": (0, 1)}, "structure, damper"),
        ({"kind": "piezo"}, "range"),
        ({}, "or a kind"),
        ({"x": x, "y": y, "kind": "piezo"}, "or a kind"),
        ({"x": x}, "x and y"),
        ({"x": x, "y": y, "length": 3}, "length 3"),
        ({"x": x, "y": y, "wave": "square"}, "square"),
    ]:
        with pytest.raises(ValueError, match=words):
            hysid.plan(**arguments)
    with pytest.raises(TypeError, match="range"):
        hysid.plan(x, y, range=3)
