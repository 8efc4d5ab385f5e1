// Step 1: files, their columns, how they are read, and what the data look like.

import { control, choice } from "../controls.js";
import { button, element, newId, Region, table } from "../elements.js";
import { Notice, linked, problem, removeOne } from "../notices.js";
import { bytes, counted, written } from "../numbers.js";
import { RecordFigures } from "../plots/record-figures.js";
import { project, startsOf } from "../project.js";
import { getJson, post } from "../server.js";
import { sendFiles } from "../uploads.js";
import { Example } from "./example.js";

const ROLES = ["input", "output", "time", "record", "rate", "unused"];
const NO_TIME = "none"; // In place of a column of time, if none has the time.
const FLAG_OF_ROLE = { input: "--input", output: "--output", time: "--time", record: "--record", rate: "--rate" };

export class DataStep {
  /** @param {HTMLElement} body */
  constructor(body) {
    this.notice = new Notice();
    this.files = new Region();
    this.columns = new Region();
    this.reading = new Region();
    this.view = new Region();
    this.findings = new Region();
    this.example = new Example(this.notice);
    /** Roles that were chosen and that the server does not have yet, by file and column. */
    this.chosen = new Map();
    body.replaceChildren(this.adding(), this.notice.node, this.example.node, this.files.node, this.columns.node, this.reading.node, this.view.node, this.findings.node);
  }

  adding() {
    const id = newId("files");
    const file = element("input", { type: "file", class: "hidden", id, multiple: true, on: { change: () => { sendFiles([...file.files]); file.value = ""; } } });
    const specimens = project.choices.specimens;
    const select = element("select", { "aria-label": "Synthetic specimen" }, ...specimens.map(({ name, what }) => element("option", { value: name, text: `${name}: ${what}` })));
    const add = button("Add", () => this.notice.during(() => post("/api/specimens", { name: select.value, seed: 1, noise_percent: 1 })));
    this.box = element("div", { class: "empty drop" },
      element("p", { class: "large", text: "Drop a file with measured input and output here" }),
      element("div", { class: "row centre" }, file, element("label", { class: "button main", for: id, text: "Choose files" }), element("span", { class: "note", text: "CSV, text, spreadsheet, MATLAB, HDF5 or NumPy. Nothing leaves this computer." })),
      element("details", {}, element("summary", { text: "Synthetic data of a known specimen" }), element("div", { class: "row centre" }, select, add)));
    return this.box;
  }

  update() {
    const { files, first, reading, columns, columns_are_chosen: areChosen, problem: whole } = project.state;
    this.box.classList.toggle("compact", files.length > 0);
    this.example.update(files.length === 0);
    this.files.update([files, whole], () => this.fileList(files, whole));
    this.columns.update([files, first, columns, areChosen, [...this.chosen].map(([id, roles]) => [id, [...roles]])], () => this.columnTables(files, first, areChosen));
    const isUnread = files.some((file) => file.problem && file.columns.length === 0);
    this.reading.update([reading, files.length > 0, isUnread], () => (files.length > 0 ? [this.readingOptions(reading, isUnread)] : []));
    const shown = project.labels ? project.usable() : [];
    if (!shown.some((file) => file.id === this.shown)) this.shown = shown[0]?.id;
    this.drawView(shown);
    this.updateFindings(shown);
  }

  fileList(files, whole) {
    if (files.length === 0) return [];
    const item = (file) => {
      const id = `use-${file.id}`;
      const use = element("select", { id, "aria-label": `Use of ${file.name}`, on: { change: () => this.notice.during(() => post(`/api/files/${file.id}/use`, { use: use.value })) } },
        ...[["training", "training"], ["unseen", "unseen"], ["unused", "not used"]].map(([value, text]) => element("option", { value, text })));
      use.value = file.use;
      const records = file.records.length > 1 ? `, ${file.records.length} records` : "";
      return element("li", {}, element("span", { class: "name", text: file.name }),
        element("span", { class: "about", text: file.problem ? "not read" : file.read_as === null ? "being read \u2026" : `${counted(file.rows)} rows${records}, ${bytes(file.bytes)}. ${file.read_as}` }), use,
        button("Remove", () => removeOne("files", file), { "aria-label": `Remove ${file.name}` }),
        file.is_held_back ? button("Read again", () => this.notice.during(() => post(`/api/files/${file.id}/read`, {})), { "aria-label": `Read ${file.name} again` }) : null,
        file.problem ? problem(file.problem) : null,
        file.warnings.length > 0 ? element("ul", { class: "warnings" }, ...file.warnings.map((words) => element("li", {}, linked(words)))) : null);
    };
    return [element("h2", { text: "Files" }), element("ul", { class: "files" }, ...files.map(item)),
      whole ? problem(whole) : null];
  }

  columnTables(files, first, areChosen) {
    // The file that tells the roles comes first; then one whose columns are doubtful, which is shown open.
    const readable = files.filter((file) => file.columns.length > 0).sort((a, b) => (b.id === first) - (a.id === first));
    if (readable.length === 0) return [];
    // Roles that a problem names lead to the table that it is about.
    const asked = readable.find((file) => file.id !== first && file.problem) ?? readable[0];
    const flagged = new Set();
    const row = (file, roles) => (column) => {
      const id = `role-${file.id}-${file.columns.indexOf(column)}`;
      const role = element("select", { id, "aria-label": `Role of ${column.name} in ${file.name}`, on: { change: () => this.chooseRole(file, column.name, role.value) } },
        ...ROLES.map((name) => element("option", { value: name, text: name })));
      role.value = roles.get(column.name);
      const flag = FLAG_OF_ROLE[role.value];
      if (file === asked && flag && !flagged.has(flag)) { role.dataset.flag = flag; flagged.add(flag); }
      return [column.name, role, column.unit ?? "", written(column.minimum), written(column.maximum), counted(column.missing ?? 0), column.note ?? ""];
    };
    const words = { text: "Note", class: "words" };
    const text = (name) => ({ text: name, class: "text" });
    const tables = readable.map((file, k) => {
      const build = () => table(`Columns of ${file.name}`, ["Column", text("Role"), text("Unit"), "Minimum", "Maximum", "Missing", words], file.columns.map(row(file, this.rolesOf(file))));
      if (k > 0 && file !== asked) {
        // Built when it is opened: there may be many.
        const details = element("details", { on: { toggle: () => { if (details.childElementCount === 1) details.append(build()); } } }, element("summary", { text: `Columns of ${file.name}` }));
        return details;
      }
      const made = build();
      // A role that no column has leads to the first select of a column without one.
      const free = [...made.querySelectorAll("select")].find((select) => select.value === "unused") ?? made.querySelector("select");
      const missing = Object.values(FLAG_OF_ROLE).filter((flag) => !flagged.has(flag));
      if (file === asked && !free.dataset.flag) free.dataset.flag = missing.join(" ");
      made.addEventListener("role", ({ detail: { column, role } }) => {
        if (file.columns.some(({ name }) => name === column) || (role === "time" && column === NO_TIME)) this.chooseRole(file, column, role, true);
      });
      return k > 0 ? element("div", {}, element("h3", { text: file.name }), made) : made;
    });
    const others = readable.length > 1 ? " Other files have the same roles: their columns are found by name and unit, and a role that you change in one of them is changed there alone." : "";
    return [element("h2", { text: "Columns" }),
      element("p", { class: "note", text: `${areChosen ? "Roles as you chose them." : "Roles were detected from names and values."} A record column separates runs; a rate column has the measured rate of the first input.${others}` }),
      ...tables, areChosen || this.chosen.size > 0 ? button("Detect again", () => this.detect()) : null];
  }

  /** The roles of the columns as the table shows them. */
  rolesOf(file) {
    const chosen = this.chosen.get(file.id);
    const roles = new Map(file.columns.map((column) => [column.name, chosen?.get(column.name) ?? column.role ?? "unused"]));
    if (chosen?.get(NO_TIME) === "time") roles.set(NO_TIME, "time");
    return roles;
  }

  detect() {
    this.chosen.clear();
    this.update();
    return this.notice.during(() => post("/api/columns", null));
  }

  /** Sends all roles as the table shows them. Two columns exchange a role that only one can have; `alone` makes a column the only input. */
  async chooseRole(file, name, role, alone = false) {
    const roles = this.rolesOf(file);
    // A column that has just lost its role still has it to exchange.
    const held = roles.get(name) ?? "unused";
    const former = file.columns.find((column) => column.name === name)?.role;
    const isFree = former && ![...roles.values()].includes(former);
    const before = held === "unused" && isFree ? former : held;
    const gives = role === "input" ? alone && "unused" : role !== "unused" && before;
    if (gives) for (const [other, had] of roles) if (had === role) roles.set(other, other === NO_TIME ? "unused" : gives);
    roles.set(name, role);
    this.chosen.set(file.id, roles);
    this.update();
    const all = (wanted) => [...roles].filter(([, had]) => had === wanted).map(([column]) => column);
    const one = (wanted) => all(wanted)[0] ?? null;
    const isFirst = file.id === project.state.first;
    const missing = ["input", "output"].find((wanted) => all(wanted).length === 0);
    if (isFirst && missing) {
      this.notice.tell(linked([`No column has the role ${missing} yet: choose `, { flag: FLAG_OF_ROLE[missing], words: `the role "${missing}"` }, "."]));
      return;
    }
    // Without roles that were detected, a column of time is still found.
    const wasFound = isFirst && file.columns.some((column) => column.role === "input");
    const chosen = { record: one("record"), time: one("time") ?? (wasFound ? NO_TIME : null), inputs: all("input"), rate: one("rate"), output: one("output") };
    await this.notice.during(async () => {
      const answer = await post(isFirst ? "/api/columns" : `/api/files/${file.id}/columns`, chosen);
      if (this.chosen.get(file.id) === roles) this.chosen.delete(file.id);
      if (wasFound && answer?.note) this.notice.show(`${answer.note}.`);
    });
    await project.load();
  }

  readingOptions(reading, isOpen) {
    const send = () => {
      const chosen = Object.fromEntries(controls.map((one) => [one.name, one.read()]).filter(([, value]) => value !== undefined));
      return this.notice.during(() => post("/api/reading", chosen));
    };
    const controls = project.choices.reading.map((option) => control("read", { default: "detected", ...option }, reading[option.name], send));
    return element("details", { open: isOpen }, element("summary", { text: "How files are read" }),
      element("p", { class: "note", text: "Delimiter, decimal sign and header are detected. Change them only if a file is read wrongly." }),
      element("div", { class: "controls" }, ...controls.map((one) => one.node)),
      Object.keys(reading).length > 0 ? button("Detect all", () => this.notice.during(() => post("/api/reading", {}))) : null);
  }

  async drawView(shown) {
    const file = shown.find((one) => one.id === this.shown);
    const key = file ? [project.dataKey(file), project.labels, shown.map((one) => [one.id, one.name, one.use])] : null;
    if (JSON.stringify(key) === this.view.key) return;
    let columns = null;
    if (file) columns = await this.notice.during(() => project.columns(file));
    if (file && (!columns || file.id !== this.shown)) return;
    this.view.update(key, () => {
      this.figures?.destroy();
      this.figures = null;
      if (!file) return [];
      this.figures = new RecordFigures({ columns, labels: project.labels, starts: startsOf(file), measuredRole: "data", withInput: true });
      const files = choice("File", shown.map((one) => ({ value: one.id, text: `${one.name} (${one.use})` })), file.id, (id) => { this.shown = Number(id); this.update(); }, { id: "data-file" });
      return [element("h2", { text: "What the data look like" }), shown.length > 1 ? element("div", { class: "row" }, files) : null, this.figures.node,
        element("p", { class: "note", text: "Drag in a figure to zoom; the other figures show the same rows. Shift and drag to move, double-click to see everything." })];
    });
  }

  async updateFindings(shown) {
    if (shown.length === 0) return this.findings.update(null, () => []);
    const key = project.state.files.map((file) => project.dataKey(file) + file.use);
    const findings = await project.once(`findings ${key}`, () => getJson("/api/findings")).catch(() => null);
    if (!findings) return undefined;
    const { warnings, issues } = findings;
    const all = [...warnings.map((statement) => ({ severity: "warning", statement, evidence: [] })), ...issues];
    return this.findings.update([key, findings], () => [element("h2", { text: "Findings" }),
      all.length === 0 ? element("p", { text: "No issues were found in the training data." })
        : element("ul", { class: "findings" }, ...all.map((finding) => this.finding(finding))),
      shown.some((file) => file.use === "training") ? element("p", { class: "steps-left" }, "Next: ", element("a", { href: "#diagnose", text: "diagnose the data" }), " or ", element("a", { href: "#identify", text: "identify a model" }), ".") : null]);
  }

  finding(finding) {
    const isWarning = finding.severity === "warning";
    const places = finding.evidence.map((one) => ({ one, file: project.files.find((file) => file.records.some((record) => record.name === one.record)) })).filter(({ file }) => file);
    return element("li", {}, element("span", { class: isWarning ? "badge warning" : "badge", text: finding.severity }), linked(finding.words ?? finding.statement),
      places.length > 0 ? button("Show", () => this.showFinding(places), { "aria-label": `Show: ${finding.statement}` }) : null);
  }

  /** Marks the rows of a finding and zooms to the first of them. */
  async showFinding(places) {
    const { file } = places[0];
    if (file.id !== this.shown) {
      this.shown = file.id;
      await this.drawView(project.usable());
    }
    if (!this.figures) return;
    const ranges = places.filter((place) => place.file === file).map(({ one }) => {
      const begin = file.records.find((record) => record.name === one.record).from;
      return [begin + one.rows[0], begin + one.rows[1]];
    });
    this.figures.link.setMarked(ranges);
    this.figures.output.showRows(...ranges[0]);
    this.figures.loop.showRows(...ranges[0]);
    this.figures.node.scrollIntoView({ block: "nearest" });
  }
}
