// Saves a figure as SVG, PNG or CSV.

import { drawing } from "./svg.js";

const ROWS_AT_ONCE = 20000;

export function download(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const fileName = (figure) => figure.title.normalize("NFKD").replace(/[^A-Za-z0-9]+/g, "-").replace(/^-|-$/g, "").slice(0, 80).toLowerCase() || "figure";

/** The rows in the window as text, made in pieces so that no long string is needed. */
function tableOf(figure) {
  const [first] = figure.traces;
  const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const columns = [{ name: figure.xLabel, trace: first, values: first.x }];
  for (const trace of figure.traces) {
    if (trace.high) columns.push({ name: `${trace.name}, low`, trace, values: trace.y }, { name: `${trace.name}, high`, trace, values: trace.high });
    else columns.push({ name: trace.name || figure.yLabel, trace, values: trace.y });
  }
  const number = ({ trace, values }, row) => {
    const value = values[row - trace.firstRow];
    return value === undefined || Number.isNaN(value) ? "" : String(value);
  };
  const pieces = [`row,${columns.map((column) => quoted(column.name)).join(",")}\n`];
  const [from, to] = figure.rowsOf(first).map((row) => row + first.firstRow);
  for (let start = from; start < to; start += ROWS_AT_ONCE) {
    const lines = [];
    for (let row = start; row < Math.min(start + ROWS_AT_ONCE, to); row++) lines.push(`${row + 1},${columns.map((column) => number(column, row)).join(",")}\n`);
    pieces.push(new Blob([lines.join("")]));
  }
  return new Blob(pieces, { type: "text/csv" });
}

/**
 * @param {import("./figure.js").Figure} figure
 * @param {"SVG" | "PNG" | "CSV"} kind
 */
export async function save(figure, kind) {
  const name = `${fileName(figure)}.${kind.toLowerCase()}`;
  if (kind === "CSV") return download(tableOf(figure), name);
  const picture = new Blob([drawing(figure)], { type: "image/svg+xml" });
  if (kind === "SVG") return download(picture, name);
  // The picture is the drawing at twice its size: light colours on white, whatever the page looks like.
  const image = new Image();
  const address = URL.createObjectURL(picture);
  await new Promise((done, failed) => Object.assign(image, { onload: done, onerror: failed, src: address }));
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [2 * image.width, 2 * image.height];
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  URL.revokeObjectURL(address);
  return canvas.toBlob((blob) => download(blob, name), "image/png");
}
