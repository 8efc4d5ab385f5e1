// Step 2: the server's cards on the properties of the data.

import { documentOf, element, emptyState, Region } from "../elements.js";
import { problem } from "../notices.js";
import { project } from "../project.js";
import { getJson } from "../server.js";

export class DiagnoseStep {
  constructor(body) {
    this.region = new Region(body);
  }

  async update() {
    if (!project.labels) {
      return this.region.update(["empty", project.state.problem], () => [emptyState("There are no training data to diagnose. ", element("a", { class: "button", href: "#data", text: "Go to the data" })), project.state.problem ? problem(project.state.problem) : null]);
    }
    const key = project.usable("training").map((file) => project.dataKey(file)).join();
    if (this.region.key === JSON.stringify(key)) return undefined;
    this.region.update("wait", () => [element("p", { role: "status", text: "Diagnosing the data \u2026" })]);
    try {
      const { html } = await project.once(`diagnosis ${key}`, () => getJson("/api/diagnosis"));
      this.region.update(key, () => [this.cards(html)]);
    } catch (error) {
      this.region.update(`failed ${error.message}`, () => [problem(error.message)]);
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
