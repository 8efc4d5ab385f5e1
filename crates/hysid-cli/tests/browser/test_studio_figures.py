"""Figures of the studio under the pointer and the keys: zoom by drag, movement, marks, and models drawn over data."""

import csv
import io
import struct

import pytest
from test_studio import hysid, saved, visit  # noqa: F401 (a fixture)

ROWS = 200


@pytest.fixture(scope="module")
def drawn(shared):
    """A studio with 200 rows of time, input and output."""
    rows = "".join(f"{0.1 * k:.1f},{(k % 40) - 20},{(k % 40) * 0.5}\n" for k in range(ROWS))
    shared.add("loops.csv", "t_s,x_mm,y_N\n" + rows)
    return shared


def rows_in(page, figure) -> list[int]:
    """The rows that a figure shows, as it saves them."""
    _, content = saved(page, lambda: figure.get_by_role("button", name="CSV").click())
    return [int(row["row"]) for row in csv.DictReader(io.StringIO(content.decode()))]


def place_in(figure, x, y=0.5):
    """A place of the drawing, in shares from the left and from above."""
    figure.scroll_into_view_if_needed()
    box = figure.locator(".u-over").bounding_box()
    return box["x"] + x * box["width"], box["y"] + y * box["height"]


def drag(page, figure, start, end, key=None):
    page.mouse.move(*place_in(figure, *start))
    if key:
        page.keyboard.down(key)
    page.mouse.down()
    page.mouse.move(*place_in(figure, *end), steps=4)
    page.mouse.up()
    if key:
        page.keyboard.up(key)


def test_a_drag_over_time_shows_these_rows_in_all_figures(drawn, visit):  # noqa: F811
    opened = visit(drawn)
    page = opened.page
    output, loop, given = (opened.figure("data", title) for title in ("Output", "Loop", "Input"))
    drag(page, output, (0.3, 0.5), (0.5, 0.5))
    shown = rows_in(page, output)
    # Time goes from 0 to 19.9 s over the whole width; a row or two more may lie at the edges.
    assert abs(shown[0] - (0.3 * (ROWS - 1) + 1)) < 3 and abs(shown[-1] - (0.5 * (ROWS - 1) + 1)) < 3
    assert rows_in(page, given) == shown and rows_in(page, loop) == shown
    drag(page, output, (0.6, 0.5), (0.4, 0.5), key="Shift")
    moved = rows_in(page, output)
    # A fifth of the window, to the right.
    assert 3 < moved[0] - shown[0] < 15 and abs(len(moved) - len(shown)) < 3
    assert rows_in(page, loop) == moved
    page.mouse.dblclick(*place_in(output, 0.5))
    assert len(rows_in(page, output)) == len(rows_in(page, loop)) == ROWS
    opened.check()


def test_a_click_is_no_zoom_and_a_button_shows_the_whole_loop(drawn, visit):  # noqa: F811
    opened = visit(drawn)
    page = opened.page
    loop = opened.figure("data", "Loop")
    whole = loop.get_by_role("button", name="Show the whole figure")
    page.mouse.click(*place_in(loop, 0.5))
    assert not whole.is_visible()
    drag(page, loop, (0.3, 0.3), (0.6, 0.6))
    whole.click()
    whole.wait_for(state="hidden")
    opened.check()


def test_the_row_under_the_pointer_is_marked_in_the_other_figures(drawn, visit):  # noqa: F811
    opened = visit(drawn)
    output, loop = opened.figure("data", "Output"), opened.figure("data", "Loop")
    assert loop.locator(".dot:visible").count() == 0
    opened.page.mouse.move(*place_in(output, 0.5))
    loop.locator(".dot:visible").first.wait_for()
    loop.scroll_into_view_if_needed()
    opened.page.mouse.move(*place_in(loop, 0.5, 0.02))
    opened.page.mouse.move(5, 5)
    loop.locator(".dot:visible").first.wait_for(state="hidden")
    opened.check()


def test_a_figure_is_reached_and_moved_by_keys(drawn, visit):  # noqa: F811
    opened = visit(drawn)
    keyboard = opened.page.keyboard
    for _ in range(80):
        keyboard.press("Tab")
        label = opened.page.evaluate("document.activeElement.getAttribute('aria-label')") or ""
        if label.startswith("Output: "):
            break
    assert label.startswith("Output: ")
    output = opened.figure("data", "Output")
    for key in ["+", "+", "+"]:
        keyboard.press(key)
    near = opened.page.evaluate("document.activeElement.className")
    assert near == "plot"
    shown = rows_in(opened.page, output)
    assert len(shown) < 0.7 * ROWS
    output.locator(".plot").focus()
    keyboard.press("ArrowRight")
    assert rows_in(opened.page, output)[0] > shown[0]
    output.locator(".plot").focus()
    keyboard.press("0")
    assert len(rows_in(opened.page, output)) == ROWS
    opened.check()


def test_models_that_are_ticked_are_drawn_as_the_program_simulates_them(start, visit, tmp_path):  # noqa: F811
    studio = start()
    train, unseen = studio.specimen("terfenol-rod")
    for name in ("prandtl-ishlinskii", "masing"):
        studio.begin(model=name)
        assert studio.ended()["problem"] is None
    models = studio.state()["models"]
    opened = visit(studio)
    opened.go("compare")
    output = opened.figure("compare", "Output")
    output.locator(".legend", has_text=models[1]["title"]).wait_for()
    _, content = saved(opened.page, lambda: output.get_by_role("button", name="CSV").click())
    table = list(csv.DictReader(io.StringIO(content.decode())))
    data = next(file["name"] for file in studio.state()["files"] if file["id"] == unseen)
    for model in models:
        hysid(tmp_path, "simulate", f"hysid-project/models/{model['file']}", f"hysid-project/data/{data}", "-o", f"{model['id']}.csv")
        with (tmp_path / f"{model['id']}.csv").open() as file:
            expected = [float(row["displacement_um_model"]) for row in csv.DictReader(file)]
        assert [float(row[model["title"]]) for row in table] == pytest.approx(expected, rel=1e-9, abs=1e-9)
    opened.page.locator(f"#overlay-{models[0]['id']}").uncheck()
    output.locator(".legend", has_not_text=models[0]["title"]).wait_for()
    _, content = saved(opened.page, lambda: output.get_by_role("button", name="CSV").click())
    header = content.decode().splitlines()[0]
    assert models[1]["title"] in header and models[0]["title"] not in header
    status, _, numbers = studio.request("GET", f"/api/models/{models[1]['id']}/simulated/{unseen}")
    assert status == 200 and train != unseen
    assert struct.unpack_from("<d", numbers)[0] == pytest.approx(float(table[0][models[1]["title"]]))
    opened.check()
