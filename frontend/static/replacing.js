// Another form that is on its way: what is typed and pressed meanwhile waits for it.

import { formOf } from "./form.js";

const way = { ctx: null, isTyped: false, presses: [] };

export const isReplacing = () => way.ctx !== null;
export const begin = (ctx) => (way.ctx = ctx);
export const typed = () => (way.isTyped = true);
export const later = (press) => way.presses.push(press);
export const forget = () => (way.presses.length = 0);

// It has been put in place, or came to nothing.
document.addEventListener("htmx:finally:request", (event) => {
  if (event.detail.ctx !== way.ctx) return;
  way.ctx = null;
  if (way.isTyped) formOf().dispatchEvent(new Event("input"));
  way.isTyped = false;
  while (!way.ctx && way.presses.length) way.presses.shift()();
});
