// The choice of a model and of a file, which several steps share.

import { choice } from "../controls.js";
import { button, element, emptyState } from "../elements.js";
import { pageNotice } from "../notices.js";
import { project } from "../project.js";
import { post } from "../server.js";

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

/** Turns into a field for the name of a model; without a name, a model is called what it is. */
export function renaming(model) {
  const save = (name) => pageNotice.during(() => post(`/api/models/${model.id}/name`, { name }));
  const open = button("Rename", () => {
    const field = element("input", { type: "text", "aria-label": "Name of the model", value: model.title, maxlength: "80" });
    form.replaceChildren(field, element("button", { type: "submit", text: "Save" }), model.is_named ? button("Name it by what it is", () => save("")) : "");
    field.focus();
    field.select();
    form.onsubmit = (event) => {
      event.preventDefault();
      save(field.value);
    };
  });
  const form = element("form", { class: "row renaming" }, open);
  return form;
}
