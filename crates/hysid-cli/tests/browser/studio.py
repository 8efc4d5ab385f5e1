"""A studio that runs, asked as a page asks it."""

import http.client
import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path


class Studio:
    """A running `hysid studio`, started in a folder."""

    #: Until it is known.
    key = ""

    def __init__(self, folder: Path, *arguments: str):
        self.folder = folder
        command = [os.environ["HYSID_PROGRAM"], "studio", "--no-open", *arguments]
        if "--port" not in arguments:
            command += ["--port", "0"]
        self.said = (folder / "stderr.txt").open("w+")
        self.process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=self.said, text=True)
        printed = self.process.stdout.readline().strip()
        assert printed, (folder / "stderr.txt").read_text()
        self.port, self.token = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?token=(\w+)", printed).groups()
        self.origin = f"http://127.0.0.1:{self.port}"
        end = time.monotonic() + 20
        while not (said := re.search(r"project (\S+)\n", (folder / "stderr.txt").read_text())):
            assert time.monotonic() < end
            time.sleep(0.01)
        self.project = folder / said.group(1)
        # As the page: the token gives a ticket, and the ticket the key.
        _, headers, _ = self.request("GET", f"/?token={self.token}", None, self.headers(Origin=None, X_Hysid_Key=None))
        self.ticket = headers["set-cookie"].split(";")[0]
        _, _, content = self.request("POST", "/api/session", b"", self.headers(X_Hysid_Key=None, Cookie=self.ticket))
        self.key = json.loads(content)["key"]

    @property
    def address(self) -> str:
        """An address that opens one browser: that of the file in the project."""
        return re.search(r"http://[^\"]+", (self.project / "studio.html").read_text()).group(0)

    def headers(self, **changed: str | None) -> dict[str, str]:
        """Those that its own page sends, with some changed or left out."""
        own = {"Host": f"127.0.0.1:{self.port}", "Origin": self.origin, "X-Hysid-Key": self.key}
        named = {name.replace("_", "-"): value for name, value in changed.items()}
        return {name: value for name, value in (own | named).items() if value is not None}

    def request(self, method: str, path: str, body=None, headers=None) -> tuple[int, http.client.HTTPMessage, bytes]:
        """Status, headers and content of an answer."""
        connection = http.client.HTTPConnection("127.0.0.1", int(self.port), timeout=60)
        try:
            connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
            headers = self.headers() if headers is None else headers
            content = body if isinstance(body, bytes) or body is None else json.dumps(body).encode()
            if content is not None and "Content-Length" not in headers:
                headers = {"Content-Type": "application/json", **headers, "Content-Length": str(len(content))}
            for name, value in headers.items():
                connection.putheader(name, value)
            connection.endheaders(content)
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read()
        finally:
            connection.close()

    def ask(self, path: str, body=None):
        """Response to its own page; sends `body`."""
        status, _, content = self.request("GET" if body is None else "POST", path, body)
        assert status == 200, (path, status, content)
        return json.loads(content)

    def state(self) -> dict:
        """The state of the project, once its files are read."""
        while (state := self.ask("/api/project"))["is_reading"]:
            time.sleep(0.01)
        return state

    def add(self, name: str, content: str | bytes) -> int:
        """Adds a file."""
        content = content.encode() if isinstance(content, str) else content
        status, _, answer = self.request("POST", f"/api/files?name={name}", content)
        assert status == 200, answer
        return json.loads(answer)["id"]

    def specimen(self, name: str) -> list[int]:
        return self.ask("/api/specimens", {"name": name, "seed": 1, "noise_percent": 1})["ids"]

    def begin(self, **options) -> int:
        """Begins a fit."""
        return self.ask("/api/fit", {"options": options})["id"]

    def ended(self) -> dict:
        """The fit, once it has ended."""
        return self.wait(lambda state: state["fit"] and not state["fit"]["is_running"])["fit"]

    def wait(self, is_there, most: float = 120) -> dict:
        """The state of the project, once something is there."""
        end = time.monotonic() + most
        while not is_there(state := self.state()):
            assert time.monotonic() < end, state
            time.sleep(0.05)
        return state

    def end(self, how=signal.SIGINT) -> int:
        """Ends it; the exit status."""
        if self.process.poll() is None:
            self.process.send_signal(how)
        status = self.process.wait(timeout=60)
        self.process.stdout.close()
        self.said.close()
        return status
