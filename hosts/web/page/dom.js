/** Shorthands for the elements of the page. */

/** The element of that id. */
export const element = id => document.getElementById(id);

/** A new element. `properties` are set on it, `children` (elements or text) put into it. */
export function create(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

/** 1234567 as 1 234 567, with narrow no-break spaces. */
export const grouped = number => String(number).replace(/\B(?=(\d{3})+$)/g, '\u202f');

/** Whether the user has asked the system for less motion. */
export const wantsLessMotion = () => matchMedia('(prefers-reduced-motion: reduce)').matches;
