// Controls of options, made from the kind of their values.

import { element, newId } from "./elements.js";

const MOST_LETTERS = 36; // Of a default that fits into a field; a longer one stands below it.
const NUMBERS = new Set(["count", "whole", "fraction", "zero-or", "number"]);

function input(option, value, shown) {
  const { kind, names = [], from, to } = option.values;
  if (kind === "names" || kind === "truth") {
    const choices = kind === "truth" ? ["true", "false"] : names;
    const node = element("select", {}, element("option", { value: "", text: `default${shown ? `: ${shown}` : ""}` }),
      ...choices.map((name) => element("option", { value: name, text: name })));
    node.value = value === undefined || value === null ? "" : String(value);
    return node;
  }
  if (kind === "flag") return element("input", { type: "checkbox", checked: value === true });
  if (kind === "list") return element("textarea", { rows: 2, value: (value ?? []).join("\n"), placeholder: shown || "one a line" });
  if (NUMBERS.has(kind)) {
    const isWhole = kind === "count" || kind === "whole" || kind === "zero-or";
    const limits = { min: kind === "zero-or" || kind === "whole" || kind === "fraction" ? 0 : from, max: kind === "fraction" ? 1 : to };
    const node = element("input", { type: "number", step: isWhole ? "1" : "any", placeholder: shown });
    if (limits.min !== undefined) node.min = limits.min;
    if (limits.max !== undefined) node.max = limits.max;
    node.value = value ?? "";
    return node;
  }
  return element("input", { type: "text", value: String(value ?? ""), placeholder: shown });
}

/**
 * A labelled control. `read` gives what was chosen, or nothing for the default.
 * @param {string} scope: makes the id unique and the same each time, so that the focus can stay.
 * @param {{name: string, flag: string, meaning: string, default?: string, values: any}} option
 */
export function control(scope, option, value, changed = () => {}) {
  const id = `${scope}${option.flag}`;
  const help = `${id}-help`;
  const { default: otherwise = "", meaning } = option;
  const fits = otherwise.length <= MOST_LETTERS;
  const node = input(option, value, fits ? otherwise : "");
  node.id = id;
  node.dataset.flag = option.flag;
  node.setAttribute("aria-describedby", help);
  node.addEventListener("change", changed);
  const name = option.name.replaceAll("_", " ");
  const label = element("label", { for: id, text: name.charAt(0).toUpperCase() + name.slice(1) });
  const read = () => {
    if (node.type === "checkbox") return node.checked ? true : undefined;
    const text = node.value.trim();
    if (text === "") return undefined;
    if (option.values.kind === "truth") return text === "true";
    if (option.values.kind === "list") return text.split("\n").map((line) => line.trim()).filter(Boolean);
    return node.type === "number" ? Number(text) : text;
  };
  const wrap = element("div", { class: node.type === "checkbox" ? "control check" : "control" },
    label, element("code", { class: "flag", text: option.flag }), node, element("p", { class: "help", id: help, text: `${meaning.replace(/\.$/, "")}.${fits ? "" : ` Default: ${otherwise}.`}` }));
  return { node: wrap, read, name: option.name };
}

/** A labelled select of entries {value, text}. */
export function choice(label, entries, value, changed, properties = {}) {
  const id = properties.id ?? newId("choice");
  const node = element("select", { ...properties, id, on: { change: () => changed(node.value) } }, ...entries.map((entry) => element("option", { value: String(entry.value), text: entry.text })));
  node.value = String(value);
  return element("div", { class: "choice" }, element("label", { for: id, text: label }), node);
}

/** A labelled check box. */
export function tick(label, checked, changed) {
  const node = element("input", { type: "checkbox", checked, on: { change: () => changed(node.checked) } });
  return element("label", { class: "tick" }, node, label);
}

/** A slider with its value beside it, also as a number that can be typed. */
export function slider(label, { low, high, value, step }, changed) {
  const id = newId("slider");
  const range = element("input", { type: "range", id });
  const number = element("input", { type: "number", step: "any", "aria-label": `${label}, as a number` });
  Object.assign(range, { min: low, max: high, step: step ?? (high - low) / 500 });
  const set = (next) => { range.value = next; number.value = Number(Number(next).toPrecision(4)); };
  set(value);
  const told = (from) => () => {
    const next = Number(from.value);
    if (!Number.isFinite(next) || from.value === "") return;
    if (from === range) number.value = Number(next.toPrecision(4));
    else range.value = next;
    changed(next);
  };
  range.addEventListener("input", told(range));
  number.addEventListener("change", told(number));
  return { node: element("div", { class: "slider" }, element("label", { for: id, text: label }), range, number), read: () => Number(number.value), set };
}
