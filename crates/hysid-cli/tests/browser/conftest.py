"""A browser, and pages of the program to open in it."""

import os
import re
import subprocess
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright
from studio import Studio

#: Without a network and a graphics card, as a test machine is; root needs no sandbox of Chromium.
ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"]


@pytest.fixture(scope="session")
def browser():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=os.environ["HYSID_BROWSER"], args=ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """A folder with `model.html`, the report of a fit: two records of time, input and output, an ensemble with a band."""
    folder = tmp_path_factory.mktemp("pages")
    run(folder, "generate terfenol-actuator -o rod.csv --test rod-test.csv --noise 1")
    rows = (folder / "rod.csv").read_text().splitlines()
    half = len(rows) // 2
    names = ["record," + rows[0]] + [f"up,{row}" for row in rows[1:half]] + [f"down,{row}" for row in rows[half:]]
    (folder / "two.csv").write_text("\n".join(names) + "\n")
    run(folder, "fit two.csv -o model.json --model xpnn+ --members 2 --epochs 5")
    run(folder, "cycles two.csv -o cycles.csv")
    return folder


def run(folder: Path, arguments: str) -> None:
    """Runs the program in the folder."""
    command = [os.environ["HYSID_PROGRAM"], *arguments.split()]
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr


class Opened:
    """A page, and what went wrong in it."""

    def __init__(self, page, path: Path):
        self.page = page
        self.errors: list[str] = []
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("console", lambda line: self.errors.append(line.text) if line.type == "error" else None)
        #: Addresses other than the page itself.
        self.requests: list[str] = []
        page.on("request", lambda request: self.requests.append(request.url))
        page.goto(path.as_uri())
        self.requests.remove(path.as_uri())

    def figure(self, label: str):
        """The first figure whose description contains a text."""
        return self.page.locator("figure", has=self.page.locator(f'svg.plot[aria-label*="{label}"]')).first

    def axis(self, figure) -> list[float]:
        """The numbers at the horizontal axis of a figure, as they are drawn now."""
        texts = figure.locator("svg.plot[role=img]").evaluate(
            """svg => [...svg.querySelectorAll("text")]
                .filter((text) => text.getClientRects().length > 0 && text.getAttribute("text-anchor") === "middle")
                .map((text) => text.textContent.trim())"""
        )
        number = re.compile(r"^[−-]?\d+(\.\d+)?(e[−-]?\d+)?$")
        return [float(text.replace("−", "-")) for text in texts if number.match(text)]

    def check(self) -> None:
        """Nothing went wrong, and nothing outside was asked for."""
        assert self.errors == []
        outside = [url for url in self.requests if not url.startswith(("data:", "blob:"))]
        assert outside == []


@pytest.fixture
def opened(browser, folder):
    """Opens a page of the folder in a window of a size, with a colour scheme."""
    contexts = []

    def open_page(name="model.html", width=1400, height=900, **options) -> Opened:
        context = browser.new_context(viewport={"width": width, "height": height}, accept_downloads=True, **options)
        contexts.append(context)
        return Opened(context.new_page(), folder / name)

    yield open_page
    for context in contexts:
        context.close()


@pytest.fixture
def start(tmp_path):
    """Starts studios, which end with the test."""
    started = []

    def start_studio(*arguments: str, folder: Path = tmp_path) -> Studio:
        started.append(Studio(folder, *arguments))
        return started[-1]

    yield start_studio
    for studio in started:
        studio.end()


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    """A studio for all tests of a file."""
    studio = Studio(tmp_path_factory.mktemp("studio"))
    yield studio
    studio.end()
