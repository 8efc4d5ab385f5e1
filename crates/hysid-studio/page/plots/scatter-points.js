// Dots of a scatter diagram: at most one in each square of two pixels, so that their number is bounded by the picture.

import { yPixel } from "./points.js";

const SQUARE = 2;

/**
 * @param {import("./trace.js").Trace} trace
 * @param {[number, number]} rows
 * @param {import("./points.js").Place} place
 * @param {import("./points.js").Points} points
 * @param {number} stride: every how many rows are looked at.
 */
export function scatterPoints(trace, rows, place, points, stride) {
  points.clear();
  const columns = Math.ceil(place.width / SQUARE) + 1;
  const lines = Math.ceil(place.height / SQUARE) + 1;
  const taken = new Uint8Array(columns * lines);
  const end = Math.min(rows[1], trace.length);
  for (let row = Math.max(rows[0], 0); row < end; row += stride) {
    const px = place.xScale * trace.x[row] + place.xOffset;
    const py = yPixel(place, trace.y[row]);
    const column = Math.floor((px - place.left) / SQUARE);
    const line = Math.floor((py - place.top) / SQUARE);
    if (!(column >= 0 && column < columns && line >= 0 && line < lines)) continue;
    const at = line * columns + column;
    if (taken[at]) continue;
    taken[at] = 1;
    points.add(px, py);
  }
}
