"""The pictures of docs/tour.md: a whole session with the data of a tutorial. HYSID_WRITE=1 writes them."""

import io
import os
import re
from pathlib import Path

from PIL import Image
from test_studio import drop, visit  # noqa: F401 (a fixture)

DOCS = Path(__file__).parents[4] / "docs"
PICTURES = DOCS / "images" / "studio"

#: All pictures together, in bytes.
MOST_BYTES = 400_000

#: True if the pictures are written.
WRITES = bool(os.environ.get("HYSID_WRITE"))

#: Colours of a picture: figures and text of the page have few.
COLOURS = 20


class Tour:
    """Takes pictures of the page."""

    def __init__(self, page):
        self.page = page
        self.taken: list[str] = []

    def take(self, name: str):
        self.page.wait_for_timeout(400)
        whole = Image.open(io.BytesIO(self.page.screenshot())).convert("RGB")
        assert len(whole.getcolors(whole.width * whole.height)) > 20, name
        self.taken.append(f"images/studio/{name}.png")
        if WRITES:
            small = whole.quantize(COLOURS, dither=Image.Dither.NONE)
            small.save(PICTURES / f"{name}.png", optimize=True)


def test_the_tour(start, visit, tmp_path):  # noqa: F811
    data = DOCS / "tutorials" / "data"
    studio = start("--project", "column")
    opened = visit(studio, width=1040, height=760)
    page = opened.page
    tour = Tour(page)
    page.locator("#explore").wait_for()
    tour.take("first")
    drop(page, "column-test.txt", (data / "column-test.txt").read_text())
    page.locator("#data canvas").nth(2).wait_for()
    page.evaluate("scrollTo(0, 190)")
    tour.take("data")
    opened.go("diagnose")
    tour.take("diagnose")
    identify = opened.go("identify")
    identify.get_by_role("button", name="Start").click()
    identify.locator(".legend", has_text=re.compile("measured")).first.wait_for(timeout=60_000)
    identify.locator(".figure", has_text="Convergence").locator("canvas").wait_for(timeout=60_000)
    if WRITES:
        identify.locator(".remaining", has_text="left").wait_for(timeout=20_000)
    tour.take("identify")
    page.get_by_role("link", name="Judge this model").wait_for(timeout=120_000)
    tour.take("result")
    opened.go("judge")
    drop(page, "earthquake-60.csv", (data / "earthquake-60.csv").read_text())
    page.locator("#judge tr", has_text="earthquake-60.csv").wait_for()
    tour.take("judge")
    # A second model to compare with.
    studio.begin(model="preisach")
    studio.ended()
    opened.go("compare").locator("tbody tr").nth(1).wait_for()
    page.locator("#compare canvas").first.wait_for()
    tour.take("compare")
    opened.go("try")
    tour.take("try")
    plan = opened.go("plan")
    plan.get_by_role("button", name="Plan").click()
    plan.locator("svg.plot").first.wait_for()
    tour.take("plan")
    opened.go("take-away")
    tour.take("take-away")
    opened.check()
    # The page has these pictures, in this order, each with its text.
    shown = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", (DOCS / "tour.md").read_text())
    assert shown == tour.taken
    sizes = [(DOCS / picture).stat().st_size for picture in shown]
    assert sum(sizes) < MOST_BYTES and len(list(PICTURES.iterdir())) == len(shown), sizes
