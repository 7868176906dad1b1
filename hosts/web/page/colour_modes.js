/** What the colours of the map can mean, and the legend of each meaning. */

import {create} from 'page/dom.js';
import {confidenceCode} from 'page/surfel_decoder.js';

/** Colours of matplotlib's and Google's maps (viridis, plasma, turbo) in equal steps: bright means more. */
const VIRIDIS = ['#440154', '#482878', '#3e4989', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b',
  '#fde725'];
const PLASMA = ['#0d0887', '#46039f', '#7201a8', '#9c179e', '#bd3786', '#d8576b', '#ed7953', '#fb9f3a', '#fdca26',
  '#f0f921'];
const TURBO = ['#30123b', '#4145ab', '#4675ed', '#39a2fc', '#1bcfd4', '#24eca6', '#61fc6c', '#a4fc3b', '#d1e834',
  '#f3c63a', '#fe9b2d', '#f36315', '#d93806', '#b11901', '#7a0403'];

/** Colours of the axes in the mode `normal`, as the shader mixes them: half grey, half direction. */
const NORMAL_SWATCHES = [['#ff8080', 'right'], ['#80ff80', 'up'], ['#8080ff', 'towards the start']];

const RAMP_WIDTH = 256;
const GREATEST_CODE = 255;

/** Numbers of the shader (surfel_shader.js). */
export const SHADER_MODE = {colour: 0, normal: 1, height: 2, confidence: 3, created: 4, seen: 5};

/** @returns the modes in the order of the page; range is in the unit of what the shader colours. */
export function colourModes(map) {
  const [low, high] = [map.bounds[0][1], map.bounds[1][1]];
  const most = confidenceCode(map.confidence, map.coding) / GREATEST_CODE;
  const byFrame = (id, name, [first, last]) => ({id, name, ramp: PLASMA, range: [first, Math.max(last, first + 1)],
    labels: [`frame ${first}`, `frame ${last}`]});
  return [
    {id: 'colour', name: 'Colour', legend: 'As the camera saw it, in the exposure of the map'},
    {id: 'normal', name: 'Normal', swatches: NORMAL_SWATCHES},
    {id: 'height', name: 'Height', ramp: TURBO, range: [low, high],
      labels: ['0 m', `${(high - low).toFixed(2)} m above the lowest`]},
    {id: 'confidence', name: 'Confidence', ramp: VIRIDIS, range: [0, Math.max(most, 1 / GREATEST_CODE)],
      labels: ['0', `${Math.round(map.confidence)} weighted observations`]},
    byFrame('created', 'First seen', map.created),
    byFrame('seen', 'Last seen', map.seen),
  ];
}

const gradient = ramp => `linear-gradient(90deg, ${ramp.join(', ')})`;

/** The colours of a mode between the ends of its range: RGBA, one row. */
export function rampPixels(ramp) {
  const canvas = create('canvas', {width: RAMP_WIDTH, height: 1});
  const context = canvas.getContext('2d');
  const fill = context.createLinearGradient(0, 0, RAMP_WIDTH, 0);
  ramp.forEach((colour, i) => fill.addColorStop(i / (ramp.length - 1), colour));
  context.fillStyle = fill;
  context.fillRect(0, 0, RAMP_WIDTH, 1);
  return {width: RAMP_WIDTH, data: new Uint8Array(context.getImageData(0, 0, RAMP_WIDTH, 1).data)};
}

/** The legend as elements. */
export function legendOf(mode) {
  if (mode.ramp) {
    const bar = create('i', {className: 'ramp'});
    bar.style.background = gradient(mode.ramp);
    const [low, high] = mode.labels;
    return [bar, create('span', {className: 'ends'}, create('span', {}, low), create('span', {}, high))];
  }
  if (mode.swatches) {
    return mode.swatches.map(([colour, meaning]) => {
      const swatch = create('i', {className: 'swatch'});
      swatch.style.background = colour;
      return create('span', {className: 'key'}, swatch, meaning);
    });
  }
  return [create('span', {}, mode.legend)];
}
