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
    this.loop = element("div");
    this.history = element("div");
    this.convergence = new Figure({ title: "Convergence", kind: "curve", xLabel: "time, s", yLabel: "error, %", height: 200, isLog: true });
    this.node = element("div", { hidden: true },
      element("div", { class: "pair" }, this.loop, element("div", { class: "stack" }, this.head.node, this.result.node, this.convergence.node)),
      this.history, this.candidates.node);
  }

  update() {
    const { fit } = project.state;
    this.node.hidden = !fit;
    if (!fit) return;
    this.head.update([fit.id, fit.is_running], () => this.build(fit));
    if (fit.is_running) this.advance(fit);
    this.result.update([fit.id, fit.is_running, fit.made, fit.problem, fit.is_unsaved, project.models], () => this.ended(fit));
    this.candidates.update([fit.is_running, fit.candidates], () => this.candidateTable(fit));
    this.drawConvergence(fit);
    this.draw(fit);
  }

  candidateTable(fit) {
    if (fit.candidates.length === 0) return [];
    const details = element("details", { open: this.isUnfolded ?? fit.is_running, on: { toggle: () => { this.isUnfolded = details.open; } } },
      element("summary", { text: `Candidates (${fit.candidates.length})` }),
      table("Candidates", ["Model", { text: "Error, % of std", class: "" }, "Folds", { text: "State", class: "text" }],
        fit.candidates.map((one) => [one.name, percent(one.error_percent), `${one.folds} of ${one.of}`, one.state])),
      element("p", { class: "note", text: "Cross-validation errors inside the trained range, in % of the standard deviation of the output. Candidates that are far from the best are dropped." }));
    return [details];
  }

  /** The lowest error over time, and for auto also the error of each candidate on the folds so far. */
  drawConvergence(fit) {
    // Up to now the error is the last one.
    const curve = fit.curve.length > 0 && fit.seconds > fit.curve.at(-1)[0] ? [...fit.curve, [fit.seconds, fit.curve.at(-1)[1]]] : fit.curve;
    const key = `${fit.id} ${curve.at(-1)} ${fit.tried.length} ${fit.running.at(-1)}`;
    this.convergence.node.hidden = [curve, fit.tried, fit.running].every((points) => points.length === 0);
    if (this.convergence.node.hidden || this.drawnCurve === key) return;
    this.drawnCurve = key;
    const trace = (name, role, style, points) => ({ name, role, style, x: Float64Array.from(points, ([seconds]) => seconds), y: Float64Array.from(points, ([, error]) => error ?? NaN) });
    this.convergence.setTraces([trace("training error of the running fit", "faint", "thin", fit.running), trace("candidates, on the folds so far", "error", "points", fit.tried), trace(fit.curve_is, "simulated", "line", curve)].filter(({ x }) => x.length > 0), true);
  }

  build(fit) {
    this.isUnfolded = undefined;
    if (!fit.is_running) return [];
    this.bar = element("div");
    this.progress = element("div", { class: "progress", role: "progressbar", "aria-label": "Progress of the fit", "aria-valuemin": "0", "aria-valuemax": "100" }, this.bar);
    this.remaining = element("p", { class: "remaining" });
    this.words = element("p", { class: "note" });
    return [element("h2", { text: `Fitting ${fit.model}` }), this.progress, this.remaining, this.words,
      button("Stop and keep the best model", () => this.notice.during(() => post("/api/fit/stop", {})), { id: "fit-stop" })];
  }

  advance(fit) {
    const share = Math.round(100 * fit.done);
    this.bar.style.width = `${share}%`;
    this.progress.setAttribute("aria-valuenow", String(share));
    const error = fit.error_percent === null ? "" : ` Best ${fit.curve_is} so far: ${percent(fit.error_percent)} of the standard deviation of the output.`;
    this.remaining.textContent = `${share}\u202f%, ${duration(fit.seconds)} elapsed${fit.remaining ? `, ${fit.remaining}` : ""}`;
    this.words.textContent = `${fit.part}.${error}`;
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
      element("ul", { class: "use" }, ...model.use.map((text) => element("li", { text }))),
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

  /** The measured loop from the beginning, and over it the newest model. While one is on its way, no second. */
  async draw(fit) {
    const model = fit.is_running ? null : project.models.find(({ id, is_stale: isStale }) => id === fit.made && !isStale);
    const file = project.files.find(({ id }) => id === project.state.first);
    if (!file || !project.usable().includes(file) || !(model || fit.is_running)) return this.dropPictures();
    const key = `${fit.id} ${project.dataKey(file)} ${model ? "made" : fit.preview}`;
    if (this.isFetching || this.drawn === key) return undefined;
    this.isFetching = true;
    try {
      const columns = await project.columns(file);
      const pictures = `${fit.id} ${project.dataKey(file)}`;
      if (this.pictured !== pictures) {
        this.dropPictures();
        this.figures = new RecordFigures({ columns, labels: project.labels, starts: startsOf(file), loopHeight: 400 });
        this.loop.replaceChildren(this.figures.loop.node);
        this.history.replaceChildren(this.figures.output.node);
        this.pictured = pictures;
      }
      if (model) this.figures.setOverlays([{ name: model.title, role: "simulated", y: (await project.simulated(model, file)).y }]);
      else if (fit.preview > 0) {
        const { numbers, headers } = await getBinary("/api/fit/preview");
        const name = decodeURIComponent(headers.get("x-name") ?? "") || "best model so far";
        this.figures?.setOverlays([{ name, role: "simulated", y: numbers, firstRow: Number(headers.get("x-from") ?? 0) }]);
      }
      this.drawn = key;
    } catch {
      // The next picture comes within a second.
    } finally {
      this.isFetching = false;
    }
    // The fit may have ended meanwhile.
    if (project.state.fit && !project.state.fit.is_running && !model) return this.draw(project.state.fit);
    return undefined;
  }

  dropPictures() {
    this.figures?.destroy();
    this.figures = null;
    this.pictured = null;
    this.loop.replaceChildren();
    this.history.replaceChildren();
  }
}
