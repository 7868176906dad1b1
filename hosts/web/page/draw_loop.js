/**
 * Draws when something has changed: as many surfels as the machine draws in time while it moves, all of them in slices
 * once it stands still. Nothing is begun before the graphics card has finished what came before, so that an answer to
 * the user waits for one slice at most.
 */

const MOVING = 33;             // ms per picture: more, and turning the room is no longer smooth
const SLICE = 80;              // ms: each costs a picture of the whole page as well
const SLOW = 1.35;             // times what is wanted
const FAST = 0.67;
const MORE = 1.5;              // times as many surfels after a fast picture
const LATE = 200;              // ms: so slow a picture counts at once; others when the one before was slow, too
const SMALLEST_SAMPLE = 16384; // the first piece
const SMALLEST_SLICE = 1024;
const JERKY = 90;              // ms per picture: rather fewer pixels
const COARSEST = 0.25;         // of the pixels along a side
const SHARPER = 1.2;
const REST = 250;              // ms without a change until everything is drawn

/** How many surfels are drawn at a time. */
class Pace {
  /** @param wanted  ms  @param smallest, surfels  at least, and at first */
  constructor(wanted, smallest, surfels = Infinity) {
    Object.assign(this, {wanted, smallest, surfels});
    this.before = 0;     // ms
    this.sharpness = 1;  // share of the pixels along a side
  }

  measure(took, drawn) {
    const steady = took > LATE ? took : Math.min(took, this.before);
    this.before = took;
    if (steady > SLOW * this.wanted) this.surfels = Math.max(drawn * this.wanted / steady, this.smallest);
    else if (took < FAST * this.wanted) this.surfels = Math.max(drawn * MORE, this.surfels);
    return steady;
  }

  /** As measure(). Discs fill the picture however few they are: where that is what takes the time, it gets coarser. */
  measureSample(took, drawn) {
    const {surfels, sharpness} = this;
    const steady = this.measure(took, drawn);
    if (steady > JERKY && drawn <= this.smallest) {
      this.sharpness = Math.max(sharpness * Math.sqrt(FAST * JERKY / steady), COARSEST);
    } else if (sharpness < 1) {
      this.surfels = Math.min(this.surfels, surfels);
      if (took < FAST * FAST * JERKY) this.sharpness = Math.min(sharpness * SHARPER, 1);
    }
  }
}

export class DrawLoop {
  /**
   * @param fence()           told of the end of what has been drawn: {passed}
   * @param sample(budget, sharpness)  draws a picture with about that many surfels and that share of the pixels along
   *                          each side
   * @param slice(budget, from, to)  draws what lies between these shares of a picture with that many surfels and all
   *                          pixels; the first slice begins it
   * @param step()            moves what moves by itself; returns whether it goes on
   * @param shown(took)       told when a picture is complete, and how long it took, ms
   * @param rests(is)         told when the picture begins to change, and when it is complete and still
   */
  constructor({fence, sample, slice, step, shown, rests}) {
    Object.assign(this, {fence, sample, slice, step, shown, rests});
    this.moving = new Pace(MOVING, SMALLEST_SAMPLE);
    this.better = [];         // budgets of pictures that are to be drawn in slices when nothing moves
    this.at = 0;              // share of the first of them that is drawn
    this.still = null;        // pace of the slices
    this.largest = SMALLEST_SAMPLE;  // of the budget: all surfels there are
    this.requested = this.scheduled = false;
    this.work = null;         // of the graphics card: {fence, begin, done(took)}
    this.changed = 0;         // time of the last change
    // what happened in the background says nothing about the machine
    document.addEventListener('visibilitychange', () => { if (this.work) this.work.begin = null; });
  }

  /** Something that is seen has changed. */
  request() {
    this.requested = true;
    this.rests(false);
    this.schedule();
  }

  schedule() {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => this.frame());
  }

  frame() {
    this.scheduled = false;
    if (this.work && !this.work.fence.passed) return this.schedule();
    this.finish();
    if (this.requested) this.drawSample();
    else if (performance.now() - this.changed > REST) {
      if (this.better.length === 0) return this.rests(true);
      this.drawSlice();
    }
    this.schedule();
  }

  begin(draw, done) {
    const begin = performance.now();
    draw();
    this.work = {fence: this.fence(), begin, done};
  }

  finish() {
    if (!this.work) return;
    const {begin, done} = this.work;
    this.work = null;
    if (begin !== null) done(performance.now() - begin);
  }

  drawSample() {
    this.requested = this.step();
    const {largest, moving} = this, {sharpness} = moving;
    const budget = Math.min(moving.surfels, largest);
    this.better = sharpness < 1 && budget < largest ? [budget, largest]
      : sharpness < 1 || budget < largest ? [largest] : [];
    this.at = 0;
    this.still = new Pace(SLICE, SMALLEST_SLICE, budget * sharpness ** 2);
    this.begin(() => this.sample(budget, sharpness), took => {
      moving.measureSample(took, budget);
      this.shown(took);
    });
    this.changed = performance.now();
  }

  drawSlice() {
    const {still, at} = this, [budget] = this.better;
    const to = Math.min(at + still.surfels / budget, 1);
    this.begin(() => this.slice(budget, at, to), took => still.measure(took, (to - at) * budget));
    this.at = to < 1 ? to : 0;
    if (to === 1) this.better.shift();
  }
}
