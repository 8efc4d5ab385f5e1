// Problems in the server's words. Options that help are links to their controls.

import { button, element } from "./elements.js";
import { project } from "./project.js";
import { Gone, post, remove } from "./server.js";

const OF_COLUMNS = ["--input", "--output", "--time", "--record", "--rate", "--mass", "--displacement", "--velocity", "--acceleration", "--absolute-acceleration", "--base-acceleration", "--applied-force"];

/** The control of an option, of the step that is shown if it has one. */
function controlOf(flag) {
  const found = [...document.querySelectorAll("[data-flag]")].filter((node) => node.dataset.flag.split(" ").includes(flag));
  return found.find((node) => node.closest("section")?.hidden === false) ?? found[0];
}

/** Moves the focus to the control of an option and unfolds what it is in. A column that is named gets the role. */
function follow(flag, value) {
  const control = controlOf(flag);
  if (!control) return;
  const section = control.closest("section");
  if (section.hidden) location.hash = section.id;
  // The step is shown in the next task, after the change of the hash.
  setTimeout(() => {
    for (let part = control.closest("details"); part; part = part.parentElement.closest("details")) part.open = true;
    if (value) control.dispatchEvent(new CustomEvent("role", { bubbles: true, detail: { column: value, role: flag.slice(2) } }));
    // The table is built again with the new role.
    const shown = control.isConnected ? control : controlOf(flag);
    shown?.focus();
    shown?.scrollIntoView({ block: "center" });
  }, 50);
}

const isControl = (flag) => OF_COLUMNS.includes(flag) || [...project.choices.options, ...project.choices.reading].some((option) => option.flag === flag);

/** Words with links to controls: a text, or a list of texts and controls. */
export function linked(words) {
  const link = ({ flag, words: label, value }) => (isControl(flag) ? button(label, () => follow(flag, value), { class: "link" }) : label);
  return element("span", {}, ...[words].flat().map((part) => (typeof part === "string" ? part : link(part))));
}

export const problem = (words) => element("p", { class: "problem" }, linked(words));

/** Why an action failed. */
export const failure = (error) => problem(error.words ?? error.message);

/** Words that are no problem, with what can be done. */
const told = (words, ...more) => element("p", { class: "told" }, words, " ", ...more);

/** A place for the error of an action; empty as long as there is none. */
export class Notice {
  constructor() { this.node = element("div", { role: "alert" }); }
  show(words) { this.node.replaceChildren(problem(words)); }
  /** Shows why an action failed. The banner tells when the server is gone. */
  fail(error) { if (!(error instanceof Gone)) this.show(error.words ?? error.message); }
  tell(words, ...more) { this.node.replaceChildren(told(words, ...more)); }
  /** Shows several: words, or why actions failed. */
  all(problems) { this.node.replaceChildren(...problems.filter((one) => !(one instanceof Gone)).map((one) => (typeof one === "string" ? problem(one) : failure(one)))); }
  clear() { this.node.replaceChildren(); }
  /** Runs an action and shows its error. */
  async during(action) {
    this.clear();
    try {
      return await action();
    } catch (error) {
      this.fail(error);
      return undefined;
    }
  }
}

/** The notice above all steps. */
export const pageNotice = new Notice();
document.getElementById("notices").append(pageNotice.node);

/** Removes a file or a model from the project, and offers to bring it back. */
export const removeOne = (kind, { id, name }) => pageNotice.during(async () => {
  const stays = await remove(`/api/${kind}/${id}`);
  const undo = () => pageNotice.during(() => post(`/api/removed/${id}`, {}));
  pageNotice.tell(`${name} was removed. ${stays}`, button("Undo", undo, { "aria-label": `Undo: bring ${name} back` }));
});
