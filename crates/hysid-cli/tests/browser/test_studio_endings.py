"""A studio under bad conditions: progress of a single model, kills before there is a model, cut uploads, damaged projects."""

import json
import os
import signal
import socket
import struct
import subprocess

import pytest
from test_studio import visit  # noqa: F401 (a fixture)

TABLE = "t,x,y\n" + "".join(f"{k},{k % 7},{k % 7 + 0.1 * (k % 3)}\n" for k in range(40))


def test_the_progress_of_a_single_model_grows_until_it_is_stopped(start, visit):  # noqa: F811
    studio = start()
    studio.specimen("magnetostrictive-actuator")
    opened = visit(studio)
    identify = opened.choose("xpnn")
    epochs = identify.locator("[data-flag='--epochs']")
    if not epochs.is_visible():
        identify.get_by_text("More options of").click()
    epochs.fill("20000")
    opened.page.evaluate(
        """() => {
            window.told = [];
            new MutationObserver(() => {
                const bar = document.querySelector("#identify [role=progressbar]");
                if (bar) window.told.push(Number(bar.getAttribute("aria-valuenow")));
            }).observe(document.querySelector("#identify"), { subtree: true, childList: true, attributes: true });
        }"""
    )
    identify.get_by_role("button", name="Start").click()
    identify.get_by_role("progressbar").wait_for()
    identify.locator("canvas").first.wait_for()
    opened.page.wait_for_function("() => window.told.some((share) => share > 0)", timeout=60_000)
    identify.get_by_role("button", name="Stop and keep the best model").click()
    opened.page.get_by_role("link", name="Judge this model").wait_for(timeout=60_000)
    told = opened.page.evaluate("window.told")
    assert told == sorted(told) and all(0 <= share <= 100 for share in told)
    model = studio.state()["models"][0]
    assert model["termination"] == "stopped" and model["options"]["epochs"] == 20000
    opened.check()


def test_a_fit_that_was_killed_before_it_had_a_model_says_so(start, visit):  # noqa: F811
    studio = start()
    studio.specimen("terfenol-rod")
    studio.begin(model="auto", members=50)
    studio.end(signal.SIGKILL)
    had_model = (studio.project / "models" / ".best-so-far.json").exists()
    again = start("--project", "hysid-project")
    state = again.state()
    assert state["fit"]["was_interrupted"] and len(state["models"]) == int(had_model)
    opened = visit(again)
    identify = opened.go("identify")
    identify.get_by_text("The fit was interrupted").wait_for()
    assert identify.get_by_text("the best model so far was kept" if had_model else "start it again").first.is_visible()
    # The interruption is told once; a new fit goes through.
    again.begin(model="prandtl-ishlinskii")
    assert again.ended()["problem"] is None


def test_an_upload_that_breaks_off_leaves_nothing(start):
    studio = start()
    head = "POST /api/files?name=cut.csv HTTP/1.1\r\n"
    lines = {**studio.headers(), "Content-Length": "100000"}
    with socket.create_connection(("127.0.0.1", int(studio.port))) as connection:
        connection.sendall((head + "".join(f"{name}: {value}\r\n" for name, value in lines.items()) + "\r\nt,x,y\n0,1,2\n").encode())
        studio.wait(lambda _: list((studio.project / "data").iterdir()))
    studio.wait(lambda _: not list((studio.project / "data").iterdir()))
    assert studio.state()["files"] == []
    studio.add("good.csv", TABLE)
    assert studio.state()["files"][0]["problem"] is None


@pytest.mark.parametrize("rows", [0, 20001, 2**62, 2**63, 2**64 - 1, -1])
def test_a_path_of_any_length_is_refused_in_words(network, rows):
    status, _, content = network.request("POST", f"/api/models/{network.made}/run?rows={rows}", b"")
    assert status == 400 and json.loads(content)["error"]
    assert network.process.poll() is None


@pytest.mark.parametrize("numbers", [(0, 1, 2, 1, float("nan"), 2), (0, 1, 2, 1, float("inf"), 2), (0, 0, 0, 1, 2, 3), (2, 1, 0, 1, 2, 3)])
def test_numbers_that_no_model_can_follow_are_refused(network, numbers):
    status, _, content = network.request("POST", f"/api/models/{network.made}/run?rows=3", struct.pack("<6d", *numbers))
    assert status == 400 and "row" in json.loads(content)["error"]


@pytest.fixture(scope="module")
def network(shared):
    """A studio with a network that needs time."""
    shared.specimen("magnetostrictive-actuator")
    shared.made = shared.begin(model="xpnn", epochs=5)
    assert shared.ended()["problem"] is None
    return shared


def test_a_project_that_names_files_elsewhere_is_refused(start, tmp_path):
    studio = start()
    studio.add("good.csv", TABLE)
    studio.end()
    (tmp_path / "secret.csv").write_text(TABLE.replace("x", "secret"))
    written = json.loads((studio.project / "project.json").read_text())
    written["files"][0]["name"] = "../../secret.csv"
    text = json.dumps(written, indent=2)
    (studio.project / "project.json").write_text(text)
    ran = refused(tmp_path)
    assert '"../../secret.csv" is no name of a file in the project' in ran.stderr
    assert (tmp_path / "secret.csv").exists() and (studio.project / "project.json").read_text() == text


def refused(folder):
    """A start that is refused in one line."""
    command = [os.environ["HYSID_PROGRAM"], "studio", "--no-open", "--port", "0", "--project", "hysid-project"]
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)
    assert ran.returncode == 1 and len(ran.stderr.splitlines()) == 1, ran.stderr
    return ran


def test_a_damaged_project_is_one_line_and_stays_as_it_is(start, tmp_path):
    studio = start()
    studio.add("good.csv", TABLE)
    studio.end()
    damaged = (studio.project / "project.json").read_text()[:40]
    (studio.project / "project.json").write_text(damaged)
    assert "project.json: is damaged" in refused(tmp_path).stderr
    assert (studio.project / "project.json").read_text() == damaged


def test_a_finished_model_is_not_lost_when_the_disk_is_full(start, visit):  # noqa: F811
    studio = start()
    studio.specimen("ferromagnet")
    # As with a full disk: nothing can be written to the folder of models.
    models, away = studio.project / "models", studio.project / "away"
    models.rename(away)
    models.write_text("")
    opened = visit(studio)
    identify = opened.choose("prandtl-ishlinskii")
    identify.get_by_role("button", name="Start").click()
    identify.get_by_text("The model is not stored").wait_for(timeout=60_000)
    with opened.page.expect_download() as download:
        identify.get_by_role("button", name="Download the model").click()
    content = download.value.path().read_bytes()
    assert json.loads(content)["format"] == "hysid-model"
    models.unlink()
    away.rename(models)
    identify.get_by_role("button", name="Save again").click()
    opened.page.get_by_role("link", name="Judge this model").wait_for()
    assert (models / download.value.suggested_filename).read_bytes() == content
    assert studio.state()["fit"]["problem"] is None and len(studio.state()["models"]) == 1
    opened.check()
