// The inverse: the input that drives a model along a wanted output.

import { choice } from "../controls.js";
import { element } from "../elements.js";
import { linked } from "../notices.js";
import { written } from "../numbers.js";
import { project } from "../project.js";
import { modelChoice, modelOr, noFile, noModel, stale } from "./model-choice.js";
import { field, UseCase } from "./use-case.js";

export class InvertStep extends UseCase {
  choose(id) { this.model = id; }
  /** A wanted output that was dropped here; it needs no input. */
  take(file) {
    this.file = file;
    this.update();
  }
  get useOfDropped() { return "unused"; }

  update() {
    const model = modelOr(this.model);
    if (!model) return this.showNothing(noModel());
    const files = project.files.filter(({ columns }) => columns.length > 0);
    const file = files.find(({ id }) => id === this.file) ?? files.find(({ use }) => use === "unseen") ?? files[0];
    if (!file) return this.showNothing(noFile());
    return this.form.update([project.models.map(({ id, title }) => [id, title]), model.id, files.map(({ id, name }) => [id, name]), file.id], () => {
      const [range] = model.ranges;
      const low = field(`Lowest ${model.input_labels[0]}`, written(range[0]));
      const high = field(`Highest ${model.input_labels[0]}`, written(range[1]));
      const slew = field("Largest rate of it", "none");
      const chosen = choice("Wanted output: the output column of", files.map(({ id, name }) => ({ value: id, text: name })), file.id, (id) => { this.file = Number(id); this.update(); }, { id: "invert-file" });
      const start = this.asking("Invert", () => `/api/models/${model.id}/inverse`, () => ({ file: file.id, low: low.read(), high: high.read(), slew: slew.read() }));
      this.result.replaceChildren();
      return [element("div", { class: "row" }, modelChoice("invert", model, (id) => { this.model = id; this.update(); }), chosen), stale(model),
        element("div", { class: "row" }, low.node, high.node, slew.node, start),
        element("p", { class: "note" }, linked(`Drop a table with time and ${model.output_label} here to use it as the wanted output. Without other limits the input stays in the trained range.`))];
    });
  }
}
