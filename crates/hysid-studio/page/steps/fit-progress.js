// A fit while it runs and when it has ended: progress, best model so far over the data, convergence, candidates.

import { button, element, Region, table } from "../elements.js";
import { problem } from "../notices.js";
import { duration, percent, sentence } from "../numbers.js";
import { Figure } from "../plots/figure.js";
import { RecordFigures } from "../plots/record-figures.js";
import { download } from "../plots/save.js";
import { project, startsOf } from "../project.js";
import { getBinary, getFile, post } from "../server.js";

const judge = (model) => element("p", {}, element("a", { class: "button", href: `#judge/${model.id}`, text: "Judge this model" }));

export class FitProgress {
  /** @param {import("../notices.js").Notice} notice */
  constructor(notice) {
    this.notice = notice;
    this.head = new Region();
    this.result = new Region();
    this.candidates = new Region();
    this.pictures = element("div");
    this.convergence = new Figure({ title: "Convergence", kind: "curve", xLabel: "time, s", yLabel: "error, %", height: 220, isLog: true });
    this.below = element("div", { class: "pair" }, this.convergence.node, this.candidates.node);
    this.node = element("div", { hidden: true }, this.head.node, this.result.node, this.pictures, this.below);
  }

  update() {
    const { fit } = project.state;
    this.node.hidden = !fit;
    if (!fit) return;
    this.head.update([fit.id, fit.is_running], () => this.build(fit));
    if (fit.is_running) this.advance(fit);
    this.result.update([fit.id, fit.is_running, fit.made, fit.problem, fit.is_unsaved, project.models.length], () => this.ended(fit));
    this.candidates.update(fit.candidates, () => (fit.candidates.length === 0 ? [] : [element("h3", { text: "Candidates" }),
      table("Candidates", ["Model", { text: "Error, % of std", class: "" }, "Folds", { text: "State", class: "text" }],
        fit.candidates.map((one) => [one.name, percent(one.error_percent), `${one.folds} of ${one.of}`, one.state])),
      element("p", { class: "note", text: "Cross-validation errors inside the trained range, in % of the standard deviation of the output. Candidates that are far from the best are dropped." })]));
    // Up to now the error is the last one.
    const curve = fit.curve.length > 0 && fit.seconds > fit.curve.at(-1)[0] ? [...fit.curve, [fit.seconds, fit.curve.at(-1)[1]]] : fit.curve;
    this.below.hidden = curve.length < 2 && fit.candidates.length === 0;
    if (curve.length > 1 && this.drawnCurve !== `${fit.id} ${curve.at(-1)}`) {
      this.drawnCurve = `${fit.id} ${curve.at(-1)}`;
      this.convergence.setTraces([{ name: fit.curve_is, role: "simulated", x: Float64Array.from(curve, ([seconds]) => seconds), y: Float64Array.from(curve, ([, error]) => error ?? NaN) }], true);
    }
    if (fit.preview > 0 && fit.is_running) this.preview(fit);
    else if (!fit.is_running) this.dropPictures();
  }

  build(fit) {
    if (!fit.is_running) return [];
    this.bar = element("div");
    this.progress = element("div", { class: "progress", role: "progressbar", "aria-label": "Progress of the fit", "aria-valuemin": "0", "aria-valuemax": "100" }, this.bar);
    this.words = element("p");
    return [element("h2", { text: `Fitting ${fit.model}` }), this.progress, this.words,
      button("Stop and keep the best model", () => this.notice.during(() => post("/api/fit/stop", {})), { id: "fit-stop" })];
  }

  advance(fit) {
    const share = Math.round(100 * fit.done);
    this.bar.style.width = `${share}%`;
    this.progress.setAttribute("aria-valuenow", String(share));
    const error = fit.error_percent === null ? "" : ` Best ${fit.curve_is} so far: ${percent(fit.error_percent)} of the standard deviation of the output.`;
    this.words.textContent = `${share}\u202f %, ${duration(fit.seconds)} elapsed${fit.remaining ? `, ${fit.remaining}` : ""}: ${fit.part}.${error}`.replace("\u202f ", "\u202f");
  }

  ended(fit) {
    if (fit.is_running) return [];
    const model = project.models.find(({ id }) => id === fit.made);
    if (fit.was_interrupted) return [element("h2", { text: "The fit was interrupted" }), problem(fit.problem), model ? judge(model) : null];
    if (fit.is_unsaved) return [element("h2", { text: "The model is not stored" }), problem(fit.problem), this.saving()];
    if (fit.problem) return [element("h2", { text: "The fit failed" }), problem(fit.problem)];
    if (!model) return [];
    const held = model.validation ? ` and ${percent(model.validation.nrmse_std_percent)} in cross-validation` : "";
    return [element("h2", { text: "Result" }),
      element("p", { class: "verdict", text: `${model.title}: error ${percent(model.train.nrmse_std_percent)} on the training data${held}, in % of the standard deviation of the output. ${duration(model.seconds)}, ${model.termination}.` }),
      ...[model.chosen, model.why].filter(Boolean).map((words) => element("p", { text: sentence(words) })),
      judge(model)];
  }

  /** What can be done with a model that could not be stored. */
  saving() {
    const save = () => this.notice.during(() => post("/api/fit/save", {}));
    const keep = () => this.notice.during(async () => {
      const { name, content } = await getFile("/api/fit/model");
      download(content, name);
    });
    return element("div", { class: "row" }, button("Save again", save), button("Download the model", keep));
  }

  /** Fetches the newest picture; while one is on its way, no second. */
  async preview(fit) {
    const key = `${fit.id} ${fit.preview}`;
    if (this.isFetching || this.drawn === key) return;
    this.isFetching = true;
    try {
      const { numbers, headers } = await getBinary("/api/fit/preview");
      const file = project.files.find(({ id }) => id === Number(headers.get("x-file")));
      if (!file || !project.state.fit?.is_running) return;
      const pictures = `${fit.id} ${project.dataKey(file)}`;
      if (this.pictured !== pictures) {
        this.dropPictures();
        const columns = await project.columns(file);
        this.figures = new RecordFigures({ columns, labels: project.labels, starts: startsOf(file), loopHeight: 340 });
        this.pictures.replaceChildren(this.figures.node);
        this.pictured = pictures;
      }
      const name = decodeURIComponent(headers.get("x-name") ?? "") || "best model so far";
      this.figures.setOverlays([{ name, role: "simulated", y: numbers, firstRow: Number(headers.get("x-from") ?? 0) }]);
      this.drawn = key;
    } catch {
      // The next picture comes within a second.
    } finally {
      this.isFetching = false;
    }
  }

  dropPictures() {
    this.figures?.destroy();
    this.figures = null;
    this.pictured = null;
    this.pictures.replaceChildren();
  }
}
