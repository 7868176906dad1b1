/** Where the camera was: its path, the keyframes, and the camera at the time of the slider. */

import {
  DoubleSide, Group, Matrix4, Mesh, MeshBasicMaterial, PlaneGeometry, Quaternion, SRGBColorSpace, TextureLoader,
  Vector3,
} from 'three';
import {WideLines} from 'page/wide_lines.js';

const PATH = {colour: '#2f9bff', width: 3};
const PASSED = {colour: '#ffb020', width: 3};
const KEYFRAME = {colour: '#2f9bff', width: 1.5, opacity: 0.75};
const CAMERA = {colour: '#ffb020', width: 2.5};

/** Metres from the eye to the image plane of the symbols. */
const CAMERA_DEPTH = 0.22;
const KEYFRAME_DEPTH = 0.09;

/** When the run does not say what camera it was: one as wide as most depth cameras. */
const USUAL_CAMERA = {width: 640, height: 480, fx: 525, fy: 525, cx: 319.5, cy: 239.5};

/** Segments of a pyramid; axes of the camera: x right, y down, z forward. */
function pyramid(camera, depth) {
  const corner = (u, v) => [(u - camera.cx) / camera.fx * depth, (v - camera.cy) / camera.fy * depth, depth];
  const corners = [corner(0, 0), corner(camera.width, 0), corner(camera.width, camera.height),
    corner(0, camera.height)];
  const edges = corners.map((c, i) => [...c, ...corners[(i + 1) % corners.length]]);
  return edges.concat(corners.map(c => [0, 0, 0, ...c])).flat();
}

function transformed(segments, matrix) {
  const out = [];
  const point = new Vector3();
  for (let i = 0; i < segments.length; i += 3) {
    point.fromArray(segments, i).applyMatrix4(matrix).toArray(out, i);
  }
  return out;
}

export class CameraTrack {
  constructor(scene) {
    this.intrinsics = scene.camera ?? USUAL_CAMERA;
    this.object = new Group();
    this.path = new WideLines([], PATH);
    this.passed = new WideLines([], PASSED);
    this.passed.object.renderOrder = 1;
    this.symbols = new WideLines([], KEYFRAME);
    this.camera = new WideLines(pyramid(this.intrinsics, CAMERA_DEPTH), CAMERA);
    this.camera.object.matrixAutoUpdate = false;
    this.picture = this.makePicture();
    this.camera.object.add(this.picture);
    this.lines = [this.path, this.passed, this.symbols, this.camera];
    this.object.add(...this.lines.map(line => line.object));
    this.textures = new TextureLoader();
    this.set(scene.poses, scene.keyframes);
  }

  set(poses, keyframes) {
    this.poses = poses;
    this.keyframes = keyframes;
    this.path.set(this.pathSegments(0, this.count - 1));
    this.symbols.set(this.keyframeSegments());
    this.camera.object.visible = this.count > 0;
  }

  get count() { return this.poses.frame.length; }

  position(pose) { return new Vector3().fromArray(this.poses.position, 3 * pose); }

  /** From the camera's axes to the page's. */
  matrix(pose) {
    const rotation = new Quaternion().fromArray(this.poses.rotation, 4 * pose).normalize();
    return new Matrix4().compose(this.position(pose), rotation, new Vector3(1, 1, 1));
  }

  /** Frames without tracking leave a gap: nobody knows where the camera was. */
  pathSegments(first, last) {
    const {frame, position} = this.poses;
    const segments = [];
    for (let i = first; i < last; ++i) {
      if (frame[i + 1] === frame[i] + 1) segments.push(...position.slice(3 * i, 3 * i + 6));
    }
    return segments;
  }

  keyframeSegments() {
    const symbol = pyramid(this.intrinsics, KEYFRAME_DEPTH);
    return this.keyframes.flatMap(keyframe => transformed(symbol, this.matrix(keyframe.pose)));
  }

  /** What the camera saw, on the image plane of its symbol; seen from both sides, as if it were glass. */
  makePicture() {
    const {width, height, fx, fy, cx, cy} = this.intrinsics;
    const plane = new PlaneGeometry(width / fx * CAMERA_DEPTH, height / fy * CAMERA_DEPTH);
    const material = new MeshBasicMaterial({side: DoubleSide, transparent: true, opacity: 0.92});
    const picture = new Mesh(plane, material);
    picture.rotation.x = Math.PI;  // images have y down
    picture.position.set((width / 2 - cx) / fx * CAMERA_DEPTH, (height / 2 - cy) / fy * CAMERA_DEPTH, CAMERA_DEPTH);
    picture.visible = false;
    return picture;
  }

  /** @param keyframe  whose picture the camera shows; null: none */
  show(pose, keyframe, redraw) {
    this.passed.set(this.pathSegments(0, pose));
    this.camera.object.matrix.copy(this.matrix(pose));
    const url = keyframe?.image ?? null;
    this.picture.visible = url !== null && this.picture.material.map !== null && this.shown === url;
    if (url === null || this.shown === url) return;
    this.shown = url;
    this.textures.load(url, texture => {
      if (this.shown !== url) return texture.dispose();
      texture.colorSpace = SRGBColorSpace;
      this.picture.material.map?.dispose();
      this.picture.material.map = texture;
      this.picture.material.needsUpdate = true;
      this.picture.visible = true;
      redraw();
    });
  }

  /** The last keyframe until that pose, or the first one; null: there are none with a picture. */
  keyframeAt(pose) {
    const pictured = this.keyframes.filter(keyframe => keyframe.image !== null);
    return pictured.findLast(keyframe => keyframe.pose <= pose) ?? pictured[0] ?? null;
  }

  set pathVisible(on) { this.path.object.visible = this.passed.object.visible = on; }

  set keyframesVisible(on) { this.symbols.object.visible = on; }

  fitTo(width, height, ratio) {
    this.lines.forEach(line => line.fitTo(width, height, ratio));
  }
}
