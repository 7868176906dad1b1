/** Draws when something has changed, and with fewer surfels as long as it moves on a slow machine. */

const SLOW = 45;               // ms per picture: more, and turning the room is no longer smooth
const FAST = 22;
const LESS = 0.75;
const MORE = 1.25;
const SMALLEST_SAMPLE = 16384; // the first piece
const REST = 250;              // ms without a change until everything is drawn
const LONGEST_PAUSE = 1000;    // ms; longer, and it was no picture but a window in the background

export class DrawLoop {
  /**
   * @param draw(budget)  draws a picture with about that many surfels
   * @param step()        moves what moves by itself; returns whether it goes on
   * @param rests(is)     told when the picture begins to change, and when it is complete and still
   */
  constructor(draw, step, rests) {
    this.draw = draw;
    this.step = step;
    this.rests = rests;
    this.budget = Infinity;
    this.largest = SMALLEST_SAMPLE;  // of the budget: all surfels there are
    this.requested = false;
    this.before = null;   // time of the picture before, while it moves
    this.rest = null;     // timer
  }

  /** Something that is seen has changed. */
  request() {
    if (this.requested) return;
    this.requested = true;
    this.rests(false);
    requestAnimationFrame(now => this.frame(now));
  }

  frame(now) {
    this.requested = false;
    this.adapt(now);
    const goes_on = this.step();
    this.draw(Math.min(this.budget, this.largest));
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.finish(), REST);
    if (goes_on) this.request();
  }

  /** The time between two pictures includes the graphics card's, which a program cannot measure directly. */
  adapt(now) {
    const took = this.before === null ? null : now - this.before;
    this.before = now;
    if (took === null || took > LONGEST_PAUSE) return;
    const budget = Math.min(this.budget, this.largest);
    if (took > SLOW) this.budget = Math.max(budget * LESS, SMALLEST_SAMPLE);
    else if (took < FAST) this.budget = budget * MORE;
  }

  /** Nothing moves: the whole map. */
  finish() {
    if (this.requested) return;
    this.before = null;
    if (this.budget < this.largest) this.draw(Infinity);
    this.rests(true);
  }
}
