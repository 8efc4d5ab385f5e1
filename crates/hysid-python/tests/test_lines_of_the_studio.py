"""The lines of Python that the studio shows give the very same model, byte for byte."""

import json
import subprocess
import sys
import urllib.request
from contextlib import closing, contextmanager
from http.client import HTTPConnection

import pytest


class Studio:
    """A studio that runs, and its requests."""

    def __init__(self, address: str):
        # As the page: the token gives a ticket, and the ticket the key.
        self.origin, token = address.split("/?token=")
        with closing(HTTPConnection(self.origin.removeprefix("http://"))) as connection:
            connection.request("GET", f"/?token={token}")
            self.headers = {"Cookie": connection.getresponse().headers["set-cookie"].split(";")[0]}
        self.headers = {"X-Hysid-Key": self.ask("/api/session", {})["key"]}

    def ask(self, path: str, body=None):
        data = None if body is None else json.dumps(body).encode()
        headers = {"Origin": self.origin, "Content-Type": "application/json", **self.headers}
        with urllib.request.urlopen(urllib.request.Request(self.origin + path, data, headers)) as answer:
            return json.load(answer)

    def fit(self, options: dict, rate: str) -> int:
        """Fits a model and waits for it."""
        number = self.ask("/api/fit", {"options": options, "rate": rate})["id"]
        while True:
            fit = self.ask("/api/project")["fit"]
            if not fit["is_running"]:
                assert fit["problem"] is None
                return number


@contextmanager
def studio(program, folder):
    command = [program.path, "studio", "--no-open", "--port", "0"]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as running:
        try:
            yield Studio(running.stdout.readline().strip())
        finally:
            running.terminate()


@pytest.mark.parametrize(
    ("specimen", "options", "rate"),
    [
        ("magnetostrictive-actuator", {"model": "xpnn", "stops": 6, "epochs": 20, "no_deterioration": True}, "backward"),
        ("ferromagnet", {"model": "prandtl-ishlinskii", "operators": 7, "seed": 3}, "auto"),
    ],
)
def test_the_lines_give_the_model(program, tmp_path, specimen, options, rate):
    pytest.importorskip("pandas")
    with studio(program, tmp_path) as page:
        page.ask("/api/specimens", {"name": specimen, "seed": 1, "noise_percent": 1})
        number = page.fit(options, rate)
        lines = page.ask(f"/api/models/{number}/commands")["python"]
    project = tmp_path / "hysid-project"
    ran = subprocess.run([sys.executable, "-c", lines], cwd=project, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    name = f"{number}-{options['model']}.json"
    assert (project / name).read_bytes() == (project / "models" / name).read_bytes()
