// Step 7: drive a model by hand or with a wave.

import { choice, slider } from "../controls.js";
import { button, element, Region } from "../elements.js";
import { Notice } from "../notices.js";
import { Figure } from "../plots/figure.js";
import { project } from "../project.js";
import { runBinary } from "../server.js";
import { drivenBy, HandPath } from "./drives.js";
import { modelChoice, modelOr, noModel } from "./model-choice.js";

/** Runs one request at a time; of those that come meanwhile, only the last. */
class Latest {
  async run(action) {
    this.waiting = action;
    if (this.isBusy) return;
    this.isBusy = true;
    while (this.waiting) {
      const next = this.waiting;
      this.waiting = null;
      try { await next(); } catch (error) { this.failed?.(error); }
    }
    this.isBusy = false;
  }
}

export class TryStep {
  constructor(body) {
    this.notice = new Notice();
    this.region = new Region();
    this.latest = new Latest();
    this.latest.failed = (error) => this.notice.fail(error);
    body.replaceChildren(this.region.node, this.notice.node);
  }
  choose(id) { this.model = id; }

  async update() {
    const model = modelOr(this.model);
    if (!model) {
      this.region.update("empty", () => [noModel()]);
      return;
    }
    // Behind the loop of the model lie the data that it was fitted to, if they are still there.
    const file = model.is_stale ? null : project.usable("training")[0];
    const key = [model.id, file && project.dataKey(file), project.models.map(({ id, title }) => [id, title])];
    if (this.region.key === JSON.stringify(key)) return;
    const columns = file ? await this.notice.during(() => project.columns(file)) : null;
    this.region.update(key, () => this.build(model, columns));
    this.runWave();
  }

  build(model, columns) {
    this.now = model;
    this.figure?.destroy();
    const { ranges, input_labels: inputs, output_label: output } = model;
    const [low, high] = ranges[0];
    const [middle, half] = [(low + high) / 2, (high - low) / 2];
    this.figure = new Figure({ title: "Loop", kind: "loop", xLabel: inputs[0], yLabel: output, height: 440 });
    this.measured = columns ? [{ name: "training data", role: "faint", style: "thin", x: columns.inputs[0], y: columns.output }] : [];
    this.hand = new HandPath({ ranges, factor: paceOf(model) });

    const others = inputs.slice(1).map((label, k) => slider(label, { low: ranges[k + 1][0], high: ranges[k + 1][1], value: this.hand.values[k + 1] }, (value) => { this.hand.move(k + 1, value); this.runHand(); }));
    const first = slider(inputs[0], { low: low - 0.2 * half, high: high + 0.2 * half, value: this.hand.values[0] }, (value) => { this.hand.move(0, value); this.runHand(); });
    first.node.classList.add("large");
    const pace = element("input", { type: "number", step: "any", min: "0", id: "try-pace", value: String(this.hand.factor), on: { change: () => { if (Number(pace.value) > 0) this.hand.factor = Number(pace.value); } } });
    const byHand = element("fieldset", {}, element("legend", { text: "By hand" }),
      element("p", { class: "note", text: "Move the slider, or use the arrow keys. The simulation starts from the initial state." }), first.node, ...others.map(({ node }) => node),
      element("div", { class: "row" }, button("Clear", () => { this.hand.clear(); this.runHand(); }),
        model.needs_time ? element("div", { class: "choice" }, element("label", { for: "try-pace", text: `Model time in one second, ${model.time_label}` }), pace) : null));

    const changed = () => this.runWave();
    const amplitude = slider(`Amplitude of ${inputs[0]}`, { low: 0, high: 1.2 * half, value: half }, changed);
    const rate = slider(model.time_label.endsWith("(s)") ? "Frequency, Hz" : `Cycles per unit of ${model.time_label}`, { low: 0.01 * this.hand.rate, high: 10 * this.hand.rate, value: this.hand.rate }, changed);
    const cycles = slider("Number of cycles", { low: 1, high: 20, value: 3, step: 1 }, changed);
    let form = "sine";
    const forms = choice("Wave form", [["sine", "sine"], ["triangle", "triangle"], ["decaying", "decaying sine"], ["growing", "growing sine"]].map(([value, text]) => ({ value, text })), form, (value) => { form = value; changed(); });
    this.wave = () => drivenBy({ form, middle, amplitude: amplitude.read(), rate: rate.read(), cycles: Math.max(1, Math.round(cycles.read())), others: this.hand.values.slice(1) });
    const whatIf = element("fieldset", {}, element("legend", { text: "With a wave" }), amplitude.node, model.needs_time ? rate.node : null, cycles.node, element("div", { class: "row" }, forms));
    return [element("div", { class: "row" }, modelChoice("try", model, (id) => { this.model = id; this.update(); })),
      element("div", { class: "pair" }, element("div", {}, byHand, whatIf), this.figure.node)];
  }

  runHand() { this.run(this.hand.path()); }
  runWave() { this.run(this.wave()); }

  /** @param {{time: Float64Array, inputs: Float64Array[]}} path */
  run(path) {
    const model = this.now;
    const rows = path.time.length;
    if (rows < 2) return this.draw(path, null);
    const arrays = model.needs_time ? [path.time, ...path.inputs] : path.inputs;
    return this.latest.run(async () => {
      const { cut } = await runBinary(`/api/models/${model.id}/run?rows=${rows}`, arrays);
      if (this.now !== model) return;
      this.notice.clear();
      this.draw(path, cut(model.has_band ? 3 : 1));
    });
  }

  draw(path, answer) {
    const [x] = path.inputs;
    const traces = [...this.measured];
    if (answer?.[1]) traces.push({ name: "prediction band", role: "band", style: "band", x, y: answer[1], high: answer[2] });
    if (answer) traces.push({ name: "simulated", role: "simulated", x, y: answer[0] });
    this.figure.setTraces(traces, true);
  }
}

/** Cycles per unit of time over the trained range at half the largest trained rate; 1 for a model without a rate. */
function paceOf({ ranges: [[low, high]], largest_rate: rate }) {
  return Number(((rate ?? 0) / (2 * Math.PI * (high - low)) || 1).toPrecision(1));
}
