/** From where the map is looked at: by hand, along preset views, or through the recorded camera. */

import {PerspectiveCamera, Quaternion, Spherical, Vector3} from 'three';
import {OrbitControls} from 'three/OrbitControls';
import {wantsLessMotion} from 'page/dom.js';

const FIELD_OF_VIEW = 50;           // degrees
const NEAR = 0.02;                  // m
const FLIGHT_TIME = 700;            // ms
const DAMPING = 0.18;
const FOLLOW_DISTANCE = 1.5;        // m in front of the recorded camera: what is turned about afterwards
const KEY_ANGLE = Math.PI / 36;     // per press
const KEY_ZOOM = 0.88;
const KEY_SHIFT = 0.06;             // of the distance to the target
const HOME_DIRECTION = new Vector3(0.18, 0.62, 1).normalize();  // behind the first camera, from above
const HOME_DISTANCE = 0.95;         // in units of what would just fit
const NOTABLE_GROWTH = 0.03;        // of the size of the map
const AWAY_FROM_POLE = 0.02;        // rad: straight above, left and right are not defined
const UP = new Vector3(0, 1, 0);

/** Cameras of images look along +z with y down, those of WebGL along -z with y up. */
const FLIP = new Quaternion(1, 0, 0, 0);

const eased = t => t < 0.5 ? 4 * t ** 3 : 1 - (2 - 2 * t) ** 3 / 2;

export class Viewpoint {
  /** @param moved  called when the picture has to be drawn anew */
  constructor(canvas, bounds, moved) {
    this.moved = moved;
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, NEAR);
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, {
      enableDamping: !wantsLessMotion(), dampingFactor: DAMPING, zoomToCursor: true, screenSpacePanning: true,
      minDistance: 0.05,
    });
    this.setBounds(bounds);
    this.controls.addEventListener('start', () => this.takeOver());
    this.controls.addEventListener('change', moved);
    this.flight = null;
    this.following = false;
    this.atHome = false;   // the whole map is in view, and nobody has moved since
    this.left = () => {};  // called when the user leaves the recorded camera
  }

  setBounds([low, high]) {
    this.low = new Vector3(...low);
    this.high = new Vector3(...high);
    this.extent = Math.max(this.high.distanceTo(this.low), 0.1);
    this.camera.far = 60 * this.extent;
    this.camera.updateProjectionMatrix();
    this.controls.maxDistance = 6 * this.extent;
  }

  /** The map has grown: who looks at all of it goes on doing so. */
  grow(bounds) {
    const before = [...this.low.toArray(), ...this.high.toArray()];
    const most = Math.max(...bounds.flat().map((value, i) => Math.abs(value - before[i])));
    if (most < NOTABLE_GROWTH * this.extent) return;
    this.setBounds(bounds);
    if (this.atHome) this.home(true);
    this.moved();
  }

  /** The middle of the room and the distance from which all of it is in view. */
  frame() {
    const target = this.low.clone().add(this.high).multiplyScalar(0.5);
    const half = Math.tan(FIELD_OF_VIEW * Math.PI / 360) * Math.min(1, this.camera.aspect);
    return {target, distance: HOME_DISTANCE * this.extent / 2 / half};
  }

  home(at_once = false) {
    const {target, distance} = this.frame();
    this.fly(target.clone().addScaledVector(HOME_DIRECTION, distance), target, at_once);
    this.atHome = true;
  }

  top() {
    const {target, distance} = this.frame();
    const offset = new Vector3().setFromSpherical(new Spherical(distance, AWAY_FROM_POLE, 0));
    this.fly(target.clone().add(offset), target);
  }

  /** Turns about that point from now on. */
  focus(point) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const nearer = Math.min(offset.length(), this.camera.position.distanceTo(point));
    this.fly(point.clone().add(offset.setLength(nearer)), point);
  }

  fly(position, target, at_once = false) {
    this.takeOver();
    const from = {position: this.camera.position.clone(), target: this.controls.target.clone()};
    this.flight = {from, to: {position, target}, begin: at_once || wantsLessMotion() ? -Infinity : performance.now()};
    this.moved();
  }

  /** Looks through the recorded camera. @param pose  matrix from its axes to the page's */
  follow(pose, intrinsics) {
    this.flight = null;
    this.atHome = false;
    this.following = true;
    this.controls.enableDamping = false;
    pose.decompose(this.camera.position, this.camera.quaternion, new Vector3());
    this.camera.quaternion.multiply(FLIP);
    const forward = new Vector3(0, 0, -1).applyQuaternion(this.camera.quaternion);
    this.controls.target.copy(this.camera.position).addScaledVector(forward, FOLLOW_DISTANCE);
    // the whole image is in view, whatever the shape of the window
    const tangent = Math.max(intrinsics.height / 2 / intrinsics.fy,
      intrinsics.width / 2 / intrinsics.fx / this.camera.aspect);
    this.setFieldOfView(2 * Math.atan(tangent) * 180 / Math.PI);
    this.moved();
  }

  setFieldOfView(degrees) {
    this.camera.fov = degrees;
    this.camera.updateProjectionMatrix();
  }

  /** The user, or a flight, moves the view from now on. */
  takeOver() {
    this.flight = null;
    this.atHome = false;
    if (!this.following) return;
    this.following = false;
    this.controls.enableDamping = !wantsLessMotion();
    this.camera.up.copy(UP);
    this.setFieldOfView(FIELD_OF_VIEW);
    this.left();
  }

  /** One step; called before each picture. @returns whether another one will follow */
  step() {
    if (this.following) return false;
    if (this.flight) return this.fly_on();
    return this.controls.update();
  }

  fly_on() {
    const {from, to, begin} = this.flight;
    const t = Math.min((performance.now() - begin) / FLIGHT_TIME, 1);
    this.camera.position.lerpVectors(from.position, to.position, eased(t));
    this.controls.target.lerpVectors(from.target, to.target, eased(t));
    this.camera.lookAt(this.controls.target);
    if (t === 1) {
      this.flight = null;
      this.controls.update();
    }
    return t < 1;
  }

  /** Turns (radians), shifts (shares of the distance) and zooms about the target: what the keys do. */
  nudge({right = 0, up = 0, shift = false, zoom = 1}) {
    this.takeOver();
    const offset = this.camera.position.clone().sub(this.controls.target);
    if (shift) {
      const across = new Vector3().setFromMatrixColumn(this.camera.matrix, 0).multiplyScalar(right);
      const upwards = new Vector3().setFromMatrixColumn(this.camera.matrix, 1).multiplyScalar(up);
      this.controls.target.add(across.add(upwards).multiplyScalar(KEY_SHIFT * offset.length()));
    } else {
      const at = new Spherical().setFromVector3(offset);
      at.theta += KEY_ANGLE * right;
      at.phi = Math.min(Math.max(at.phi - KEY_ANGLE * up, AWAY_FROM_POLE), Math.PI - AWAY_FROM_POLE);
      offset.setFromSpherical(at);
    }
    this.camera.position.copy(this.controls.target).add(offset.multiplyScalar(zoom));
    this.controls.update();
    this.moved();
  }

  zoom(closer) { this.nudge({zoom: closer ? KEY_ZOOM : 1 / KEY_ZOOM}); }

  fitTo(aspect) {
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
  }
}
