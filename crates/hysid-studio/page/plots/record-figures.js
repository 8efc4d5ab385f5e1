// The loop and the histories of one file, linked: measured, and with it anything that has the same rows.

import { element } from "../elements.js";
import { Figure } from "./figure.js";
import { Link } from "./link.js";

/**
 * Time that grows over the whole file: where a record begins anew, its time goes on after the record before.
 * @param {Float64Array} time
 * @param {number[]} starts
 */
export function goingOn(time, starts) {
  if (starts.every((row) => row === 0 || time[row] > time[row - 1])) return time;
  const joined = Float64Array.from(time);
  starts.forEach((from, k) => {
    if (from === 0) return;
    const to = starts[k + 1] ?? time.length;
    const step = from + 1 < to ? time[from + 1] - time[from] : 1;
    const shift = joined[from - 1] + step - time[from];
    for (let row = from; row < to; row++) joined[row] = time[row] + shift;
  });
  return joined;
}

/**
 * @typedef {{time: Float64Array, inputs: Float64Array[], rate: Float64Array | null, output: Float64Array}} Columns
 * @typedef {{name: string, role: string, style?: string, y: Float64Array, high?: Float64Array, firstRow?: number}} Overlay
 */
export class RecordFigures {
  /**
   * @param {{columns: Columns, labels: any, starts: number[], measuredRole?: string, withInput?: boolean, loopHeight?: number}} options
   */
  constructor({ columns, labels, starts, measuredRole = "measured", withInput = false, loopHeight = 420 }) {
    this.link = new Link();
    this.columns = columns;
    this.starts = starts;
    this.measuredRole = measuredRole;
    this.time = goingOn(columns.time, starts);
    this.labels = labels;
    const timeLabel = labels.time || "row";
    const make = (title, kind, xLabel, yLabel, height) => new Figure({ title, kind, xLabel, yLabel, height, link: this.link });
    this.loop = make("Loop", "loop", labels.inputs[0], labels.output, loopHeight);
    this.inputs = withInput ? columns.inputs.map((_, k) => make(columns.inputs.length > 1 ? `Input ${k + 1}` : "Input", "history", timeLabel, labels.inputs[k], 150)) : [];
    this.output = make("Output", "history", timeLabel, labels.output, withInput ? 210 : loopHeight);
    this.node = element("div", { class: "pair" }, this.loop.node, element("div", { class: "stack" }, ...this.inputs.map((figure) => figure.node), this.output.node));
    this.inputs.forEach((figure, k) => figure.setTraces([{ name: labels.inputs[k], role: "input", x: this.time, y: columns.inputs[k], breaks: starts }]));
    this.setOverlays([]);
  }

  /** Draws these over what was measured. @param {Overlay[]} overlays */
  setOverlays(overlays, keepView = true) {
    // Wide, so that it is seen below a model that is close to it.
    const measured = { name: "measured", role: this.measuredRole, style: this.measuredRole === "measured" ? "wide" : "line", y: this.columns.output };
    // Bands lie behind everything.
    const all = [...overlays.filter((one) => one.style === "band"), measured, ...overlays.filter((one) => one.style !== "band")];
    const over = (x) => all.map((one) => ({
      ...one, x: one.firstRow ? x.subarray(one.firstRow) : x, breaks: this.starts.map((row) => row - (one.firstRow ?? 0)),
    }));
    this.loop.setTraces(over(this.columns.inputs[0]), keepView);
    this.output.setTraces(over(this.time), keepView);
  }

  get figures() { return [this.loop, ...this.inputs, this.output]; }
  destroy() { this.figures.forEach((figure) => figure.destroy()); }
}
