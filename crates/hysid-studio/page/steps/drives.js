// Inputs for a model: a path made by hand, and waves.

const MOST_ROWS = 20000;
const ROWS_OF_A_CYCLE = 240;

/** The path that sliders took, with points between, so that a fast motion does not jump. */
export class HandPath {
  /** @param {{ranges: [number, number][], factor: number}} options: `factor` is the cycles per unit of time of the data. */
  constructor({ ranges, factor }) {
    this.ranges = ranges;
    this.rate = factor;
    // By hand, a cycle takes about two seconds; the model's time runs so that this is the rate of the data.
    this.factor = Number((1 / (2 * factor)).toPrecision(1));
    this.values = ranges.map(([low, high]) => Math.min(Math.max(0, low), high));
    this.clear();
  }
  clear() {
    this.time = [0];
    this.inputs = this.values.map((value) => [value]);
    this.last = performance.now();
  }
  /** One slider has moved. */
  move(input, value) {
    const now = performance.now();
    // A pause counts as a short one: nobody wants an hour of waiting in the path.
    const passed = Math.min(Math.max((now - this.last) / 1000, 0.004), 1) * this.factor;
    this.last = now;
    const [low, high] = this.ranges[input];
    const steps = Math.max(1, Math.ceil(Math.abs(value - this.values[input]) / (0.005 * (high - low))));
    const [from, begin] = [this.values[input], this.time.at(-1)];
    for (let step = 1; step <= steps; step++) {
      this.time.push(begin + passed * step / steps);
      this.inputs.forEach((list, k) => list.push(k === input ? from + (value - from) * step / steps : this.values[k]));
    }
    this.values[input] = value;
    const excess = this.time.length - MOST_ROWS;
    if (excess > 0) [this.time, ...this.inputs].forEach((list) => list.splice(0, excess));
  }
  path() { return { time: Float64Array.from(this.time), inputs: this.inputs.map((list) => Float64Array.from(list)) }; }
}

const FORMS = {
  sine: (phase) => Math.sin(2 * Math.PI * phase),
  triangle: (phase) => 2 / Math.PI * Math.asin(Math.sin(2 * Math.PI * phase)),
  decaying: (phase, share) => (1 - share) * Math.sin(2 * Math.PI * phase),
  growing: (phase, share) => share * Math.sin(2 * Math.PI * phase),
};

/** A wave of the first input; the others are held. */
export function drivenBy({ form, middle, amplitude, rate, cycles, others }) {
  const rows = Math.min(MOST_ROWS, cycles * ROWS_OF_A_CYCLE + 1);
  const time = new Float64Array(rows);
  const input = new Float64Array(rows);
  for (let row = 0; row < rows; row++) {
    const share = row / (rows - 1);
    time[row] = share * cycles / rate;
    input[row] = middle + amplitude * FORMS[form](share * cycles, share);
  }
  return { time, inputs: [input, ...others.map((value) => new Float64Array(rows).fill(value))] };
}
