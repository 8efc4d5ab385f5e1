"""The first page, a fit as it is watched, and what can be done with models: names, uses, removal."""

import re

from test_studio import begin_auto, drop, is_drawn, visit  # noqa: F401 (a fixture)


def test_the_example_is_shown_at_once_and_opened_in_all_steps(start, visit):  # noqa: F811
    studio = start()
    opened = visit(studio)
    page = opened.page
    verdict = page.locator("#data .verdict", has_text="soft magnet")
    verdict.wait_for()
    assert studio.state()["files"] == [] and is_drawn(page.locator("#data canvas").first)
    told = re.search(r"error of ([\d.]+)\s%.*estimated ([\d.]+)\s%", verdict.inner_text()).groups()
    page.get_by_role("button", name="Explore this example").click()
    page.wait_for_url("**#judge/*")
    # The numbers of the first page are those of the model that is judged.
    rows = page.locator("#judge tbody tr")
    rows.filter(has_text="not used in training").wait_for()
    shown = [rows.filter(has_text=name).locator("td").nth(3).inner_text() for name in ("not used in training", "cross-validation")]
    assert tuple(text.split()[0] for text in shown) == told
    assert page.locator("#judge .use li").count() == 3
    assert page.locator("#judge .use").inner_text().count("H from −400 to 400 A/m") == 1
    # With files there is no example, and one button begins a fit.
    opened.go("data")
    assert not page.get_by_role("button", name="Explore").is_visible()
    identify = opened.go("identify")
    assert identify.get_by_role("button").all_inner_texts()[0] == "Start" and not identify.get_by_label("Model", exact=True).is_visible()
    # The first file of the user replaces the example and its model.
    drop(page, "own.csv", "t_s,x_mm,y_N\n" + "".join(f"{k},{k % 7},{k % 7 + 0.1 * (k % 3)}\n" for k in range(60)))
    state = studio.wait(lambda state: [file["name"] for file in state["files"]] == ["own.csv"])
    assert state["files"][0]["use"] == "training" and state["models"] == [] and state["columns"]["inputs"] == ["x_mm"]
    opened.check()


def test_a_fit_is_drawn_over_the_data_from_its_beginning_and_stays(start, visit):  # noqa: F811
    studio, opened, identify = begin_auto(start, visit)
    # The measured loop is there before any model; progress and convergence are beside it.
    identify.locator("canvas").first.wait_for(timeout=5_000)
    identify.locator(".remaining", has_text=re.compile(r"\d\s%, .* elapsed")).wait_for()
    studio.wait(lambda state: state["fit"]["running"] or state["fit"]["tried"], most=20)
    convergence = opened.figure("identify", "Convergence")
    convergence.locator("canvas").wait_for()
    loop = opened.figure("identify", "Loop")
    left = loop.bounding_box()
    beside = convergence.bounding_box()
    assert left["x"] + left["width"] <= beside["x"] and beside["y"] < left["y"] + left["height"]
    loop.get_by_text("measured").wait_for(timeout=60_000)
    assert identify.locator("details[open] table").is_visible()
    identify.get_by_role("button", name="Stop and keep the best model").click()
    opened.page.get_by_role("link", name="Judge this model").wait_for(timeout=60_000)
    # Loop and verdict stay, over the data; the candidates are folded.
    title = studio.state()["models"][0]["title"]
    assert title.startswith("auto, ") and title.endswith(", terfenol-rod-train")
    loop.get_by_text(title).wait_for()
    assert is_drawn(loop.locator("canvas")) and title in identify.locator(".verdict").inner_text()
    assert not identify.locator("table").is_visible() and identify.get_by_text("Candidates (").is_visible()
    opened.check()


def test_models_have_names_and_removals_are_undone(start, visit):  # noqa: F811
    studio = start()
    studio.specimen("ferromagnet")
    for operators in (4, 5):
        studio.begin(model="prandtl-ishlinskii", operators=operators)
        studio.ended()
    before = studio.state()
    titles = [model["title"] for model in before["models"]]
    assert titles == [f"prandtl-ishlinskii, operators {number}, ferromagnet-train" for number in (4, 5)]
    opened = visit(studio)
    page = opened.page
    opened.go("judge").get_by_role("button", name="Rename").click()
    page.get_by_label("Name of the model").fill("Sheet, five plays")
    page.get_by_role("button", name="Save", exact=True).click()
    studio.wait(lambda state: state["models"][1]["title"] == "Sheet, five plays")
    # A model and a file are removed and come back, with the same numbers in the same places.
    opened.go("compare")
    page.get_by_role("button", name="Remove Sheet, five plays").click()
    studio.wait(lambda state: len(state["models"]) == 1)
    page.get_by_role("button", name="Undo").click()
    studio.wait(lambda state: [model["id"] for model in state["models"]] == [model["id"] for model in before["models"]])
    opened.go("data")
    page.get_by_role("button", name="Remove ferromagnet-train.csv").click()
    studio.wait(lambda state: len(state["files"]) == 1)
    assert not (studio.project / "data" / "ferromagnet-train.csv").exists()
    page.get_by_role("button", name="Undo").click()
    after = studio.wait(lambda state: len(state["files"]) == 2)
    assert [file["name"] for file in after["files"]] == [file["name"] for file in before["files"]]
    assert after["models"][1]["title"] == "Sheet, five plays" and not after["models"][1]["is_stale"]
    assert (studio.project / "models" / after["models"][1]["file"]).exists()
    # What was removed for good is gone when the studio has ended.
    page.get_by_role("button", name="Remove ferromagnet-test.csv").click()
    studio.wait(lambda state: len(state["files"]) == 1)
    # Findings are refused as long as there are no training data.
    assert [error for error in opened.errors if "400" not in error] == []
    studio.end()
    assert [path.name for path in (studio.project / "data").iterdir()] == ["ferromagnet-train.csv"]


def test_a_table_on_a_telephone_names_each_number(start, visit):  # noqa: F811
    studio = start()
    studio.specimen("ferromagnet")
    studio.begin(model="prandtl-ishlinskii")
    studio.ended()
    opened = visit(studio, width=400)
    cell = opened.go("judge").locator("tr", has_text="not used in training").locator("td").nth(1)
    assert cell.evaluate("cell => getComputedStyle(cell, '::before').content") == '"RMSE (T)"'
    box = cell.bounding_box()
    assert box["x"] >= 0 and box["x"] + box["width"] <= 400
    opened.check()


def test_the_fields_show_the_defaults_of_their_model_in_full(start, visit):  # noqa: F811
    studio = start()
    studio.specimen("terfenol-rod")
    page = visit(studio)
    widths = """fields => fields.filter((field) => {
        const pen = document.createElement("canvas").getContext("2d");
        const { fontSize, fontFamily } = getComputedStyle(field, "::placeholder");
        const { paddingLeft, paddingRight } = getComputedStyle(field);
        pen.font = `${fontSize} ${fontFamily}`;
        // The arrows of a number take the room of two letters.
        return pen.measureText(field.placeholder).width > field.clientWidth - parseFloat(paddingLeft) - parseFloat(paddingRight) - 16;
    }).map((field) => field.id + ": " + field.placeholder)"""
    for model in studio.ask("/api/choices")["models"]:
        identify = page.choose(model["name"])
        identify.locator("details").evaluate_all("all => all.forEach((one) => { one.open = true; })")
        assert identify.locator(".control > [placeholder]").evaluate_all(widths) == []

    def default(model: str, flag: str) -> str:
        return page.choose(model).locator(f"[data-flag='--{flag}']").get_attribute("placeholder")

    assert default("auto", "operators") == "set by each candidate"
    assert (default("preisach", "operators"), default("duhem-nn", "hidden"), default("hysteretic-oscillator", "hidden")) == ("30", "8", "8 (4 with degradation)")
    # Too long for a field, and different by trainer.
    assert "Default: 400 for subgradient, 40 for levenberg-marquardt, 2000 for hybrid, 2000 for genetic." in page.choose("pnn").locator("[id='fit--epochs-help']").text_content()
    page.check()
