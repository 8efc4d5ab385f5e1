// A figure as an SVG drawing: axes, ticks, labels, legend and thinned curves, in light colours on white.

import { bandPolygon, bandQuadrilaterals, lineWidth } from "./painter.js";
import { historyPoints } from "./history-points.js";
import { LoopWalk } from "./loop-points.js";
import { colour, lightPalette } from "./palette.js";
import { Points } from "./points.js";
import { scatterPoints } from "./scatter-points.js";

const MOST_POINTS = 200000;
const LEGEND = 24;
const escaped = (text) => text.replace(/[&<>"]/g, (sign) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[sign]);
const short = (value) => value.toFixed(1);

/** @param {Points} points */
function linesOf(points, attributes) {
  const lines = [[]];
  for (let k = 0; k < points.length; k += 2) {
    if (Number.isNaN(points.values[k])) lines.push([]);
    else lines.at(-1).push(`${short(points.values[k])},${short(points.values[k + 1])}`);
  }
  return lines.filter((line) => line.length > 1).map((line) => `<polyline ${attributes} points="${line.join(" ")}"/>`).join("\n");
}

function curve(figure, trace, place) {
  const paint = colour(trace.role, lightPalette);
  const attributes = `fill="none" stroke="${paint}" stroke-width="${lineWidth(trace.style)}" stroke-linejoin="round"`;
  const points = new Points();
  if (trace.style === "band") {
    const polygons = figure.kind === "loop" ? bandQuadrilaterals(trace, figure.rowsOf(trace), place) : [bandPolygon(trace, figure.view.x, place)];
    const path = polygons.map((polygon) => `M${polygon.map(([x, y]) => `${short(x)},${short(y)}`).join("L")}Z`).join("");
    return `<path fill="${paint.slice(0, 7)}" fill-opacity="0.18" d="${path}"/>`;
  }
  if (trace.style === "points") {
    scatterPoints(trace, figure.rowsOf(trace), place, points, 1);
    const dots = [];
    for (let k = 0; k < points.length; k += 2) dots.push(`<circle cx="${short(points.values[k])}" cy="${short(points.values[k + 1])}" r="1"/>`);
    return `<g fill="${paint}">${dots.join("")}</g>`;
  }
  if (figure.kind === "loop") new LoopWalk(trace, figure.rowsOf(trace), place, { tolerance: 0.8, stride: 1 }).addTo(points, MOST_POINTS);
  else historyPoints(trace, trace.y, figure.view.x, place, points);
  return linesOf(points, attributes);
}

/** @param {import("./figure.js").Figure} figure */
export function drawing(figure) {
  const { width, height } = figure.plot;
  const place = figure.place(1);
  const { left, top } = place;
  const [right, bottom] = [left + place.width, top + place.height];
  const parts = [];
  const texts = [];
  figure.plot.axes.forEach((axis, k) => {
    (axis._splits ?? []).forEach((value, tick) => {
      const words = escaped(axis._values[tick] ?? "");
      const at = figure.plot.valToPos(value, axis.scale) + (k === 0 ? left : top);
      if (k === 0) {
        if (at < left - 1 || at > right + 1) return;
        parts.push(`<path stroke="${lightPalette.grid}" d="M${short(at)},${short(top)}V${short(bottom)}"/>`);
        texts.push(`<text x="${short(at)}" y="${short(bottom + 16)}" text-anchor="middle">${words}</text>`);
      } else {
        if (at < top - 1 || at > bottom + 1) return;
        parts.push(`<path stroke="${lightPalette.grid}" d="M${short(left)},${short(at)}H${short(right)}"/>`);
        texts.push(`<text x="${short(left - 6)}" y="${short(at + 4)}" text-anchor="end">${words}</text>`);
      }
    });
  });
  texts.push(`<text x="${short((left + right) / 2)}" y="${height - 4}" text-anchor="middle">${escaped(figure.xLabel)}</text>`);
  texts.push(`<text transform="translate(12,${short((top + bottom) / 2)}) rotate(-90)" text-anchor="middle">${escaped(figure.yLabel)}</text>`);
  let legendAt = left;
  const legend = figure.traces.map((trace) => {
    const entry = `<rect x="${short(legendAt)}" ${trace.style === "band" ? 'y="-15" height="10" fill-opacity="0.18"' : 'y="-12" height="4"'} width="16" fill="${colour(trace.role, lightPalette).slice(0, 7)}"/><text x="${short(legendAt + 20)}" y="-6">${escaped(trace.name)}</text>`;
    legendAt += 36 + 6.5 * trace.name.length;
    return entry;
  });
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height + LEGEND}" viewBox="0 ${-LEGEND} ${width} ${height + LEGEND}" font-family="system-ui, sans-serif" font-size="12" fill="${lightPalette.text}">
<title>${escaped(figure.title)}</title>
<rect x="0" y="${-LEGEND}" width="${width}" height="${height + LEGEND}" fill="#ffffff"/>
${legend.join("\n")}
<clipPath id="area"><rect x="${left}" y="${top}" width="${place.width}" height="${place.height}"/></clipPath>
${parts.join("\n")}
<g clip-path="url(#area)">
${figure.traces.map((trace) => curve(figure, trace, place)).join("\n")}
</g>
<rect x="${left}" y="${top}" width="${place.width}" height="${place.height}" fill="none" stroke="${lightPalette.axis}"/>
${texts.join("\n")}
</svg>
`;
}
