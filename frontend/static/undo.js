// Undo and redo of every edit of the form: its contents in the order in which they came to be. The browser's own undo
// inside a text field stays the browser's.

const MOST = 200;
const contents = []; // what the form said, oldest first
let at = -1; // the one it says now
let group = null; // field and visit that the latest change belongs to: its keystrokes are one step
let visit = 0;
let restoring = null;
let underWay = null; // the request of the form that is not answered yet
let next = null; // a step that waits for it

const formOf = () => document.getElementById("application");
const contentOf = (form) => new URLSearchParams(new FormData(form)).toString();

function record(changedIn) {
  const form = formOf();
  if (!form) return;
  const content = contentOf(form);
  if (content !== contents[at]) {
    const same = changedIn !== null && changedIn === group && at > 0;
    contents.splice(same ? at : at + 1, Infinity, content);
    if (contents.length > MOST) contents.shift();
    at = contents.length - 1;
    group = changedIn;
  }
  show();
}

function show() {
  for (const button of document.querySelectorAll("[data-undo]")) {
    const possible = button.dataset.undo === "back" ? at > 0 : at < contents.length - 1;
    button.setAttribute("aria-disabled", String(!possible));
  }
}

export function step(direction) {
  if (underWay?.presses) {
    next = direction; // the form does not yet say what is to be taken back
    return;
  }
  if (!underWay?.restores) record(null); // a gear that was chosen, or pinned, and is not answered yet
  const to = at + (direction === "back" ? -1 : 1);
  if (!contents[to] || restoring !== null) return;
  at = to;
  group = null;
  restoring = contents[to];
  const form = formOf();
  form.setAttribute("hx-method", new URLSearchParams(restoring).has("phases") ? "post" : "get");
  form.requestSubmit();
  show();
}

// The form is built by the server: ask it for the earlier content instead of the present one.
document.addEventListener("htmx:config:request", (event) => {
  const { ctx } = event.detail;
  if (restoring === null || ctx.sourceElement.id !== "application") return;
  const body = new FormData();
  for (const [name, value] of new URLSearchParams(restoring)) body.append(name, value);
  ctx.request.body = body;
  ctx.replaces = ctx.restores = true;
  restoring = null;
});

document.addEventListener("htmx:before:request", (event) => {
  const { ctx } = event.detail;
  if (ctx.sourceElement.id === "application") underWay = ctx;
});
document.addEventListener("htmx:finally:request", (event) => {
  if (event.detail.ctx !== underWay) return;
  const direction = next;
  underWay = next = null;
  if (direction) step(direction);
});

document.addEventListener("focusin", () => visit++);
document.addEventListener("input", (event) => {
  if (event.target.form?.id === "application") record(`${event.target.id} ${visit}`);
});
document.addEventListener("htmx:after:swap", (event) => {
  const { ctx } = event.detail;
  if (ctx?.restores) contents[at] = contentOf(formOf()); // the server may write a content in another order
  record(null);
});

document.addEventListener("click", (event) => {
  const button = event.target.closest("[data-undo]");
  if (button) step(button.dataset.undo);
});

const ownUndo = (element) => element.isContentEditable || element.matches("textarea, input:not([type=checkbox], [type=radio], [type=button], [type=submit], [type=file])");
document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.altKey || ownUndo(event.target) || document.querySelector("dialog[open]")) return;
  const key = event.key.toLowerCase();
  if (key !== "z" && key !== "y") return;
  event.preventDefault();
  step(key === "y" || event.shiftKey ? "forward" : "back");
});

// Another language or other units load the page anew. Each content says what it is written in, so that they go along.
const KEPT = "undo";
document.addEventListener("submit", (event) => {
  if (!event.target.matches("form.reader")) return;
  try {
    sessionStorage.setItem(KEPT, JSON.stringify({ contents, at }));
  } catch {} // too much to keep
});
const kept = JSON.parse(sessionStorage.getItem(KEPT));
sessionStorage.removeItem(KEPT);
if (kept && formOf()) {
  contents.push(...kept.contents);
  at = kept.at;
  contents[at] = contentOf(formOf()); // the same, as it is written now
}

record(null);
