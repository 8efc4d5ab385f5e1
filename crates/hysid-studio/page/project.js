// The project as the server has it, and the arrays that were fetched for it.

import { getBinary, getJson } from "./server.js";

const KEPT = 24; // Answers that are kept, so that going back to a step is immediate.

class Project extends EventTarget {
  constructor() {
    super();
    this.choices = null;
    this.state = null;
    this.kept = new Map();
  }

  /** Fetches the project. Only one request at a time is on its way, so that an old state never follows a new one. */
  load() {
    this.isOutdated = true;
    this.loading ??= this.fetchAll().finally(() => { this.loading = null; });
    return this.loading;
  }
  async fetchAll() {
    while (this.isOutdated) {
      this.isOutdated = false;
      await this.fetchState();
    }
  }
  async fetchState() {
    const [choices, state] = await Promise.all([this.choices ?? getJson("/api/choices"), getJson("/api/project")]);
    Object.assign(this, { choices, state });
    this.dispatchEvent(new Event("change"));
  }
  /** Progress of a fit. */
  setFit(fit) {
    if (!this.state) return;
    this.state.fit = fit;
    this.dispatchEvent(new Event("fit"));
  }

  get files() { return this.state.files; }
  /** Models whose file can be read. */
  get models() { return this.state.models.filter((model) => !model.problem); }
  get labels() { return this.state.labels; }
  usable(use) { return this.files.filter((file) => file.read_as !== null && !file.problem && (use ? file.use === use : file.use !== "unused")); }
  /** Changes when the columns of a file mean something else. */
  dataKey(file) { return JSON.stringify([file.id, file.rows, file.bytes, file.use === "unused", file.columns.map(({ role }) => role), this.state.columns, this.state.reading]); }

  /** An answer that is asked for once. */
  once(key, ask) {
    if (!this.kept.has(key)) {
      const answer = ask();
      answer.catch(() => this.kept.delete(key));
      this.kept.set(key, answer);
      if (this.kept.size > KEPT) this.kept.delete(this.kept.keys().next().value);
    }
    return this.kept.get(key);
  }
  columns(file) {
    return this.once(`columns ${this.dataKey(file)}`, async () => {
      const { cut, headers } = await getBinary(`/api/files/${file.id}/columns`);
      const names = headers.get("x-columns").split(",");
      const arrays = cut(names.length);
      const of = (name) => arrays.filter((_, k) => names[k] === name);
      return { time: of("time")[0] ?? of("row")[0], inputs: of("input"), rate: of("rate")[0] ?? null, output: of("output")[0] };
    });
  }
  simulated(model, file) {
    return this.once(`simulated ${model.id} ${this.dataKey(file)}`, async () => {
      const { cut, headers } = await getBinary(`/api/models/${model.id}/simulated/${file.id}`);
      const names = (headers.get("x-columns") ?? "simulated").split(",");
      const arrays = cut(names.length);
      const of = (name) => arrays[names.indexOf(name)] ?? null;
      return { y: of("simulated"), low: of("low"), high: of("high") };
    });
  }
  members(model, file) {
    return this.once(`members ${model.id} ${this.dataKey(file)}`, async () => {
      const { cut, headers } = await getBinary(`/api/models/${model.id}/members/${file.id}`);
      const names = JSON.parse(decodeURIComponent(headers.get("x-names") ?? "[]"));
      return cut(names.length).map((y, k) => ({ name: names[k], y }));
    });
  }
  judgement(model, file) {
    return this.once(`judgement ${model.id} ${this.dataKey(file)} ${file.use}`, () => getJson(`/api/models/${model.id}/judgement/${file.id}`));
  }
  ofModel(model, what) { return this.once(`${what} ${model.id}`, () => getJson(`/api/models/${model.id}/${what}`)); }
}

export const project = new Project();
export const startsOf = (file) => file.records.map((record) => record.from);
