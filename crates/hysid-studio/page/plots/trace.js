// A curve of a figure: arrays with one number a row, read where they lie and never copied.

import { MinMaxLevels } from "./min-max-levels.js";

const CHUNK = 256; // Rows with one box around them.

/**
 * @typedef {object} TraceOptions
 * @property {string} name
 * @property {string} role: its colour, see palette.js.
 * @property {"line" | "thin" | "wide" | "band" | "points"} [style]
 * @property {Float64Array} x
 * @property {Float64Array} y: for a band its lower limit.
 * @property {Float64Array} [high]: the upper limit of a band.
 * @property {number} [firstRow]: row of the file that the first number belongs to.
 * @property {number[]} [breaks]: rows of the arrays at which a new record begins.
 */
export class Trace {
  /** @param {TraceOptions} options */
  constructor({ name, role, style = "line", x, y, high = null, firstRow = 0, breaks = [] }) {
    Object.assign(this, { name, role, style, x, y, high, firstRow });
    this.length = Math.min(x.length, y.length);
    this.breaks = breaks.filter((row) => row > 0 && row < this.length);
  }

  /** Minima and maxima of blocks of rows, of the lower or of the upper limit. */
  levels(values) {
    this.levelsOf ??= new Map();
    if (!this.levelsOf.has(values)) this.levelsOf.set(values, new MinMaxLevels(values));
    return this.levelsOf.get(values);
  }

  /** [lowest x, highest x, lowest y, highest y] of all rows. */
  range() {
    const [low, high] = this.levels(this.y).range();
    const top = this.high ? this.levels(this.high).range()[1] : high;
    const [left, right] = this.isOrdered ? [this.x[0], this.x[this.length - 1]] : this.levels(this.x).range();
    return [left, right, Math.min(low, top), Math.max(high, top)];
  }

  /** Boxes around each 256 rows and the row after them: four numbers a box. */
  boxes() {
    if (this.boxesMade) return this.boxesMade;
    const count = Math.ceil(this.length / CHUNK);
    const boxes = new Float64Array(4 * count);
    const { x, y, length } = this;
    for (let chunk = 0; chunk < count; chunk++) {
      let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
      const end = Math.min((chunk + 1) * CHUNK + 1, length);
      for (let row = chunk * CHUNK; row < end; row++) {
        const a = x[row];
        const b = y[row];
        if (a < left) left = a;
        if (a > right) right = a;
        if (b < low) low = b;
        if (b > high) high = b;
      }
      boxes.set([left, right, low, high], 4 * chunk);
    }
    this.boxesMade = boxes;
    return boxes;
  }
}

Trace.CHUNK = CHUNK;
