// What the loop and the histories of one file share: the window of time, the row under the pointer, marked rows.

export class Link extends EventTarget {
  constructor() {
    super();
    /** @type {[number, number] | null} Window of time; null for all. */
    this.window = null;
    /** @type {[number, number] | null} Rows in the window. */
    this.rows = null;
    /** @type {number | null} */
    this.row = null;
    /** @type {[number, number][]} Rows of a finding. */
    this.marked = [];
    /** @type {[number, number][]} Rows that the zoomed loop shows. */
    this.inside = [];
  }
  setWindow(window, rows, source) {
    Object.assign(this, { window, rows });
    this.tell("window", source);
  }
  /** Everything is shown again, in all figures. */
  reset(source) {
    Object.assign(this, { window: null, rows: null, inside: [] });
    this.tell("reset", source);
  }
  setRow(row, source) {
    if (row === this.row) return;
    this.row = row;
    this.tell("row", source);
  }
  setMarked(ranges) {
    this.marked = ranges;
    this.tell("marked", null);
  }
  setInside(ranges, source) {
    this.inside = ranges;
    this.tell("inside", source);
  }
  tell(what, source) { this.dispatchEvent(new CustomEvent("change", { detail: { what, source } })); }
}
