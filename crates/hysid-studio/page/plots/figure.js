// A figure: axes by uPlot, curves by painter.js, with zoom, movement, values under the pointer and saving.

import uPlot from "../uplot/uPlot.esm.js";
import { button, element, newId } from "../elements.js";
import { tickTexts, written } from "../numbers.js";
import { listen } from "./gestures.js";
import { nearestRow } from "./loop-points.js";
import { paintMarkedRows, paintRanges, rowsInside } from "./marks.js";
import { moving, paint, rowsInWindow } from "./painter.js";
import { colour, palette, whenColoursChange } from "./palette.js";
import { firstNotBelow, yPixel } from "./points.js";
import { save } from "./save.js";
import { Trace } from "./trace.js";

const REST = 120; // Milliseconds without movement after which all detail is drawn.
const LEAST_WINDOW = 1e-6; // Smallest share of the whole range that can be shown.

/**
 * @typedef {object} FigureOptions
 * @property {string} title
 * @property {"history" | "loop" | "points" | "curve"} kind
 * @property {string} xLabel
 * @property {string} yLabel
 * @property {import("./link.js").Link} [link]
 * @property {number} [height]
 * @property {boolean} [isLog]: logarithmic vertical axis.
 */
export class Figure {
  /** @param {FigureOptions} options */
  constructor({ title, kind, xLabel, yLabel, link = null, height = 240, isLog = false }) {
    Object.assign(this, { title, kind, xLabel, yLabel, link, height, isLog });
    /** @type {Trace[]} */
    this.traces = [];
    this.view = { x: [0, 1], y: [0, 1] };
    this.home = { x: [0, 1], y: [0, 1] };
    this.isMoving = false;
    this.build();
    this.follow = (event) => this.linked(event.detail);
    link?.addEventListener("change", this.follow);
    this.forgetColours = whenColoursChange(() => this.draw());
    this.observer = new ResizeObserver(() => this.fit());
    this.observer.observe(this.area);
  }

  build() {
    const help = newId("figure-help");
    this.legend = element("span", { class: "legend" });
    this.readout = element("div", { class: "readout", "aria-hidden": "true" });
    this.area = element("div", { class: "plot", tabindex: "0", role: "group", "aria-label": `${this.title}: ${this.yLabel} over ${this.xLabel}`, "aria-describedby": help });
    this.area.style.height = `${this.height}px`;
    const tool = (text, title, action, properties = {}) => button(text, action, { title, "aria-label": `${title}: ${this.title}`, ...properties });
    this.whole = tool("Whole figure", "Show the whole figure (double-click, or 0)", () => this.reset(), { hidden: true });
    const tools = element("div", { class: "tools" },
      tool("+", "Zoom in", () => this.zoomAbout([0.5, 0.5], 0.7)), tool("\u2212", "Zoom out", () => this.zoomAbout([0.5, 0.5], 1 / 0.7)),
      tool("\u2190", "Move left", () => this.move(-0.2, 0)), tool("\u2192", "Move right", () => this.move(0.2, 0)),
      this.whole, this.readout,
      element("span", { class: "save" }, ...["SVG", "PNG", "CSV"].map((kind) => tool(kind, `Save as ${kind}`, () => save(this, kind)))));
    this.node = element("figure", { class: "figure" },
      element("figcaption", {}, element("span", { class: "title", text: this.title }), this.legend),
      this.area,
      element("p", { class: "hidden", id: help, text: "Drag to zoom, Shift and drag to move, double-click to reset. Keys: arrows move, plus and minus zoom, 0 resets." }),
      tools);
  }

  /**
   * Shows these curves. The view stays where it is if it was zoomed and `keepView` is set.
   * @param {import("./trace.js").TraceOptions[]} options
   */
  setTraces(options, keepView = false) {
    this.traces = options.map((entry) => {
      const trace = new Trace(entry);
      trace.isOrdered = this.kind === "history" || this.kind === "curve";
      return trace;
    });
    const shown = this.traces.filter((trace) => trace.length > 0).map((trace) => trace.range());
    const least = (k) => Math.min(...shown.map((range) => range[k]).filter(Number.isFinite));
    const most = (k) => Math.max(...shown.map((range) => range[k]).filter(Number.isFinite));
    const isZoomed = this.isZoomed;
    const margin = this.kind === "history" || this.kind === "curve" ? 0 : 0.04;
    const log = (value) => (this.isLog ? Math.log10(value) : value);
    this.home = { x: widened(least(0), most(1), margin), y: widened(log(least(2)), log(most(3)), 0.06) };
    if (!keepView || !isZoomed) this.view = { x: [...this.home.x], y: [...this.home.y] };
    if (this.link?.window && this.kind === "history") this.view.x = [...this.link.window];
    const named = this.traces.filter((trace, k) => trace.name && this.traces.findIndex((other) => other.name === trace.name) === k);
    this.legend.replaceChildren(...(named.length > 1 ? named : []).map((trace) => {
      const swatch = element("i", { class: trace.style === "band" ? "swatch wide" : "swatch" });
      swatch.dataset.role = trace.role;
      return element("span", {}, swatch, trace.name);
    }));
    this.settle();
  }

  get isZoomed() { return ["x", "y"].some((axis) => this.view[axis].some((value, k) => value !== this.home[axis][k])); }

  /** Makes the plot once its place has a width, and keeps its size. */
  fit() {
    const width = Math.floor(this.area.clientWidth);
    if (width < 50) return;
    if (!this.plot) this.make(width);
    else if (this.plot.width !== width) this.plot.setSize({ width, height: this.height });
  }

  make(width) {
    const range = (axis) => () => [...this.view[axis]];
    const paintAxis = (name) => () => palette()[name];
    const axis = (label) => ({
      label, labelSize: 18, labelFont: "12px system-ui, sans-serif", font: "11.5px system-ui, sans-serif", stroke: paintAxis("axis"),
      grid: { stroke: paintAxis("grid"), width: 1 }, ticks: { show: false }, gap: 4,
    });
    const values = (plot, splits, k, space, step) => tickTexts(splits, step);
    const powers = (plot, splits) => splits.map((value) => written(10 ** value, 2));
    const size = (plot, texts) => 14 + 6.6 * Math.max(3, ...(texts ?? []).map((text) => text.length));
    this.plot = new uPlot({
      width, height: this.height, padding: [8, 12, 0, 0],
      legend: { show: false }, cursor: { show: false }, select: { show: true },
      scales: { x: { time: false, auto: false, range: range("x") }, y: { auto: false, range: range("y") } },
      series: [{}, { show: false }],
      axes: [{ ...axis(this.xLabel), size: 24, values, space: 64 }, { ...axis(this.yLabel), size, values: this.isLog ? powers : values, space: 34 }],
      hooks: { draw: [() => this.paint()] },
    }, [[0], [null]], this.area);
    this.crosshair = element("div", { class: "crosshair", hidden: true });
    this.plot.over.append(this.crosshair);
    this.dots = [];
    listen(this.plot.over, this.area, this);
  }

  /** Where numbers lie, in pixels of the canvas (`ratio` = device pixels) or of the page (1). */
  place(ratio) {
    const { bbox } = this.plot;
    const scale = ratio / uPlot.pxRatio;
    const [left, top, width, height] = [bbox.left * scale, bbox.top * scale, bbox.width * scale, bbox.height * scale];
    const [xScale, yScale] = [width / (this.view.x[1] - this.view.x[0]), -height / (this.view.y[1] - this.view.y[0])];
    return { left, top, width, height, xScale, xOffset: left - xScale * this.view.x[0], yScale, yOffset: top + height - yScale * this.view.y[0], isLog: this.isLog };
  }

  /** The rows of a trace that are shown. */
  rowsOf(trace) {
    if (trace.isOrdered) return rowsInWindow(trace, this.view.x);
    const rows = this.link?.rows ?? [0, Infinity];
    return [Math.max(rows[0] - trace.firstRow, 0), Math.max(Math.min(rows[1] - trace.firstRow, trace.length), 0)];
  }

  paint() {
    const ratio = uPlot.pxRatio;
    const { ctx, bbox } = this.plot;
    cancelAnimationFrame(this.slice);
    const clip = () => {
      ctx.save();
      ctx.beginPath();
      ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
      ctx.clip();
    };
    const colours = palette();
    clip();
    const marks = [ctx, this.traces[0], this.link, this.place(ratio), ratio, colours];
    if (this.kind === "history" && this.link && this.traces[0]) paintRanges(...marks);
    const more = paint(ctx, {
      kind: this.kind, traces: this.traces, window: this.view.x, place: this.place(ratio), rowsOf: (trace) => this.rowsOf(trace),
      isMoving: this.isMoving, colours, ratio,
    });
    if (this.kind === "loop" && !this.isMoving && this.link && this.traces[0]) paintMarkedRows(...marks);
    ctx.restore();
    const next = () => {
      clip();
      const isLeft = more();
      ctx.restore();
      if (isLeft) this.slice = requestAnimationFrame(next);
    };
    // The first slice comes in the next frame, after what is drawn now can be seen.
    if (more) this.slice = requestAnimationFrame(next);
    for (const swatch of this.legend.querySelectorAll("i")) swatch.style.background = colour(swatch.dataset.role, colours);
    this.mark();
  }

  // Movement.

  /** Draws in the next frame. */
  draw() {
    if (!this.plot || this.isPending) return;
    this.isPending = true;
    requestAnimationFrame(() => {
      this.isPending = false;
      if (!this.plot) return;
      if (this.isMoving && this.kind === "loop") moving.frame();
      this.plot.batch(() => {
        this.plot.setScale("x", { min: this.view.x[0], max: this.view.x[1] });
        this.plot.setScale("y", { min: this.view.y[0], max: this.view.y[1] });
      });
    });
  }
  /** Draws with little detail, and with all of it after a rest. */
  stir() {
    this.isMoving = true;
    this.draw();
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.settle(), REST);
  }
  settle() {
    clearTimeout(this.rest);
    this.isMoving = false;
    this.whole.hidden = !this.isZoomed && !this.link?.window;
    this.draw();
  }
  show(x, y) {
    const whole = this.home;
    const clipped = (axis, [low, high]) => (high - low < LEAST_WINDOW * (whole[axis][1] - whole[axis][0]) ? this.view[axis] : [low, high]);
    this.view = { x: clipped("x", x), y: clipped("y", y) };
    this.stir();
    if (!this.link) return;
    if (this.kind === "history" && this.traces[0]) {
      const isWhole = this.view.x[0] <= whole.x[0] && this.view.x[1] >= whole.x[1];
      this.link.setWindow(isWhole ? null : [...this.view.x], isWhole ? null : rowsInWindow(this.traces[0], this.view.x), this);
    } else if (this.kind === "loop") {
      clearTimeout(this.search);
      this.search = setTimeout(() => this.link.setInside(this.isZoomed && this.traces[0] ? rowsInside(this.traces[0], this.view) : [], this), 2 * REST);
    }
  }
  zoomTo(x, y) {
    const part = ([low, high], [from, to]) => [low + from * (high - low), low + to * (high - low)];
    this.show(part(this.view.x, x), part(this.view.y, y));
  }
  zoomAbout([x, y], factor) {
    const about = (share) => [share - factor * share, share + factor * (1 - share)];
    this.zoomTo(about(x), this.kind === "history" ? [0, 1] : about(y));
  }
  move(dx, dy) { this.zoomTo([dx, 1 + dx], [dy, 1 + dy]); }
  reset() {
    this.link?.reset(this);
    this.showHome();
  }
  showHome() {
    clearTimeout(this.search);
    this.view = { x: [...this.home.x], y: [...this.home.y] };
    this.stir();
  }
  /** Shows these rows and some around them. */
  showRows(from, to) {
    const [trace] = this.traces;
    const width = Math.max(3 * (to - from), 60);
    const first = Math.max(Math.floor((from + to - width) / 2), 0);
    const last = Math.min(Math.ceil((from + to + width) / 2), trace.length - 1);
    if (this.kind === "history") return this.show([trace.x[first], trace.x[last]], [...this.home.y]);
    const [left, right, low, high] = new Trace({ name: "", role: "data", x: trace.x.subarray(first, last + 1), y: trace.y.subarray(first, last + 1) }).range();
    this.view = { x: widened(left, right, 0.2), y: widened(low, high, 0.2) };
    return this.stir();
  }

  linked({ what, source }) {
    if (source === this) return;
    if (what === "row") this.mark();
    else if (what === "reset") this.showHome();
    else if (what === "window") {
      if (this.kind === "history") this.view.x = this.link.window ? [...this.link.window] : [...this.home.x];
      this.stir();
    } else this.settle();
  }

  // The pointer.

  box(shares) {
    const { over } = this.plot;
    const [width, height] = [over.clientWidth, over.clientHeight];
    if (!shares) return this.plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    const [x, y] = shares;
    const [isWide, isHigh] = [x[1] - x[0] > 0.02, y[1] - y[0] > 0.04];
    const [left, right] = isWide ? x : [0, 1];
    const [bottom, top] = isHigh ? y : [0, 1];
    return this.plot.setSelect(isWide || isHigh
      ? { left: left * width, top: (1 - top) * height, width: (right - left) * width, height: (top - bottom) * height }
      : { left: 0, top: 0, width: 0, height: 0 }, false);
  }
  hover(at) {
    const [trace] = this.traces.filter((one) => one.style !== "band");
    if (!trace || trace.length === 0) return;
    const place = this.place(1);
    let row;
    if (trace.isOrdered) {
      const x = this.view.x[0] + at[0] * (this.view.x[1] - this.view.x[0]);
      row = Math.min(firstNotBelow(trace.x, x, trace.length), trace.length - 1);
      if (row > 0 && x - trace.x[row - 1] < trace.x[row] - x) row -= 1;
    } else {
      const found = nearestRow(trace, this.rowsOf(trace), place, place.left + at[0] * place.width, place.top + (1 - at[1]) * place.height);
      if (found.distance > 60) return this.leave();
      row = found.row;
    }
    this.pointed = row + trace.firstRow;
    this.link?.setRow(this.pointed, this);
    this.mark();
  }
  leave() {
    this.pointed = null;
    this.link?.setRow(null, this);
    this.mark();
  }
  /** Dots on the curves, and their values, at the row under the pointer in this figure or a linked one. */
  mark() {
    if (!this.plot) return;
    const row = this.link ? this.link.row : this.pointed;
    const place = this.place(1);
    const traces = row === null || row === undefined ? [] : this.traces.filter((trace) => trace.style !== "band" && row >= trace.firstRow && row < trace.firstRow + trace.length);
    while (this.dots.length < traces.length) {
      this.dots.push(element("div", { class: "dot" }));
      this.plot.over.append(this.dots.at(-1));
    }
    this.dots.forEach((dot, k) => {
      const trace = traces[k];
      const at = trace && [trace.x[row - trace.firstRow], trace.y[row - trace.firstRow]];
      const [px, py] = at ? [place.xScale * at[0] + place.xOffset - place.left, yPixel(place, at[1]) - place.top] : [NaN, NaN];
      const isShown = px >= 0 && px <= place.width && py >= 0 && py <= place.height;
      dot.hidden = !isShown;
      if (!isShown) return;
      dot.style.transform = `translate(${px}px, ${py}px)`;
      dot.style.borderColor = colour(trace.role, palette());
    });
    const [first] = traces;
    this.crosshair.hidden = !first?.isOrdered;
    if (first?.isOrdered) this.crosshair.style.transform = `translateX(${place.xScale * first.x[row - first.firstRow] + place.xOffset - place.left}px)`;
    const value = (trace) => `${trace.name && traces.length > 1 ? `${trace.name} ` : ""}${written(trace.y[row - trace.firstRow], 5)}`;
    this.readout.textContent = first ? `${this.xLabel}: ${written(first.x[row - first.firstRow], 5)}; ${this.yLabel}: ${traces.slice(0, 4).map(value).join(", ")}` : "";
  }

  destroy() {
    this.link?.removeEventListener("change", this.follow);
    this.forgetColours();
    this.observer.disconnect();
    clearTimeout(this.rest);
    clearTimeout(this.search);
    cancelAnimationFrame(this.slice);
    this.plot?.destroy();
    this.plot = null;
  }
}

/** A range with a margin, never empty. */
function widened(low, high, share) {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
  const width = high - low || Math.abs(high) || 1;
  const more = high === low ? 0.5 * width : share * width;
  return [low - more, high + more];
}
