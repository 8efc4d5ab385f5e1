"""The steps that plan, invert and prepare data, each with the result of the program."""

import csv
import io
import json
import math
import zipfile

import pytest
from test_studio import drop, hysid, saved, visit  # noqa: F401 (a fixture)


@pytest.fixture(scope="module")
def furnished(shared):
    """A studio with a magnet and a model of it."""
    shared.specimen("ferromagnet")
    shared.begin(model="prandtl-ishlinskii")
    assert shared.ended()["problem"] is None
    return shared


def test_a_model_is_inverted_along_a_wanted_output_within_limits(furnished, visit, tmp_path):  # noqa: F811
    opened = visit(furnished)
    invert = opened.go("invert")
    rows = "".join(f"{0.5 * math.sin(k / 9):.5f}\n" for k in range(120))
    drop(opened.page, "wanted.csv", "B_T\n" + rows)
    opened.page.wait_for_function("() => document.querySelector('#invert-file').selectedOptions[0].text === 'wanted.csv'")
    invert.get_by_label("Lowest H (A/m)").fill("-60")
    invert.get_by_label("Highest H (A/m)").fill("100")
    invert.get_by_role("button", name="Invert").click()
    invert.locator("svg.plot").first.wait_for()
    name, table = saved(opened.page, lambda: invert.get_by_role("button", name="Save wanted.drive.csv").click())
    # The table of the program, to the last digit.
    (tmp_path / "wanted.csv").write_text("B_T\n" + rows)
    model = furnished.project / "models" / furnished.state()["models"][0]["file"]
    hysid(tmp_path, "invert", str(model), "wanted.csv", "-o", "drive.csv", "--limits=-60:100")
    assert name == "wanted.drive.csv" and table == (tmp_path / "drive.csv").read_bytes()
    drive = [float(row["H_A_per_m"]) for row in csv.DictReader(io.StringIO(table.decode()))]
    assert len(drive) == 120 and min(drive) >= -60 and max(drive) <= 100


def test_the_inverse_is_taken_away_with_its_limits(furnished, visit):  # noqa: F811
    opened = visit(furnished)
    take = opened.go("take-away")
    take.get_by_label("Lowest H (A/m)").fill("-120")
    name, content = saved(opened.page, lambda: take.get_by_role("button", name="Download inverse, c").click())
    with zipfile.ZipFile(io.BytesIO(content)) as files:
        header = next(files.read(file).decode() for file in files.namelist() if file.endswith("_inverse.h"))
    assert "_inverse" in name and "_LOW (-120.0)" in header and "_HIGH 400.0" in header
    opened.check()


def test_the_next_measurement_is_planned(furnished, visit, tmp_path):  # noqa: F811
    opened = visit(furnished)
    plan = opened.go("plan")
    plan.get_by_label("Most rows").fill("500")
    plan.get_by_role("button", name="Plan").click()
    plan.get_by_role("heading", name="Segments").wait_for()
    name, table = saved(opened.page, lambda: plan.get_by_role("button", name="Save ferromagnet-train.drive.csv").click())
    data = furnished.project / "data" / "ferromagnet-train.csv"
    hysid(tmp_path, "plan", "--like", str(data), "--length", "500", "-o", "drive.csv", "--no-report")
    assert table == (tmp_path / "drive.csv").read_bytes()
    # Without data: the first test of a kind of specimen, which needs a range.
    plan.get_by_label("Plan", exact=True).select_option("actuator")
    plan.get_by_role("button", name="Plan").click()
    plan.get_by_text("a first test needs the range of the input").wait_for()
    plan.get_by_label("Lowest input").fill("0")
    plan.get_by_label("Highest input").fill("150")
    plan.get_by_role("button", name="Plan").click()
    plan.get_by_role("button", name="Save actuator.drive.csv").wait_for()


def test_a_restoring_force_becomes_a_file_of_the_project(start, visit, tmp_path):  # noqa: F811
    # A mass of 2 kg on a spring of 50 N/m: u = m y'' + k y.
    y = [0.01 * math.sin(3 * k / 100) for k in range(400)]
    lines = [f"{k / 100},{y[k]},{(50 - 2 * 9) * y[k]}" for k in range(400)]
    text = "t_s,x_m,F_N\n" + "\n".join(lines) + "\n"
    studio = start()
    opened = visit(studio)
    page = opened.page
    page.locator("header a[href='#restoring-force']").click()
    drop(page, "rig.csv", text)
    force = page.locator("#restoring-force")
    force.get_by_label("Mass, such as 2 t").fill("heavy")
    force.get_by_role("button", name="Compute").click()
    force.locator(".problem", has_text="a number is needed").wait_for()
    force.get_by_label("Mass, such as 2 t").fill("2 kg")
    force.get_by_role("button", name="Compute").click()
    force.locator("svg.plot[aria-label^='restoring force (N) over x (m)']").wait_for()
    force.get_by_role("button", name="Add to the project").click()
    state = studio.wait(lambda state: len(state["files"]) == 2)
    assert state["files"][1]["name"] == "rig.force.csv" and [file["problem"] for file in state["files"]] == [None, None]
    with (studio.project / "data" / "rig.force.csv").open() as table:
        found = list(csv.DictReader(table))
    column = next(name for name in found[0] if name.startswith("restoring_force"))
    middle = range(50, 350)
    assert [float(found[k][column]) for k in middle] == pytest.approx([50 * y[k] for k in middle], abs=0.01)
    (tmp_path / "rig.csv").write_text(text)
    printed = json.loads(hysid(tmp_path, "restoring-force", "rig.csv", "--mass", "2 kg", "--json"))
    assert (tmp_path / printed["table"]).read_bytes() == (studio.project / "data" / "rig.force.csv").read_bytes()
