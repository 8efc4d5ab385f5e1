// A step with a form, and below it a page that the server makes, with a table to keep.

import { button, documentOf, element, newId, Region } from "../elements.js";
import { Notice } from "../notices.js";
import { download } from "../plots/save.js";
import { post } from "../server.js";

/** A labelled field of a form: a number, or a text. `read` gives nothing for the default. */
export function field(label, placeholder, { type = "number", flag } = {}) {
  const node = element("input", { type, step: type === "number" ? "any" : undefined, placeholder, id: newId("field"), "data-flag": flag });
  const read = () => (node.value.trim() === "" ? null : type === "number" ? Number(node.value) : node.value.trim());
  return { node: element("div", { class: "choice" }, element("label", { for: node.id, text: label }), node), read };
}

export class UseCase {
  /** @param {HTMLElement} body */
  constructor(body) {
    this.form = new Region();
    this.notice = new Notice();
    this.result = element("div");
    body.replaceChildren(this.form.node, this.notice.node, this.result);
  }

  /** Without what it needs, a step shows what to do. */
  showNothing(...content) {
    this.form.update("empty", () => content);
    this.result.replaceChildren();
  }

  /** A button that asks for a result; `more` makes further buttons for it. */
  asking(text, address, request, more = () => []) {
    return button(text, () => this.notice.during(async () => {
      this.result.replaceChildren(element("p", { role: "status", text: "Computing \u2026" }));
      try {
        const made = await post(address(), request());
        const save = button(`Save ${made.file}`, () => download(new Blob([made.table], { type: "text/csv" }), made.file));
        this.result.replaceChildren(element("div", { class: "row" }, save, ...more(made)), documentOf(made.html));
      } catch (error) {
        this.result.replaceChildren();
        throw error;
      }
    }), { class: "main" });
  }
}
