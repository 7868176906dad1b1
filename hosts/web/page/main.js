/** Puts the page together: scene, picture, controls. */

import {Group, Raycaster, Scene, Vector2, WebGLRenderer} from 'three';
import {CameraTrack} from 'page/camera_track.js';
import {colourModes} from 'page/colour_modes.js';
import {element} from 'page/dom.js';
import {DrawLoop} from 'page/draw_loop.js';
import {GpuFence} from 'page/gpu_fence.js';
import {watchKeys} from 'page/keys.js';
import {LiveRun} from 'page/live_run.js';
import {Measuring, metres} from 'page/measuring.js';
import * as panel from 'page/panel.js';
import {pick} from 'page/picking.js';
import {watchPointer} from 'page/pointer.js';
import {readPieces, readScene} from 'page/scene_data.js';
import {Skeletons} from 'page/skeletons.js';
import {SurfelCloud} from 'page/surfel_cloud.js';
import {decodePiece} from 'page/surfel_decoder.js';
import {Timeline} from 'page/timeline.js';
import {Viewpoint} from 'page/viewpoint.js';

const MOST_PIXEL_RATIO = 2;   // more is not seen, but drawn
const ENDS = {finished: 'has finished', failed: 'has failed', interrupted: 'was interrupted'};
const PICK_PIXELS = 8;        // how far beside a point a click may be

function makeRenderer(canvas) {
  const renderer = new WebGLRenderer({
    canvas, alpha: true, antialias: false, powerPreference: 'high-performance',
    preserveDrawingBuffer: true,  // slices are drawn over one another
  });
  renderer.setClearColor(0, 0);  // the style sheet's background shines through
  return renderer;
}

class Page {
  constructor(scene, renderer) {
    this.data = scene;
    this.renderer = renderer;
    const gl = renderer.getContext();
    const [, mostPixels] = gl.getParameter(gl.ALIASED_POINT_SIZE_RANGE);
    this.cloud = new SurfelCloud(scene.map.coding, mostPixels);
    this.track = new CameraTrack(scene);
    this.skeletons = new Skeletons(scene.skeletons);
    this.cover = element('cover');
    this.pictures = 0;
    const {dataset} = document.documentElement;
    this.loop = new DrawLoop({
      fence: () => new GpuFence(gl),
      sample: (budget, sharpness) => this.sample(budget, sharpness),
      slice: (budget, from, to) => this.slice(budget, from, to),
      step: () => this.step(),
      shown: took => Object.assign(dataset, {pictures: String(++this.pictures), took: took.toFixed(1)}),
      rests: is => { dataset.rests = String(is); },
    });
    const redraw = () => this.loop.request();
    this.redraw = redraw;
    this.viewpoint = new Viewpoint(renderer.domElement, scene.map.bounds, redraw);
    this.measuring = new Measuring(element('labels'), () => this.measured());
    this.isMeasuring = false;
    this.grows = false;
    this.world = new Scene();
    this.marks = new Group();
    this.marks.add(this.track.object, this.skeletons.object, this.measuring.object);
    this.world.add(this.cloud.object, this.marks);
    this.timeline = new Timeline(scene.poses, scene.keyframes, pose => this.goTo(pose));
    this.addControls();
    this.resize();
    addEventListener('resize', () => this.resize());
    this.viewpoint.home(true);
    this.timeline.choose(0);
  }

  addControls() {
    const {viewpoint, cloud, track, timeline} = this;
    const modes = this.modes = panel.addModes(colourModes(this.data.map), mode => {
      cloud.colourBy(mode);
      this.redraw();
    });
    panel.addDiscSize(scale => {
      cloud.discScale = scale;
      this.redraw();
    });
    const onSwitch = (id, apply) => panel.onSwitch(id, on => {
      apply(on);
      this.redraw();
    });
    onSwitch('show-path', on => { track.pathVisible = on; });
    onSwitch('show-keyframes', on => { track.keyframesVisible = on; });
    onSwitch('show-people', on => { this.skeletons.visible = on; });
    onSwitch('cutaway', on => { cloud.cutaway = on; });
    onSwitch('grow', on => {
      this.grows = on;
      this.showTime();
    });
    this.offerWhatIsThere();
    viewpoint.left = () => panel.press('follow', false);
    const press = (id, action) => element(id).addEventListener('click', action);
    press('home', () => viewpoint.home());
    press('top', () => viewpoint.top());
    press('follow', () => this.follow(!viewpoint.following));
    press('measure', () => this.measure(!this.isMeasuring));
    press('measure-clear', () => this.measuring.clear());
    panel.addPanelToggle();
    const theme = panel.addTheme();
    const help = panel.addHelp();
    watchPointer(this.renderer.domElement, {
      click: (x, y) => this.click(x, y),
      twice: (x, y) => this.focus(x, y),
    });
    const arrow = direction => event => viewpoint.nudge({...direction, shift: event.shiftKey});
    watchKeys({
      ArrowLeft: arrow({right: -1}), ArrowRight: arrow({right: 1}),
      ArrowUp: arrow({up: 1}), ArrowDown: arrow({up: -1}),
      '+': () => viewpoint.zoom(true), '=': () => viewpoint.zoom(true), '-': () => viewpoint.zoom(false),
      r: () => viewpoint.home(), t: () => viewpoint.top(), c: () => this.follow(!viewpoint.following),
      m: () => this.measure(!this.isMeasuring), Escape: () => this.measure(false), l: theme, h: help, '?': help,
      ' ': () => timeline.toggle(), ',': () => timeline.move(-1), '.': () => timeline.move(1),
      '[': () => timeline.jump(false), ']': () => timeline.jump(true),
      ...Object.fromEntries([0, 1, 2, 3, 4, 5].map(i => [String(i + 1), () => modes.choose(i)])),
    });
  }

  offerWhatIsThere() {
    for (const id of ['show-path', 'show-keyframes', 'grow']) {
      element(id).closest('label').hidden = this.track.count === 0;
    }
    element('show-people').closest('label').hidden = this.skeletons.count === 0;
    element('follow').hidden = this.track.count === 0;
  }

  /** Everything that depends on the chosen time. */
  goTo(pose) {
    const keyframe = this.track.keyframeAt(pose);
    const number = this.data.keyframes.indexOf(keyframe);
    panel.showKeyframe(keyframe, number, keyframe ? this.data.poses.seconds[keyframe.pose] : 0);
    this.track.show(pose, keyframe?.pose === pose ? keyframe : null, this.redraw);
    document.documentElement.dataset.people = String(this.skeletons.show(pose));
    this.showTime();
    if (this.viewpoint.following) this.follow(true);
    this.redraw();
  }

  showTime() {
    this.cloud.showUntil(this.grows ? this.data.poses.frame[this.timeline.pose] : Infinity);
  }

  follow(on) {
    if (this.track.count === 0) return;
    panel.press('follow', on);
    if (on) this.viewpoint.follow(this.track.matrix(this.timeline.pose), this.track.intrinsics);
    else this.viewpoint.takeOver();
    this.redraw();
  }

  measure(on) {
    this.isMeasuring = on;
    panel.press('measure', on);
    document.body.classList.toggle('measuring', on);
    if (!on) this.measuring.cancel();
    panel.hint(on ? 'Choose the first of two points' : '', on);
  }

  measured() {
    panel.listDistances(this.measuring.distances);
    this.resize();
  }

  pointUnder(x, y) {
    const {width, height} = this.size();
    const caster = new Raycaster();
    const box = this.renderer.domElement.getBoundingClientRect();
    const camera = this.viewpoint.camera;
    caster.setFromCamera(new Vector2(2 * (x - box.left) / width - 1, 1 - 2 * (y - box.top) / height), camera);
    const slope = PICK_PIXELS * 2 * Math.tan(camera.fov * Math.PI / 360) / height;
    return pick(this.cloud, caster.ray, this.cloud.discScale, slope);
  }

  click(x, y) {
    if (!this.isMeasuring) return;
    const point = this.pointUnder(x, y);
    if (point === null) return panel.hint('There is no surface at this place', true);
    const distance = this.measuring.add(point);
    const next = distance === null ? 'Choose the second point' : `${metres(distance)}. Choose the next two points`;
    panel.hint(next, true);
  }

  focus(x, y) {
    if (this.isMeasuring) return;
    const point = this.pointUnder(x, y);
    if (point !== null) this.viewpoint.focus(point);
  }

  size() {
    const canvas = this.renderer.domElement;
    return {width: canvas.clientWidth, height: canvas.clientHeight};
  }

  resize() {
    const {width, height} = this.size();
    this.sharpen(1);
    this.renderer.setSize(width, height, false);
    this.viewpoint.fitTo(width / height);
    this.fitLines();
    this.redraw();
  }

  sharpen(share) {
    const ratio = share * Math.min(devicePixelRatio, MOST_PIXEL_RATIO);
    if (ratio === this.renderer.getPixelRatio()) return;
    this.renderer.setPixelRatio(ratio);
    this.fitLines();
  }

  /** Their width is in pixels. */
  fitLines() {
    const {width, height} = this.size();
    const ratio = this.renderer.getPixelRatio();
    for (const part of [this.track, this.skeletons, this.measuring]) part.fitTo(width * ratio, height * ratio, ratio);
  }

  step() {
    const plays = this.timeline.step();
    return this.viewpoint.step() || plays;
  }

  /** A picture with about that many surfels and that share of the pixels along each side. */
  sample(budget, sharpness) {
    this.sharpen(sharpness);
    this.draw(budget, 0, 1);
  }

  /** A part of a picture. Until it is complete, the one before is seen. */
  slice(budget, from, to) {
    if (from === 0) {
      this.keepPicture();
      this.sharpen(1);
    }
    this.draw(budget, from, to);
  }

  /** Adds to the picture what lies between these shares of it. */
  draw(budget, from, to) {
    const {camera} = this.viewpoint;
    const complete = to === 1;
    const drawn = this.cloud.sample(budget, from, to);
    this.track.object.visible = !this.viewpoint.following;  // nobody sees the camera that he looks through
    this.marks.visible = complete;
    this.cloud.fitTo(camera, this.renderer.domElement.height);
    const {width, height} = this.size();
    this.measuring.place(camera, width, height);
    this.renderer.autoClear = from === 0;
    this.renderer.render(this.world, camera);
    if (!complete) return;
    this.cover.hidden = true;
    document.documentElement.dataset.drawn = String(drawn);
  }

  keepPicture() {
    const {width, height} = this.renderer.domElement;
    Object.assign(this.cover, {width, height});
    this.cover.getContext('2d').drawImage(this.renderer.domElement, 0, 0);
    this.cover.hidden = false;
  }

  async load() {
    const {map} = this.data;
    for await (const piece of readPieces(map)) {
      this.cloud.put(this.cloud.parts.size, decodePiece(piece, map.coding));
      this.loop.largest = this.cloud.loaded;
      panel.showLoading(this.cloud.loaded / map.surfels);
      this.redraw();
    }
    document.documentElement.dataset.state = 'complete';
  }

  /** As long as the run goes on. */
  async watch() {
    panel.showLoading(1);
    const {dataset} = document.documentElement;
    const {coding} = this.data.map;
    const cell = (id, piece) => {
      if (piece === null) this.cloud.remove(id);
      else this.cloud.put(id, decodePiece(piece, coding));
      this.loop.largest = this.cloud.loaded;
      dataset.surfels = String(this.cloud.loaded);
      this.redraw();
    };
    dataset.state = 'live';
    try {
      const how = await new LiveRun(this.data.live, coding.bytes_per_surfel, cell, news => this.update(news)).watch();
      dataset.state = 'complete';
      panel.hint(`The run ${ENDS[how] ?? how}; \u201cposefusion web\u201d shows it again`, true);
    } catch (error) {
      console.warn(error);
      dataset.state = 'left';
      panel.hint('The run does not answer any more; this is what it had until then', true);
    }
  }

  update({status, frames, frames_to_do, map, poses, keyframes, people}) {
    const {data} = this;
    Object.assign(data, {poses, keyframes});
    Object.assign(data.map, map);
    const of = frames_to_do > 0 ? ` of ${frames_to_do}` : '';
    const goesOn = status === 'running';
    data.facts = [['Run', status], ['Frames', `${frames}${of}`]];
    if (poses.seconds.length > 0) data.facts.push(['Duration', `${poses.seconds.at(-1).toFixed(1)} s`]);
    panel.showTitle(data, goesOn ? `live, frame ${frames}${of}` : undefined);
    this.modes.update(colourModes(data.map));
    this.skeletons.set(people);
    this.track.set(poses, keyframes);
    const atTheEnd = this.timeline.set(poses, keyframes);
    this.viewpoint.grow(data.map.bounds);
    this.offerWhatIsThere();
    if (poses.frame.length > 0) this.timeline.choose(atTheEnd ? poses.frame.length - 1 : this.timeline.pose);
    this.fitLines();
    this.redraw();
  }
}

async function start() {
  const scene = readScene();
  panel.showTitle(scene);
  let renderer;
  try {
    renderer = makeRenderer(element('view'));
  } catch {
    panel.fail('This browser does not draw in 3-D here',
      'The page needs WebGL 2. It may be switched off: look for "hardware acceleration" in the settings of the ' +
      'browser, or at chrome://gpu or about:support, or open the page in another browser.');
    return;
  }
  try {
    const page = new Page(scene, renderer);
    await (scene.live ? page.watch() : page.load());
  } catch (error) {
    console.error(error);
    panel.fail('The map cannot be shown', error.message);
  }
}

start();
