"""Exports of a studio: source code that compiles, lines of Python, the report, and how answers are labelled."""

import ast
import io
import shutil
import subprocess
import zipfile

import pytest
from test_studio import visit  # noqa: F401 (a fixture)


@pytest.fixture(scope="module")
def made(shared):
    """A studio with a network of chosen options."""
    shared.specimen("magnetostrictive-actuator")
    shared.begin(model="xpnn", epochs=20, stops=5, seed=7)
    assert shared.ended()["problem"] is None
    return shared


def the_model(studio) -> dict:
    return studio.state()["models"][0]


def test_the_exported_source_compiles_and_its_own_test_passes(made, tmp_path):
    compiler = shutil.which("gcc") or shutil.which("cc")
    if not compiler:
        pytest.skip("no C compiler here")
    status, headers, archive = made.request("GET", f"/api/models/{the_model(made)['id']}/export/c")
    assert status == 200 and "attachment" in headers["content-disposition"]
    with zipfile.ZipFile(io.BytesIO(archive)) as files:
        assert files.testzip() is None
        assert not any(name.startswith("/") or ".." in name for name in files.namelist())
        files.extractall(tmp_path)
    (folder,) = tmp_path.iterdir()
    sources = sorted(str(path) for path in folder.glob("*.c"))
    command = [compiler, "-std=c99", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off", "-o", "tested", *sources, "-lm"]
    compiled = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert compiled.returncode == 0, compiled.stderr
    ran = subprocess.run([folder / "tested"], cwd=folder, capture_output=True, text=True)
    assert ran.returncode == 0 and ran.stdout.startswith("0 of "), ran.stdout + ran.stderr


def test_the_lines_of_python_have_the_options(made, visit):  # noqa: F811
    opened = visit(made)
    lines = opened.go("take-away").locator("pre").nth(1).inner_text()
    calls = [node for node in ast.walk(ast.parse(lines)) if isinstance(node, ast.Call)]
    fit = next(call for call in calls if ast.unparse(call.func) == "hysid.fit")
    options = {one.arg: ast.literal_eval(one.value) for one in fit.keywords if isinstance(one.value, ast.Constant)}
    assert options == {"model": "xpnn", "epochs": 20, "stops": 5, "seed": 7}
    columns = {one.arg: ast.unparse(one.value) for one in fit.keywords if one.arg in ("time", "records")}
    assert columns == {"time": "table['t_s']", "records": "table['record']"}
    saves = next(call for call in calls if ast.unparse(call.func) == "model.save")
    assert ast.literal_eval(saves.args[0]) == the_model(made)["file"]
    opened.check()


def test_the_report_opens_without_an_error(made, visit):  # noqa: F811
    opened = visit(made)
    wrong = []
    opened.page.context.on("console", lambda line: wrong.append(line.text) if line.type == "error" else None)
    opened.page.context.on("weberror", lambda error: wrong.append(str(error.error)))
    take = opened.go("take-away")
    with opened.page.expect_popup() as popup:
        take.get_by_role("link", name="Report").click()
    popup.value.frame_locator("#report").get_by_role("button", name="SVG").first.wait_for()
    popup.value.reload()
    popup.value.frame_locator("#report").get_by_role("button", name="SVG").first.wait_for()
    assert wrong == []


def test_every_kind_of_answer_is_labelled(made):
    model = the_model(made)["id"]
    file = made.state()["files"][0]["id"]
    paths = [f"/api/files/{file}/columns", "/api/diagnosis", "/api/findings"]
    parts = ["file", "export/c", "facts", "commands", f"simulated/{file}", f"judgement/{file}"]
    paths += [f"/api/models/{model}/{part}" for part in parts]
    refused = [("/api/project", made.headers(X_Hysid_Key=None)), ("/api/models/99/file", made.headers())]
    for path, headers in [*((path, made.headers()) for path in paths), *refused]:
        _, answer, _ = made.request("GET", path, None, headers)
        assert "unsafe" not in answer["content-security-policy"] and "default-src 'none'" in answer["content-security-policy"], path
        assert answer["x-content-type-options"] == "nosniff" and answer["cache-control"] == "no-store", path
    _, answer, _ = made.request("GET", f"/api/models/{model}/report")
    policy = dict(part.strip().split(" ", 1) for part in answer["content-security-policy"].split(";"))
    assert policy["script-src"].startswith("'sha256-") and "unsafe" not in policy["script-src"]
    # A sandbox: the report cannot ask the studio for anything.
    assert "allow-same-origin" not in policy["sandbox"] and policy["default-src"] == "'none'"


def test_the_lines_of_a_fit_that_was_stopped_by_hand_say_so(start, visit):  # noqa: F811
    studio = start()
    studio.specimen("terfenol-rod")
    studio.begin(model="auto")
    studio.wait(lambda state: state["fit"]["preview"] > 0)
    studio.ask("/api/fit/stop", {})
    assert studio.ended()["problem"] is None and the_model(studio)["termination"] == "stopped"
    take = visit(studio).go("take-away")
    # The lines run the fit to its end, which makes another model.
    take.get_by_text("This fit was stopped early").wait_for()


def test_a_report_of_somebody_else_runs_no_script_of_its_own(made, browser, tmp_path, start):
    shutil.copytree(made.project, tmp_path / "hysid-project", ignore=shutil.ignore_patterns(".*", "studio.html"))
    (report,) = (tmp_path / "hysid-project" / "models").glob("*.html")
    foreign = "<script>parent.document.title = 'taken'; document.body.innerHTML = 'taken'</script><img src=x onerror=\"document.body.innerHTML = 'taken'\">"
    report.write_text(report.read_text().replace("<h1>", f"{foreign}<h1>"))
    studio = start()
    context = browser.new_context()
    page = context.new_page()
    page.goto(studio.address)
    # The page has its key when it shows the project.
    page.locator("#data .body input[type=file]").wait_for()
    page.goto(f"{studio.origin}/report#{the_model(studio)['id']}")
    frame = page.frame_locator("#report")
    # The script of the program runs.
    frame.get_by_role("button", name="SVG").first.wait_for()
    assert frame.locator("h1").count() == 1 and "taken" not in page.title()
    context.close()
