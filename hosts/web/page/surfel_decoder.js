/** From the bytes of a piece (hosts/web/map_pieces.hpp) to arrays for the graphics card and for picking. */

const POSITION_BYTES = 3;
const FRAME_BYTES = 3;

const GOLDEN = 0.6180339887;

/**
 * Which row entry comes at which place: neighbours in the bytes are neighbours in space, and are scattered so that the
 * first so many surfels of a piece are an even sample of it.
 */
function scatteredOrder(surfels) {
  const greatestDivisor = (a, b) => b === 0 ? a : greatestDivisor(b, a % b);
  let step = Math.max(1, Math.round(GOLDEN * surfels));
  while (greatestDivisor(step, surfels) !== 1) ++step;
  const order = new Uint32Array(surfels);
  for (let place = 1; place < surfels; ++place) order[place] = (order[place - 1] + step) % surfels;
  return order;
}

/** One row of bytes after the other, each with one byte per surfel. */
class Rows {
  constructor(bytes, surfels) {
    this.bytes = bytes;
    this.surfels = surfels;
    this.order = scatteredOrder(surfels);
    this.at = 0;
  }

  next() {
    const row = this.bytes.subarray(this.at, this.at + this.surfels);
    this.at += this.surfels;
    return row;
  }

  /** Little-endian numbers of several rows, put through `value` into every `stride`-th place from `offset` on. */
  numbers(rowCount, into, stride, offset, value) {
    const rows = Array.from({length: rowCount}, () => this.next());
    for (let i = 0; i < this.surfels; ++i) {
      let code = 0;
      for (let r = rowCount - 1; r >= 0; --r) code = code * 256 + rows[r][this.order[i]];
      into[i * stride + offset] = value(code);
    }
  }

  /** Bytes as they are. */
  copy(rowCount, into, stride, offset) {
    for (let r = 0; r < rowCount; ++r) {
      const row = this.next();
      for (let i = 0; i < this.surfels; ++i) into[i * stride + offset + r] = row[this.order[i]];
    }
  }
}

/**
 * positions: x y z, metres
 * colours:   red green blue confidence
 * discs:     normal (2, octahedral), radius, 0
 * frames:    first seen, last seen: frame numbers
 */
export function decodePiece({bytes, surfels}, coding) {
  const piece = {
    surfels,
    positions: new Float32Array(3 * surfels),
    colours: new Uint8Array(4 * surfels),
    discs: new Uint8Array(4 * surfels),
    frames: new Float32Array(2 * surfels),
  };
  const rows = new Rows(bytes, surfels);
  for (let axis = 0; axis < 3; ++axis) {
    rows.numbers(POSITION_BYTES, piece.positions, 3, axis, code => coding.origin[axis] + code * coding.step);
  }
  rows.copy(2, piece.discs, 4, 0);
  rows.copy(3, piece.colours, 4, 0);
  rows.copy(1, piece.discs, 4, 2);
  rows.copy(1, piece.colours, 4, 3);
  for (const which of [0, 1]) rows.numbers(FRAME_BYTES, piece.frames, 2, which, code => code);
  return piece;
}

/** Metres. */
export const radiusOf = (code, coding) => coding.least_radius * coding.radius_growth ** code;

/** The code of a confidence, from 0 to 255. */
export const confidenceCode = (confidence, coding) => Math.log2(1 + confidence) / coding.confidence_scale;

/** The unit normal of two codes; the shader does the same. */
export function normalOf(a, b) {
  let x = (a - 128) / 127;
  let y = (b - 128) / 127;
  const z = 1 - Math.abs(x) - Math.abs(y);
  if (z < 0) {
    [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
  }
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}
