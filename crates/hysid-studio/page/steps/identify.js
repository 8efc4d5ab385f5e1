// Step 3: start the fit, follow it, stop it; the model and its options are behind the button.

import { choice, control } from "../controls.js";
import { button, element, emptyState, newId, Region } from "../elements.js";
import { Notice, linked } from "../notices.js";
import { project } from "../project.js";
import { post } from "../server.js";
import { FitProgress } from "./fit-progress.js";

const COMMON = ["members", "stops", "hidden", "operators", "seed"];
const RATES = [["auto", "auto"], ["none", "none"], ["central", "central differences"], ["backward", "backward differences"], ["savitzky-golay", "Savitzky-Golay"]];

export class IdentifyStep {
  constructor(body) {
    this.notice = new Notice();
    this.form = new Region();
    this.progress = new FitProgress(this.notice);
    this.model = "auto";
    /** Values that were chosen, by option: they stay when the model changes. */
    this.values = {};
    this.rate = "auto";
    this.limit = "";
    body.replaceChildren(this.form.node, this.notice.node, this.progress.node);
  }

  update() {
    const isRunning = project.state.fit?.is_running ?? false;
    const isReady = project.labels && !project.state.problem;
    const data = JSON.stringify([project.state.problem, project.files.map(({ id, use, problem }) => [id, use, problem])]);
    // An error of the last start may be of a file that was removed.
    if (this.data !== undefined && this.data !== data) this.notice.clear();
    this.data = data;
    this.form.update([isReady, isRunning, this.model, data], () => (isReady ? this.build(isRunning)
      : [emptyState("There are no training data to fit a model to. ", element("a", { class: "button", href: "#data", text: "Go to the data" })),
        project.state.problem ? element("p", { class: "problem" }, linked(project.state.problem)) : null]));
    this.progress.update();
    // Start cannot be pressed now: the focus goes to Stop.
    if (isRunning && this.hasStarted) {
      this.hasStarted = false;
      document.getElementById("fit-stop")?.focus({ preventScroll: true });
    }
  }

  build(isRunning) {
    const { models, options } = project.choices;
    const model = models.find(({ name }) => name === this.model) ?? models[0];
    const used = options.filter(({ name }) => name in model.defaults);
    const controls = new Map(used.map((option) => {
      const made = control("fit", { ...option, default: model.defaults[option.name] }, this.values[option.name], () => { this.values[option.name] = made.read(); });
      return [option.name, made];
    }));
    const nodes = (list) => element("div", { class: "controls" }, ...list.map(({ name }) => controls.get(name).node));
    const common = used.filter(({ name }) => COMMON.includes(name));
    const rest = used.filter(({ name }) => !COMMON.includes(name));
    const headings = [...new Set(rest.map(({ heading }) => heading))];
    const limit = element("input", { type: "number", min: "1", step: "any", placeholder: "none", value: this.limit, id: newId("limit"), on: { change: () => { this.limit = limit.value; } } });
    limit.dataset.flag = "--time-limit";
    const rate = choice("Rate of the input", RATES.map(([value, text]) => ({ value, text })), this.rate, (value) => { this.rate = value; }, { "data-flag": "--rate" });
    const facts = [model.rate === "needed" ? "Needs the rate of the input." : null, model.several_inputs ? "Takes several inputs." : null].filter(Boolean).join(" ");
    const modelChoice = choice("Model", models.map(({ name }) => ({ value: name, text: name })), model.name, (name) => { this.model = name; this.update(); }, { id: "fit-model", "data-flag": "--model" });
    const start = button("Start", () => this.start(model, controls), { class: "main large", id: "fit-start" });
    const files = project.usable("training").map(({ name }) => name);
    const what = model.name === "auto" ? "Hysid cross-validates networks and classical models, and combines the best" : `${model.name}: ${model.what}`;
    const behind = element("details", { open: this.behind?.open ?? false }, element("summary", { text: "Model and options" }),
      element("div", { class: "row" }, modelChoice, model.rate === "no" ? null : project.state.columns.rate ? element("p", { text: `Rate of the input: column ${project.state.columns.rate}.` }) : rate,
        element("div", { class: "choice" }, element("label", { for: limit.id, text: "Time limit, s" }), limit)),
      facts ? element("p", { text: facts }) : null,
      common.length > 0 ? nodes(common) : null,
      headings.length > 0 ? element("details", {}, element("summary", { text: `More options of ${model.name}` }),
        ...headings.map((heading) => element("fieldset", {}, element("legend", { text: heading }), nodes(rest.filter((option) => option.heading === heading))))) : null);
    this.behind = behind;
    return isRunning ? [] : [element("div", { class: "begin" }, start, element("p", { text: `${what}. Training data: ${files.join(", ")}.` })), behind];
  }

  start(model, controls) {
    const options = { model: model.name };
    for (const [name, one] of controls) {
      const value = one.read();
      if (value !== undefined) options[name] = value;
    }
    const limit = Number(this.limit) > 0 ? Number(this.limit) : null;
    return this.notice.during(async () => {
      await post("/api/fit", { options, rate: model.rate === "no" ? "none" : this.rate, time_limit: limit });
      this.hasStarted = true;
      this.update();
    });
  }
}
