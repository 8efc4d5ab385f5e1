"""Requests that only the page of a studio may make, and those that the page itself may not."""

import http.server
import json
import os
import signal
import socket
import subprocess
import threading
import time

import pytest

TABLE = "t,x,y\n" + "".join(f"{k},{k % 7},{k % 7 + 0.1 * (k % 3)}\n" for k in range(40))

READING = ["/api/project", "/api/choices", "/api/events", "/", "/main.js", "/assets/document.css"]


def refused(studio, method, path, body=None, **headers):
    """The words of a refusal; the project stays as it is."""
    before = (studio.project / "project.json").read_bytes() if studio.project.joinpath("project.json").exists() else b""
    status, _, content = studio.request(method, path, body, studio.headers(**headers))
    after = (studio.project / "project.json").read_bytes() if studio.project.joinpath("project.json").exists() else b""
    assert status == 403 and before == after, (status, content)
    return json.loads(content)["error"]


@pytest.mark.parametrize("path", ["/api/project", "/api/choices", "/api/events"])
def test_nothing_is_read_without_the_key(shared, path):
    assert "studio.html" in refused(shared, "GET", path, X_Hysid_Key=None)
    refused(shared, "GET", path, X_Hysid_Key="0" * len(shared.key))
    refused(shared, "GET", path, X_Hysid_Key=shared.token)
    # What other servers on this address may have got.
    refused(shared, "GET", path, X_Hysid_Key=None, Cookie=shared.ticket)
    refused(shared, "GET", f"{path}?token={shared.token}", X_Hysid_Key=None)


def test_an_address_opens_one_browser_and_leaves_nothing_in_it_but_the_key(start, browser):
    studio = start()
    studio.add("a.csv", TABLE)
    address = studio.address
    context = browser.new_context()
    page = context.new_page()
    asked = []
    page.on("request", lambda request: asked.append((request.url, request.headers.get("referer"))))
    # As a desktop opens it: by the file.
    page.goto((studio.project / "studio.html").as_uri())
    page.get_by_text("a.csv").first.wait_for()
    assert page.url == f"{studio.origin}/" and context.cookies() == []
    assert [url for url, referer in asked if "token" in url or "token" in (referer or "")] == [address]
    # Reload, a second tab, and the address that is used up: this browser has the key.
    page.reload()
    page.get_by_text("a.csv").first.wait_for()
    for again in [studio.origin, address]:
        tab = context.new_page()
        tab.goto(again)
        tab.get_by_text("a.csv").first.wait_for()
        assert tab.url == f"{studio.origin}/"
    # Another browser gets nothing of the project.
    for again in [studio.origin, address]:
        other = browser.new_context()
        tab = other.new_page()
        tab.goto(again)
        tab.get_by_text("Open the file studio.html").wait_for()
        assert "a.csv" not in tab.content()
        other.close()
    # The next address opens it too.
    other = browser.new_context()
    tab = other.new_page()
    tab.goto(studio.address)
    tab.get_by_text("a.csv").first.wait_for()
    # A restart: the pages of the studio before say so, and go on once this browser has the new key.
    studio.end()
    again = start("--port", studio.port, "--project", "hysid-project")
    tab.get_by_text("The studio was restarted").wait_for(timeout=20_000)
    opened = other.new_page()
    opened.goto(again.address)
    opened.get_by_text("a.csv").first.wait_for()
    tab.get_by_text("The studio was restarted").wait_for(state="hidden")
    tab.get_by_text("a.csv").first.wait_for()
    context.close()
    other.close()


def test_no_argument_of_a_browser_opens_the_studio(tmp_path):
    (tmp_path / "programs").mkdir()
    for name in ["xdg-open", "gio", "gnome-open", "kde-open", "wslview"]:
        program = tmp_path / "programs" / name
        program.write_text(f'#!/bin/sh\necho "$@" >> {tmp_path}/arguments\n')
        program.chmod(0o755)
    command = [os.environ["HYSID_PROGRAM"], "studio", "--port", "0"]
    path = {**os.environ, "PATH": f"{tmp_path}/programs{os.pathsep}{os.environ['PATH']}"}
    process = subprocess.Popen(command, cwd=tmp_path, env=path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        token = process.stdout.readline().strip().split("=")[1]
        wait_for(lambda: (tmp_path / "arguments").exists() and (tmp_path / "arguments").read_text())
        arguments = (tmp_path / "arguments").read_text()
        file = tmp_path / "hysid-project" / "studio.html"
        assert str(file) in arguments and token not in arguments and "token" not in arguments
        assert file.stat().st_mode & 0o777 == 0o600 and file.parent.stat().st_mode & 0o777 == 0o700
    finally:
        process.send_signal(signal.SIGINT)
        # As every command that Ctrl-C ends.
        assert process.wait(timeout=60) == 130
        process.stdout.close()
        process.stderr.close()
    assert not file.exists()


def wait_for(is_there):
    end = time.monotonic() + 20
    while not is_there():
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.mark.parametrize("host", ["evil.example:{port}", "127.0.0.1.nip.io:{port}", "127.0.0.1", "localhost:{port}", "[::1]:{port}", ""])
def test_a_name_that_is_not_the_studios_gets_nothing(shared, host):
    host = host.format(port=shared.port)
    origin = f"http://{host}"
    refused(shared, "GET", "/api/project", Host=host, Origin=None)
    refused(shared, "POST", "/api/reading", {}, Host=host, Origin=origin)
    refused(shared, "GET", f"/?token={shared.token}", Host=host, Origin=None)


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:{port}", "http://127.0.0.1:1", None])
def test_no_other_page_changes_anything(shared, origin):
    origin = origin and origin.format(port=shared.port)
    for method, path, body in [
        ("POST", "/api/reading", {"delimiter": "tab"}),
        ("POST", "/api/columns", None),
        ("POST", "/api/files?name=x.csv", TABLE.encode()),
        ("POST", "/api/specimens", {"name": "ferromagnet"}),
        ("POST", "/api/fit", {"options": {"model": "pnn"}}),
        ("DELETE", "/api/files/1", None),
        ("DELETE", "/api/models/1", None),
        ("POST", "/api/removed/1", {}),
        ("POST", "/api/models/1/name", {"name": "x"}),
        ("POST", "/api/plan", {"kind": "magnet", "low": 0, "high": 1}),
    ]:
        refused(shared, method, path, body, Origin=origin)
    if origin:
        refused(shared, "GET", "/api/project", Origin=origin)


def test_a_browser_that_says_it_comes_from_elsewhere_gets_nothing(shared):
    for site in ["cross-site", "same-site"]:
        refused(shared, "GET", "/api/project", Origin=None, Sec_Fetch_Site=site)


def test_every_answer_forbids_what_the_page_does_not_need(shared):
    for path in [*READING[:2], *READING[3:], "/nothing"]:
        _, headers, _ = shared.request("GET", path)
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy and "script-src 'self'" in policy and "unsafe" not in policy
        assert "frame-ancestors 'none'" in policy and "form-action 'none'" in policy
        assert headers["x-content-type-options"] == "nosniff" and headers["cache-control"] == "no-store"
        assert headers["referrer-policy"] == "no-referrer"


def test_it_listens_on_this_machine_alone(shared):
    probe = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        # No packet is sent: the system only chooses the address that it would use.
        probe.connect(("192.0.2.1", 9))
        own = probe.getsockname()[0]
    except OSError:
        pytest.skip("this machine has no other address")
    finally:
        probe.close()
    if own.startswith("127."):
        pytest.skip("this machine has no other address")
    with pytest.raises(OSError):
        socket.create_connection((own, int(shared.port)), timeout=5).close()


@pytest.mark.parametrize(
    "name",
    ["../../outside.csv", "..%2F..%2Foutside.csv", "/etc/outside.csv", "C:%5Coutside.csv", "..", "%00.csv", "con.csv", ".hidden"],
)
def test_no_file_leaves_the_folder_of_data(shared, name):
    before = {path for path in shared.folder.rglob("*") if path.parent != shared.project / "data"}
    number = shared.add(name, TABLE)
    file = next(file for file in shared.state()["files"] if file["id"] == number)
    assert (shared.project / "data" / file["name"]).read_text() == TABLE
    assert "/" not in file["name"] and "\\" not in file["name"] and not file["name"].startswith(".")
    after = {path for path in shared.folder.rglob("*") if path.parent != shared.project / "data"}
    assert after - before <= {shared.project / "project.json"}


@pytest.mark.parametrize(
    "path",
    ["/../project.json", "/..%2fproject.json", "/%2e%2e/project.json", "/api/models/../../project.json", "/api/files/1/../../../etc/passwd", "//etc/passwd"],
)
def test_no_address_reads_other_files(shared, path):
    status, _, content = shared.request("GET", path)
    assert status in (400, 404) and b"hysid-project" not in content and b"root:" not in content


def test_large_bodies_are_refused_before_they_are_sent(shared):
    headers = shared.headers() | {"Content-Length": str(2 << 30), "Content-Type": "application/octet-stream"}
    status, _, content = shared.request("POST", "/api/files?name=huge.csv", b"", headers)
    assert status == 413 and "larger than 1 GB" in json.loads(content)["error"]
    status, _, content = shared.request("POST", "/api/reading", b" " * (9 << 20))
    assert status == 413 and "error" in json.loads(content)
    assert not list((shared.project / "data").glob(".upload-*"))


@pytest.mark.parametrize(
    ("method", "path", "body"),
    [
        ("POST", "/api/reading", b"{"),
        ("POST", "/api/reading", b'{"delimiter": 7}'),
        ("POST", "/api/reading", b'{"unknown": "x"}'),
        ("POST", "/api/columns", b'{"output": "y"}'),
        ("POST", "/api/fit", b"7"),
        ("POST", "/api/fit", b'{"options": {"model": "nothing"}}'),
        ("POST", "/api/fit", b'{"options": {"stops": -1}}'),
        ("POST", "/api/fit", b'{"time_limit": 0}'),
        ("POST", "/api/specimens", b'{"name": "nothing"}'),
        ("POST", "/api/files/99/use", b'{"use": "unseen"}'),
        ("POST", "/api/files/x/use", b'{"use": "unseen"}'),
        ("POST", "/api/models/99/run?rows=2", b""),
        ("POST", "/api/models/99/name", b'{"name": "x"}'),
        ("POST", "/api/models/99/inverse", b'{"file": 1}'),
        ("POST", "/api/files/99/columns", b"{}"),
        ("POST", "/api/removed/99", b"{}"),
        ("POST", "/api/plan", b'{"length": -1}'),
        ("POST", "/api/plan", b'{"kind": "magnet", "low": 2, "high": 1}'),
        ("POST", "/api/restoring-force", b'{"file": 99, "mass": "2 kg"}'),
        ("DELETE", "/api/files/99", None),
        ("GET", "/api/models/99/file", None),
        ("GET", "/api/models/99/export/c", None),
        ("GET", "/api/files/99/columns", None),
        ("GET", "/api/nothing", None),
    ],
)
def test_what_is_wrong_is_refused_in_words(shared, method, path, body):
    status, _, content = shared.request(method, path, body)
    assert 400 <= status < 500, (status, content)
    # A text, or texts and the controls that help.
    error = json.loads(content)["error"]
    assert len("".join(part if isinstance(part, str) else part["words"] for part in ([error] if isinstance(error, str) else error))) > 5
    assert shared.process.poll() is None


COLUMN = "\"><img src=x onerror=\"document.title='taken'\">_N"


def test_one_fit_at_a_time(start):
    studio = start()
    studio.specimen("terfenol-rod")
    studio.begin(model="auto")
    status, _, content = studio.request("POST", "/api/fit", {"options": {"model": "pnn"}})
    assert status == 409 and "a fit is running" in json.loads(content)["error"]
    studio.ask("/api/fit/stop", {})
    studio.ended()
    studio.begin(model="prandtl-ishlinskii")
    assert studio.ended()["problem"] is None


def test_names_are_text_and_never_html(browser, start):
    studio = start()
    rows = "".join(f"<b>r</b>,{k},{k % 7},{k % 7 + 0.1 * (k % 3)}\n" for k in range(60))
    header = 'record,t,<script>alert(1)</script>,"' + COLUMN.replace('"', '""') + '"\n'
    studio.add("%3Cscript%3Edocument.title%3D'taken'%3C%2Fscript%3E.csv", header + rows)
    columns = {"record": "record", "time": "t", "inputs": ["<script>alert(1)</script>"], "rate": None, "output": COLUMN}
    studio.ask("/api/columns", columns)
    studio.begin(model="prandtl-ishlinskii", operators=3)
    assert studio.ended()["problem"] is None
    context = browser.new_context()
    page = context.new_page()
    wrong = []
    page.on("dialog", lambda dialog: (wrong.append(dialog.message), dialog.dismiss()))
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("request", lambda request: wrong.append(request.url) if not request.url.startswith((studio.origin, "data:", "blob:")) else None)
    page.goto(studio.address)
    page.get_by_text(COLUMN).first.wait_for()
    steps = {"diagnose": ".card", "figures": "svg.plot", "identify": ".main", "judge": "td", "compare": "td", "take-away": "pre", "try": "canvas"}
    for step, part in steps.items():
        page.evaluate("step => { location.hash = step; }", step)
        page.locator(f"#{step} {part}").first.wait_for()
        assert page.locator("main img, main script, main b, main iframe").count() == 0
    report = context.new_page()
    report.on("dialog", lambda dialog: (wrong.append(dialog.message), dialog.dismiss()))
    report.goto(f"{studio.origin}/report#{studio.state()['models'][0]['id']}")
    report.frame_locator("#report").locator("h1").wait_for()
    assert report.frame_locator("#report").locator("main img, main b").count() == 0
    assert "taken" not in page.title() + report.title() and wrong == []
    context.close()


HOSTILE = """<!DOCTYPE html><title>waiting</title><img src="{origin}/api/project"><iframe src="{address}"></iframe>
<form id="f" method="post" enctype="text/plain" target="t" action="{origin}/api/reading"><input name='{{"delimiter":"tab","x":"' value='"}}'></form>
<iframe name="t"></iframe><script>
const tries = [
  fetch("{origin}/api/project", {{credentials: "include"}}).then((answer) => answer.text()),
  fetch("{origin}/api/reading", {{method: "POST", body: '{{"delimiter":"tab"}}', credentials: "include", mode: "no-cors"}}).then((answer) => answer.text()),
  fetch("{origin}/api/reading", {{method: "POST", body: '{{}}', headers: {{"content-type": "application/json"}}, credentials: "include"}}).then((answer) => answer.text()),
  new Promise((done, failed) => {{ const events = new EventSource("{origin}/api/events", {{withCredentials: true}}); events.onopen = done; events.onerror = () => failed(events.close()); }}),
];
document.getElementById("f").submit();
Promise.allSettled(tries).then((all) => {{ document.title = "read: " + all.filter((one) => one.status === "fulfilled" && one.value).length; }});
</script>"""


def test_a_page_on_another_port_of_this_machine_reaches_nothing(browser, start):
    studio = start()
    studio.add("a.csv", TABLE)
    before = (studio.project / "project.json").read_bytes()

    class Page(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(HOSTILE.format(origin=studio.origin, address=studio.address).encode())

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Page)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        context = browser.new_context()
        own = context.new_page()
        own.goto(studio.address)
        own.get_by_text("a.csv").first.wait_for()
        # The same browser, which has the key of the studio.
        hostile = context.new_page()
        hostile.goto(f"http://127.0.0.1:{server.server_port}/")
        hostile.wait_for_function("document.title.startsWith('read')")
        assert hostile.title() == "read: 0"
        for frame in hostile.frames[1:]:
            assert "a.csv" not in frame.content()
        context.close()
    finally:
        server.shutdown()
    assert (studio.project / "project.json").read_bytes() == before
    assert studio.state()["reading"] == {}


def test_two_studios_side_by_side(browser, start, tmp_path):
    first, second = start(), start()
    assert second.ask("/api/project")["name"] == "hysid-project-2"
    context = browser.new_context()
    pages = []
    for studio in (first, second):
        pages.append(context.new_page())
        pages[-1].goto(studio.address)
        pages[-1].get_by_text("Drop a file").wait_for()
    # Each has its own key.
    for studio, page in zip((first, second), pages):
        page.reload()
        page.get_by_text(studio.state()["name"], exact=True).wait_for()
    context.close()


def refused_start(folder, *arguments):
    command = [os.environ["HYSID_PROGRAM"], "studio", "--no-open", *arguments]
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)
    assert len(ran.stderr.splitlines()) == 1, ran.stderr
    return ran.returncode, ran.stderr


def test_a_port_that_is_taken_and_folders_that_are_none(start, tmp_path):
    studio = start()
    status, words = refused_start(tmp_path, "--port", studio.port)
    assert status == 2 and f"port {studio.port} is in use" in words and "--port" in words
    status, words = refused_start(tmp_path, "--project", "hysid-project")
    assert status == 2 and "another studio has this project open" in words
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "thesis.txt").write_text("x")
    status, words = refused_start(tmp_path, "--project", "mine")
    assert status == 2 and "is not a Hysid project" in words and [path.name for path in mine.iterdir()] == ["thesis.txt"]
    status, words = refused_start(tmp_path, "nothing.csv", "--project", "new")
    assert status == 1 and words.startswith("error: nothing.csv: ")
