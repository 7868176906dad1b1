/** A run that goes on: asks its server what is new, and puts the parts together. Layout: hosts/web/live_json.cpp. */

import {bytesOf, download, downloadJson} from 'page/scene_data.js';

const PAUSE = 500;       // ms between having everything and asking again
const AT_ONCE = 4;       // downloads

/** Calls act(item) for each, a few at a time. */
async function forEachAtOnce(items, act) {
  const left = [...items];
  const work = async () => {
    for (let item = left.shift(); item !== undefined; item = left.shift()) await act(item);
  };
  await Promise.all(Array.from({length: AT_ONCE}, work));
}

const pause = () => new Promise(resolve => setTimeout(resolve, PAUSE));

export class LiveRun {
  /**
   * @param url       of the state
   * @param bytesPerSurfel  in the pieces of the map
   * @param cell(id, piece)  a part of the map is another; piece: {surfels, bytes}, null: it has gone
   * @param news({status, frames, frames_to_do, map, poses, keyframes, people})  after every look
   */
  constructor(url, bytesPerSurfel, cell, news) {
    Object.assign(this, {url, bytesPerSurfel, cell, news});
    this.base = url.slice(0, url.lastIndexOf('/') + 1);
    this.cells = new Map();    // id to version
    this.path = [];            // {version, poses, people}
    this.pictures = new Map(); // number to URL
  }

  /** Until the run has ended; @returns how. Throws if the server is gone. */
  async watch() {
    for (;;) {
      const state = await downloadJson(this.url);
      await this.takeMap(state.cells);
      await this.takePath(state.path);
      await this.takePictures(state.keyframes);
      this.news({...state, ...this.joined(), keyframes: this.keyframesOf(state.keyframes)});
      if (state.status !== 'running') return state.status;
      await pause();
    }
  }

  async takeMap(cells) {
    const there = new Set(cells.map(([id]) => id));
    for (const id of this.cells.keys()) {
      if (there.has(id)) continue;
      this.cells.delete(id);
      this.cell(id, null);
    }
    await forEachAtOnce(cells.filter(([id, version]) => this.cells.get(id) !== version), async ([id, version]) => {
      const packed = await download(`${this.base}map/${id}`);
      if (packed.length === 0) return;  // has gone since; the next state will tell
      const bytes = await bytesOf(packed);
      const surfels = bytes.length / this.bytesPerSurfel;
      if (!Number.isInteger(surfels)) throw new Error('a piece of the map is damaged');
      this.cells.set(id, version);
      this.cell(id, {surfels, bytes});
    });
  }

  async takePath(versions) {
    this.path.length = Math.min(this.path.length, versions.length);
    const changed = versions.map((version, i) => ({version, i})).filter(({version, i}) =>
      this.path[i]?.version !== version);
    await forEachAtOnce(changed, async ({version, i}) => {
      const part = await downloadJson(`${this.base}path/${i}`);
      if (part !== null) this.path[i] = {version, ...part};
    });
  }

  async takePictures(keyframes) {
    const wanted = new Set(keyframes.map(([, picture]) => picture).filter(picture => picture !== null));
    for (const [number, url] of this.pictures) {
      if (wanted.has(number)) continue;
      URL.revokeObjectURL(url);
      this.pictures.delete(number);
    }
    await forEachAtOnce([...wanted].filter(number => !this.pictures.has(number)), async number => {
      const bytes = await download(`${this.base}keyframes/${number}.jpg`);
      if (bytes.length > 0) this.pictures.set(number, URL.createObjectURL(new Blob([bytes], {type: 'image/jpeg'})));
    });
  }

  /** All poses and all people. */
  joined() {
    const poses = {frame: [], seconds: [], position: [], rotation: []};
    const people = new Map();
    for (const part of this.path.filter(known => known !== undefined)) {
      for (const [name, list] of Object.entries(part.poses)) for (const value of list) poses[name].push(value);
      for (const person of part.people) {
        const known = people.get(person.id);
        if (!known) {
          people.set(person.id, {...person, pose: [...person.pose], joints: [...person.joints]});
          continue;
        }
        known.pose.push(...person.pose);
        known.joints.push(...person.joints);
      }
    }
    return {poses, people: [...people.values()]};
  }

  keyframesOf(keyframes) {
    const count = this.path.reduce((sum, part) => sum + (part?.poses.frame.length ?? 0), 0);
    return keyframes.filter(([pose]) => pose < count).map(([pose, picture]) =>
      ({pose, image: this.pictures.get(picture) ?? null}));
  }
}
