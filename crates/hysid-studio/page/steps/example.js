// The first page: a finished example, which can be explored before there are any files.

import { button, element } from "../elements.js";
import { counted, percent } from "../numbers.js";
import { RecordFigures } from "../plots/record-figures.js";
import { project } from "../project.js";
import { getBinary, post } from "../server.js";

export class Example {
  /** @param {import("../notices.js").Notice} notice */
  constructor(notice) {
    this.notice = notice;
    this.node = element("div");
    this.isShown = false;
  }

  async update(isShown) {
    if (isShown === this.isShown) return;
    this.isShown = isShown;
    if (!isShown) {
      this.figures?.destroy();
      this.figures = null;
      this.node.replaceChildren();
      return;
    }
    this.node.replaceChildren(element("p", { class: "note", role: "status", text: "The example is being computed \u2026" }));
    try {
      const { cut, headers } = await getBinary("/api/example");
      const names = headers.get("x-columns").split(",");
      const arrays = cut(names.length);
      const of = (name) => arrays[names.indexOf(name)] ?? null;
      if (this.isShown) this.build(of, JSON.parse(decodeURIComponent(headers.get("x-facts"))));
    } catch {
      // Without an example the page is as good.
      this.node.replaceChildren();
    }
  }

  build(of, facts) {
    const columns = { time: of("row"), inputs: [of("input")], rate: null, output: of("output") };
    this.figures = new RecordFigures({ columns, labels: { time: null, inputs: facts.inputs, output: facts.output }, starts: [0], loopHeight: 340 });
    const band = of("low") ? [{ name: "prediction band", role: "band", style: "band", y: of("low"), high: of("high") }] : [];
    this.figures.setOverlays([...band, { name: "simulated", role: "simulated", y: of("simulated") }]);
    const explore = button("Explore this example", () => {
      explore.disabled = true;
      this.explore(facts);
    }, { id: "explore" });
    const verdict = `A ${facts.model} model was fitted to ${counted(facts.rows_in_training)} rows of a soft magnet (synthetic electrical steel). It simulates the ${counted(facts.rows)} rows below, to which it was not fitted, with an error of ${percent(facts.error_percent)} of the standard deviation of the output; cross-validation estimated ${percent(facts.validation_percent)}.`;
    this.node.replaceChildren(element("h2", { text: "An example: a soft magnet" }), element("p", { class: "verdict", text: verdict }), element("div", { class: "row" }, explore, element("span", { class: "note", text: "opens it in all steps. Your own file replaces it." })), this.figures.node);
  }

  /** The same data and the same fit as a project, then the step that judges it. */
  explore({ specimen, options }) {
    return this.notice.during(async () => {
      await post("/api/specimens", specimen);
      const { id } = await post("/api/fit", { options });
      const events = ["change", "fit"];
      const ended = () => {
        const { fit } = project.state;
        if (fit?.id !== id || fit.is_running || (fit.made && !project.models.some((model) => model.id === fit.made))) return;
        events.forEach((name) => project.removeEventListener(name, ended));
        if (fit.made) location.hash = `judge/${fit.made}`;
      };
      events.forEach((name) => project.addEventListener(name, ended));
      ended();
    });
  }
}
