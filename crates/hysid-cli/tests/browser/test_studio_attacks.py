"""What nobody but the page of a studio may do, and what the page itself may not."""

import http.server
import json
import os
import socket
import subprocess
import threading

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


@pytest.mark.parametrize("path", READING)
def test_nothing_is_read_without_the_token(shared, path):
    assert "hysid studio" in refused(shared, "GET", path, Cookie=None)
    wrong = f"hysid-studio-{shared.port}={'0' * len(shared.token)}"
    refused(shared, "GET", path, Cookie=wrong)
    # The cookie of a studio on another port.
    refused(shared, "GET", path, Cookie=f"hysid-studio-1={shared.token}")


def test_the_token_opens_the_page_alone_and_becomes_a_cookie(shared):
    status, headers, content = shared.request("GET", f"/?token={shared.token}", None, shared.headers(Cookie=None, Origin=None))
    assert status == 200 and b"Hysid studio" in content
    cookie = headers["set-cookie"]
    assert cookie.startswith(f"hysid-studio-{shared.port}={shared.token};")
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie
    refused(shared, "GET", f"/api/project?token={shared.token}", Cookie=None)
    status, headers, _ = shared.request("GET", "/?token=wrong", None, shared.headers(Cookie=None, Origin=None))
    assert status == 403 and headers["set-cookie"] is None


@pytest.mark.parametrize("host", ["evil.example:{port}", "127.0.0.1.nip.io:{port}", "127.0.0.1", "[::1]:{port}", ""])
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
    assert len(json.loads(content)["error"]) > 5
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
    steps = {"diagnose": ".card", "identify": ".main", "judge": "td", "compare": "td", "take-away": "pre", "try": "canvas"}
    for step, part in steps.items():
        page.evaluate("step => { location.hash = step; }", step)
        page.locator(f"#{step} {part}").first.wait_for()
        assert page.locator("main img, main script, main b, main iframe").count() == 0
    report = context.new_page()
    report.on("dialog", lambda dialog: (wrong.append(dialog.message), dialog.dismiss()))
    report.goto(f"{studio.origin}/api/models/{studio.state()['models'][0]['id']}/report")
    report.locator("h1").wait_for()
    assert report.locator("main img, main b").count() == 0
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
        # The same browser, which has the cookie of the studio.
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
        pages[-1].get_by_text("Drop CSV").wait_for()
    # Each has its own cookie.
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
