/** Which surfel is under the pointer: the same discs as drawn, in double precision on the processor. */

import {normalOf, radiusOf} from 'page/surfel_decoder.js';

const RADIUS_CODES = 256;

function radii(coding, scale) {
  return Float64Array.from({length: RADIUS_CODES}, (_, code) => scale * radiusOf(code, coding));
}

/** Whether the ray meets the disc: the distance along it, or Infinity. */
function meet(ray, piece, i, radius, cutaway) {
  const [nx, ny, nz] = normalOf(piece.discs[4 * i], piece.discs[4 * i + 1]);
  const {origin: o, direction: d} = ray;
  const facing = nx * d.x + ny * d.y + nz * d.z;
  if (facing === 0 || (cutaway && facing > 0)) return Infinity;
  const x = piece.positions[3 * i] - o.x;
  const y = piece.positions[3 * i + 1] - o.y;
  const z = piece.positions[3 * i + 2] - o.z;
  const t = (nx * x + ny * y + nz * z) / facing;
  const off = (t * d.x - x) ** 2 + (t * d.y - y) ** 2 + (t * d.z - z) ** 2;
  return t > 0 && off <= radius * radius ? t : Infinity;
}

/**
 * The nearest point of the map on a ray (three.js), or null.
 * @param scale  of the discs, as drawn
 * @param slope  of a cone around the ray in which a surfel counts if no disc is met: a few pixels
 */
export function pick(cloud, ray, scale, slope) {
  const radius = radii(cloud.coding, scale);
  const {origin: o, direction: d} = ray;
  let hit = Infinity;
  let near = {angle: slope, t: Infinity};
  for (const piece of cloud.pieces) {
    const {positions, discs, frames, surfels} = piece;
    for (let i = 0, at = 0; i < surfels; ++i, at += 3) {
      const x = positions[at] - o.x;
      const y = positions[at + 1] - o.y;
      const z = positions[at + 2] - o.z;
      const t = x * d.x + y * d.y + z * d.z;
      if (t <= 0 || frames[2 * i] > cloud.lastFrame) continue;
      const off = x * x + y * y + z * z - t * t;
      const r = radius[discs[4 * i + 2]];
      if (off <= r * r) {
        if (t - r < hit) hit = Math.min(hit, meet(ray, piece, i, r, cloud.cutaway));
      } else if (off < (near.angle * t) ** 2) {
        const [nx, ny, nz] = normalOf(discs[4 * i], discs[4 * i + 1]);
        if (!cloud.cutaway || nx * d.x + ny * d.y + nz * d.z < 0) near = {angle: Math.sqrt(off) / t, t};
      }
    }
  }
  const t = hit < Infinity ? hit : near.t;
  return t < Infinity ? o.clone().addScaledVector(d, t) : null;
}
