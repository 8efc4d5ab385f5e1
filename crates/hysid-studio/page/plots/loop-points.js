// Points of a loop: those that moved visibly at the present zoom. Rows outside the picture are passed over in boxes.

import { Trace } from "./trace.js";

const CHUNK = Trace.CHUNK;

/** A walk over the rows of a loop that can be stopped and taken up again. */
export class LoopWalk {
  /**
   * @param {Trace} trace
   * @param {[number, number]} rows: of the trace.
   * @param {import("./points.js").Place} place
   * @param {{tolerance: number, stride: number}} detail: pixels a point must move, and every how many rows are looked at.
   */
  constructor(trace, rows, place, detail) {
    this.trace = trace;
    this.row = Math.max(rows[0], 0);
    this.end = Math.min(rows[1], trace.length);
    this.place = place;
    this.detail = detail;
    this.nextBreak = trace.breaks.findIndex((row) => row > this.row);
    this.lastX = NaN;
    this.lastY = NaN;
  }

  get isDone() { return this.row >= this.end; }

  /** Adds points until there are so many numbers, or the walk has come to its end. */
  addTo(points, most) {
    const { trace, place, end, detail } = this;
    const { x, y } = trace;
    const { xScale, xOffset, yScale, yOffset, left, top } = place;
    const [right, bottom] = [left + place.width, top + place.height];
    const boxes = trace.boxes();
    const square = detail.tolerance * detail.tolerance;
    let { row, lastX, lastY } = this;
    if (points.length === 0 && !Number.isNaN(lastX)) points.add(lastX, lastY);
    while (row < end && points.length < most) {
      const box = 4 * Math.floor(row / CHUNK);
      const chunkEnd = Math.min((Math.floor(row / CHUNK) + 1) * CHUNK, end);
      const [boxLeft, boxRight] = [xScale * boxes[box] + xOffset, xScale * boxes[box + 1] + xOffset];
      const [boxBottom, boxTop] = [yScale * boxes[box + 2] + yOffset, yScale * boxes[box + 3] + yOffset];
      const isOutside = !(boxRight >= left && boxLeft <= right && boxBottom >= top && boxTop <= bottom);
      if (isOutside) {
        points.lift();
        lastX = NaN;
        row = chunkEnd;
        continue;
      }
      for (; row < chunkEnd; row += detail.stride) {
        const px = xScale * x[row] + xOffset;
        const py = yScale * y[row] + yOffset;
        if (this.nextBreak >= 0 && row >= trace.breaks[this.nextBreak]) {
          points.lift();
          lastX = NaN;
          while (this.nextBreak >= 0 && row >= trace.breaks[this.nextBreak]) {
            this.nextBreak = this.nextBreak + 1 < trace.breaks.length ? this.nextBreak + 1 : -1;
          }
        }
        if (px !== px || py !== py) {
          points.lift();
          lastX = NaN;
          continue;
        }
        const [dx, dy] = [px - lastX, py - lastY];
        // The first point of a line: nothing to compare it with.
        if (lastX !== lastX || dx * dx + dy * dy >= square) {
          points.add(px, py);
          lastX = px;
          lastY = py;
        }
      }
    }
    // The last row is drawn even if it moved little: a loop must close.
    if (row >= end && end > this.row && lastX === lastX) {
      const [px, py] = [xScale * x[end - 1] + xOffset, yScale * y[end - 1] + yOffset];
      if (px === px && py === py) points.add(px, py);
    }
    Object.assign(this, { row, lastX, lastY });
  }
}

/** How many rows are in boxes that touch the picture. */
export function visibleRows(trace, rows, place) {
  const boxes = trace.boxes();
  const [right, bottom] = [place.left + place.width, place.top + place.height];
  let count = 0;
  for (let chunk = Math.floor(rows[0] / CHUNK); chunk < Math.ceil(Math.min(rows[1], trace.length) / CHUNK); chunk++) {
    const box = 4 * chunk;
    const isVisible = place.xScale * boxes[box + 1] + place.xOffset >= place.left && place.xScale * boxes[box] + place.xOffset <= right
      && place.yScale * boxes[box + 2] + place.yOffset >= place.top && place.yScale * boxes[box + 3] + place.yOffset <= bottom;
    if (isVisible) count += CHUNK;
  }
  return Math.min(count, rows[1] - rows[0]);
}

/** The row nearest to a pixel, and its distance; boxes that are farther than the best so far are passed over. */
export function nearestRow(trace, rows, place, px, py) {
  const boxes = trace.boxes();
  let best = { row: -1, distance: Infinity };
  const { xScale, xOffset, yScale, yOffset } = place;
  for (let chunk = Math.floor(Math.max(rows[0], 0) / CHUNK); chunk < Math.ceil(Math.min(rows[1], trace.length) / CHUNK); chunk++) {
    const box = 4 * chunk;
    const outX = Math.max(xScale * boxes[box] + xOffset - px, px - xScale * boxes[box + 1] - xOffset, 0);
    const outY = Math.max(yScale * boxes[box + 3] + yOffset - py, py - yScale * boxes[box + 2] - yOffset, 0);
    if (outX * outX + outY * outY >= best.distance * best.distance) continue;
    const end = Math.min((chunk + 1) * CHUNK, rows[1], trace.length);
    for (let row = Math.max(chunk * CHUNK, rows[0]); row < end; row++) {
      const distance = Math.hypot(xScale * trace.x[row] + xOffset - px, yScale * trace.y[row] + yOffset - py);
      if (distance < best.distance) best = { row, distance };
    }
  }
  return best;
}
