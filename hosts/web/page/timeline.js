/** The slider over the time of the run. */

import {create, element} from 'page/dom.js';

const PLAY_SPEED = 1;   // recorded seconds per second

export class Timeline {
  /** @param changed(pose)  called whenever another pose is chosen */
  constructor(poses, keyframes, changed) {
    this.changed = changed;
    this.pose = 0;
    this.playing = null;  // {pose, begin}: from which pose on, since when
    this.slider = element('time');
    this.button = element('play');
    this.slider.addEventListener('input', () => {
      this.stop();
      this.choose(this.slider.valueAsNumber);
    });
    this.button.addEventListener('click', () => this.toggle());
    this.set(poses, keyframes);
  }

  /** @returns whether the newest pose was chosen until now, and so there may be a newer one to choose */
  set(poses, keyframes) {
    const newest = this.seconds === undefined || this.pose >= this.count - 1;
    this.seconds = poses.seconds;
    this.frames = poses.frame;
    this.keyframes = keyframes.map(keyframe => keyframe.pose);
    element('timeline').hidden = this.count === 0;
    this.slider.max = Math.max(this.count - 1, 0);
    this.addTicks();
    return newest;
  }

  get count() { return this.seconds.length; }

  addTicks() {
    const last = Math.max(this.count - 1, 1);
    element('ticks').replaceChildren(...this.keyframes.map(pose => {
      const tick = create('i');
      tick.style.left = `${100 * pose / last}%`;
      return tick;
    }));
  }

  choose(pose) {
    if (this.count === 0) return;
    this.pose = Math.min(Math.max(pose, 0), this.count - 1);
    const time = `${this.seconds[this.pose].toFixed(2)} s`;
    this.slider.value = this.pose;
    this.slider.style.setProperty('--share', this.count > 1 ? this.pose / (this.count - 1) : 0);
    this.slider.setAttribute('aria-valuetext', `${time}, frame ${this.frames[this.pose]}`);
    element('time-text').replaceChildren(create('b', {}, time), ` frame ${this.frames[this.pose]}`);
    this.changed(this.pose);
  }

  move(by) {
    this.stop();
    this.choose(this.pose + by);
  }

  /** To the next keyframe, or back. */
  jump(forward) {
    this.stop();
    const next = forward ? this.keyframes.find(pose => pose > this.pose)
      : this.keyframes.findLast(pose => pose < this.pose);
    if (next !== undefined) this.choose(next);
  }

  toggle() {
    if (this.playing) return this.stop();
    if (this.pose === this.count - 1) this.choose(0);
    this.playing = {pose: this.pose, begin: performance.now()};
    this.button.setAttribute('aria-pressed', 'true');
    this.button.setAttribute('aria-label', 'Pause');
    this.choose(this.pose);
  }

  stop() {
    this.playing = null;
    this.button.setAttribute('aria-pressed', 'false');
    this.button.setAttribute('aria-label', 'Play');
  }

  /** One step of playing. @returns whether it goes on */
  step() {
    if (!this.playing) return false;
    const {pose, begin} = this.playing;
    const now = this.seconds[pose] + PLAY_SPEED * (performance.now() - begin) / 1000;
    let next = this.pose;
    while (next + 1 < this.count && this.seconds[next + 1] <= now) ++next;
    if (next !== this.pose) this.choose(next);
    if (next === this.count - 1) this.stop();
    return this.playing !== null;
  }
}
