"""The script of pages in a real browser: zoom, values at the pointer, cycles, saving, narrow screens, no script."""

import csv
import io
import os
import re
import xml.etree.ElementTree as tree
from pathlib import Path

import pytest
from conftest import run
from PIL import Image

#: The picture of a report in the README; HYSID_WRITE=1 writes it.
PICTURE = Path(__file__).parents[4] / "docs" / "images" / "report.png"


def drag(opened, figure, start, end):
    """Drags from one place of a figure to another, in shares of the drawing from the left and from above."""
    figure.scroll_into_view_if_needed()
    box = figure.locator("svg.plot[role=img]").bounding_box()
    places = [(box["x"] + x * box["width"], box["y"] + y * box["height"]) for x, y in (start, end)]
    mouse = opened.page.mouse
    mouse.move(*places[0])
    mouse.down()
    mouse.move(*places[1], steps=4)
    mouse.up()


def test_a_drag_zooms_and_a_button_shows_the_whole_figure(opened):
    page = opened()
    figure = page.figure("Loops of")
    before = page.axis(figure)
    drag(page, figure, (0.3, 0.3), (0.5, 0.6))
    zoomed = page.axis(figure)
    assert max(zoomed) - min(zoomed) < 0.5 * (max(before) - min(before)), (before, zoomed)
    figure.get_by_role("button", name="Whole figure").click()
    assert page.axis(figure) == before
    page.check()


def test_keys_zoom_and_move(opened):
    page = opened()
    figure = page.figure("Loops of")
    before = page.axis(figure)
    drawing = figure.locator("svg.plot[role=img]")
    drawing.focus()
    drawing.press("+")
    drawing.press("+")
    near = page.axis(figure)
    assert max(near) - min(near) < max(before) - min(before)
    drawing.press("ArrowRight")
    assert sum(page.axis(figure)) / len(page.axis(figure)) > sum(near) / len(near)
    drawing.press("0")
    assert page.axis(figure) == before


def test_figures_over_time_of_a_record_zoom_together(opened):
    page = opened()
    figures = [page.figure(f"{label} over t (s), record up") for label in ("displacement (µm)", "error (µm)", "current (A)")]
    before = page.axis(figures[0])
    other = page.figure("displacement (µm) over t (s), record down")
    of_other = page.axis(other)
    drag(page, figures[0], (0.3, 0.5), (0.6, 0.5))
    axes = [page.axis(figure) for figure in figures]
    assert axes[0] != before and axes[0] == axes[1] == axes[2]
    assert page.axis(other) == of_other


def test_the_pointer_reads_the_same_moment_in_all_figures_of_the_record(opened, folder):
    page = opened()
    figure = page.figure("displacement (µm) over t (s), record up")
    figure.scroll_into_view_if_needed()
    box = figure.locator("svg.plot[role=img]").bounding_box()
    page.page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    said = figure.locator("output").text_content()
    read = re.fullmatch(r"t \(s\): ([\d.]+); displacement \(µm\): measured ([\d.]+), model [\d.]+", said)
    assert read, said
    time = float(read[1])
    # The measured value is that of the table.
    rows = csv.DictReader((folder / "two.csv").open())
    row = next(row for row in rows if row["record"] == "up" and abs(float(row["t_s"]) - time) < 1e-6)
    assert float(read[2]) == pytest.approx(float(row["displacement_um"]), rel=1e-3)
    # Of a long record each figure draws some of the rows: the nearest one is marked.
    beside = page.figure("current (A) over t (s), record up").locator("output").text_content()
    assert abs(float(re.match(r"t \(s\): ([\d.]+);", beside)[1]) - time) < 0.1, (said, beside)
    assert page.figure("Loops of").locator("circle.cursor").count() >= 1
    other = page.figure("displacement (µm) over t (s), record down").locator("output").text_content()
    assert other == ""


def test_a_cycle_is_selected_in_loops_and_over_time(opened):
    page = opened()
    figure = page.figure("Loops of")
    slider = figure.locator("input[type=range]").first
    figure.scroll_into_view_if_needed()
    slider.focus()
    slider.press("ArrowRight")
    slider.press("ArrowRight")
    assert figure.locator("svg.curves.pale").count() == 1
    over_time = page.figure("displacement (µm) over t (s), record up").locator("rect.times")
    assert over_time.count() == 1
    page.check()


def test_a_figure_is_saved_as_drawing_picture_and_table(opened, tmp_path):
    page = opened()
    figure = page.figure("Loops of")
    saved = {}
    for kind in ("SVG", "PNG", "CSV"):
        with page.page.expect_download() as download:
            figure.get_by_role("button", name=kind).click()
        saved[kind] = tmp_path / download.value.suggested_filename
        download.value.save_as(saved[kind])
    root = tree.parse(saved["SVG"]).getroot()
    assert root.tag.endswith("svg") and root.findall(".//{*}polyline")
    assert saved["PNG"].read_bytes().startswith(b"\x89PNG")
    rows = list(csv.reader(saved["CSV"].open(encoding="utf-8")))
    assert len(rows) > 100 and any("current" in cell for cell in rows[0]), rows[0]
    page.check()


@pytest.mark.parametrize("name", ["model.html", "cycles.html"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_phone_has_no_sideways_overflow(opened, name, scheme):
    page = opened(name, width=400, height=800, color_scheme=scheme)
    size = page.page.evaluate("[document.documentElement.scrollWidth, document.documentElement.clientWidth]")
    assert size[0] <= size[1]
    page.check()


def test_a_page_without_scripts_is_complete(opened):
    page = opened(java_script_enabled=False)
    assert page.page.locator("figure svg.plot").count() >= 5
    assert page.page.locator("table").count() >= 2
    assert page.page.locator("figure .tools").count() == 0


def test_the_head_of_a_report_says_how_good_the_model_is(opened, folder):
    run(folder, "generate ferromagnet -o magnet.csv --noise 1")
    run(folder, "fit magnet.csv -o magnet.json --model preisach --members 2 --title Magnet")
    page = opened("magnet.html", width=1160, height=700)
    whole = Image.open(io.BytesIO(page.page.screenshot())).convert("RGB")
    assert len(whole.getcolors(whole.width * whole.height)) > 20
    words = page.page.locator("body").inner_text()
    assert words.startswith("Magnet") and "held-out" in words[:800]
    if os.environ.get("HYSID_WRITE"):
        whole.quantize(24, dither=Image.Dither.NONE).save(PICTURE, optimize=True)
    assert PICTURE.stat().st_size < 100_000
    page.check()
