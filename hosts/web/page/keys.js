/** What can be done without a mouse. */

/** Keys that a focused control needs for itself. */
const KEPT = {
  range: ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown'],
  radio: ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', ' '],
  checkbox: [' '],
  submit: [' ', 'Enter'],
  button: [' ', 'Enter'],
};

const belongsTo = (control, key) => (KEPT[control?.type] ?? []).includes(key) ||
  (control?.tagName === 'SUMMARY' && [' ', 'Enter'].includes(key));

/** @param actions  key (as in KeyboardEvent.key, letters in lower case) to what it does, given the event */
export function watchKeys(actions) {
  addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (!(key in actions) || belongsTo(document.activeElement, event.key)) return;
    event.preventDefault();
    actions[key](event);
  });
}
