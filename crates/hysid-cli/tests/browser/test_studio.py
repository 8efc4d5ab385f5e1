"""The way through the studio in a real browser: from a dropped file to a model that is taken away."""

import ast
import csv
import io
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import xml.etree.ElementTree as tree
import zipfile

import pytest
from axe_playwright_python.sync_playwright import Axe

STEPS = {
    "data": "canvas",
    "diagnose": ".card",
    "figures": "svg.plot",
    "identify": "button.main",
    "judge": "td",
    "compare": "td",
    "try": "canvas",
    "invert": "button.main",
    "plan": "button.main",
    "restoring-force": "button.main",
    "take-away": "pre",
}


class Page:
    """The page of a studio, and what went wrong in it."""

    def __init__(self, studio, context):
        self.studio = studio
        self.page = context.new_page()
        self.errors: list[str] = []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("console", lambda line: self.errors.append(line.text) if line.type == "error" else None)
        self.page.on("request", self.see)
        self.page.goto(studio.address)
        self.page.locator("#data .body input[type=file]").wait_for()

    def see(self, request):
        if not request.url.startswith((self.studio.origin, "data:", "blob:")):
            self.errors.append(f"asked for {request.url}")

    def go(self, step: str):
        """Goes to a step and waits until it shows something."""
        self.page.locator(f"header a[href='#{step}']").click()
        self.page.locator(f"#{step} {STEPS[step]}").first.wait_for()
        return self.page.locator(f"#{step}")

    def figure(self, step: str, title: str):
        """A figure of a step by its heading."""
        return self.page.locator(f"#{step} .figure", has=self.page.get_by_text(title, exact=True)).first

    def choose(self, model: str):
        """The step Identify with a model other than the default."""
        identify = self.go("identify")
        if not identify.get_by_label("Model", exact=True).is_visible():
            identify.get_by_text("Model and options").click()
        identify.get_by_label("Model", exact=True).select_option(model)
        return identify

    def fit(self, model: str, **options):
        """Fits a model with the form, and waits for the result."""
        identify = self.choose(model)
        for name, value in options.items():
            control = identify.locator(f"[data-flag='--{name}']")
            if not control.is_visible():
                identify.get_by_text("More options of").click()
            control.fill(str(value))
        identify.get_by_role("button", name="Start").click()
        self.page.get_by_role("link", name="Judge this model").wait_for(timeout=120_000)

    def check(self):
        assert self.errors == []


@pytest.fixture
def visit(browser):
    """Opens pages of studios."""
    contexts, pages = [], []

    def visit_studio(studio, width=1280, height=800, **options) -> Page:
        context = browser.new_context(viewport={"width": width, "height": height}, accept_downloads=True, **options)
        contexts.append(context)
        pages.append(Page(studio, context))
        return pages[-1]

    yield visit_studio
    for context in contexts:
        context.close()


def drop(page, name: str, text: str):
    """Drops a file on the page."""
    page.evaluate(
        """([name, text]) => {
            const transfer = new DataTransfer();
            transfer.items.add(new File([text], name));
            const event = (kind) => new DragEvent(kind, { dataTransfer: transfer, bubbles: true, cancelable: true });
            document.body.dispatchEvent(event("dragover"));
            document.body.dispatchEvent(event("drop"));
        }""",
        [name, text],
    )


def is_drawn(canvas) -> bool:
    """True if a canvas shows curves and not only a frame."""
    return canvas.evaluate(
        """(canvas) => {
            const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
            let drawn = 0;
            for (let k = 3; k < data.length; k += 4) drawn += data[k] > 0;
            return drawn > 1500;
        }"""
    )


def hysid(folder, *arguments: str) -> str:
    ran = subprocess.run([os.environ["HYSID_PROGRAM"], *arguments], cwd=folder, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def saved(page, click) -> tuple[str, bytes]:
    """Name and content of what a click saves."""
    with page.expect_download() as download:
        click()
    return download.value.suggested_filename, download.value.path().read_bytes()


def test_the_whole_way(start, visit, tmp_path):
    studio = start()
    opened = visit(studio)
    page = opened.page
    hysid(tmp_path, "generate", "terfenol-actuator", "-o", "rod.csv", "--test", "rod-test.csv", "--noise", "1")

    # 1. Data: a dropped file, its columns, a role that is changed and changed back.
    drop(page, "rod.csv", (tmp_path / "rod.csv").read_text())
    data = page.locator("#data")
    data.get_by_label("Role of current_A in rod.csv").wait_for()
    names = (tmp_path / "rod.csv").read_text().splitlines()[0].split(",")
    roles = {name: data.get_by_label(f"Role of {name} in rod.csv").input_value() for name in names}
    assert roles == {"t_s": "time", "current_A": "input", "displacement_um": "output"}
    data.get_by_label("Role of current_A in rod.csv").select_option("unused")
    data.get_by_text("no column has the role input").first.wait_for()
    assert json.loads((studio.project / "project.json").read_text())["understanding"]["columns"] is None
    data.get_by_label("Role of current_A in rod.csv").select_option("output")
    studio.wait(lambda state: state["columns"]["output"] == "current_A" and state["columns"]["inputs"] == ["displacement_um"])
    data.get_by_role("button", name="Detect again").click()
    studio.wait(lambda state: state["columns"]["output"] == "displacement_um" and not state["columns_are_chosen"])
    drawn = data.locator("canvas")
    assert drawn.count() == 3 and all(is_drawn(drawn.nth(place)) for place in range(3))

    # 2. Diagnose: a card with a picture for each property.
    diagnose = opened.go("diagnose")
    found = json.loads(hysid(studio.project, "diagnose", "data/rod.csv", "--json", "--no-report"))["properties"]
    assert diagnose.locator(".card").count() == len(found)
    assert diagnose.locator("svg.plot").count() >= 3

    # The cycles, as the program counts them.
    cycles = opened.go("figures")
    counted = json.loads(hysid(studio.project, "cycles", "data/rod.csv", "--json"))["cycles"]
    complete = sum(row["complete"] for row in counted)
    assert f"{complete} cycles" in cycles.inner_text() and cycles.locator("table").count() >= 1
    # What the columns do not tell is given in a form.
    assert "squareness" not in cycles.inner_text()
    cycles.get_by_label("Field").select_option("magnet")
    cycles.get_by_role("button", name="Read the cycles").click()
    cycles.get_by_text("squareness").first.wait_for()
    cycles.get_by_label("Mass density").fill("7650")
    cycles.get_by_role("button", name="Read the cycles").click()
    cycles.get_by_text("losses per mass need an energy per volume").first.wait_for()

    # 3. Identify, and a second model.
    opened.fit("xpnn", stops=4, seed=3)
    opened.fit("prandtl-ishlinskii", operators=6)

    # 4. Judge: a second file that is dropped is unseen data.
    drop(page, "rod-test.csv", (tmp_path / "rod-test.csv").read_text())
    page.get_by_label("Use of rod-test.csv").wait_for()
    assert page.get_by_label("Use of rod-test.csv").input_value() == "unseen"
    models = studio.state()["models"]
    opened.go("judge").get_by_label("Model", exact=True).select_option(str(models[0]["id"]))
    errors = json.loads(hysid(studio.project, "evaluate", f"models/{models[0]['file']}", "data/rod-test.csv", "--json"))
    row = page.locator("#judge tr", has_text="not used in training: rod-test.csv").filter(has_text=f"{errors['nrmse_std_percent']:.3g}")
    row.wait_for()
    cells = [float(text.replace("\u202f", "").replace(" ", "").rstrip("%")) for text in row.locator("td").all_inner_texts()]
    expected = [errors[name] for name in ("samples", "rmse", "max_abs_error", "nrmse_std_percent", "fit_percent")]
    assert cells == pytest.approx(expected, rel=6e-3)
    assert is_drawn(page.locator("#judge canvas").first)

    # 5. Compare.
    compare = opened.go("compare")
    assert compare.locator("tbody tr").count() == 2

    # 6. Take away: the lines of the page make the same model, and the file is that model.
    take = opened.go("take-away")
    take.get_by_label("Model", exact=True).select_option(str(models[0]["id"]))
    take.get_by_text("--stops 4").first.wait_for()
    name, content = saved(page, lambda: take.get_by_role("button", name="Model file").click())
    assert name == models[0]["file"] and content == (studio.project / "models" / name).read_bytes()
    line = take.locator("pre").first.inner_text()
    programs = tmp_path / "programs"
    programs.mkdir()
    shutil.copy(os.environ["HYSID_PROGRAM"], programs / "hysid")
    path = {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}
    ran = subprocess.run(["sh", "-c", f"{line} --no-report"], cwd=tmp_path, env=path, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    assert (studio.project / name).read_bytes() == content
    ast.parse(take.locator("pre").nth(1).inner_text())
    _, archive = saved(page, lambda: take.get_by_role("button", name="Download c:").click())
    with zipfile.ZipFile(io.BytesIO(archive)) as files:
        assert any(file.endswith(".c") for file in files.namelist()) and files.testzip() is None
    with page.expect_popup() as popup:
        take.get_by_role("link", name="Report").click()
    wrong = []
    popup.value.on("pageerror", lambda error: wrong.append(str(error)))
    report = popup.value.frame_locator("#report")
    report.get_by_role("heading", name="Errors").wait_for()
    # Its script runs: figures have buttons.
    report.get_by_role("button", name="SVG").first.wait_for()
    assert wrong == []
    # What was refused on the way is told in the console.
    assert [error for error in opened.errors if "400" not in error] == []


def begin_auto(start, visit):
    """A studio with data, its page, and the step of a default fit that has just begun."""
    studio = start()
    studio.specimen("terfenol-rod")
    opened = visit(studio)
    identify = opened.go("identify")
    identify.get_by_role("button", name="Start").click()
    identify.get_by_role("progressbar").wait_for()
    return studio, opened, identify


def test_auto_shows_its_candidates_and_keeps_the_best_when_it_is_stopped(start, visit):
    studio, opened, identify = begin_auto(start, visit)
    # Candidates come with their errors, and the best of them is drawn over the data.
    identify.locator("tbody tr", has_text=re.compile(r"\d\s%")).first.wait_for(timeout=60_000)
    identify.locator("canvas").first.wait_for()
    # A reload in mid-fit: all of it is there again.
    opened.page.reload()
    identify.get_by_role("progressbar").wait_for()
    identify.locator("tbody tr").first.wait_for()
    identify.get_by_role("button", name="Stop and keep the best model").click()
    opened.page.get_by_role("link", name="Judge this model").wait_for(timeout=60_000)
    state = studio.state()
    assert state["models"][0]["termination"] == "stopped" and state["fit"]["made"] == state["models"][0]["id"]
    errors = [one["error_percent"] for one in state["fit"]["candidates"] if one["state"] != "dropped" and one["error_percent"]]
    assert errors and errors == sorted(errors)
    opened.check()


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_nothing_is_lost_when_the_studio_ends_in_mid_fit(start, visit, how):
    studio = start()
    studio.specimen("magnetostrictive-actuator")
    studio.begin(model="prandtl-ishlinskii")
    studio.ended()
    columns = studio.state()["columns"]
    fit = studio.begin(model="auto")
    studio.wait(lambda state: state["fit"]["preview"] > 0)
    opened = visit(studio)
    status = studio.end(how)
    opened.page.get_by_text("The studio is not running").wait_for()
    again = start("--project", "hysid-project")
    state = again.state()
    assert [file["name"] for file in state["files"]] == ["magnetostrictive-actuator-train.csv", "magnetostrictive-actuator-test.csv"]
    assert state["columns"] == columns
    kept = [model for model in state["models"] if model["id"] == fit]
    assert len(kept) == 1 and len(state["models"]) == 2
    if how == signal.SIGINT:
        assert status == 130 and kept[0]["termination"] == "stopped" and not kept[0]["was_interrupted"]
    else:
        assert kept[0]["was_interrupted"] and "closed during this fit" in state["fit"]["problem"]
        page = visit(again)
        page.go("identify").get_by_text("The fit was interrupted").wait_for()
    # The model that was kept runs.
    unseen = state["files"][1]["id"]
    assert again.ask(f"/api/models/{fit}/judgement/{unseen}")["errors"]["samples"] > 0


def test_a_page_of_an_earlier_start_says_what_to_do(start, visit):
    studio = start()
    opened = visit(studio)
    studio.end()
    opened.page.get_by_text("The studio is not running").wait_for()
    start("--port", studio.port)
    opened.page.get_by_text("The studio was restarted").wait_for(timeout=20_000)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("empty.csv", "", "is empty"),
        ("header.csv", "t,x,y\n", "no rows"),
        ("picture.csv", "\u0089PNG\r\n\u001a\n\u0000\u0000\u0000\rIHDR\u0000\u0000", "picture.csv"),
        ("short.csv", "t,x,y\n0,1,2\n1,2\n2,3,4\n", "short.csv, line 3"),
        ("blank.csv", "t,x,y\n0,1,2\n1,,3\n2,3,4\n", "blank.csv, line 3"),
        ("time.csv", "t,x,y\n0,1,2\n2,2,3\n1.5,3,4\n", "time.csv"),
        ("one.csv", "t\n1\n2\n", "one.csv"),
    ],
)
def test_a_malformed_file_is_a_problem_in_words(start, visit, name, content, words):
    studio = start()
    opened = visit(studio)
    drop(opened.page, name, content)
    problem = opened.page.locator("#data .problem", has_text=words).first
    problem.wait_for()
    # A good file afterwards is read.
    opened.page.get_by_role("button", name=f"Remove {name}").click()
    opened.page.get_by_text("Drop a file").wait_for()
    good = "t,x,y\n" + "".join(f"{k},{k % 7},{k % 7 + 0.1 * (k % 3)}\n" for k in range(40))
    drop(opened.page, "good.csv", good)
    opened.page.locator("#data canvas").first.wait_for()
    opened.check()


def test_an_option_in_a_problem_leads_to_its_control(start, visit):
    studio = start()
    opened = visit(studio)
    rows = "".join(",".join(str(k % most) for most in range(3, 11)) + "\n" for k in range(40))
    drop(opened.page, "many.csv", "a,b,c,d,e,f,g,h\n" + rows)
    opened.page.locator("#data .problem button", has_text='the role "input"').first.click()
    opened.page.wait_for_function("() => document.activeElement.getAttribute('aria-label')?.startsWith('Role of ')")


def test_figures_zoom_together_tell_values_and_are_saved(start, visit):
    studio = start()
    number = studio.add("loops.csv", "t_s,x_mm,y_N\n" + "".join(f"{0.1 * k:.1f},{(k % 40) - 20},{(k % 40) * 0.5}\n" for k in range(200)))
    opened = visit(studio)
    page = opened.page
    output, loop = opened.figure("data", "Output"), opened.figure("data", "Loop")
    area = output.locator(".plot")
    area.scroll_into_view_if_needed()
    area.focus()
    area.press("+")
    area.press("+")
    _, content = saved(page, lambda: output.get_by_role("button", name="CSV").click())
    shown = list(csv.DictReader(io.StringIO(content.decode())))
    assert 0 < len(shown) < 200
    _, other = saved(page, lambda: loop.get_by_role("button", name="CSV").click())
    rows = {row["row"] for row in csv.DictReader(io.StringIO(other.decode()))}
    assert {row["row"] for row in shown} <= rows and len(rows) < 200
    values = {int(row["row"]): row for row in shown}
    for row, cells in values.items():
        numbers = [float(value) for name, value in cells.items() if name != "row"]
        assert numbers == pytest.approx([0.1 * (row - 1), ((row - 1) % 40) * 0.5])
    area.press("0")
    _, content = saved(page, lambda: output.get_by_role("button", name="CSV").click())
    assert len(content.decode().splitlines()) == 201
    name, drawing = saved(page, lambda: loop.get_by_role("button", name="SVG").click())
    assert name.endswith(".svg") and tree.fromstring(drawing).tag.endswith("svg") and "x (mm)" in drawing.decode()
    name, picture = saved(page, lambda: loop.get_by_role("button", name="PNG").click())
    assert name.endswith(".png") and picture.startswith(b"\x89PNG")
    box = area.bounding_box()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    told = output.locator(".readout").inner_text()
    time, value = (float(text.replace("−", "-")) for text in re.findall(r"[−-]?\d+(?:\.\d+)?", told)[:2])
    assert value == pytest.approx((round(10 * time) % 40) * 0.5), told
    assert number == 1
    opened.check()


def test_a_finding_is_marked_in_the_figures(start, visit):
    studio = start()
    rows = [f"{0.1 * k:.1f},{(k % 40) - 20},{(k % 40) * 0.5}" for k in range(400)]
    rows[250] = "25.0,-10,9999"
    studio.add("marked.csv", "t_s,x_mm,y_N\n" + "\n".join(rows) + "\n")
    opened = visit(studio)
    finding = opened.page.locator("#data .findings li", has_text="9999").first
    finding.get_by_role("button", name="Show").click()
    # The figures show the rows around the mark.
    output = opened.figure("data", "Output")
    _, content = saved(opened.page, lambda: output.get_by_role("button", name="CSV").click())
    shown = [int(row["row"]) for row in csv.DictReader(io.StringIO(content.decode()))]
    assert 251 in shown and len(shown) < 100
    opened.check()


def test_members_of_an_ensemble_are_drawn(start, visit):
    studio = start()
    train, unseen = studio.specimen("terfenol-rod")
    model = studio.begin(model="pnn", members=3, stops=4, epochs=5)
    assert studio.ended()["problem"] is None
    status, headers, content = studio.request("GET", f"/api/models/{model}/members/{unseen}")
    rows = next(file["rows"] for file in studio.state()["files"] if file["id"] == unseen)
    members = studio.state()["models"][0]["members"][0]["count"]
    assert status == 200 and len(content) == 8 * rows * members and members > 1
    opened = visit(studio)
    judge = opened.go("judge")
    judge.get_by_label("Members as thin lines").check()
    output = opened.figure("judge", "Output")
    output.get_by_text(re.compile(r"^1 pnn")).first.wait_for()
    _, table = saved(opened.page, lambda: output.get_by_role("button", name="CSV").click())
    columns = table.decode().splitlines()[0].split(",")
    assert sum(bool(re.match(r"\d pnn", name)) for name in columns) == members
    assert train != unseen
    opened.check()


def test_a_model_is_driven_by_hand_and_by_waves(start, visit, tmp_path):
    studio = start()
    studio.specimen("magnetostrictive-actuator")
    opened = visit(studio)
    opened.fit("xpnn", stops=4)
    model = studio.state()["models"][0]
    driven = opened.go("try")
    page = opened.page
    runs = []
    page.on("request", lambda request: runs.append(request) if "/run?" in request.url else None)
    slider = driven.locator("fieldset input[type=range]").first
    slider.focus()
    for _ in range(5):
        slider.press("ArrowRight")
    driven.locator("#try-amplitude, fieldset >> nth=1 >> input[type=range]").first.press("ArrowLeft")
    page.wait_for_function("() => document.querySelectorAll('#try canvas').length > 0")
    assert len(runs) >= 2
    assert is_drawn(driven.locator("canvas").first)
    # The last run, as the program simulates it.
    request = runs[-1]
    rows = int(re.search(r"rows=(\d+)", request.url).group(1))
    status, _, answer = studio.request("POST", f"/api/models/{model['id']}/run?rows={rows}", request.post_data_buffer)
    assert status == 200
    numbers = struct.unpack(f"<{2 * rows}d", request.post_data_buffer)
    outputs = struct.unpack(f"<{len(answer) // 8}d", answer)[:rows]
    lines = [f"{numbers[k]!r},{numbers[rows + k]!r}" for k in range(rows)]
    (tmp_path / "drive.csv").write_text("t_s,current_A\n" + "\n".join(lines) + "\n")
    hysid(tmp_path, "simulate", f"hysid-project/models/{model['file']}", "drive.csv", "-o", "out.csv")
    with (tmp_path / "out.csv").open() as table:
        simulated = [float(row["displacement_um_model"]) for row in csv.DictReader(table)]
    assert outputs == pytest.approx(simulated, rel=1e-12, abs=1e-12)
    opened.check()


def test_a_million_rows(start, visit, tmp_path):
    """Drawn, moved, and to the last bit what is in the file; how long it takes is measured in docs/studio.md."""
    rows = 1_000_000
    x = [round(((k * 7919) % 20011) / 1000 - 10, 3) for k in range(rows)]
    with (tmp_path / "million.csv").open("w") as table:
        table.write("t_s,x_mm,y_N\n")
        table.writelines(f"{k / 1000:.3f},{x[k]},{0.5 * x[k]:.4f}\n" for k in range(rows))
    studio = start()
    opened = visit(studio)
    opened.page.locator("#data input[type=file]").set_input_files(tmp_path / "million.csv")
    opened.page.locator("#data canvas").nth(2).wait_for(timeout=60_000)
    area = opened.figure("data", "Output").locator(".plot")
    area.focus()
    for key in ["+", "+", "ArrowRight", "ArrowRight", "0"]:
        area.press(key)
    assert all(is_drawn(opened.page.locator("#data canvas").nth(place)) for place in range(3))
    status, headers, content = studio.request("GET", "/api/files/1/columns")
    assert status == 200 and headers["x-columns"] == "time,input,rate,output" and headers["x-rows"] == str(rows)
    assert list(struct.unpack(f"<{rows}d", content[8 * rows : 16 * rows])) == x
    opened.check()


@pytest.fixture(scope="module")
def furnished(shared):
    """The studio of this file with data and a network."""
    shared.specimen("magnetostrictive-actuator")
    shared.begin(model="xpnn", epochs=20)
    assert shared.ended()["problem"] is None
    return shared


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_serious_for_those_who_do_not_see_the_page(furnished, visit, scheme):
    opened = visit(furnished, color_scheme=scheme)
    for step in STEPS:
        opened.go(step)
        opened.page.evaluate("() => document.querySelectorAll('details').forEach((one) => { one.open = true; })")
        found = Axe().run(opened.page).response["violations"]
        serious = [(one["id"], one["nodes"][0]["html"]) for one in found if one["impact"] in ("serious", "critical")]
        assert serious == [], step
    opened.check()


def test_a_telephone_scrolls_in_one_direction(furnished, visit):
    opened = visit(furnished, width=400)
    for step in STEPS:
        opened.go(step)
        width = opened.page.evaluate("document.scrollingElement.scrollWidth")
        assert width <= 400, (step, width)
    opened.check()


def test_the_keyboard_is_enough(furnished, visit):
    opened = visit(furnished)
    page = opened.page
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    # From link to link of the bar to Identify, and on to Start.
    for _ in range(40):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.textContent") == "Identify":
            break
    page.keyboard.press("Enter")
    page.locator("#identify button.main").wait_for()
    for _ in range(40):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.textContent") == "Start":
            break
    assert page.evaluate("document.activeElement.textContent") == "Start"
