// Rows that are marked in a figure: those of a finding, and those that a zoomed loop shows.

import { paint } from "./painter.js";
import { Trace } from "./trace.js";

const STRIPES = 1500; // Pieces of a file in which a zoomed loop looks for its rows.

/** Behind a history: the rows of a finding, and a stripe over the rows that a zoomed loop shows. */
export function paintRanges(context, trace, link, place, ratio, colours) {
  const at = (row) => place.xScale * trace.x[Math.min(Math.max(row, 0), trace.length - 1)] + place.xOffset;
  const rectangles = (ranges, top, height, least) => {
    for (const [from, to] of ranges) context.fillRect(at(from), top, Math.max(at(to) - at(from), least * ratio), height);
  };
  context.fillStyle = `${colours.mark}33`;
  rectangles(link.marked, place.top, place.height, 3);
  context.fillStyle = colours.simulated;
  rectangles(link.inside, place.top, 4 * ratio, 1);
}

/** Over a loop: the rows of a finding. */
export function paintMarkedRows(context, trace, link, place, ratio, colours) {
  const traces = link.marked.map(([from, to]) => new Trace({
    name: "", role: "mark", x: trace.x.subarray(from, to + 1), y: trace.y.subarray(from, to + 1),
  }));
  paint(context, { kind: "loop", traces, window: null, place, rowsOf: (one) => [0, one.length], isMoving: true, colours, ratio: 2.5 * ratio });
}

/** Pieces of the file with rows in the view of a loop. */
export function rowsInside(trace, view) {
  const [[left, right], [low, high]] = [view.x, view.y];
  const stripe = Math.max(1, Math.ceil(trace.length / STRIPES));
  const found = [];
  for (let from = 0; from < trace.length; from += stripe) {
    const to = Math.min(from + stripe, trace.length);
    let isInside = false;
    for (let row = from; row < to && !isInside; row++) {
      isInside = trace.x[row] >= left && trace.x[row] <= right && trace.y[row] >= low && trace.y[row] <= high;
    }
    if (!isInside) continue;
    if (found.length > 0 && found.at(-1)[1] === from) found.at(-1)[1] = to;
    else found.push([from, to]);
  }
  return found;
}
