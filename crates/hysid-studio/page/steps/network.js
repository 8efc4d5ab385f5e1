// Inside a network: its stops, what each does along the driven path, and the widths of loops.

import { choice } from "../controls.js";
import { button, element, Region, table } from "../elements.js";
import { problem } from "../notices.js";
import { percent, written } from "../numbers.js";
import { Figure } from "../plots/figure.js";
import { project } from "../project.js";
import { runBinary } from "../server.js";

const FIRST = 12; // Small figures that are drawn without asking.

export class Network {
  constructor() {
    this.region = new Region();
    this.node = this.region.node;
    this.figures = [];
    this.chosen = 0;
  }

  /** @param {any} model: null for none. */
  async show(model) {
    this.model = model;
    this.networks = null;
    this.chosen = 0;
    if (!model) return this.region.update(null, () => this.build());
    try {
      const neurons = await project.ofModel(model, "neurons");
      if (this.model !== model) return undefined;
      this.networks = neurons?.networks ?? null;
      this.redraw();
    } catch (error) {
      this.region.update(error.message, () => [problem(error.message)]);
    }
    return undefined;
  }

  redraw() {
    this.region.update([this.model.id, this.chosen, this.all], () => this.build());
    if (this.last) this.run(...this.last);
  }

  build() {
    this.figures.forEach(({ figure }) => figure.destroy());
    this.figures = [];
    const network = this.networks?.[this.chosen];
    if (!network) return [];
    const { stops } = network;
    const order = stops.map((_, k) => k).sort((a, b) => (stops[b].influence ?? 0) - (stops[a].influence ?? 0)).slice(0, this.all ? stops.length : FIRST);
    const [input, ...others] = this.model.input_labels;
    this.figures = order.map((stop) => ({
      stop, figure: new Figure({ title: stops[stop].name, kind: "loop", xLabel: input, yLabel: this.model.output_label, height: 170, isSmall: true }),
    }));
    const hasRate = stops[0].weights.length > 1 + others.length;
    const channels = ["weight", ...(hasRate ? ["weight of the rate"] : []), ...others.map((label) => `weight of ${label}`)];
    return [element("h2", { text: "Neurons" }),
      this.networks.length > 1 ? element("div", { class: "row" }, choice("Network", this.networks.map(({ name }, k) => ({ value: k, text: name })), this.chosen, (k) => { this.chosen = Number(k); this.redraw(); }, { id: "try-network" })) : null,
      element("p", { class: "note", text: "What each stop contributes along the driven path: the output of the network minus its output without this stop. The stop that matters most comes first." }),
      element("div", { class: "grid many" }, ...this.figures.map(({ figure }) => figure.node)),
      stops.length > FIRST && !this.all ? button(`Show all ${stops.length} stops`, () => { this.all = true; this.redraw(); }) : null,
      element("details", {}, element("summary", { text: "Stops: thresholds and weights" }),
        table("Stops", ["Stop", `Threshold of ${input}`, ...channels, "Capacity", "Influence"],
          stops.map((stop) => [stop.name, written(stop.threshold), ...stop.weights.map((weight) => written(weight)), stop.beta === null ? "\u2013" : written(stop.beta), percent(stop.influence === null ? null : 100 * stop.influence)])),
        element("p", { class: "note", text: "Weights apply to inputs scaled to a largest magnitude of 1. Capacity: the slip, in multiples of the threshold, after which the output of a stop is zero. Influence: change of the output without this stop, in % of the output's range." })),
      ...this.widths(network)];
  }

  /** The paper's K and P. */
  widths({ K, P }) {
    if (K === null) return [];
    const [unit] = this.model.input_units;
    const words = `K, the width of the loop over the trained range as the rate tends to zero: ${written(K)}${unit ? ` ${unit}` : ""}.`;
    return [element("h3", { text: "Width of the loop: K and P" }), element("p", { text: P.length > 0 ? `${words} P is the width at a rate minus K.` : `${words} P is 0: the network does not depend on the rate.` }),
      P.length > 0 ? table("P", [this.model.rate_label, unit ? `P (${unit})` : "P"], P.map(([rate, width]) => [written(rate), written(width)])) : null];
  }

  /** Draws the contributions along a path; the arrays are those that the model was run with. */
  async run(arrays, input) {
    this.last = [arrays, input];
    const network = this.networks?.[this.chosen];
    if (!network) return;
    const { model, chosen } = this;
    const { cut } = await runBinary(`/api/models/${model.id}/neurons/run?rows=${input.length}&network=${chosen}`, arrays);
    if (this.model !== model || this.chosen !== chosen) return;
    const outputs = cut(network.stops.length);
    for (const { stop, figure } of this.figures) figure.setTraces([{ name: "", role: `series ${stop}`, x: input, y: outputs[stop] }]);
  }
}
