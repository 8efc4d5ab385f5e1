// Points of a curve over time: every row where there are few, else the minimum and the maximum of each pixel.

import { firstNotBelow, yPixel } from "./points.js";

const ROWS_OF_A_PIXEL = 5; // Up to so many rows a pixel, all of them are drawn.

/** The rows [from, to) that are in the window, and one more on either side, so that lines reach the edges. */
export function rowsBetween(trace, from, to) {
  const first = firstNotBelow(trace.x, from, trace.length);
  const last = firstNotBelow(trace.x, to, trace.length);
  return [Math.max(first - 1, 0), Math.min(last + 1, trace.length)];
}

/**
 * @param {import("./trace.js").Trace} trace
 * @param {Float64Array} values: `trace.y`, or one limit of a band.
 * @param {[number, number]} window: of x.
 * @param {import("./points.js").Place} place
 * @param {import("./points.js").Points} points
 * @param {"both" | "low" | "high"} side: a band needs one side of each pixel only.
 */
export function historyPoints(trace, values, window, place, points, side = "both") {
  points.clear();
  const [from, to] = rowsBetween(trace, window[0], window[1]);
  const { x } = trace;
  const perPixel = (to - from) / Math.max(place.width, 1);
  let nextBreak = trace.breaks.findIndex((row) => row > from);
  if (perPixel < ROWS_OF_A_PIXEL) {
    for (let row = from; row < to; row++) {
      if (nextBreak >= 0 && row === trace.breaks[nextBreak]) {
        points.lift();
        nextBreak = nextBreak + 1 < trace.breaks.length ? nextBreak + 1 : -1;
      }
      const value = values[row];
      if (Number.isNaN(value)) points.lift();
      else points.add(place.xScale * x[row] + place.xOffset, yPixel(place, value));
    }
    return;
  }
  // Buckets begin at multiples of their rows, so that the curve does not flicker while it is moved.
  const level = trace.levels(values).levelFor(perPixel) ?? { low: values, high: values, rows: 1 };
  const blocks = Math.max(1, Math.ceil(perPixel / level.rows));
  const rows = blocks * level.rows;
  let last = 0;
  for (let start = Math.floor(from / rows) * rows; start < to; start += rows) {
    const firstBlock = start / level.rows;
    const end = Math.min(firstBlock + blocks, level.low.length);
    let [least, most] = [Infinity, -Infinity];
    for (let block = firstBlock; block < end; block++) {
      if (level.low[block] < least) least = level.low[block];
      if (level.high[block] > most) most = level.high[block];
    }
    if (nextBreak >= 0 && start + rows > trace.breaks[nextBreak]) {
      points.lift();
      while (nextBreak >= 0 && start + rows > trace.breaks[nextBreak]) nextBreak = nextBreak + 1 < trace.breaks.length ? nextBreak + 1 : -1;
    }
    if (least > most) {
      points.lift();
      continue;
    }
    const at = (share) => place.xScale * x[Math.min(start + Math.floor(share * rows), trace.length - 1)] + place.xOffset;
    if (side === "low") points.add(at(0.5), yPixel(place, least));
    else if (side === "high") points.add(at(0.5), yPixel(place, most));
    else {
      // Where rows are far apart in time, a bucket is wider than a pixel: its two points lie apart, or a slope would be a stair.
      const isNearMost = Math.abs(most - last) < Math.abs(least - last);
      points.add(at(0.25), yPixel(place, isNearMost ? most : least));
      points.add(at(0.75), yPixel(place, isNearMost ? least : most));
      last = isNearMost ? least : most;
    }
  }
}
