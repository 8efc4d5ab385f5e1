// Pointer, wheel, touch and keys on a figure, as calls of the figure: zoom to a box, zoom about a point, move, reset, hover.

/**
 * @param {HTMLElement} area: the plotting area.
 * @param {HTMLElement} focusable: the element that has the keyboard.
 * @param {{zoomTo: Function, zoomAbout: Function, move: Function, reset: Function, hover: Function, leave: Function, box: Function}} figure
 *   All positions are shares of the area, from its left and from its bottom.
 */
export function listen(area, focusable, figure) {
  let begin = null;
  let last = null;
  const touches = new Map();
  const shares = (event) => {
    const box = area.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height];
  };
  const within = (at) => at.map((share) => Math.min(Math.max(share, 0), 1));
  const boxOf = (from, to) => [[Math.min(from[0], to[0]), Math.max(from[0], to[0])], [Math.min(from[1], to[1]), Math.max(from[1], to[1])]];

  area.addEventListener("pointerdown", (event) => {
    const at = shares(event);
    if (event.pointerType === "touch") {
      touches.set(event.pointerId, at);
      return;
    }
    if (event.button !== 0) return;
    begin = last = at;
    area.setPointerCapture(event.pointerId);
    event.preventDefault();
    focusable.focus({ preventScroll: true });
  });
  area.addEventListener("pointermove", (event) => {
    const at = shares(event);
    if (event.pointerType === "touch" && touches.size === 2) return pinch(event.pointerId, at);
    if (!begin) return figure.hover(at);
    if (event.shiftKey) {
      figure.move(last[0] - at[0], last[1] - at[1]);
      begin = last = at;
    } else figure.box(boxOf(begin, within(at)));
    return undefined;
  });
  const end = (event) => {
    touches.delete(event.pointerId);
    figure.box(null);
    if (!begin) return;
    const [x, y] = boxOf(begin, within(shares(event)));
    begin = null;
    if (event.type === "pointercancel" || event.shiftKey) return;
    // A click is no zoom; a flat or narrow box shows all of the other axis.
    const [isWide, isHigh] = [x[1] - x[0] > 0.02, y[1] - y[0] > 0.04];
    if (isWide || isHigh) figure.zoomTo(isWide ? x : [0, 1], isHigh ? y : [0, 1]);
  };
  area.addEventListener("pointerup", end);
  area.addEventListener("pointercancel", end);
  area.addEventListener("pointerleave", () => { if (!begin) figure.leave(); });
  area.addEventListener("dblclick", () => figure.reset());
  // The wheel scrolls the page until the figure has the focus, or with Ctrl, as maps in a page do.
  area.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey && document.activeElement !== focusable) return;
    event.preventDefault();
    if (Math.abs(event.deltaX) > Math.abs(event.deltaY)) figure.move(event.deltaX / area.clientWidth, 0);
    else figure.zoomAbout(shares(event), Math.exp(Math.min(Math.max(event.deltaY, -100), 100) / 300));
  }, { passive: false });

  function pinch(id, at) {
    const before = touches.get(id);
    const other = [...touches].find(([key]) => key !== id)[1];
    touches.set(id, at);
    const [old, now] = [Math.hypot(before[0] - other[0], before[1] - other[1]), Math.hypot(at[0] - other[0], at[1] - other[1])];
    if (old > 0.05 && now > 0.05) figure.zoomAbout([(at[0] + other[0]) / 2, (at[1] + other[1]) / 2], Math.min(Math.max(old / now, 0.8), 1.25));
    figure.move((before[0] - at[0]) / 2, (before[1] - at[1]) / 2);
  }

  focusable.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target !== focusable) return;
    const step = 0.15;
    const actions = {
      "+": () => figure.zoomAbout([0.5, 0.5], 0.8), "=": () => figure.zoomAbout([0.5, 0.5], 0.8), "-": () => figure.zoomAbout([0.5, 0.5], 1.25),
      0: () => figure.reset(), Escape: () => figure.reset(),
      ArrowLeft: () => figure.move(-step, 0), ArrowRight: () => figure.move(step, 0), ArrowDown: () => figure.move(0, -step), ArrowUp: () => figure.move(0, step),
    };
    if (!actions[event.key]) return;
    actions[event.key]();
    event.preventDefault();
  });
}
