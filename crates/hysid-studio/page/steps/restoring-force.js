// The restoring force of an element from the measured motion of a mass.

import { choice } from "../controls.js";
import { button, element, emptyState } from "../elements.js";
import { project } from "../project.js";
import { sendFiles } from "../uploads.js";
import { field, UseCase } from "./use-case.js";

const COLUMNS = { displacement: "Displacement", velocity: "Velocity", acceleration: "Acceleration relative to the base", absolute_acceleration: "Acceleration as measured on the mass", base_acceleration: "Acceleration of the base", applied_force: "Applied force" };

export class RestoringForceStep extends UseCase {
  /** A motion that was dropped here. */
  take(file) {
    this.file = file;
    this.update();
  }
  get useOfDropped() { return "unused"; }
  get needsNoModel() { return true; }

  update() {
    const files = project.files.filter(({ columns }) => columns.length > 0);
    const file = files.find(({ id }) => id === this.file) ?? files.at(-1);
    if (!file) return this.showNothing(emptyState("Drop a table with the motion of a mass: time, displacement, and a force or an acceleration."));
    return this.form.update([files.map(({ id, name }) => [id, name]), file.id, file.columns.map(({ name }) => name)], () => {
      const chosen = choice("Motion in", files.map(({ id, name }) => ({ value: id, text: name })), file.id, (id) => { this.file = Number(id); this.update(); }, { id: "force-file" });
      const mass = field("Mass, such as 2 t", "in kg, or with a unit", { type: "text", flag: "--mass" });
      const values = {};
      const roles = Object.entries(COLUMNS).map(([name, text]) => {
        const usual = { displacement: "found by name and unit", applied_force: "found by name and unit", velocity: "computed", acceleration: "computed" }[name] ?? "none";
        const entries = [{ value: "", text: usual }, ...(name === "applied_force" ? [{ value: "none", text: "none" }] : []), ...file.columns.map((column) => ({ value: column.name, text: column.name }))];
        return choice(text, entries, "", (value) => { values[name] = value || null; }, { "data-flag": `--${name.replaceAll("_", "-")}` });
      });
      const add = ({ file: name, table }) => [button("Add to the project", () => this.notice.during(async () => {
        await sendFiles([new File([table], name, { type: "text/csv" })]);
        location.hash = "data";
      }))];
      this.result.replaceChildren();
      return [element("div", { class: "row" }, chosen, mass.node), element("div", { class: "controls" }, ...roles),
        this.asking("Compute the restoring force", () => "/api/restoring-force", () => ({ file: file.id, mass: mass.read() ?? "", ...values }), add)];
    });
  }
}
