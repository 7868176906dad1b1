/** The scene as the program wrote it into the page, and the map's pieces, from the page itself or its server. */

import {element} from 'page/dom.js';

/** Layout: hosts/web/scene_json.cpp. Metres and seconds; x right, y up, z backwards. */
export function readScene() {
  return JSON.parse(element('scene').textContent);
}

function bytesOfElement(id) {
  const holder = element(id);
  const bytes = Uint8Array.from(atob(holder.textContent), character => character.charCodeAt(0));
  holder.remove();  // the text is twice as large as what it stands for
  return bytes;
}

export async function download(url) {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`the server answers ${answer.status} when asked for ${url}`);
  return new Uint8Array(await answer.arrayBuffer());
}

/** null where there is nothing any more. */
export async function downloadJson(url) {
  const bytes = await download(url);
  return bytes.length === 0 ? null : JSON.parse(new TextDecoder().decode(bytes));
}

/** What a piece of the map holds. */
export async function bytesOf(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Lets the browser draw and answer the user between two pieces. */
const breath = () => new Promise(resolve => setTimeout(resolve));

/** The pieces in their order, as soon as each is there: {surfels, bytes}. */
export async function* readPieces(map) {
  for (const piece of map.pieces) {
    const packed = piece.url.startsWith('#') ? bytesOfElement(piece.url.slice(1)) : await download(piece.url);
    const bytes = await bytesOf(packed);
    if (bytes.length !== piece.surfels * map.coding.bytes_per_surfel) throw new Error('a piece of the map is damaged');
    yield {surfels: piece.surfels, bytes};
    await breath();
  }
}
