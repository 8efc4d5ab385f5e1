// Numbers that are drawn, as x and y in pixels one after the other; NaN ends a line. The array grows and is used again.

export class Points {
  constructor() {
    this.values = new Float64Array(1 << 14);
    this.length = 0;
  }
  clear() { this.length = 0; }
  add(x, y) {
    if (this.length + 2 > this.values.length) {
      const larger = new Float64Array(2 * this.values.length);
      larger.set(this.values);
      this.values = larger;
    }
    this.values[this.length] = x;
    this.values[this.length + 1] = y;
    this.length += 2;
  }
  /** Ends the line, if one has begun. */
  lift() {
    if (this.length > 0 && !Number.isNaN(this.values[this.length - 1])) this.add(NaN, NaN);
  }
}

/**
 * Where numbers lie on a figure: pixel = scale * number + offset; `isLog` for a logarithmic vertical axis.
 * @typedef {{xScale: number, xOffset: number, yScale: number, yOffset: number, left: number, top: number, width: number,
 *   height: number, isLog: boolean}} Place
 */

/** The vertical pixel of a number. */
export const yPixel = (place, y) => place.yScale * (place.isLog ? Math.log10(y) : y) + place.yOffset;

/** The first row whose number is not below the value, in numbers that grow. */
export function firstNotBelow(numbers, value, length = numbers.length) {
  let [low, high] = [0, length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}
