/** A surfel is drawn as a point whose fragments are tested against the disc in space: one vertex per surfel. */

export const VERTEX_SHADER = `
attribute vec4 colours;   // red, green, blue, confidence; 0 to 1
attribute vec4 discs;     // octahedral normal (2), radius: codes from 0 to 255
attribute vec2 frames;    // in which it was first and last seen

uniform sampler2D ramp;
uniform vec2 range;              // of what the ramp shows
uniform int mode;                // SHADER_MODE
uniform float lastFrame;         // what came later is not drawn
uniform float leastRadius, radiusGrowth, radiusScale;
uniform float pixelsPerTangent;  // half the height of the picture over the tangent of half its angle
uniform float mostPixels;        // of a point, by the graphics card
uniform bool cutaway;            // what is seen from behind is not drawn

varying vec3 colour;
varying vec3 normal_view;
varying vec3 ray;                // from the eye to the surfel, unit
varying float discPerPoint;      // half a point in radii of the disc
varying vec2 depth;              // z of the surfel in the axes of the eye, and its radius; metres

const float SMALL = 1.5;         // pixels: below it a disc and a square are the same

vec3 octahedral(vec2 codes) {
  vec2 p = (codes - 128.0) / 127.0;
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  return normalize(n);
}

vec3 meaning(float value) {
  return texture2D(ramp, vec2(clamp((value - range.x) / (range.y - range.x), 0.0, 1.0), 0.5)).rgb;
}

void main() {
  vec3 n = octahedral(discs.xy);
  vec4 p = modelViewMatrix * vec4(position, 1.0);
  normal_view = normalMatrix * n;
  ray = normalize(p.xyz);
  bool hidden = frames.x > lastFrame || (cutaway && dot(normal_view, ray) > 0.0);
  if (hidden) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);  // behind the far plane
    gl_PointSize = 1.0;
    return;
  }
  gl_Position = projectionMatrix * p;
  float radius = radiusScale * leastRadius * pow(radiusGrowth, discs.z);
  float pixels = 2.0 * radius * pixelsPerTangent / max(-p.z, 1e-3);
  gl_PointSize = clamp(pixels + 1.0, SMALL, mostPixels);
  depth = vec2(p.z, radius);
  discPerPoint = pixels < SMALL ? 0.0 : gl_PointSize / pixels;

  if (mode == 1) colour = 0.5 + 0.5 * n;
  else if (mode == 2) colour = meaning(position.y);
  else if (mode == 3) colour = meaning(colours.a);
  else if (mode == 4) colour = meaning(frames.x);
  else if (mode == 5) colour = meaning(frames.y);
  else colour = colours.rgb;
  // colours that are no photograph need light, or shapes could not be told
  if (mode != 0) colour *= 0.55 + 0.45 * abs(dot(normal_view, ray));
}
`;

export const FRAGMENT_SHADER = `
varying vec3 colour;
varying vec3 normal_view;
varying vec3 ray;
varying float discPerPoint;
varying vec2 depth;

uniform mat4 projectionMatrix;

const float FLATTEST = 0.15;  // cosine: discs seen from the edge keep a width, so that floors far away have no gaps
const float CONE = 0.5;       // radii by which the rim lies deeper than the middle: of discs in one plane, each pixel
                              // belongs to the nearest centre instead of to the disc drawn first

void main() {
  vec3 offset = vec3((2.0 * gl_PointCoord - 1.0) * vec2(1.0, -1.0) * discPerPoint, 0.0);
  float facing = dot(normal_view, ray);
  facing = (facing < 0.0 ? -1.0 : 1.0) * max(abs(facing), FLATTEST);
  offset -= ray * dot(normal_view, offset) / facing;  // along the ray into the plane of the disc
  float off = dot(offset, offset);
  if (off > 1.0) discard;
  float z = depth.x + depth.y * (offset.z - CONE * off);
  vec2 clip = z * vec2(projectionMatrix[2][2], projectionMatrix[2][3]) +
    vec2(projectionMatrix[3][2], projectionMatrix[3][3]);
  gl_FragDepth = 0.5 + 0.5 * clip.x / clip.y;
  gl_FragColor = vec4(colour, 1.0);
}
`;
