/** Distances between two points of the map, as lines with a label. */

import {Group, Mesh, MeshBasicMaterial, SphereGeometry, Vector3} from 'three';
import {create} from 'page/dom.js';
import {WideLines} from 'page/wide_lines.js';

const LINE = {colour: '#ff3d7f', width: 2.5, through: true};
const POINT_SIZE = 0.006;  // of the distance to the eye

/** Metres as text: to the millimetre, which is about the accuracy of the positions in the page. */
export const metres = value => `${value.toFixed(3)} m`;

export class Measuring {
  /** @param labels  element over the picture, for the labels */
  constructor(labels, changed) {
    this.labels = labels;
    this.changed = changed;
    this.object = new Group();
    this.distances = [];  // {a, b, metres, line, label}
    this.start = null;    // first of two points
    this.points = [];
    this.lines = [];
    this.ball = new SphereGeometry(1, 16, 12);
    this.paint = new MeshBasicMaterial({color: LINE.colour, depthTest: false, transparent: true});
  }

  /** The next point. @returns the distance if it was the second one, else null */
  add(point) {
    this.mark(point);
    if (this.start === null) {
      this.start = point;
      this.changed();
      return null;
    }
    const [a, b] = [this.start, point];
    this.start = null;
    const line = new WideLines([...a.toArray(), ...b.toArray()], LINE);
    line.object.renderOrder = 2;
    const distance = a.distanceTo(b);
    const label = create('span', {className: 'measure', textContent: metres(distance)});
    this.labels.append(label);
    this.lines.push(line);
    this.object.add(line.object);
    this.distances.push({middle: a.clone().add(b).multiplyScalar(0.5), metres: distance,
      rise: Math.abs(a.y - b.y), label});
    this.changed();
    return distance;
  }

  mark(point) {
    const mark = new Mesh(this.ball, this.paint);
    mark.position.copy(point);
    mark.renderOrder = 3;
    this.points.push(mark);
    this.object.add(mark);
  }

  /** A distance of which only one point was chosen. */
  cancel() {
    if (this.start === null) return;
    this.object.remove(this.points.pop());
    this.start = null;
    this.changed();
  }

  clear() {
    this.object.clear();
    this.labels.replaceChildren();
    this.distances = [];
    this.points = [];
    this.lines = [];
    this.start = null;
    this.changed();
  }

  fitTo(width, height, ratio) {
    this.lines.forEach(line => line.fitTo(width, height, ratio));
  }

  /** Keeps points at their size and labels at their lines. */
  place(camera, width, height) {
    for (const point of this.points) point.scale.setScalar(POINT_SIZE * point.position.distanceTo(camera.position));
    for (const {middle, label} of this.distances) {
      const seen = new Vector3().copy(middle).project(camera);
      label.hidden = seen.z > 1 || seen.z < -1;
      label.style.transform = `translate(${(seen.x + 1) / 2 * width}px, ${(1 - seen.y) / 2 * height}px)`;
    }
  }
}
