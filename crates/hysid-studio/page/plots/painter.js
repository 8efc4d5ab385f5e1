// Draws traces on a canvas. A loop with many points is drawn in slices, so that the page stays responsive.

import { colour } from "./palette.js";
import { historyPoints, rowsBetween } from "./history-points.js";
import { LoopWalk, visibleRows } from "./loop-points.js";
import { Pace } from "./pace.js";
import { Points } from "./points.js";
import { scatterPoints } from "./scatter-points.js";

/** Points of loops while they move, and of one slice of the rest. */
export const moving = new Pace({ points: 6000, least: 800, most: 20000 });
const slices = new Pace({ points: 4000, least: 500, most: 40000 });
const MOVING_ROWS = 250000; // Rows that are looked at within a frame.
const LINES = 500; // Points of one stroke: long paths are slow to draw.
const points = new Points();
const upper = new Points();

/** The width of the lines of a style, in CSS pixels. */
export const lineWidth = (style) => ({ thin: 0.8, wide: 4 })[style] ?? 1.4;

function strokePoints(context, drawn) {
  const { values, length } = drawn;
  let isDown = false;
  let count = 0;
  context.beginPath();
  for (let k = 0; k < length; k += 2) {
    const [x, y] = [values[k], values[k + 1]];
    if (x !== x) isDown = false;
    else if (!isDown) {
      context.moveTo(x, y);
      isDown = true;
    } else {
      context.lineTo(x, y);
      if ((count += 1) % LINES === 0) {
        context.stroke();
        context.beginPath();
        context.moveTo(x, y);
      }
    }
  }
  context.stroke();
}

/** The band over time as polygons: along the upper limit and back along the lower one. */
export function bandPolygon(trace, window, place) {
  historyPoints(trace, trace.y, window, place, points, "low");
  historyPoints(trace, trace.high, window, place, upper, "high");
  const polygon = [];
  for (let k = 0; k < upper.length; k += 2) if (upper.values[k] === upper.values[k]) polygon.push([upper.values[k], upper.values[k + 1]]);
  for (let k = points.length - 2; k >= 0; k -= 2) if (points.values[k] === points.values[k]) polygon.push([points.values[k], points.values[k + 1]]);
  return polygon;
}

/** The band of a loop as one quadrilateral between each two rows, all of one orientation, so that they do not cancel. */
export function bandQuadrilaterals(trace, rows, place, most = 3000) {
  const stride = Math.max(1, Math.ceil((rows[1] - rows[0]) / most));
  const pieces = [];
  const at = (row) => [place.xScale * trace.x[row] + place.xOffset, place.yScale * trace.y[row] + place.yOffset, place.yScale * trace.high[row] + place.yOffset];
  const end = Math.min(rows[1], trace.length);
  for (let row = Math.max(rows[0], 0); row + stride < end; row += stride) {
    let [a, b] = [at(row), at(row + stride)];
    const isBroken = trace.breaks.some((start) => start > row && start <= row + stride);
    if (isBroken || a.concat(b).some(Number.isNaN)) continue;
    if (b[0] < a[0]) [a, b] = [b, a];
    pieces.push([[a[0], a[1]], [b[0], b[1]], [b[0], b[2]], [a[0], a[2]]]);
  }
  return pieces;
}

function fill(context, polygons) {
  context.beginPath();
  for (const polygon of polygons) {
    polygon.forEach(([x, y], k) => (k === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    context.closePath();
  }
  context.fill();
}

/** How a loop is looked at while it moves; `isFull` if that is all there is to see. */
function movingDetail(trace, rows, place) {
  const visible = visibleRows(trace, rows, place);
  const kept = trace.keptShare ?? 1;
  const stride = Math.max(1, Math.ceil(visible * kept / moving.points), Math.ceil(visible / MOVING_ROWS));
  return { tolerance: stride > 1 ? 1.2 : 0.6, stride, isFull: stride === 1 };
}

/**
 * Draws all traces. Returns a function that draws the next slice of what is left and says whether more is left, or null.
 * @param {CanvasRenderingContext2D} context
 * @param {{kind: string, traces: import("./trace.js").Trace[], window: [number, number], place: import("./points.js").Place,
 *   rowsOf: (trace: any) => [number, number], isMoving: boolean, colours: any, ratio: number}} picture
 */
export function paint(context, picture) {
  const { kind, traces, window, place, rowsOf, isMoving, colours, ratio } = picture;
  const left = [];
  for (const trace of traces) {
    context.strokeStyle = context.fillStyle = colour(trace.role, colours);
    context.lineWidth = lineWidth(trace.style) * ratio;
    context.lineJoin = "round";
    if (trace.style === "points") {
      const rows = rowsOf(trace);
      scatterPoints(trace, rows, place, points, isMoving ? Math.max(1, Math.ceil((rows[1] - rows[0]) / MOVING_ROWS)) : 1);
      const side = (kind === "curve" ? 5 : 2) * ratio;
      for (let k = 0; k < points.length; k += 2) context.fillRect(points.values[k] - side / 2, points.values[k + 1] - side / 2, side, side);
    } else if (kind !== "loop") {
      if (trace.style === "band") fill(context, [bandPolygon(trace, window, place)]);
      else {
        historyPoints(trace, trace.y, window, place, points);
        strokePoints(context, points);
      }
    } else if (trace.style === "band") {
      fill(context, bandQuadrilaterals(trace, rowsOf(trace), place, isMoving ? 800 : 3000));
    } else {
      const rows = rowsOf(trace);
      const detail = movingDetail(trace, rows, place);
      // A coarse loop at once; the rest follows over it.
      points.clear();
      new LoopWalk(trace, rows, place, detail).addTo(points, Infinity);
      strokePoints(context, points);
      if (!isMoving && !detail.isFull) left.push({ trace, walk: new LoopWalk(trace, rows, place, { tolerance: 0.6, stride: 1 }), begin: rows[0], count: 0 });
    }
  }
  if (left.length === 0) return null;
  return () => {
    slices.frame();
    let room = 2 * slices.points;
    while (left.length > 0 && room > 0) {
      const now = left[0];
      context.strokeStyle = colour(now.trace.role, colours);
      context.lineWidth = lineWidth(now.trace.style) * ratio;
      points.clear();
      now.walk.addTo(points, room);
      strokePoints(context, points);
      now.count += points.length / 2;
      room -= points.length;
      if (now.walk.isDone) {
        now.trace.keptShare = Math.min(1, now.count / Math.max(now.walk.end - now.begin, 1));
        left.shift();
      }
    }
    return left.length > 0;
  };
}

/** The rows of a trace that a history's window shows. */
export const rowsInWindow = (trace, window) => rowsBetween(trace, window[0], window[1]);
