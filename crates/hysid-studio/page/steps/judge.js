// Step 4: measured against simulated, errors, residuals and facts of a model.

import { tick } from "../controls.js";
import { documentOf, element, Region, table } from "../elements.js";
import { failure, linked } from "../notices.js";
import { counted, duration, percent, sentence, written } from "../numbers.js";
import { Figure } from "../plots/figure.js";
import { goingOn, RecordFigures } from "../plots/record-figures.js";
import { project, startsOf } from "../project.js";
import { fileChoice, fileOr, modelChoice, modelOr, noFile, noModel, renaming, stale } from "./model-choice.js";

export class JudgeStep {
  constructor(body) {
    this.head = new Region();
    this.result = new Region();
    this.pictures = new Region();
    this.errors = new Region();
    this.residuals = new Region();
    this.facts = new Region();
    this.withMembers = false;
    this.drawn = [];
    body.replaceChildren(this.head.node, this.result.node, this.pictures.node, this.errors.node, this.residuals.node, this.facts.node);
  }

  choose(id) { this.model = id; }
  /** Judges the model by a file that was dropped here. */
  take(file) {
    this.file = file;
    this.update();
    scrollTo(0, 0);
  }

  update() {
    const model = modelOr(this.model);
    const file = fileOr(this.file);
    if (!model || !file) {
      this.head.update("empty", () => [model ? noFile() : noModel()]);
      for (const region of [this.result, this.pictures, this.errors, this.residuals, this.facts]) region.update(null, () => []);
      this.dropFigures();
      return;
    }
    const choose = (what) => (id) => { this[what] = id; this.update(); };
    const unread = project.files.find(({ id, problem: why }) => id === this.file && why);
    this.head.update([model, unread, project.usable().map(({ id, name, use }) => [id, name, use]), file.id, this.withMembers], () => [
      element("div", { class: "row" }, modelChoice("judge", model, choose("model")), renaming(model), fileChoice("judge", file, choose("file")),
        tick("Members as thin lines", this.withMembers, (is) => { this.withMembers = is; this.update(); })),
      unread ? element("p", { class: "problem" }, linked(unread.problem)) : null,
      stale(model), model.chosen ? element("p", { class: "verdict", text: sentence(model.chosen) }) : null, model.why ? element("p", { class: "note", text: sentence(model.why) }) : null,
      project.usable("unseen").length === 0 ? element("p", { class: "problem", text: "There are no unseen data. Drop a second measurement here to estimate the error on new data." }) : null]);
    this.draw(model, file);
  }

  async draw(model, file) {
    const key = `${model.id} ${project.dataKey(file)} ${file.use}`;
    this.wanted = key;
    const others = project.usable().filter(({ id, use }) => use === "unseen" && id !== file.id);
    try {
      const [columns, simulated] = await Promise.all([project.columns(file), project.simulated(model, file)]);
      const members = this.withMembers ? await project.members(model, file) : [];
      if (this.wanted !== key) return;
      this.pictures.update(key, () => this.buildPictures(columns, file));
      this.overlay(simulated, members);
      const [judged, ...unseen] = await Promise.all([file, ...others].map((one) => project.judgement(model, one)));
      if (this.wanted !== key) return;
      this.result.update([file.name, judged.is_training, judged.errors], () => [this.summary(file, judged)]);
      this.errors.update([model, judged, unseen], () => this.errorTable(model, file, judged, others, unseen));
      this.residuals.update([key, judged.residuals], () => this.buildResiduals(columns, simulated, file, judged));
      this.facts.update(model.id, () => [this.factsOf(model)]);
    } catch (error) {
      this.result.update(null, () => []);
      this.errors.update(error.message, () => [failure(error)]);
    }
  }

  /** The errors on the chosen file in one line, above the figures. */
  summary(file, { errors, is_training: isTraining }) {
    const unit = project.state.output_unit ? ` ${project.state.output_unit}` : "";
    const relative = errors.nrmse_std_percent === null ? "" : `, ${percent(errors.nrmse_std_percent)} of the standard deviation`;
    return element("p", { class: "result", text: `${file.name} (${isTraining ? "used" : "not used"} in training): RMSE ${written(errors.rmse)}${unit}${relative}; largest error ${written(errors.max_abs_error)}${unit}.` });
  }

  /** What driving the model over its range tells; it is computed when it is opened. */
  factsOf(model) {
    const facts = element("div", {}, element("p", { role: "status", text: "Diagnosing the model \u2026" }));
    const folded = element("details", { on: { toggle: async () => {
      if (!folded.open || this.told === model.id) return;
      this.told = model.id;
      try {
        facts.replaceChildren(documentOf((await project.ofModel(model, "facts")).html));
      } catch (error) {
        facts.replaceChildren(failure(error));
      }
    } } }, element("summary", { text: "Model diagnosis: properties, equations" }), facts);
    this.told = null;
    return folded;
  }

  dropFigures() {
    this.figures?.destroy();
    this.figures = null;
    this.drawn.forEach((figure) => figure.destroy());
    this.drawn = [];
  }

  buildPictures(columns, file) {
    this.figures?.destroy();
    this.figures = new RecordFigures({ columns, labels: project.labels, starts: startsOf(file) });
    return [this.figures.node];
  }

  overlay(simulated, members) {
    const band = simulated.low ? [{ name: "prediction band", role: "band", style: "band", y: simulated.low, high: simulated.high }] : [];
    const thin = members.map((member, k) => ({ name: member.name, role: `series ${k + 1}`, style: "thin", y: member.y }));
    this.figures.setOverlays([...band, ...thin, { name: "simulated", role: "simulated", y: simulated.y }]);
  }

  errorTable(model, file, judged, others, unseen) {
    const unit = project.state.output_unit;
    const inUnit = (name) => (unit ? `${name} (${unit})` : name);
    const row = (name, errors) => [name, counted(errors.samples), written(errors.rmse), written(errors.max_abs_error), percent(errors.nrmse_std_percent), percent(errors.fit_percent)];
    const rows = [row("training", model.train)];
    if (model.validation) rows.push(row("cross-validation", model.validation));
    const of = (one, told) => row(`${told.is_training ? "used in training" : "not used in training"}: ${one.name}`, told.errors);
    if (file.use !== "training" || !judged.is_training) rows.push(of(file, judged));
    others.forEach((other, k) => rows.push(of(other, unseen[k])));
    const records = judged.records.length > 1 ? element("details", {}, element("summary", { text: `Errors of the ${judged.records.length} records of ${file.name}` }),
      table("Errors of records", ["Record", "Samples", inUnit("RMSE"), inUnit("Largest error"), "NRMSE, % of std", "Fit"], judged.records.filter(({ errors }) => errors).map(({ name, errors }) => row(name, errors)))) : null;
    return [element("h2", { text: "What this model may be used for" }), element("ul", { class: "use" }, ...model.use.map((text) => element("li", { text }))),
      element("h2", { text: "Errors" }),
      table("Errors", ["Data", "Samples", inUnit("RMSE"), inUnit("Largest error"), "NRMSE, % of std", "Fit"], rows),
      element("p", { class: "note", text: "Errors of a free run: the model gets only the input. NRMSE: the root mean square error in % of the standard deviation of the output. Fit: 100 % minus that error. Cross-validation: all held-out rows together." }),
      judged.inside_band_percent === null ? null : element("p", { text: `${percent(judged.inside_band_percent)} of the measured outputs of ${file.name} lie in the ${percent(100 * project.choices.band)} prediction band. The band holds for new data of the specimen that the model was trained on; outputs of another specimen may lie outside.` }),
      judged.warnings.length > 0 ? element("ul", { class: "warnings" }, ...judged.warnings.map((words) => element("li", {}, linked(words)))) : null, records,
      element("p", { class: "note", text: [`${counted(model.parameters)} parameters, ${duration(model.seconds)}, ${model.termination}.`, ...model.notes].join(" ") })];
  }

  buildResiduals(columns, simulated, file, judged) {
    this.drawn.forEach((figure) => figure.destroy());
    const residual = columns.output.map((value, row) => value - simulated.y[row]);
    const { labels } = project;
    const starts = startsOf(file);
    const yLabel = `residual of ${labels.output}`;
    const figure = (title, kind, xLabel, x) => {
      const made = new Figure({ title, kind, xLabel, yLabel, height: 220 });
      made.setTraces([{ name: "residual", role: "error", style: kind === "points" ? "points" : "line", x, y: residual, breaks: starts }]);
      return made;
    };
    this.drawn = [figure("Residuals over time", "history", labels.time || "row", goingOn(columns.time, starts)), figure("Residuals over the input", "points", labels.inputs[0], columns.inputs[0])];
    if (columns.rate) this.drawn.push(figure("Residuals over the rate", "points", project.state.rate_label, columns.rate));
    const text = (name) => ({ text: name, class: "text" });
    return [element("h2", { text: "Residuals" }), element("p", { class: "note", text: "Measured minus simulated output. A pattern suggests that the model misses something; the tests below say what." }),
      element("div", { class: "grid" }, ...this.drawn.map(({ node }) => node)),
      judged.residuals.length > 0 ? table("Residual tests", ["Test", text("Verdict"), "p", { text: "Statement", class: "words" }, { text: "Advice", class: "words" }],
        judged.residuals.map((one) => [one.test, one.verdict, one.p ?? "\u2013", one.statement, one.advice ? linked(one.advice) : ""])) : null];
  }
}
