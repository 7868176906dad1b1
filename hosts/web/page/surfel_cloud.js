/** The map: pieces of surfels that come, and of a run that goes on change and go; drawn with one material. */

import {
  BufferAttribute, BufferGeometry, DataTexture, Group, LinearFilter, Points, ShaderMaterial, Vector2,
} from 'three';
import {rampPixels, SHADER_MODE} from 'page/colour_modes.js';
import {FRAGMENT_SHADER, VERTEX_SHADER} from 'page/surfel_shader.js';

/** Discs grow by at most this when only a sample of them is drawn. */
const MOST_GROWTH = 2.5;

export class SurfelCloud {
  constructor(coding, mostPixels) {
    this.coding = coding;
    this.parts = new Map();  // by name: {piece (decodePiece()), points}
    this.loaded = 0;         // surfels
    this.discScale = 1;
    this.object = new Group();
    this.material = new ShaderMaterial({
      vertexShader: VERTEX_SHADER,
      fragmentShader: FRAGMENT_SHADER,
      uniforms: {
        ramp: {value: null},
        range: {value: new Vector2(0, 1)},
        mode: {value: SHADER_MODE.colour},
        lastFrame: {value: Infinity},
        leastRadius: {value: coding.least_radius},
        radiusGrowth: {value: coding.radius_growth},
        radiusScale: {value: 1},
        pixelsPerTangent: {value: 1},
        mostPixels: {value: mostPixels},
        cutaway: {value: true},
      },
    });
    this.showUntil(Infinity);
  }

  get pieces() { return [...this.parts.values()].map(({piece}) => piece); }

  /** A piece, in the place of an earlier one of that name. */
  put(name, piece) {
    this.remove(name);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(piece.positions, 3));
    geometry.setAttribute('colours', new BufferAttribute(piece.colours, 4, true));
    geometry.setAttribute('discs', new BufferAttribute(piece.discs, 4));
    geometry.setAttribute('frames', new BufferAttribute(piece.frames, 2));
    const points = new Points(geometry, this.material);
    points.frustumCulled = false;  // every piece is all over the room
    points.matrixAutoUpdate = false;
    this.object.add(points);
    this.parts.set(name, {piece, points});
    this.loaded += piece.surfels;
  }

  remove(name) {
    const part = this.parts.get(name);
    if (!part) return;
    this.object.remove(part.points);
    part.points.geometry.dispose();
    this.loaded -= part.piece.surfels;
    this.parts.delete(name);
  }

  /**
   * About `budget` surfels will be drawn, the first of each piece, larger so that the room stays closed; of these,
   * those from the share `from` to the share `to`. @returns how many there are in all
   */
  sample(budget, from = 0, to = 1) {
    const share = Math.min(1, budget / Math.max(this.loaded, 1));
    const counts = this.pieces.map(piece => Math.ceil(share * piece.surfels));
    const drawn = counts.reduce((sum, count) => sum + count, 0);
    const [first, end] = [from, to].map(part => Math.round(part * drawn));
    let before = 0;
    for (const [i, {points}] of [...this.parts.values()].entries()) {
      const [begin, stop] = [first, end].map(number => Math.min(Math.max(number - before, 0), counts[i]));
      points.geometry.setDrawRange(begin, stop - begin);
      points.visible = stop > begin;
      before += counts[i];
    }
    const growth = drawn > 0 ? Math.sqrt(this.loaded / drawn) : 1;
    this.material.uniforms.radiusScale.value = this.discScale * Math.min(growth, MOST_GROWTH);
    return drawn;
  }

  colourBy(mode) {
    const uniforms = this.material.uniforms;
    uniforms.mode.value = SHADER_MODE[mode.id];
    uniforms.ramp.value?.dispose();
    uniforms.ramp.value = null;
    if (!mode.ramp) return;
    const {width, data} = rampPixels(mode.ramp);
    const texture = new DataTexture(data, width, 1);
    texture.minFilter = texture.magFilter = LinearFilter;
    texture.needsUpdate = true;
    uniforms.ramp.value = texture;
    uniforms.range.value.set(...mode.range);
  }

  /** Only what was in the map after that frame. */
  showUntil(frame) {
    this.lastFrame = frame;
    this.material.uniforms.lastFrame.value = Math.min(frame, Number.MAX_SAFE_INTEGER);
  }

  set cutaway(on) { this.material.uniforms.cutaway.value = on; }
  get cutaway() { return this.material.uniforms.cutaway.value; }

  /** @param height  of the picture, in pixels of the screen */
  fitTo(camera, height) {
    const tangent = Math.tan(camera.fov * Math.PI / 360) / camera.zoom;
    this.material.uniforms.pixelsPerTangent.value = height / 2 / tangent;
  }
}
