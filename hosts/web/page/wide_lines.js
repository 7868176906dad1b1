/** Lines of a width in pixels; WebGL's own are one pixel wide, which is hardly seen on today's screens. */

import {
  Color, DynamicDrawUsage, InstancedBufferAttribute, InstancedBufferGeometry, BufferAttribute, Mesh, ShaderMaterial,
  Vector2,
} from 'three';

const VERTEX_SHADER = `
attribute vec3 from, to;
uniform vec2 size;     // of the picture, pixels
uniform float width;   // pixels
const float NEAR = 0.01;

void main() {
  // what lies behind the eye is cut off: it has no place in the picture
  vec4 a = modelViewMatrix * vec4(from, 1.0), b = modelViewMatrix * vec4(to, 1.0);
  if (a.z > -NEAR && b.z > -NEAR) { gl_Position = vec4(0.0, 0.0, 2.0, 1.0); return; }
  if (a.z > -NEAR) a = mix(a, b, (a.z + NEAR) / (a.z - b.z));
  if (b.z > -NEAR) b = mix(b, a, (b.z + NEAR) / (b.z - a.z));
  vec4 p = projectionMatrix * a, q = projectionMatrix * b;
  vec2 along = (q.xy / q.w - p.xy / p.w) * size;
  along = length(along) > 1e-6 ? normalize(along) : vec2(1.0, 0.0);
  vec4 end = position.x < 0.0 ? p : q;
  vec2 shift = (position.x * along + position.y * vec2(-along.y, along.x)) * width / size;
  gl_Position = end + vec4(shift * end.w, 0.0, 0.0);
}
`;

const FRAGMENT_SHADER = `
uniform vec3 colour;
uniform float opacity;
void main() { gl_FragColor = vec4(colour, opacity); }
`;

/** Corners of the rectangle around a segment; x: which end, y: which side. Reaching over the ends closes the bends. */
const CORNERS = new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]);
const TRIANGLES = [0, 1, 2, 0, 2, 3];

export class WideLines {
  /** @param segments  x y z of one end, then of the other, for each */
  constructor(segments, {colour, width, opacity = 1, through = false}) {
    this.material = new ShaderMaterial({
      vertexShader: VERTEX_SHADER,
      fragmentShader: FRAGMENT_SHADER,
      uniforms: {
        size: {value: new Vector2(1, 1)},
        width: {value: width},
        colour: {value: new Color().setStyle(colour, '')},
        opacity: {value: opacity},
      },
      transparent: opacity < 1 || through,
      depthTest: !through,
      depthWrite: opacity === 1 && !through,
    });
    this.width = width;
    this.geometry = new InstancedBufferGeometry();
    this.geometry.setAttribute('position', new BufferAttribute(CORNERS, 3));
    this.geometry.setIndex(TRIANGLES);
    this.object = new Mesh(this.geometry, this.material);
    this.object.frustumCulled = false;  // its bounds are those of one rectangle
    this.set(segments);
  }

  set(segments) {
    const pairs = new Float32Array(segments);
    const count = pairs.length / 6;
    const from = new Float32Array(3 * count);
    const to = new Float32Array(3 * count);
    for (let i = 0; i < count; ++i) {
      from.set(pairs.subarray(6 * i, 6 * i + 3), 3 * i);
      to.set(pairs.subarray(6 * i + 3, 6 * i + 6), 3 * i);
    }
    for (const [name, ends] of [['from', from], ['to', to]]) {
      this.geometry.setAttribute(name, new InstancedBufferAttribute(ends, 3).setUsage(DynamicDrawUsage));
    }
    this.geometry.instanceCount = count;
  }

  /** @param ratio  pixels of the screen per pixel of the page */
  fitTo(width, height, ratio) {
    this.material.uniforms.size.value.set(width, height);
    this.material.uniforms.width.value = this.width * ratio;
  }
}
