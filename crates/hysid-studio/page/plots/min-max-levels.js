// The smallest and the largest of each 8, 64, 512 ... numbers, so that a picture of a million rows reads a few thousand.

const FACTOR = 8;

export class MinMaxLevels {
  /** @param {Float64Array} values */
  constructor(values) {
    this.values = values;
    this.levels = [];
    let [low, high] = [values, values];
    while (low.length > FACTOR) {
      const count = Math.ceil(low.length / FACTOR);
      const nextLow = new Float64Array(count);
      const nextHigh = new Float64Array(count);
      for (let block = 0; block < count; block++) {
        const end = Math.min((block + 1) * FACTOR, low.length);
        let [least, most] = [Infinity, -Infinity];
        for (let k = block * FACTOR; k < end; k++) {
          // Comparisons with NaN are false: missing numbers are passed over.
          if (low[k] < least) least = low[k];
          if (high[k] > most) most = high[k];
        }
        nextLow[block] = least;
        nextHigh[block] = most;
      }
      this.levels.push({ low: nextLow, high: nextHigh, rows: FACTOR ** (this.levels.length + 1) });
      [low, high] = [nextLow, nextHigh];
    }
  }

  /** The finest level whose blocks have at most so many rows; null for the rows themselves. */
  levelFor(rows) {
    let found = null;
    for (const level of this.levels) if (level.rows <= rows) found = level;
    return found;
  }

  /** [smallest, largest] of all numbers. */
  range() {
    const top = this.levels.at(-1) ?? { low: this.values, high: this.values };
    let [least, most] = [Infinity, -Infinity];
    for (let k = 0; k < top.low.length; k++) {
      if (top.low[k] < least) least = top.low[k];
      if (top.high[k] > most) most = top.high[k];
    }
    return [least, most];
  }
}
