// What the page adds to htmx: the form stays the reader's while answers arrive, and history has one entry per edit.
// Everything hangs on the document, because going back in history replaces the body.

const formOf = () => document.getElementById("application");
const contentOf = (form) => new URLSearchParams(new FormData(form)).toString();

// --- Another language or other units ----------------------------------------------------------------------------------

// The way back leads to what the form says, finished or not; the server turns it into the units of the link.
document.addEventListener("submit", async (event) => {
  const settings = event.target;
  const form = formOf();
  if (!form || !settings.matches("form.reader")) return;
  if (form.method === "get") {
    settings.elements.back.value = `/?${contentOf(form)}${form.elements.written ? "" : "&written=en"}`;
    return;
  }
  event.preventDefault(); // a cycle too long for an address is posted again
  await fetch(settings.action, { method: "POST", body: new URLSearchParams(new FormData(settings, event.submitter)), redirect: "manual" });
  form.submit();
});

// --- Answers that come too late ---------------------------------------------------------------------------------------

document.addEventListener("htmx:config:request", (event) => {
  const { ctx } = event.detail;
  if (ctx.sourceElement.id !== "application") return;
  if (ctx.sourceEvent.type === "input" && unfinishedRow() && !presses.length && !unfinishedRow().querySelector('[aria-invalid="true"]')) {
    ctx.sourceElement.dataset.waiting = "";
    event.preventDefault();
    return;
  }
  delete ctx.sourceElement.dataset.waiting;
  carryPresses(ctx);
  ctx.asked = contentOf(ctx.sourceElement);
});

document.addEventListener("htmx:before:swap", (event) => {
  const { ctx } = event.detail;
  if (ctx.asked === undefined) return;
  // An answer to what the form no longer says must not overwrite it; the request for what it says now is under way.
  if (leaving || ctx.asked !== contentOf(formOf())) event.preventDefault();
  else if (event.detail.tasks.some((task) => task.type === "main")) mirrorIntoAttributes(formOf());
});

document.addEventListener("htmx:after:swap", (event) => {
  const { ctx } = event.detail;
  if (ctx.asked === undefined) return;
  if (ctx.replaces || ctx.presses) followAttributes(formOf());
  if (ctx.presses) presses.splice(0, ctx.presses);
  ctx.refocus?.();
  for (const part of document.querySelectorAll("[data-part][open]")) bring(part);
});

// Going back replaces the page: the answer under way belongs to the one that is left.
let leaving = false;
document.addEventListener("htmx:before:history:restore", () => {
  leaving = true;
  htmx.trigger(formOf(), "htmx:abort");
});
document.addEventListener("htmx:finally:request", (event) => {
  if (event.detail.ctx.request.headers["HX-History-Restore-Request"]) leaving = false;
});

// --- What an answer brings --------------------------------------------------------------------------------------------

// Typing has changed the form already, so that it need not come again, unless there is or was something to correct.
const typed = (ctx) =>
  !ctx.replaces && !presses.length && document.querySelector("#application:not([data-invalid]):not(:has(#phases)) ~ #result.answered");

// What is folded away comes along from when somebody has unfolded it for the first time.
const unfolded = new Set();

document.addEventListener("htmx:before:request", (event) => {
  const { ctx } = event.detail;
  if (ctx.sourceElement.id === "application") ctx.request.headers["HPN-Parts"] = [...(typed(ctx) ? [] : ["form"]), "result", ...unfolded].join(" ");
});

document.addEventListener(
  "toggle",
  (event) => {
    const part = event.target;
    if (!part.open || !part.matches("[data-part]")) return;
    unfolded.add(part.id);
    bring(part);
  },
  true,
);

const addressOf = (part) => document.getElementById(part.id)?.getAttribute("hx-get");
const bring = (part) => part.childElementCount === 1 && htmx.trigger(part, "unfold");

// What a part was asked for belongs to one answer: beside a later one it would be wrong.
document.addEventListener("htmx:config:request", (event) => {
  const { ctx } = event.detail;
  if (ctx.sourceElement.matches("[data-part]")) ctx.partOf = addressOf(ctx.sourceElement);
});

document.addEventListener("htmx:before:swap", (event) => {
  const { ctx } = event.detail;
  if (ctx.partOf !== undefined && ctx.partOf !== addressOf(ctx.sourceElement)) event.preventDefault();
});

// Nothing works unseen: what is wrong is unfolded, and so is what an undo or a file has brought.
const holds = (part) => [...part.querySelectorAll("input")].some((field) => (field.type === "checkbox" ? field.checked : field.value.trim()));

document.addEventListener("htmx:after:swap", (event) => {
  const { ctx } = event.detail;
  const brought = ctx.replaces || ctx.sourceElement.id === "paste-form";
  for (const part of document.querySelectorAll("#application details:not([open])")) {
    if (part.querySelector('[aria-invalid="true"]') || (brought && holds(part))) part.open = true;
  }
});

// --- Saving -----------------------------------------------------------------------------------------------------------

// What is saved is what the form says, although its answer may still be under way.
document.addEventListener("submit", (event) => {
  const form = formOf();
  if (!form || !event.target.matches("form.save")) return;
  if (form.matches("[data-invalid], [data-waiting]")) {
    event.preventDefault();
    document.querySelector('#connection [data-state="unsaved"]').hidden = false;
    return;
  }
  event.target.elements.link.value = `/?${contentOf(form)}`;
});

// --- Row edits that are under way while somebody types on -------------------------------------------------------------

const presses = []; // row edits that are not answered yet, each as the rows stand after those before it

// The row at which a row stands after an edit, or null where the edit removes it.
function after(press, row, rows) {
  const [name, number] = press.split(":");
  const at = number - 1;
  if (name === "remove") return row === at ? null : row - (row > at);
  if (name !== "up" && name !== "down") return row;
  const to = Math.min(Math.max(at + (name === "down" ? 1 : -1), 0), rows - 1);
  return row === at ? to : row === to ? at : row;
}

const placeAfterPresses = (row, rows) => presses.reduce((at, press) => (at === null ? null : after(press, at, rows)), row);

// The place of a row that the edits remove: what followed it stands there afterwards.
const removedAt = (row, rows) => presses.reduce((at, press) => after(press, at, rows) ?? at, row);

// A later request takes along the row edits of the one that it replaces, so that neither they nor the typing are lost.
function carryPresses(ctx) {
  const rows = document.querySelectorAll("#duty tbody tr").length;
  const { submitter, body } = ctx.request;
  const own = submitter?.name === "do" ? submitter.value : null;
  if (!own && !presses.length) return;
  body.delete("do");
  if (own) {
    const [name, number] = own.split(":");
    const row = number === undefined ? undefined : placeAfterPresses(number - 1, rows);
    if (row !== null) presses.push(row === undefined ? name : `${name}:${row + 1}`);
  }
  for (const press of presses) body.append("do", press);
  ctx.presses = presses.length;
  keepPlace(ctx, rows);
}

// Who types, or edits rows by key, stays in the cell, wherever its row goes; where it is removed, in the one that takes
// its place. A button and a new row have their focus from the server.
function keepPlace(ctx, rows) {
  const field = document.activeElement;
  if (!field?.matches("#duty tbody input") || ctx.request.submitter?.value === "add") return;
  const [name, number] = field.id.split("-");
  const row = placeAfterPresses(Number(number), rows);
  const range = [field.selectionStart, field.selectionEnd];
  ctx.refocus = () => {
    const last = document.querySelectorAll("#duty tbody tr").length - 1;
    const place = document.getElementById(`${name}-${row ?? Math.min(removedAt(Number(number), rows), last)}`);
    place?.focus();
    if (row === null) place?.select();
    else place?.setSelectionRange(...range);
  };
}

// The morph compares attributes, while typing changes properties: make the two agree first.
function mirrorIntoAttributes(form) {
  for (const field of form.elements) {
    if (field.type === "checkbox") field.toggleAttribute("checked", field.checked);
    else if (field.tagName === "TEXTAREA") field.textContent = field.value;
    else if (field.type === "text" || field.type === "hidden") field.setAttribute("value", field.value);
    else if (field.tagName === "SELECT") {
      for (const option of field.options) option.toggleAttribute("selected", option.selected);
    }
  }
}

// And the other way round, where a content takes the place of what was typed: an undo, or a file.
function followAttributes(form) {
  for (const field of form.elements) {
    if (field.type === "checkbox") field.checked = field.defaultChecked;
    else if (field.tagName === "SELECT") for (const option of field.options) option.selected = option.defaultSelected;
    else if (field.defaultValue !== undefined && field.type !== "hidden" && field.value !== field.defaultValue) field.value = field.defaultValue;
  }
}

// --- Rows that are still being typed ----------------------------------------------------------------------------------

// A phase with a torque and no speed yet is no error of somebody who is about to type the speed.
function unfinishedRow() {
  const row = document.activeElement?.closest("#duty tbody tr");
  if (!row) return null;
  const filled = ["T", "n", "t"].map((name) => row.querySelector(`[name="${name}"]`).value.trim() !== "");
  return filled.includes(true) && filled.includes(false) ? row : null;
}

document.addEventListener("focusout", (event) => {
  const row = event.target.closest("#duty tbody tr");
  const form = formOf();
  if (row && "waiting" in form.dataset && !row.contains(event.relatedTarget)) form.requestSubmit();
});

// --- Choosing a candidate ---------------------------------------------------------------------------------------------

document.addEventListener("click", (event) => {
  const link = event.target.closest("a[data-gear]");
  if (!link || event.button || event.ctrlKey || event.metaKey || event.shiftKey || event.altKey) return;
  event.preventDefault();
  const form = formOf();
  form.elements.gear.value = new URL(link.href).searchParams.get("gear");
  startEdit();
  form.requestSubmit();
});

// --- History: one entry per edit, not per keystroke -------------------------------------------------------------------

let visit = 0; // counts the times that a field was entered
let edit = 0; // the visit that the latest change belongs to
let pushed = -1; // the edit that has its entry already

const startEdit = () => (edit = ++visit);
document.addEventListener("focusin", () => visit++);
document.addEventListener("input", () => (edit = visit));
document.addEventListener("submit", (event) => event.submitter?.name && startEdit());

document.addEventListener("htmx:before:history:update", (event) => {
  const { history } = event.detail;
  if (history.path === location.pathname + location.search) return event.preventDefault();
  if (edit === pushed) history.type = "replace";
  pushed = edit;
});
