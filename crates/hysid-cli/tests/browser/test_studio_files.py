"""Files of a project: columns under other names, pictures, and a file that is dropped where a model is judged."""

import math

import pytest
from test_studio import drop, visit  # noqa: F401

COLUMN = ["Time [s];Displacement [mm];Force [kN]", *(f"{k / 2};{6 * math.sin(k / 9)};{40 * math.sin(k / 9 - 0.4)}" for k in range(300))]


def table(header: str, scale: float = 1, columns: int = 1) -> str:
    """An earthquake of the same column, with the displacement in so many columns and the force in other units."""
    rows = [(k / 50, 4 * math.sin(k / 7), 25 * math.sin(k / 7 - 0.4)) for k in range(200)]
    return "\n".join([header, *(",".join(map(str, [t, *[x] * columns, scale * y])) for t, x, y in rows)]) + "\n"


def test_columns_under_other_names_are_found_and_only_doubtful_ones_are_asked_for(start, visit):  # noqa: F811
    studio = start()
    opened = visit(studio)
    page = opened.page
    drop(page, "column-test.txt", "\n".join(COLUMN) + "\n")
    page.get_by_label("Role of Force [kN] in column-test.txt").wait_for()
    # Name, unit and time: nothing is asked for, also where the unit differs.
    drop(page, "quake.csv", table("t_s,Displacement_mm,Force_N", 1000))
    state = studio.wait(lambda state: len(state["files"]) == 2)
    quake = state["files"][1]
    assert quake["problem"] is None and quake["records"][0]["to"] == 200
    assert [column["role"] for column in quake["columns"]] == ["time", "input", "output"]
    assert "converted: Force_N from N to kN" in quake["warnings"][0]
    # Two columns may be the displacement: the file asks for one, and the link leads to its table.
    drop(page, "two.csv", table("t_s,command_mm,measured_mm,Force_kN", columns=2))
    problem = page.locator("#data .problem", has_text='several columns are like "Displacement [mm]"').first
    problem.get_by_role("button", name='the role "input"').click()
    page.wait_for_function("() => document.activeElement.getAttribute('aria-label') === 'Role of command_mm in two.csv'")
    page.get_by_label("Role of measured_mm in two.csv").select_option("input")
    state = studio.wait(lambda state: len(state["files"]) == 3 and state["files"][2]["problem"] is None)
    assert [column["role"] for column in state["files"][2]["columns"]] == ["time", "unused", "input", "output"]
    assert state["columns"]["inputs"] == ["Displacement [mm]"]
    # All three together are training data.
    studio.begin(model="prandtl-ishlinskii")
    assert studio.ended()["problem"] is None
    model = studio.state()["models"][0]
    assert model["train"]["samples"] == 700 and not model["is_stale"]
    assert "name their columns differently" in studio.ask(f"/api/models/{model['id']}/commands")["note"]
    # The findings were refused as long as a file was doubtful.
    assert [error for error in opened.errors if "400" not in error] == []


def roles(page, file: str) -> list[str]:
    """The roles that the page shows."""
    return page.get_by_role("region", name=f"Columns of {file}").locator("select").evaluate_all("all => all.map((one) => one.value)")


def waves(header: str, columns, rows: int = 300) -> str:
    return "\n".join([header, *(",".join(f"{value:.6g}" for value in columns(k)) for k in range(rows))]) + "\n"


DOUBTFUL = {
    "test.csv": waves(
        "Zeit [s],Weg Soll [in],Weg oben [in],Kraft Soll [kip],Horizontalkraft [kip]",
        lambda k: (k / 10, 2 * math.sin(k / 9), 1.9 * math.sin(k / 9 - 0.02), 31 * math.sin(k / 9 - 0.38), 30 * math.sin(k / 9 - 0.4)),
    ),
    "core.csv": waves(
        "freq,ampl,t,H,B",
        lambda k: (1 + k / 100, 100 + k / 7, k / 100, 100 * math.sin(k / 9), 1.1 * math.tanh(2 * math.sin(k / 9 - 0.4))),
    ),
}


@pytest.mark.parametrize(
    ("file", "time", "given", "output"),
    [("test.csv", "Zeit [s]", "Weg oben [in]", "Horizontalkraft [kip]"), ("core.csv", "t", "H", "B")],
)
def test_roles_in_doubt_are_chosen_one_after_the_other(start, visit, file, time, given, output):  # noqa: F811
    studio = start()
    opened = visit(studio)
    page = opened.page
    drop(page, file, DOUBTFUL[file])
    page.locator("#data .problem", has_text="name input and output").first.wait_for()
    assert studio.state()["columns"] is None and set(roles(page, file)) == {"unused"}
    page.get_by_label(f"Role of {given} in {file}").select_option("input")
    page.locator("#data .told", has_text="No column has the role output yet").get_by_role("button").click()
    # The first role stays, and nothing was refused.
    assert roles(page, file).count("input") == 1
    page.get_by_label(f"Role of {output} in {file}").select_option("output")
    state = studio.wait(lambda state: state["columns"] is not None)
    assert state["columns"] == {"record": None, "time": time, "inputs": [given], "rate": None, "output": output}
    page.locator("#data canvas").first.wait_for()
    assert page.locator("#data .problem").count() == 0 and studio.state()["files"][0]["problem"] is None
    # A column that is no longer the time is not detected as time again.
    page.get_by_label(f"Role of {time} in {file}").select_option("unused")
    state = studio.wait(lambda state: state["columns"] and state["columns"]["time"] is None)
    assert state["columns"]["inputs"] == [given] and state["columns"]["output"] == output
    opened.check()


@pytest.mark.parametrize("file", DOUBTFUL)
def test_the_roles_of_a_problem_are_set_by_its_buttons(start, visit, file):  # noqa: F811
    studio = start()
    opened = visit(studio)
    page = opened.page
    drop(page, file, DOUBTFUL[file])
    problem = page.locator("#data .problem", has_text="name input and output").first
    named = [problem.get_by_role("button", name=f'the role "{role}"').first for role in ["input", "output"]]
    given, output = [one.inner_text().split('" ', 1)[1] for one in named]
    # The other column of a role gives it up.
    page.get_by_label(f"Role of {output} in {file}").select_option("input")
    named[0].click()
    page.wait_for_function("(name) => document.activeElement.getAttribute('aria-label') === name", arg=f"Role of {given} in {file}")
    assert roles(page, file).count("input") == 1
    named[1].click()
    state = studio.wait(lambda state: state["columns"] is not None)
    assert (state["columns"]["inputs"], state["columns"]["output"]) == ([given], output)
    opened.check()


def test_the_error_of_a_removed_file_is_gone_from_identify(start, visit):  # noqa: F811
    studio = start()
    opened = visit(studio)
    page = opened.page
    drop(page, "broken.csv", "nothing\n")
    page.locator("#data li .problem").wait_for()
    page.locator("header a[href='#identify']").click()
    page.locator("#identify .problem").wait_for()
    page.locator("header a[href='#data']").click()
    page.get_by_role("button", name="Remove broken.csv").click()
    page.locator("#notices .told").wait_for()
    page.locator("header a[href='#identify']").click()
    page.locator("#identify .empty").wait_for()
    assert page.locator("#identify .problem").count() == 0
    # Beside a good file, the fit refuses it.
    studio.add("column-test.txt", "\n".join(COLUMN) + "\n")
    broken = studio.add("broken.csv", "nothing\n")
    page.get_by_role("button", name="Start").click()
    page.locator("#identify .problem").wait_for()
    assert studio.request("DELETE", f"/api/files/{broken}")[0] == 200
    page.locator("#identify .problem").wait_for(state="detached")
    assert "Training data: column-test.txt." in page.locator("#identify .begin").inner_text()
    opened.errors[:] = [error for error in opened.errors if "400" not in error]
    opened.check()


def test_a_picture_is_refused_as_a_picture(start, visit):  # noqa: F811
    studio = start()
    opened = visit(studio)
    picture = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + bytes(200)
    opened.page.locator("#data input[type=file]").set_input_files([{"name": "loop.csv", "mimeType": "text/csv", "buffer": picture}])
    opened.page.locator("#notices .problem", has_text="loop.csv: is a picture").wait_for()
    assert studio.state()["files"] == [] and list((studio.project / "data").iterdir()) == []


def test_a_file_that_is_dropped_on_judge_is_judged(start, visit):  # noqa: F811
    studio = start()
    studio.add("column-test.txt", "\n".join(COLUMN) + "\n")
    studio.begin(model="prandtl-ishlinskii")
    studio.ended()
    opened = visit(studio)
    opened.go("judge")
    drop(opened.page, "quake.csv", table("t_s,Displacement_mm,Force_kN"))
    row = opened.page.locator("#judge tr", has_text="not used in training: quake.csv")
    row.wait_for()
    assert row.locator("td").first.inner_text() == "200" and opened.page.url.endswith("#judge")
    # Its errors are on the first screen, the same as in the table.
    result = opened.page.locator("#judge .result")
    cells = row.locator("td").all_inner_texts()
    assert result.inner_text().startswith(f"quake.csv (not used in training): RMSE {cells[1]} kN, {cells[3]} of the standard deviation")
    box = result.bounding_box()
    assert opened.page.evaluate("scrollY") == 0 and box["y"] + box["height"] < 800
    assert studio.state()["files"][1]["use"] == "unseen"
    opened.check()
