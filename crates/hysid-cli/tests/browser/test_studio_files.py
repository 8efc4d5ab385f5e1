"""Files of a project: columns under other names, pictures, and a file that is dropped where a model is judged."""

import math

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
    assert studio.state()["files"][1]["use"] == "unseen"
    opened.check()
