/** The controls around the picture: title, display settings, distances, messages. */

import {create, element, grouped} from 'page/dom.js';
import {legendOf} from 'page/colour_modes.js';
import {metres} from 'page/measuring.js';

const HINT_TIME = 4000;  // ms
const THEME_KEY = 'posefusion-theme';
const NARROW = '(max-width: 720px)';

/** @param note  instead of the duration of the run */
export function showTitle(scene, note) {
  const {map, facts} = scene;
  element('name').textContent = scene.title;
  const size = [0, 2, 1].map(axis => map.bounds[1][axis] - map.bounds[0][axis]);
  const surfels = `${grouped(map.surfels)} surfels`;
  const [duration] = facts.filter(([name]) => name === 'Duration').map(([, value]) => value);
  const beside = note ?? duration;
  element('summary').textContent = beside ? `${surfels} · ${beside}` : surfels;
  const extent = size.map(v => v.toFixed(1)).join(' × ');
  const rows = [...facts, ['Surfels', grouped(map.surfels)], ['Size', `${extent} m`]];
  if (scene.keyframes.length > 0) rows.push(['Keyframes', String(scene.keyframes.length)]);
  const cells = rows.flatMap(([name, value]) => [create('dt', {}, name), create('dd', {}, value)]);
  element('facts').replaceChildren(...cells);
  const off = map.coding.step * 1000 / 2;
  element('accuracy').textContent = 'Distances are between points of the map. Their positions are rounded by at most ' +
    `${off} mm per axis in this page; how accurate the map itself is, its depth camera decides.`;
}

/** @param choose(mode)  called for the first mode at once */
export function addModes(modes, choose) {
  const select = mode => {
    element('legend').replaceChildren(...legendOf(mode));
    choose(mode);
  };
  const buttons = modes.map((mode, i) => {
    const input = create('input', {type: 'radio', name: 'mode', value: mode.id, checked: i === 0});
    input.addEventListener('change', () => select(modes[i]));
    element('modes').append(create('label', {}, input, create('span', {}, mode.name)));
    return input;
  });
  select(modes[0]);
  return {
    choose(i) { buttons[i]?.click(); },
    /** The same modes with other ranges. */
    update(newer) {
      modes = newer;
      select(modes[buttons.findIndex(button => button.checked)]);
    },
  };
}

export function onSwitch(id, changed) {
  element(id).addEventListener('change', event => changed(event.target.checked));
}

export function addDiscSize(changed) {
  const slider = element('disc-size');
  const tell = () => {
    const {value, min, max} = slider;
    slider.style.setProperty('--share', (value - min) / (max - min));
    element('disc-size-text').textContent = `× ${Number(value).toFixed(1)}`;
    changed(Number(value));
  };
  slider.addEventListener('input', tell);
  tell();
}

export function listDistances(distances) {
  element('measurements').hidden = distances.length === 0;
  element('distances').replaceChildren(...distances.map(d =>
    create('li', {}, create('b', {}, metres(d.metres)), create('small', {}, `height ${metres(d.rise)}`))));
}

export function showKeyframe(keyframe, number, seconds) {
  element('keyframe').hidden = keyframe === null;
  if (keyframe === null) return;
  const image = element('keyframe-image');
  if (image.getAttribute('src') !== keyframe.image) image.src = keyframe.image;
  const caption = `Keyframe ${number + 1} · ${seconds.toFixed(2)} s`;
  image.alt = `What the camera saw: ${caption}`;
  element('keyframe-caption').textContent = caption;
}

export function press(id, on) { element(id).setAttribute('aria-pressed', String(on)); }

let hintTimer = null;

/** A line that goes away by itself unless `stays`. */
export function hint(text, stays = false) {
  clearTimeout(hintTimer);
  element('hint').textContent = text;
  element('hint').hidden = text === '';
  if (!stays) hintTimer = setTimeout(() => { element('hint').hidden = true; }, HINT_TIME);
}

/** Something that the page cannot do without. */
export function fail(heading, text) {
  element('notice').hidden = false;
  element('notice').replaceChildren(create('h2', {}, heading), create('p', {}, text));
  document.documentElement.dataset.state = 'failed';
}

export function showLoading(share) {
  const bar = element('loading');
  bar.setAttribute('aria-valuenow', String(Math.round(100 * share)));
  bar.style.setProperty('--share', share);
  bar.hidden = share >= 1;
}

/** A file opened from a disk may be forbidden to remember anything. */
const memory = {
  get: () => { try { return localStorage.getItem(THEME_KEY); } catch { return null; } },
  set: theme => { try { localStorage.setItem(THEME_KEY, theme); } catch { /* the next visit asks the system */ } },
};

export function addTheme() {
  const root = document.documentElement;
  const system = () => matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
  root.dataset.theme = memory.get() ?? system();
  const toggle = () => {
    root.dataset.theme = root.dataset.theme === 'dark' ? 'light' : 'dark';
    memory.set(root.dataset.theme);
  };
  element('theme').addEventListener('click', toggle);
  return toggle;
}

/** The settings cover half of a phone's screen: there they are closed at first. */
export function addPanelToggle() {
  const show = open => {
    element('panel').hidden = !open;
    element('panel-toggle').setAttribute('aria-expanded', String(open));
  };
  show(!matchMedia(NARROW).matches);
  element('panel-toggle').addEventListener('click', () => show(element('panel').hidden));
}

export function addHelp() {
  const open = () => element('help').showModal();
  element('help-open').addEventListener('click', open);
  return open;
}
