/** Clicks and taps on the picture, apart from the drags that turn it. */

const STILL = 6;          // pixels of the page: a finger is never quite still
const DOUBLE = 350;       // ms between the two of a double click

/** Calls click(x, y) and twice(x, y) with pixels of the page. */
export function watchPointer(canvas, {click, twice}) {
  let down = null;
  let before = {time: -Infinity, x: 0, y: 0};
  const near = (a, b) => Math.hypot(a.x - b.x, a.y - b.y) <= STILL;
  canvas.addEventListener('pointerdown', event => {
    down = event.isPrimary && event.button === 0 ? {x: event.clientX, y: event.clientY} : null;
  });
  canvas.addEventListener('pointerup', event => {
    const up = {time: event.timeStamp, x: event.clientX, y: event.clientY};
    if (down === null || !event.isPrimary || !near(down, up)) return;
    if (up.time - before.time < DOUBLE && near(before, up)) {
      before.time = -Infinity;
      twice(up.x, up.y);
    } else {
      before = up;
      click(up.x, up.y);
    }
  });
}
