// The choice of a model and of a file, which several steps share.

import { choice } from "../controls.js";
import { element, emptyState } from "../elements.js";
import { project } from "../project.js";

export const noModel = () => emptyState("There is no model yet.", element("a", { class: "button", href: "#identify", text: "Identify a model" }));

export const noFile = () => emptyState("There is no file to run the model on.", element("a", { class: "button", href: "#data", text: "Add a file" }));

/** The model with this number, else the newest. */
export const modelOr = (id) => project.models.find((model) => model.id === id) ?? project.models.at(-1) ?? null;

/** The file with this number, else the first unseen one, else the first. */
export function fileOr(id) {
  const files = project.labels ? project.usable() : [];
  return files.find((file) => file.id === id) ?? files.find((file) => file.use === "unseen") ?? files[0] ?? null;
}

export const modelChoice = (step, model, changed) => choice("Model", [...project.models].reverse().map(({ id, title, is_stale: isStale }) => ({ value: id, text: isStale ? `${title} (other data)` : title })), model.id, (id) => changed(Number(id)), { id: `${step}-model` });
export const fileChoice = (step, file, changed) => choice("File", project.usable().map(({ id, name, use }) => ({ value: id, text: `${name} (${use})` })), file.id, (id) => changed(Number(id)), { id: `${step}-file` });

export const stale = (model) => (model.is_stale ? element("p", { class: "problem", text: "This model was fitted to other files, columns or reading options than the present ones. Its errors cannot be compared with those of newer models." }) : null);
