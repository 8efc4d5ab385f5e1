// Step 6: files to keep, and the commands that do the same without the page.

import { button, element, Region } from "../elements.js";
import { Notice, failure, problem } from "../notices.js";
import { written } from "../numbers.js";
import { download } from "../plots/save.js";
import { project } from "../project.js";
import { getFile } from "../server.js";
import { field } from "./use-case.js";
import { modelChoice, modelOr, noModel, stale } from "./model-choice.js";

function copyable(title, text, note = null) {
  const id = `copy-${title}`;
  const copy = button("Copy", async () => {
    try {
      await navigator.clipboard.writeText(text);
      copy.textContent = "Copied";
    } catch {
      // Without permission the text is selected, to be copied with the keyboard.
      getSelection().selectAllChildren(document.getElementById(id));
      copy.textContent = "Press Ctrl+C";
    }
    setTimeout(() => { copy.textContent = "Copy"; }, 2000);
  }, { "aria-label": `Copy: ${title}` });
  return element("div", {}, element("div", { class: "row" }, element("h3", { text: title }), copy), note ? element("p", { class: "note", text: note }) : null, element("pre", { id, tabindex: "0", "aria-label": title, role: "region" }, element("code", { text })));
}

export class TakeAwayStep {
  constructor(body) {
    this.notice = new Notice();
    this.region = new Region();
    this.commands = new Region();
    body.replaceChildren(this.notice.node, this.region.node, this.commands.node);
  }
  choose(id) { this.model = id; }

  /** A model that cannot be exported there is told in words, and not as a failed download. */
  save(address) {
    return this.notice.during(async () => {
      const { name, content } = await getFile(address);
      download(content, name);
    });
  }

  /** The inverse of a model within bounds of its input, for the targets that have one. */
  inverse(model, address) {
    const [range] = model.ranges;
    const [label] = model.input_labels;
    const fields = { low: field(`Lowest ${label}`, written(range[0])), high: field(`Highest ${label}`, written(range[1])), slew: field("Largest rate of it", "none") };
    const query = () => Object.entries(fields).map(([name, one]) => [name, one.read()]).filter(([, value]) => value !== null).map(([name, value]) => `&${name}=${value}`).join("");
    const targets = project.choices.targets.filter(({ has_inverse: has }) => has);
    return element("div", {}, element("h2", { text: "Inverse" }),
      element("p", { class: "note" }, "The input for a wanted output, sample by sample. It keeps these limits; without others, those of the training data. ", element("a", { href: `#invert/${model.id}`, text: "Try it on a wanted output" }), "."),
      element("div", { class: "row" }, ...Object.values(fields).map(({ node }) => node),
        ...targets.map(({ name }) => button(`Download inverse, ${name}`, () => this.save(`${address}/export/${encodeURIComponent(name)}?inverse=true${query()}`)))));
  }

  async update() {
    const model = modelOr(this.model);
    if (!model) {
      this.region.update("empty", () => [noModel()]);
      this.commands.update(null, () => []);
      return;
    }
    const address = `/api/models/${model.id}`;
    const { folder } = project.state;
    this.region.update([project.models.map(({ id, title, is_stale: isStale }) => [id, title, isStale]), model.id, folder], () => [
      element("div", { class: "row" }, modelChoice("take-away", model, (id) => { this.model = id; this.update(); })), stale(model),
      element("h2", { text: "Files" }),
      element("div", { class: "row" }, button("Model file", () => this.save(`${address}/file`)),
        model.has_report ? element("a", { class: "button", href: `/report#${model.id}`, target: "_blank", text: "Report (new tab)" }) : null),
      element("p", { class: "note" }, "This model is also in the project's folder: ", element("code", { text: `${folder}/models/${model.file}` })),
      this.inverse(model, address),
      element("h2", { text: "Source code and exports" }),
      element("ul", { class: "files" }, ...project.choices.targets.map(({ name, what }) => element("li", {},
        element("span", { class: "about", text: what }), button(`Download ${name}`, () => this.save(`${address}/export/${encodeURIComponent(name)}`), { "aria-label": `Download ${name}: ${what}` }))))]);
    try {
      const { shell, python, note } = await project.ofModel(model, "commands");
      if (modelOr(this.model) === model) this.commands.update([model.id, shell, python], () => [element("h2", { text: "Without this page" }), note ? problem(note) : null, copyable("Command line", shell), python ? copyable("Python", python, `Run in the folder ${folder}.`) : element("p", { class: "note", text: "Python code is not available for several training files, files other than CSV, and reading options." })]);
    } catch (error) {
      this.commands.update(error.message, () => [failure(error)]);
    }
  }
}
