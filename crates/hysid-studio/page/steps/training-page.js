// Steps that show a page of the server on the training data: the diagnosis and the cycles.

import { documentOf, element, emptyState, Region } from "../elements.js";
import { failure, problem } from "../notices.js";
import { project } from "../project.js";
import { getJson } from "../server.js";

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
    const key = project.usable("training").map((file) => project.dataKey(file)).join();
    if (this.region.key === JSON.stringify(key)) return undefined;
    this.region.update("wait", () => [element("p", { role: "status", text: `${this.doing} \u2026` })]);
    try {
      const { html } = await project.once(`${this.address} ${key}`, () => getJson(this.address));
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

export class CyclesStep extends TrainingPage {
  constructor(body) {
    super(body, "/api/cycles", "with cycles", "Reading the cycles");
  }
}
