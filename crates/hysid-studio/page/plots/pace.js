// How many points a machine draws within a frame: fewer when frames are late, more when they are in time. The browser
// draws after a script has ended, so that only the time from frame to frame tells.

const LATE = 24; // Milliseconds from frame to frame.
const IN_TIME = 18.5;
const PAUSE = 120; // No frame of the same movement.

export class Pace {
  /** @param {{points: number, least: number, most: number}} limits */
  constructor({ points, least, most }) {
    Object.assign(this, { points, least, most, last: -Infinity });
  }
  /** A frame begins. */
  frame() {
    const now = performance.now();
    const passed = now - this.last;
    this.last = now;
    if (passed > LATE && passed < PAUSE) this.points = Math.max(this.least, Math.round(0.7 * this.points));
    else if (passed < IN_TIME) this.points = Math.min(this.most, Math.round(1.08 * this.points));
  }
}
