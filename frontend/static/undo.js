// Back is undo: one entry of the history per edit, which holds what the form said.

import { contentOf, fieldsOf, formOf, isPlain, isText, valueOf } from "./form.js";
import { forget, isReplacing, later } from "./replacing.js";

const past = {
  at: history.state?.at ?? 0, // number of the entry that the page shows
  last: history.state?.at ?? 0,
  restoring: null, // what the form said in the entry that somebody has gone to
  isSettled: true, // the next change is a new edit; what is typed in one visit of a field is one
  addressed: contentOf(formOf()), // what the form said when the address came to be
  accepted: { query: location.search, addressed: contentOf(formOf()) }, // the same before the visit of a field in which somebody types
};

export const restoring = () => past.restoring;
export const isAddressed = (content) => content === past.addressed;
export const beginEdit = () => (past.isSettled = true);

document.addEventListener("focusin", beginEdit);

export function note(own = false) {
  const content = contentOf(formOf());
  if (past.isSettled) past.accepted = { query: location.search, addressed: past.addressed };
  if (content === history.state?.content) return;
  if (past.isSettled || own) enter(content);
  else history.replaceState({ at: past.at, content }, "");
  past.isSettled = own;
  showSteps();
}

// An edit that the page makes at once.
export function edit(change) {
  note();
  change();
  note(true);
  formOf().requestSubmit();
}

function enter(content) {
  past.last = ++past.at;
  history.pushState({ at: past.at, content }, "");
}

const keep = () => history.replaceState({ at: past.at, content: contentOf(formOf()) }, "");

// The form of an answer is in place.
export function arrived({ restores }) {
  if (!restores) return note(true);
  past.restoring = null;
  keep();
  if (restores.says) markChanged(restores);
}

function restore(content, says = "") {
  const form = formOf();
  past.isSettled = true;
  forget();
  past.restoring = { content, before: fieldsOf(form), says };
  form.requestSubmit();
  showSteps();
}

addEventListener("popstate", (event) => {
  if (!formOf()) return;
  if (!event.state) return keep(); // a hash that somebody types into the address begins an entry
  past.at = event.state.at;
  restore(event.state.content);
});

// "Try it" leads to other inputs on the same page: an edit that undo takes back.
document.addEventListener("click", (event) => {
  const link = event.target.closest("[data-tries]");
  if (!link || !isPlain(event)) return;
  event.preventDefault();
  note();
  const content = link.search.slice(1);
  enter(content);
  restore(content, link.dataset.tries);
  document.getElementById("result").focus({ preventScroll: true });
});

// Changed fields are marked until the next edit, with their value from before.
function markChanged({ before, says }) {
  for (const field of formOf().elements) {
    const was = before.get(field.id);
    if (was === undefined || was === valueOf(field)) continue;
    field.classList.add("changed");
    field.title = says.replace("{}", was || "–");
  }
}

document.addEventListener("input", () => {
  for (const field of document.querySelectorAll(".changed")) {
    field.classList.remove("changed");
    field.removeAttribute("title");
  }
});

function step(direction) {
  if (isReplacing() && !past.restoring) return later(() => step(direction));
  if (!past.restoring) note();
  if (direction < 0 ? past.at === 0 : past.at === past.last) return;
  past.at += direction; // at once, so that a second press does not leave the page
  history.go(direction);
}

export function showSteps() {
  for (const button of document.querySelectorAll("[data-step]")) {
    button.setAttribute("aria-disabled", String(button.dataset.step < 0 ? past.at === 0 : past.at === past.last));
  }
}

// Of a field that is refused, what was read from its first characters is not what somebody wanted to say.
export function showAddress(ctx) {
  if (!ctx.hx?.pushurl) {
    if (ctx.restores || !document.querySelector("#problems > *")) return;
    past.addressed = past.accepted.addressed;
    return history.replaceState(history.state, "", location.pathname + past.accepted.query + location.hash);
  }
  past.addressed = ctx.kept ? contentOf(formOf()) : ctx.asked;
  history.replaceState(history.state, "", ctx.hx.pushurl + location.hash);
}

document.addEventListener("click", (event) => {
  const button = event.target.closest("[data-step]");
  if (button) step(Number(button.dataset.step));
});

const ownUndo = (element) => element.isContentEditable || (isText(element) && !element.matches("select"));
document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.altKey || ownUndo(event.target) || document.querySelector("dialog[open]")) return;
  const key = event.key.toLowerCase();
  if (key !== "z" && key !== "y") return;
  event.preventDefault();
  step(key === "y" || event.shiftKey ? 1 : -1);
});

keep();
showSteps();
