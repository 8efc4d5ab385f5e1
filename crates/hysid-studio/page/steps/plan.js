// The next measurement: a drive for what the training data do not tell, or a first test of a kind of specimen.

import { choice } from "../controls.js";
import { element } from "../elements.js";
import { project } from "../project.js";
import { field, UseCase } from "./use-case.js";

export class PlanStep extends UseCase {
  update() {
    const hasData = Boolean(project.labels) && project.usable("training").length > 0;
    const kinds = project.choices.kinds;
    const kind = this.kind ?? (hasData ? "" : kinds[0]);
    this.form.update([hasData, kind, project.usable("training").map((file) => project.dataKey(file))], () => {
      const ofData = kind === "" ? "of the data" : "needed";
      const from = choice("Plan", [...(hasData ? [{ value: "", text: "what the training data do not cover" }] : []), ...kinds.map((name) => ({ value: name, text: `a first test: ${name}` }))], kind, (value) => { this.kind = value; this.update(); }, { id: "plan-kind" });
      const fields = {
        low: field("Lowest input", ofData), high: field("Highest input", ofData), length: field("Most rows", kind === "" ? "as many as the data" : "2000"),
        step: field("Time between rows", kind === "" ? "of the data" : "none"), max_rate: field("Largest rate", kind === "" ? "of the data" : "by the length"),
      };
      const request = () => ({ kind: kind === "" ? null : kind, ...Object.fromEntries(Object.entries(fields).map(([name, one]) => [name, one.read()])) });
      this.result.replaceChildren();
      return [element("div", { class: "row" }, from, ...Object.values(fields).map(({ node }) => node), this.asking("Plan", () => "/api/plan", request))];
    });
  }
}
