// Step 5: all models side by side, and some of them over one file.

import { button, element, Region } from "../elements.js";
import { failure, problem, removeOne } from "../notices.js";
import { counted, duration, percent } from "../numbers.js";
import { RecordFigures } from "../plots/record-figures.js";
import { project, startsOf } from "../project.js";
import { fileChoice, fileOr, noFile, noModel } from "./model-choice.js";

export class CompareStep {
  constructor(body) {
    this.table = new Region();
    this.pictures = new Region();
    this.error = new Region();
    /** @type {Set<number> | null} */
    this.shown = null;
    body.replaceChildren(this.table.node, this.error.node, this.pictures.node);
  }

  /** Compares the models on a file that was dropped here. */
  take(file) {
    this.file = file;
    this.update();
  }

  async update() {
    const { models } = project;
    const file = fileOr(this.file);
    if (models.length === 0 || !file) {
      this.table.update("empty", () => [models.length > 0 ? noFile() : noModel()]);
      this.pictures.update(null, () => { this.figures?.destroy(); this.figures = null; return []; });
      return;
    }
    // The two newest are drawn at first, and each that is new.
    const added = this.known ? models.filter(({ id }) => !this.known.has(id)) : models.slice(-2);
    this.known = new Set(models.map(({ id }) => id));
    this.shown ??= new Set();
    added.forEach(({ id }) => this.shown.add(id));
    const unseen = project.usable("unseen");
    const judged = await Promise.all(models.map((model) => Promise.all(unseen.map((one) => project.judgement(model, one).catch(() => null)))));
    this.table.update([models, unseen, judged], () => this.build(models, unseen, judged));
    this.draw(file);
  }

  build(models, unseen, judged) {
    const best = (values) => Math.min(...values.filter((value) => Number.isFinite(value)));
    const columns = [
      ["Training", models.map((model) => model.train.nrmse_std_percent)], ["Cross-validation", models.map((model) => model.validation?.nrmse_std_percent ?? null)],
      ...unseen.map((file, k) => [file.name, judged.map((row) => (row[k] && !row[k].is_training ? row[k].errors.nrmse_std_percent : null))]),
    ];
    const cells = (k) => columns.map(([, values], column) => {
      const isBest = models.length > 1 && values[k] === best(values.filter((value) => value !== null));
      return element("td", { "data-label": columns[column][0] }, isBest ? element("strong", { text: percent(values[k]) }) : percent(values[k]));
    });
    const row = (model, k) => element("tr", {},
      element("th", { scope: "row" }, element("label", { class: "tick" }, element("input", {
        type: "checkbox", id: `overlay-${model.id}`, checked: this.shown.has(model.id), on: { change: (event) => { this.shown[event.target.checked ? "add" : "delete"](model.id); this.update(); } },
      }), model.is_stale ? `${model.title} (other data)` : model.title)),
      ...cells(k), element("td", { "data-label": "Parameters", text: counted(model.parameters) }), element("td", { "data-label": "Time", text: duration(model.seconds) }),
      element("td", {}, element("a", { href: `#judge/${model.id}`, text: "Judge", "aria-label": `Judge ${model.title}` }), " ",
        button("Remove", () => removeOne("models", { id: model.id, name: model.title }), { "aria-label": `Remove ${model.title}` })));
    const heads = ["Model (tick to draw)", ...columns.map(([name]) => name), "Parameters", "Time"];
    return [element("div", { class: "scroll cards", role: "region", "aria-label": "Models", tabindex: "0" }, element("table", {},
      element("caption", { class: "hidden", text: "Models" }),
      element("thead", {}, element("tr", {}, ...heads.map((text) => element("th", { scope: "col", text })), element("td"))),
      element("tbody", {}, ...models.map(row)))),
    ...project.state.models.filter((model) => model.problem).map((model) => problem([`Model ${model.id}, ${model.file}: `, model.problem].flat())),
    element("p", { class: "note", text: "Errors are NRMSE, in % of the standard deviation of the output; the lowest of each column is bold. Files are shown for models that were not fitted to them." })];
  }

  async draw(file) {
    const chosen = project.models.filter(({ id }) => this.shown.has(id));
    const key = `${project.dataKey(file)} ${file.use} ${project.usable().map(({ id }) => id)}`;
    this.wanted = `${key} ${[...this.shown]}`;
    const wanted = this.wanted;
    try {
      const [columns, ...simulated] = await Promise.all([project.columns(file), ...chosen.map((model) => project.simulated(model, file))]);
      if (this.wanted !== wanted) return;
      this.pictures.update(key, () => {
        this.figures?.destroy();
        this.figures = new RecordFigures({ columns, labels: project.labels, starts: startsOf(file) });
        return [element("div", { class: "row" }, fileChoice("compare", file, (id) => { this.file = id; this.update(); })), this.figures.node];
      });
      this.figures.setOverlays(chosen.map((model, k) => ({ name: model.title, role: `series ${project.models.indexOf(model)}`, y: simulated[k].y })));
      this.error.update(null, () => []);
    } catch (error) {
      this.error.update(error.message, () => [failure(error)]);
    }
  }
}
