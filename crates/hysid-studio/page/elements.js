// Makes elements of the page. Names of files and columns are data: they only ever become text or attributes.

let made = 0;

/** A new id, to connect a label with its control. */
export const newId = (prefix) => `${prefix}-${(made += 1)}`;

/**
 * An element with its properties (`class`, `on` for listeners, attributes by name, others as properties) and children.
 * @param {string} name
 * @param {Record<string, any>} [properties]
 * @param {...(Node | string | null | undefined | false)} children
 */
export function element(name, properties = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (key === "on") for (const [event, listener] of Object.entries(value)) node.addEventListener(event, listener);
    else if (key === "class") node.className = value;
    else if (key in node && key !== "list" && typeof value !== "string") node[key] = value;
    else if (key === "text") node.textContent = value;
    else if (key === "value") node.value = value;
    else node.setAttribute(key, value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
  return node;
}

export const button = (text, action, properties = {}) =>
  element("button", { type: "button", text, on: { click: action }, ...properties });

/** HTML that the server made and escaped. Nothing else on the page is read as HTML. */
export function documentOf(html) {
  const parsed = new DOMParser().parseFromString(html, "text/html");
  return element("div", { class: "document" }, ...parsed.body.childNodes);
}

/**
 * A table in a box of its own that scrolls sideways.
 * @param {string} caption
 * @param {(string | {text: string, class?: string})[]} heads
 * @param {((string | Node)[])[]} rows: the first cell of a row is its head.
 */
export function table(caption, heads, rows) {
  const head = heads.map((entry) => (typeof entry === "string" ? { text: entry } : entry));
  const cell = (content, column) => {
    const node = element(column === 0 ? "th" : "td", { scope: column === 0 ? "row" : undefined, class: head[column].class, "data-label": head[column].text });
    node.append(content ?? "");
    return node;
  };
  return element("div", { class: "scroll cards", tabindex: "0", role: "region", "aria-label": caption },
    element("table", {},
      element("caption", { class: "hidden", text: caption }),
      element("thead", {}, element("tr", {}, ...head.map((entry) => element("th", { scope: "col", text: entry.text, class: entry.class })))),
      element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map(cell))))));
}

/** What a step shows as long as it has nothing to show, and what to do next. */
export const emptyState = (words, ...more) => element("div", { class: "empty" }, element("p", { text: words }), ...more);

/**
 * A part of a step that is built again only when its key changes. The focus stays on the control with the same id.
 */
export class Region {
  /** @param {HTMLElement} [node] */
  constructor(node = element("div")) {
    this.node = node;
    this.key = undefined;
  }
  /**
   * @param {any} key: anything that becomes JSON.
   * @param {() => (Node | string | null)[]} build
   */
  update(key, build) {
    const text = JSON.stringify(key);
    if (text === this.key) return;
    this.key = text;
    const focused = this.node.contains(document.activeElement) ? document.activeElement.id : "";
    this.node.replaceChildren(...build().filter((child) => child !== null && child !== undefined));
    if (focused) document.getElementById(focused)?.focus({ preventScroll: true });
  }
}
