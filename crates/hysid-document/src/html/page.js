// Figures of a page: zoom, read values, follow a moment through all figures, select a cycle, save. A page without
// scripts shows the same figures. The points are read back from the drawings.
(() => {
  "use strict";
  const NS = "http://www.w3.org/2000/svg";
  const FINE = 4; // Units of a drawing in a pixel.
  const figures = [];
  let selected = null; // The cycle that is shown in front of the others.
  let printing = false;

  const node = (name, attributes = {}, text = "") => {
    const made = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.textContent = text;
    return made;
  };
  const html = (name, properties = {}) => Object.assign(document.createElement(name), properties);
  const numbers = (text) => (text ? text.trim().split(/[ ,]+/).map(Number) : []);
  const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

  // A number with so many significant digits.
  function written(value, digits = 4) {
    if (!Number.isFinite(value)) return "";
    if (value === 0) return "0";
    const exponent = Math.floor(Math.log10(Math.abs(value)));
    const text = exponent < -4 || exponent >= 6 ? Number(value.toPrecision(digits)).toExponential() : String(Number(value.toPrecision(digits)));
    return text.replace("-", "\u2212");
  }

  // An axis: its range at first and now, in powers of ten where it is logarithmic.
  class Axis {
    constructor(range, label) {
      const [low, high] = numbers(range.replace("log", ""));
      this.home = [low, high];
      this.log = range.includes("log");
      this.label = label;
      this.reset();
    }
    reset() { [this.low, this.high] = this.home; }
    get zoomed() { return this.low !== this.home[0] || this.high !== this.home[1]; }
    inner(value) { return this.log ? Math.log10(Math.max(value, 1e-300)) : value; }
    outer(value) { return this.log ? 10 ** value : value; }
    share(value) { return (this.inner(value) - this.low) / (this.high - this.low); }
    at(share) { return this.outer(this.low + share * (this.high - this.low)); }
    homeAt(share) { return this.outer(this.home[0] + share * (this.home[1] - this.home[0])); }
    // Shows this part of what is shown now, by shares.
    show(from, to) {
      const width = this.high - this.low;
      const least = 1e-4 * (this.home[1] - this.home[0]);
      if ((to - from) * width < least) return;
      [this.low, this.high] = [this.low + from * width, this.low + to * width];
    }
    // Round numbers and their texts: powers of ten, with 2 and 5 between few of them, on a logarithmic axis.
    ticks(count) {
      if (this.log && this.high - this.low > 0.5) {
        const between = this.high - this.low < 2.5 ? [1, 2, 5] : [1];
        const every = Math.max(Math.ceil((this.high - this.low) / Math.max(count, 2)), 1);
        const made = [];
        for (let power = Math.floor(this.low); power <= this.high; power++) {
          if (power % every === 0) made.push(...between.map((factor) => factor * 10 ** power));
        }
        return made.map((value) => [Math.log10(value), written(value, 3)]).filter(([at]) => at >= this.low && at <= this.high);
      }
      const rough = (this.high - this.low) / Math.max(count, 2);
      const power = 10 ** Math.floor(Math.log10(rough));
      const step = power * [1, 2, 5, 10].find((factor) => factor * power >= 0.7 * rough);
      const made = [];
      for (let k = Math.ceil(this.low / step); k * step <= this.high && made.length < 60; k++) made.push(k * step);
      const decimals = clamp(Math.ceil(-Math.log10(step) - 1e-9), 0, 12);
      const plain = step >= 1e-4 && Math.abs(this.high) < 1e6 && Math.abs(this.low) < 1e6;
      return made.map((value) => {
        const shown = Math.abs(value) < 1e-9 * step ? 0 : value;
        const text = this.log ? written(10 ** shown, 3) : plain ? shown.toFixed(decimals).replace("-", "\u2212") : written(shown, 6);
        return [value, text];
      });
    }
  }

  // A line, an area or dots, with its points in the units of the axes.
  class Curve {
    constructor(group, figure) {
      this.group = group;
      this.name = group.dataset.name || "";
      this.record = group.dataset.record;
      this.times = group.dataset.times ? Float64Array.from(numbers(group.dataset.times)) : null;
      this.cycles = numbers(group.dataset.cycles);
      this.pieces = [...group.children].map((element) => {
        const drawn = element.points === undefined
          ? [Number(element.getAttribute("cx")), Number(element.getAttribute("cy"))]
          : numbers(element.getAttribute("points"));
        return { element, points: Float64Array.from(drawn, (value, k) => figure.read(value, k % 2)) };
      });
      const all = this.pieces.flatMap((piece) => [...piece.points]);
      this.x = Float64Array.from(all.filter((_, k) => k % 2 === 0));
      this.y = Float64Array.from(all.filter((_, k) => k % 2 === 1));
      this.isArea = this.pieces.some((piece) => piece.element.localName === "polygon");
    }
    get time() { return this.times || this.x; }
    draw(figure) {
      for (const { element, points } of this.pieces) {
        const placed = figure.placed(points);
        if (element.localName === "circle") {
          element.setAttribute("cx", placed[0]);
          element.setAttribute("cy", placed[1]);
        } else element.setAttribute("points", placed.join(" "));
      }
    }
    // The point nearest to a time, if there is one in the record at all.
    atTime(time) {
      const times = this.time;
      if (times.length === 0 || this.isArea) return -1;
      let [low, high] = [0, times.length - 1];
      while (low < high) {
        const middle = (low + high) >> 1;
        if (times[middle] < time) low = middle + 1; else high = middle;
      }
      return low > 0 && time - times[low - 1] < times[low] - time ? low - 1 : low;
    }
    // The parts of its pieces between two times.
    between(from, to) {
      let first = 0;
      return this.pieces.map(({ element, points }) => {
        const kept = [];
        for (let k = 0; k < points.length; k += 2, first++) {
          if (this.time[first] >= from && this.time[first] <= to) kept.push(points[k], points[k + 1]);
        }
        return { element, kept };
      });
    }
  }

  class Figure {
    constructor(svg) {
      this.svg = svg;
      this.figure = svg.parentElement;
      this.place = this.homePlace = numbers(svg.dataset.place);
      this.size = [svg.viewBox.baseVal.width / FINE, svg.viewBox.baseVal.height / FINE];
      this.axes = [new Axis(svg.dataset.x, svg.dataset.xLabel), new Axis(svg.dataset.y, svg.dataset.yLabel)];
      this.frame = svg.querySelector("g.frame");
      this.inner = svg.querySelector("svg.curves");
      this.labels = [...svg.children].filter((child) => child.localName === "text").map((element) => (
        { element, x: this.read(Number(element.getAttribute("x")), 0), y: this.read(Number(element.getAttribute("y")), 1) }));
      this.curves = [...this.inner.querySelectorAll("g.curve")].map((group) => new Curve(group, this));
      // Time is along the horizontal axis of all of them, or of none.
      this.overTime = this.curves.some((curve) => curve.record !== undefined && !curve.times);
      this.marks = node("g", { class: "marks" });
      this.inner.append(this.marks);
      this.legend();
      this.tools();
      this.listen();
      new ResizeObserver(() => this.fit()).observe(this.figure);
    }

    // On a screen much narrower than the drawing, the figure is laid out for that width, so that its text stays legible.
    fit() {
      const room = this.figure.clientWidth;
      this.lay(!printing && room > 0 && room < 0.8 * this.size[0] ? room : 0);
    }
    lay(width) {
      if ((this.width || 0) === width) return;
      this.width = width;
      const [wide, high] = width ? [width, Math.min(this.size[1], 0.85 * width)] : this.size;
      const [left] = this.homePlace;
      this.place = width ? [left, 8 * FINE, (wide - 14) * FINE - left, (high - 8 - 42) * FINE] : this.homePlace;
      this.svg.setAttribute("viewBox", `0 0 ${wide * FINE} ${high * FINE}`);
      const [x, y, w, h] = this.place;
      for (const [name, value] of Object.entries({ x, y, width: w, height: h, viewBox: this.place.join(" ") })) {
        this.inner.setAttribute(name, value);
      }
      this.figure.classList.toggle("fitted", width > 0);
      this.draw();
    }
    // Title and legend of a figure that is laid out for a narrow screen.
    legend() {
      const title = this.svg.dataset.title ? [html("b", { textContent: this.svg.dataset.title })] : [];
      const names = new Map();
      for (const { name, pieces } of this.curves) if (name && pieces.length > 0) names.set(name, pieces[0].element);
      const entries = [...names].map(([name, element]) => {
        const sample = node("svg", { class: "plot", viewBox: "0 0 72 40" });
        const colour = element.hasAttribute("stroke") ? element.getAttribute("stroke") : element.getAttribute("fill");
        sample.append(node("line", { x1: 0, x2: 72, y1: 20, y2: 20, stroke: colour, "stroke-width": element.getAttribute("stroke-width") || 28 }));
        const entry = html("span");
        entry.append(sample, name);
        return entry;
      });
      const line = html("div", { className: "legend" });
      line.append(...title, ...entries);
      this.figure.prepend(line);
    }

    // Reading the drawing, and writing it again.
    read(value, axis) {
      const [left, top, width, height] = this.place;
      const share = axis === 0 ? (value - left) / width : 1 - (value - top) / height;
      return this.axes[axis].homeAt(share);
    }
    spot(x, y) {
      const [left, top, width, height] = this.place;
      return [left + width * this.axes[0].share(x), top + height * (1 - this.axes[1].share(y))];
    }
    placed(points) {
      const made = new Array(points.length);
      for (let k = 0; k < points.length; k += 2) {
        const [x, y] = this.spot(points[k], points[k + 1]);
        made[k] = clamp(x, -1e6, 1e6).toFixed(1);
        made[k + 1] = clamp(y, -1e6, 1e6).toFixed(1);
      }
      return made;
    }
    get zoomed() { return this.axes.some((axis) => axis.zoomed); }
    draw() {
      this.curves.forEach((curve) => curve.draw(this));
      this.drawAxes();
      this.back.hidden = !this.zoomed;
      for (const { element, x, y } of this.labels) {
        const isInside = this.axes[0].share(x) >= 0 && this.axes[0].share(x) <= 1 && this.axes[1].share(y) >= 0 && this.axes[1].share(y) <= 1;
        const [left, top] = this.spot(x, y);
        element.setAttribute("x", left.toFixed(1));
        element.setAttribute("y", top.toFixed(1));
        element.style.display = isInside || !this.zoomed ? "" : "none";
      }
      this.drawCycle();
      this.marks.replaceChildren();
    }
    // The axes of what is shown now, in the place of those of the drawing.
    drawAxes() {
      if (this.own) this.own.remove();
      const isOwn = this.zoomed || this.width > 0;
      this.frame.style.display = isOwn ? "none" : "";
      if (!isOwn) return;
      const [left, top, width, height] = this.place;
      const [right, bottom] = [left + width, top + height];
      const size = FINE * 13;
      const line = (x1, y1, x2, y2, colour, thick) => node("line", { x1, y1, x2, y2, stroke: colour, "stroke-width": thick });
      const text = (x, y, words, anchor, more = {}) =>
        node("text", { x, y, "text-anchor": anchor, "font-size": size, fill: "#111111", ...more }, words);
      this.own = node("g");
      for (const [value, words] of this.axes[0].ticks(width / FINE / 90)) {
        const x = left + width * ((value - this.axes[0].low) / (this.axes[0].high - this.axes[0].low));
        this.own.append(line(x, top, x, bottom, "#DDDDDD", 3), text(x, bottom + 1.5 * size, words, "middle"));
      }
      for (const [value, words] of this.axes[1].ticks(height / FINE / 36)) {
        const y = bottom - height * ((value - this.axes[1].low) / (this.axes[1].high - this.axes[1].low));
        this.own.append(line(left, y, right, y, "#DDDDDD", 3), text(left - 0.6 * size, y + 0.35 * size, words, "end"));
      }
      const middle = top + height / 2;
      this.own.append(
        line(left, bottom, right, bottom, "#111111", 4), line(left, top, left, bottom, "#111111", 4),
        text(left + width / 2, bottom + 2.8 * size, this.axes[0].label, "middle"),
        text(1.2 * size, middle, this.axes[1].label, "middle", { transform: `rotate(-90 ${1.2 * size} ${middle})` }));
      // Title and legend or colour bar stay; on a narrow screen they are above the figure.
      for (const child of this.width ? [] : this.frame.children) {
        if (Number(child.getAttribute("y")) < top - 0.2 * size && child.localName === "text"
          || child.localName === "polyline" && numbers(child.getAttribute("points"))[1] < top - 1
          || child.matches("g.bar")) {
          this.own.append(child.cloneNode(true));
        }
      }
      this.svg.insertBefore(this.own, this.inner);
    }

    // Where the pointer is: shares of the place of the curves, from the left and from below.
    shares(event) {
      const area = this.svg.getBoundingClientRect();
      const view = this.svg.viewBox.baseVal;
      const [left, top, width, height] = this.place;
      const x = (event.clientX - area.left) * view.width / area.width;
      const y = (event.clientY - area.top) * view.height / area.height;
      return [(x - left) / width, 1 - (y - top) / height];
    }
    zoom(x, y) {
      this.axes[0].show(...x);
      this.axes[1].show(...y);
      this.changed();
    }
    reset() {
      this.axes.forEach((axis) => axis.reset());
      this.changed();
    }
    // Figures over time below each other show the same times.
    changed() {
      this.draw();
      if (!this.overTime) return;
      for (const other of figures) {
        if (other === this || !other.overTime || other.record !== this.record) continue;
        [other.axes[0].low, other.axes[0].high] = [this.axes[0].low, this.axes[0].high];
        other.draw();
      }
    }
    get record() { return (this.curves.find((curve) => curve.record !== undefined) || {}).record; }

    listen() {
      const { svg } = this;
      svg.setAttribute("tabindex", "0");
      let begin = null;
      let last = null;
      const box = node("rect", { class: "box" });
      const touches = new Map();
      const isInside = ([x, y]) => x >= 0 && x <= 1 && y >= 0 && y <= 1;
      svg.addEventListener("pointerdown", (event) => {
        const at = this.shares(event);
        touches.set(event.pointerId, at);
        if (event.pointerType === "touch" || event.button !== 0 || !isInside(at)) return;
        begin = last = at;
        svg.setPointerCapture(event.pointerId);
        event.preventDefault();
        svg.focus({ preventScroll: true });
      });
      svg.addEventListener("pointermove", (event) => {
        const at = this.shares(event);
        if (event.pointerType === "touch" && touches.size === 2) return this.pinch(touches, event.pointerId, at);
        if (!begin) return isInside(at) ? this.hover(at) : leave();
        if (event.shiftKey) {
          const [dx, dy] = [last[0] - at[0], last[1] - at[1]];
          this.zoom([dx, 1 + dx], [dy, 1 + dy]);
          last = at;
          begin = at;
          return undefined;
        }
        const [left, top, width, height] = this.place;
        const [x1, x2] = [begin[0], clamp(at[0], 0, 1)].sort((a, b) => a - b);
        const [y1, y2] = [begin[1], clamp(at[1], 0, 1)].sort((a, b) => a - b);
        const attributes = { x: left + width * x1, y: top + height * (1 - y2), width: width * (x2 - x1), height: height * (y2 - y1) };
        for (const [key, value] of Object.entries(attributes)) box.setAttribute(key, value);
        this.inner.append(box);
        return undefined;
      });
      const end = (event) => {
        touches.delete(event.pointerId);
        box.remove();
        if (!begin) return;
        const at = this.shares(event).map((share) => clamp(share, 0, 1));
        const [x, y] = [0, 1].map((k) => [begin[k], at[k]].sort((a, b) => a - b));
        begin = null;
        // A click is no zoom; a flat or narrow box shows all of the other axis.
        const [wide, high] = [x[1] - x[0] > 0.02, y[1] - y[0] > 0.04];
        if (!event.shiftKey && (wide || high)) this.zoom(wide ? x : [0, 1], high ? y : [0, 1]);
      };
      svg.addEventListener("pointerup", end);
      svg.addEventListener("pointercancel", (event) => { touches.delete(event.pointerId); begin = null; box.remove(); });
      svg.addEventListener("pointerleave", () => { if (!begin) leave(); });
      svg.addEventListener("dblclick", () => this.reset());
      svg.addEventListener("wheel", (event) => {
        if (!event.ctrlKey && !event.metaKey) return;
        event.preventDefault();
        const at = this.shares(event);
        const factor = Math.exp(clamp(event.deltaY, -100, 100) / 300);
        this.zoom(...at.map((share) => [share - factor * share, share + factor * (1 - share)]));
      }, { passive: false });
      svg.addEventListener("keydown", (event) => {
        const step = 0.2;
        const steps = {
          "+": [[0.1, 0.9], [0.1, 0.9]], "=": [[0.1, 0.9], [0.1, 0.9]], "-": [[-0.125, 1.125], [-0.125, 1.125]],
          ArrowLeft: [[-step, 1 - step], [0, 1]], ArrowRight: [[step, 1 + step], [0, 1]],
          ArrowDown: [[0, 1], [-step, 1 - step]], ArrowUp: [[0, 1], [step, 1 + step]],
        };
        const key = event.key;
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        if (key === "0" || key === "Escape") this.reset();
        else if (steps[key] && (this.zoomed || !key.startsWith("Arrow"))) this.zoom(...steps[key]);
        else return;
        event.preventDefault();
      });
    }
    pinch(touches, id, at) {
      const before = touches.get(id);
      const other = [...touches.entries()].find(([key]) => key !== id)[1];
      touches.set(id, at);
      if (!before || !other) return;
      const spread = (axis) => {
        const [old, now] = [Math.abs(before[axis] - other[axis]), Math.abs(at[axis] - other[axis])];
        if (old < 0.1 || now < 0.1) return [0, 1];
        const factor = clamp(old / now, 0.8, 1.25);
        return [other[axis] - factor * other[axis], other[axis] + factor * (1 - other[axis])];
      };
      this.zoom(spread(0), spread(1));
      touches.forEach((_, key) => { if (key !== id) touches.set(key, other); });
    }

    // The point of a curve nearest to the pointer.
    hover(at) {
      const [left, top, width, height] = this.place;
      const [x, y] = [left + width * at[0], top + height * (1 - at[1])];
      let best = { distance: Infinity };
      for (const curve of this.curves) {
        if (curve.isArea) continue;
        for (let k = 0; k < curve.x.length; k++) {
          const [px, py] = this.spot(curve.x[k], curve.y[k]);
          const distance = this.overTime ? Math.abs(px - x) : Math.hypot(px - x, py - y);
          if (distance < best.distance) best = { distance, curve, k };
        }
      }
      if (!best.curve || !this.overTime && best.distance > FINE * 60) return leave();
      if (best.curve.record === undefined) {
        leave();
        this.mark([[best.curve, best.k]]);
        return undefined;
      }
      const time = best.curve.time[best.k];
      figures.forEach((figure) => figure.follow(best.curve.record, time));
      return undefined;
    }
    // Marks the points at a time of a record.
    follow(record, time) {
      const found = this.curves.filter((curve) => curve.record === record).map((curve) => [curve, curve.atTime(time)]);
      this.mark(found.filter(([, k]) => k >= 0), time);
    }
    mark(points, time) {
      this.marks.replaceChildren();
      this.readout.textContent = "";
      if (points.length === 0) return;
      const [, top, , height] = this.place;
      if (this.overTime) {
        const [x] = this.spot(time, 0);
        this.marks.append(node("line", { class: "cursor", x1: x, x2: x, y1: top, y2: top + height }));
      }
      for (const [curve, k] of points) {
        const [cx, cy] = this.spot(curve.x[k], curve.y[k]);
        this.marks.append(node("circle", { class: "cursor", cx, cy, r: FINE * 4 }));
      }
      const value = ([curve, k]) => `${curve.name ? `${curve.name} ` : ""}${written(curve.y[k])}`;
      const [first, k] = points[0];
      this.readout.textContent = `${this.axes[0].label}: ${written(first.x[k])}; ${this.axes[1].label}: ${points.map(value).join(", ")}`;
    }

    // The selected cycle in front of all others, which are pale; in figures over time, its times.
    drawCycle() {
      if (this.cycle) this.cycle.remove();
      this.inner.classList.toggle("pale", Boolean(selected) && !this.overTime && this.curves.some((curve) => curve.record === selected.record));
      if (!selected) return;
      const { record, from, to } = selected;
      this.cycle = node("g");
      const [, top, , height] = this.place;
      if (this.overTime && this.record === record) {
        const [x1] = this.spot(from, 0);
        const [x2] = this.spot(to, 0);
        this.cycle.append(node("rect", { class: "times", x: x1, y: top, width: Math.max(x2 - x1, 1), height }));
        this.inner.prepend(this.cycle);
        return;
      }
      for (const curve of this.curves) {
        if (curve.record !== record || curve.isArea || this.overTime) continue;
        for (const { element, kept } of curve.between(from, to)) {
          if (kept.length < 4) continue;
          const shown = element.cloneNode(false);
          shown.setAttribute("points", this.placed(kept).join(" "));
          this.cycle.append(shown);
        }
      }
      this.inner.insertBefore(this.cycle, this.marks);
    }

    tools() {
      const bar = html("div", { className: "tools" });
      const button = (text, title, action) => {
        const made = html("button", { type: "button", textContent: text, title });
        made.addEventListener("click", action);
        bar.append(made);
        return made;
      };
      this.back = button("Whole figure", "Show the whole figure again (double-click, or 0)", () => this.reset());
      this.back.hidden = true;
      this.cycleTool(bar);
      this.readout = html("output");
      bar.append(this.readout);
      const save = html("span", { className: "save", textContent: "Save " });
      bar.append(save);
      for (const [name, title, action] of [
        ["SVG", "Save the figure as a drawing", () => this.save("svg")],
        ["PNG", "Save the figure as a picture", () => this.save("png")],
        ["CSV", "Save the points of the curves as a table", () => this.save("csv")],
      ]) save.append(button(name, title, action));
      this.figure.append(bar);
    }
    // All cycles of the records of this figure, one after the other.
    cycleTool(bar) {
      const records = new Map();
      for (const curve of this.overTime ? [] : this.curves) {
        if (curve.cycles.length > 1) records.set(curve.record, curve.cycles);
      }
      const all = [...records].flatMap(([record, cycles]) =>
        cycles.slice(1).map((to, k) => ({ record, from: cycles[k], to, number: k + 1, count: cycles.length - 1 })));
      if (all.length < 2) return;
      const label = html("label", { className: "cycle" });
      const slider = html("input", { type: "range", min: 0, max: all.length, value: 0 });
      const words = html("span", { textContent: "all cycles" });
      label.append("Cycle ", slider, words);
      slider.setAttribute("aria-label", "cycle");
      slider.addEventListener("input", () => {
        selected = all[slider.value - 1] || null;
        const of = selected && records.size > 1 ? `, ${selected.record.split("\u001f").pop()}` : "";
        words.textContent = selected ? `${selected.number} of ${selected.count}${of}` : "all cycles";
        slider.setAttribute("aria-valuetext", words.textContent);
        figures.forEach((figure) => figure.drawCycle());
      });
      bar.append(label);
    }

    // A copy in the colours of a light page, with nothing left to a style sheet.
    copy() {
      this.lay(0);
      const copy = this.svg.cloneNode(true);
      this.fit();
      copy.classList.add("light");
      copy.querySelectorAll(".marks").forEach((marks) => marks.remove());
      Object.assign(copy.style, { position: "fixed", left: "-9999px" });
      document.body.append(copy);
      for (const element of copy.querySelectorAll("*")) {
        const style = getComputedStyle(element);
        if (style.display === "none") element.setAttribute("display", "none");
        for (const property of ["stroke", "fill", "opacity", "font-family"]) {
          if (property === "opacity" || property === "font-family" ? element.closest("text, .pale") : element.hasAttribute(property) || element.localName === "text") {
            element.setAttribute(property, style.getPropertyValue(property));
          }
        }
        for (const name of ["data-name", "data-record", "data-times", "data-cycles", "style"]) element.removeAttribute(name);
      }
      copy.remove();
      const view = copy.viewBox.baseVal;
      copy.removeAttribute("style");
      copy.removeAttribute("tabindex");
      copy.setAttribute("width", view.width / FINE);
      copy.setAttribute("height", view.height / FINE);
      copy.prepend(node("rect", { x: 0, y: 0, width: view.width, height: view.height, fill: "#ffffff" }));
      return new XMLSerializer().serializeToString(copy);
    }
    table() {
      const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
      const decimals = this.axes.map((axis) => clamp(Math.ceil(6 - Math.log10(axis.home[1] - axis.home[0])), 0, 15));
      const number = (value, axis) => (this.axes[axis].log ? value.toPrecision(6) : String(Number(value.toFixed(decimals[axis]))));
      const rows = [["record", "curve", ...this.axes.map((axis) => axis.label)].map(quoted).join(",")];
      for (const curve of this.curves) {
        const record = (curve.record || "").split("\u001f").pop();
        curve.x.forEach((x, k) => rows.push([quoted(record), quoted(curve.name), number(x, 0), number(curve.y[k], 1)].join(",")));
      }
      return `${rows.join("\n")}\n`;
    }
    async save(kind) {
      const words = `${document.title} ${this.svg.getAttribute("aria-label")}`;
      const name = words.normalize("NFKD").replace(/[^A-Za-z0-9]+/g, "-").replace(/^-|-$/g, "").slice(0, 80).toLowerCase();
      if (kind === "csv") return download(new Blob([this.table()], { type: "text/csv" }), `${name}.csv`);
      const drawing = new Blob([this.copy()], { type: "image/svg+xml" });
      if (kind === "svg") return download(drawing, `${name}.svg`);
      const view = this.svg.viewBox.baseVal;
      const canvas = html("canvas", { width: 3 * view.width / FINE, height: 3 * view.height / FINE });
      const picture = new Image();
      const address = URL.createObjectURL(drawing);
      await new Promise((done, failed) => Object.assign(picture, { onload: done, onerror: failed, src: address }));
      canvas.getContext("2d").drawImage(picture, 0, 0, canvas.width, canvas.height);
      URL.revokeObjectURL(address);
      return canvas.toBlob((blob) => download(blob, `${name}.png`), "image/png");
    }
  }

  for (const [name, is] of [["beforeprint", true], ["afterprint", false]]) {
    addEventListener(name, () => { printing = is; figures.forEach((figure) => figure.fit()); });
  }
  function leave() { figures.forEach((figure) => { figure.marks.replaceChildren(); figure.readout.textContent = ""; }); }
  function download(blob, name) {
    const link = html("a", { href: URL.createObjectURL(blob), download: name });
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  for (const svg of document.querySelectorAll("figure > svg.plot[data-place]")) figures.push(new Figure(svg));
  if (figures.length > 0) {
    const touch = matchMedia("(pointer: coarse)").matches;
    const words = touch
      ? "In a figure: spread two fingers to zoom, double-tap to reset."
      : "In a figure: drag to zoom, Shift-drag to move, double-click to reset. Keys: + \u2212 0 and arrows.";
    figures[0].figure.closest("section, main").querySelector("h2, h1").after(html("p", { className: "note hint", textContent: words }));
  }
})();
