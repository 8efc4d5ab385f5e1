// Steps that show a page of the server on the training data: the diagnosis and the cycles.

import { choice } from "../controls.js";
import { button, documentOf, element, emptyState, Region } from "../elements.js";
import { failure, problem } from "../notices.js";
import { project } from "../project.js";
import { getJson } from "../server.js";
import { field } from "./use-case.js";

class TrainingPage {
  /** `what` is wanted of the data, `doing` is in work. */
  constructor(body, address, what, doing) {
    this.region = new Region(body);
    Object.assign(this, { address, what, doing });
  }

  async update() {
    if (!project.labels) {
      return this.region.update(["empty", project.state.problem], () => [emptyState(`There are no training data ${this.what}. `, element("a", { class: "button", href: "#data", text: "Go to the data" })), project.state.problem ? problem(project.state.problem) : null]);
    }
    const key = `${this.address} ${project.usable("training").map((file) => project.dataKey(file)).join()}`;
    if (this.region.key === JSON.stringify(key)) return undefined;
    this.region.update("wait", () => [element("p", { role: "status", text: `${this.doing} \u2026` })]);
    try {
      const { html } = await project.once(key, () => getJson(this.address));
      this.region.update(key, () => [this.cards(html)]);
    } catch (error) {
      this.region.update(`failed ${error.message}`, () => [failure(error)]);
    }
    return undefined;
  }

  /** Links within the document would change the step: they scroll instead. */
  cards(html) {
    const cards = documentOf(html);
    cards.addEventListener("click", (event) => {
      const link = event.target.closest("a[href^='#']");
      if (!link) return;
      event.preventDefault();
      cards.querySelector(`[id="${CSS.escape(link.hash.slice(1))}"]`)?.scrollIntoView({ block: "start" });
    });
    return cards;
  }
}

export class DiagnoseStep extends TrainingPage {
  constructor(body) {
    super(body, "/api/diagnosis", "to diagnose", "Diagnosing the data");
  }
}

/** The cycles, with what the columns do not tell of them. */
export class CyclesStep extends TrainingPage {
  constructor(body) {
    const page = element("div");
    super(page, "/api/cycles", "with cycles", "Reading the cycles");
    this.form = new Region();
    body.replaceChildren(this.form.node, page);
  }

  async update() {
    this.form.update(Boolean(project.labels), () => (project.labels ? [this.row()] : []));
    return super.update();
  }

  row() {
    let named = "";
    const fields = project.choices.fields.map((name) => ({ value: name, text: name }));
    const chosen = choice("Field", [{ value: "", text: "by the names and units of the columns" }, ...fields], named, (value) => { named = value; }, { "data-flag": "--field" });
    const density = field("Mass density of a magnet, kg/m\u00b3", "none", { flag: "--density" });
    const height = field("Height of a structure, in the unit of the input", "none", { flag: "--height" });
    const ask = () => {
      const asked = Object.entries({ field: named || null, density: density.read(), height: height.read() }).filter(([, value]) => value !== null);
      this.address = `/api/cycles${asked.length > 0 ? "?" : ""}${new URLSearchParams(asked)}`;
      return this.update();
    };
    return element("div", { class: "row" }, chosen, density.node, height.node, button("Read the cycles", ask));
  }
}
