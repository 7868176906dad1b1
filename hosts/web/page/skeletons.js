/** People: their skeletons at the time of the slider, and where they walked until then. */

import {Group} from 'three';
import {WideLines} from 'page/wide_lines.js';

const LIMBS = {width: 4, through: true};
const WAY = {width: 2, opacity: 0.6};

const METRES = 1 / 1000;         // of the numbers in the scene
const LONGEST_GAP = 5;           // poses: a person who was not seen in so many is not there
const NECK = 1;                  // of OpenPose's joints; its way is that of the person

export class Skeletons {
  /** Layout: hosts/web/scene_json.cpp. */
  constructor({limbs, people}) {
    this.limbs = limbs;
    this.object = new Group();
    this.people = [];
    this.set(people);
  }

  set(people) {
    const before = this.people;
    this.people = people.map(person => {
      const {colour} = person;
      const known = before.find(({id}) => id === person.id);
      const body = known?.body ?? new WideLines([], {colour, ...LIMBS});
      const way = known?.way ?? new WideLines([], {colour, ...WAY});
      if (!known) this.object.add(way.object, body.object);
      return {...person, body, way};
    });
    for (const {id, body, way} of before) {
      if (!people.some(person => person.id === id)) this.object.remove(body.object, way.object);
    }
  }

  get count() { return this.people.length; }

  point(joints, joint) {
    const at = joints.slice(3 * joint, 3 * joint + 3);
    return at[0] === null ? null : at.map(value => value * METRES);
  }

  limbSegments(joints) {
    return this.limbs.flatMap(([a, b]) => {
      const [from, to] = [this.point(joints, a), this.point(joints, b)];
      return from && to ? [...from, ...to] : [];
    });
  }

  /** The way of the neck in the first sightings. */
  waySegments(person, sightings) {
    const segments = [];
    for (let i = 1; i < sightings; ++i) {
      const [from, to] = [this.point(person.joints[i - 1], NECK), this.point(person.joints[i], NECK)];
      if (from && to && person.pose[i] - person.pose[i - 1] <= LONGEST_GAP) segments.push(...from, ...to);
    }
    return segments;
  }

  /** @returns how many are there at that pose */
  show(pose) {
    let there = 0;
    for (const person of this.people) {
      const last = person.pose.findLastIndex(p => p <= pose);
      const seen = last >= 0 && pose - person.pose[last] <= LONGEST_GAP;
      person.body.set(seen ? this.limbSegments(person.joints[last]) : []);
      person.way.set(this.waySegments(person, last + 1));
      there += seen ? 1 : 0;
    }
    return there;
  }

  set visible(on) { this.object.visible = on; }

  fitTo(width, height, ratio) {
    for (const {body, way} of this.people) [body, way].forEach(line => line.fitTo(width, height, ratio));
  }
}
