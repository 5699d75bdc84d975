// Additions of the page to htmx. Typing asks for the result alone, so that nothing typed is ever overwritten; row buttons, Back
// and files bring another form. Everything hangs on the document, because the form may be replaced.

const formOf = () => document.getElementById("application");
const contentOf = (form) => new URLSearchParams(new FormData(form)).toString();
const isOfForm = (ctx) => ctx?.sourceElement.id === "application";
const replacesForm = (ctx) => ctx?.hx?.retarget === "#application";
const isPlain = (click) => !click.button && !click.ctrlKey && !click.metaKey && !click.shiftKey && !click.altKey;
const valueOf = (field) => (field.type === "checkbox" ? field.checked : field.value);

// --- Requests of the form ---------------------------------------------------------------------------------------------

let asked = null; // the request for an answer that is under way
let wanted = null; // the link or file of the answer that was pressed meanwhile
let underWay = null; // the request whose answer brings another form
const pending = []; // what was pressed meanwhile: row buttons, each with its row, and undo
let typedMeanwhile = false;

document.addEventListener("htmx:config:request", (event) => {
  const { ctx } = event.detail;
  if (!isOfForm(ctx)) return;
  const form = formOf();
  const { submitter } = ctx.request;
  const press = submitter?.name === "do" ? submitter : null;
  if (underWay && !restoring) {
    event.preventDefault();
    if (press) pending.push({ id: rowOf(press) === null ? press.id : press.id.split("-")[0], row: rowOf(press) });
    else typedMeanwhile = true;
    return;
  }
  if (restoring) ctx.request.body = bodyOf(restoring.content);
  else note();
  const waits = !press && !restoring && ctx.sourceEvent.type === "input" && (unfinishedNumber(ctx.sourceEvent.target) || unfinishedRow());
  form.toggleAttribute("data-waiting", Boolean(waits));
  if (waits) return event.preventDefault();
  if (restoring) ctx.request.headers["HX-Target"] = "form#application";
  ctx.before = restoring?.before ?? fieldsOf(form);
  ctx.restores = restoring;
  ctx.asked = contentOf(form);
  asked = ctx;
  if (press || restoring) underWay = ctx;
});

document.addEventListener("htmx:finally:request", (event) => {
  if (event.detail.ctx !== underWay) return;
  underWay = null; // it came to nothing, or its form has been put in place
  if (typedMeanwhile) formOf().dispatchEvent(new Event("input"));
  typedMeanwhile = false;
  next();
});

function next() {
  const press = pending.shift();
  if (press?.step) step(press.step);
  else if (press) document.getElementById(press.row === null ? press.id : `${press.id}-${press.row}`)?.click();
}

// --- Another form -----------------------------------------------------------------------------------------------------

const rowOf = (element) => element.closest("#duty tbody tr")?.id.split("-")[1] ?? null;
const fieldsOf = (form) => new Map([...form.elements].filter((field) => field.id).map((field) => [field.id, valueOf(field)]));

// Rows say where they stood in the form that was sent.
const placeOf = (row) => document.querySelector(`#duty tr[data-was="${row}"]`)?.id.split("-")[1];
const moved = (id, row) => (row === null ? id : placeOf(row) === undefined ? null : `${id.split("-")[0]}-${placeOf(row)}`);

document.addEventListener("htmx:before:swap", (event) => {
  const { ctx } = event.detail;
  if (!replacesForm(ctx)) return;
  const form = formOf();
  const field = form.contains(document.activeElement) ? document.activeElement : null;
  ctx.kept = {
    open: [...form.querySelectorAll("details[open]")].map((part) => part.id),
    typed: [...form.elements]
      .filter((each) => ctx.before?.has(each.id) && ctx.before.get(each.id) !== valueOf(each))
      .map((each) => ({ id: each.id, row: rowOf(each), value: valueOf(each) })),
    // A button and a new row have their focus from the server.
    focus: field?.matches("#duty tbody :is(input, select)") && ctx.request.submitter?.value !== "add" && !ctx.restores
      ? { id: field.id, row: rowOf(field), range: [field.selectionStart, field.selectionEnd] }
      : null,
  };
});

document.addEventListener("htmx:after:swap", (event) => {
  const { ctx } = event.detail;
  if (!ctx?.kept) return;
  const { open, typed, focus } = ctx.kept;
  for (const id of open) document.getElementById(id)?.setAttribute("open", "");
  if (ctx.restores) settle();
  else note(true);
  if (ctx.restores?.says) markChanged(ctx.restores);
  showAddress(ctx);
  for (const { id, row, value } of typed) {
    const field = document.getElementById(moved(id, row));
    if (!field) continue;
    field[field.type === "checkbox" ? "checked" : "value"] = value;
    typedMeanwhile = true;
  }
  if (focus) keepPlace(focus);
  for (const press of pending) if (press.row) press.row = placeOf(press.row) ?? "gone";
});

// The focus follows its cell while somebody types or edits rows by key; from a removed row it goes to the next.
function keepPlace({ id, row, range }) {
  const place = document.getElementById(moved(id, row));
  if (place) {
    place.focus();
    return place.setSelectionRange?.(...range);
  }
  const last = document.querySelectorAll("#duty tbody tr").length - 1;
  const other = document.getElementById(`${id.split("-")[0]}-${Math.min(row, last)}`);
  other?.focus();
  other?.select?.();
}

// --- Back is undo: one entry of the history per edit, which holds what the form said ----------------------------------

let at = history.state?.at ?? 0; // number of the entry that the page shows
let last = at;
let restoring = null; // what the form said in the entry that somebody has gone to
let settled = true; // the next change is a new edit; what is typed in one visit of a field is one
let addressed = contentOf(formOf()); // what the form said when the address came to be
let accepted = { query: location.search, addressed }; // the same before the visit of a field in which somebody types

document.addEventListener("focusin", () => (settled = true));

function note(own = false) {
  const content = contentOf(formOf());
  if (settled) accepted = { query: location.search, addressed };
  if (content === history.state?.content) return;
  if (settled || own) history.pushState({ at: (last = ++at), content }, "");
  else history.replaceState({ at, content }, "");
  settled = own;
  showSteps();
}

function settle() {
  restoring = null;
  history.replaceState({ at, content: contentOf(formOf()) }, "");
}

const bodyOf = (content) => {
  const body = new FormData();
  for (const [name, value] of new URLSearchParams(content)) body.append(name, value);
  return body;
};

function restore(content, says = "") {
  const form = formOf();
  settled = true;
  pending.length = 0;
  restoring = { content, before: fieldsOf(form), says };
  form.setAttribute("hx-method", content.length > 8000 || new URLSearchParams(content).has("phases") ? "post" : "get");
  form.requestSubmit();
  showSteps();
}

addEventListener("popstate", (event) => {
  if (!event.state || !formOf()) return;
  at = event.state.at;
  restore(event.state.content);
});

// "Try it" leads to other inputs on the same page: an edit that undo takes back.
document.addEventListener("click", (event) => {
  const link = event.target.closest("[data-tries]");
  if (!link || !isPlain(event)) return;
  event.preventDefault();
  note();
  const content = link.search.slice(1);
  history.pushState({ at: (last = ++at), content }, "");
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
  if (underWay && !restoring) return pending.push({ step: direction });
  if (!restoring) note();
  if (direction < 0 ? at === 0 : at === last) return;
  at += direction; // at once, so that a second press does not leave the page
  history.go(direction);
}

function showSteps() {
  for (const button of document.querySelectorAll("[data-step]")) {
    button.setAttribute("aria-disabled", String(button.dataset.step < 0 ? at === 0 : at === last));
  }
}

// Of a field that is refused, what was read from its first characters is not what somebody wanted to say.
function showAddress(ctx) {
  if (!ctx.hx?.pushurl) {
    if (ctx.restores || !document.querySelector("#problems > *")) return;
    addressed = accepted.addressed;
    return history.replaceState(history.state, "", location.pathname + accepted.query + location.hash);
  }
  addressed = ctx.kept ? contentOf(formOf()) : ctx.asked;
  history.replaceState(history.state, "", ctx.hx.pushurl + location.hash);
}

document.addEventListener("click", (event) => {
  const button = event.target.closest("[data-step]");
  if (button) step(Number(button.dataset.step));
});

const ownUndo = (element) => element.isContentEditable || element.matches("textarea, input:not([type=checkbox], [type=radio], [type=button], [type=submit], [type=file])");
document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.altKey || ownUndo(event.target) || document.querySelector("dialog[open]")) return;
  const key = event.key.toLowerCase();
  if (key !== "z" && key !== "y") return;
  event.preventDefault();
  step(key === "y" || event.shiftKey ? 1 : -1);
});

// --- After every answer -----------------------------------------------------------------------------------------------

document.addEventListener("htmx:after:swap", (event) => {
  const { ctx } = event.detail;
  if (!isOfForm(ctx) && !ctx?.kept) return;
  if (!ctx.kept) {
    showAddress(ctx);
    mark();
  }
  showSteps();
  // Nothing works unseen: what is wrong is unfolded.
  for (const field of document.querySelectorAll('#application details:not([open]) [aria-invalid="true"]')) field.closest("details").open = true;
});

// The result lists what is wrong; each message stands beside the field that it names, of a cell below its table.
function mark() {
  const form = formOf();
  for (const message of form.querySelectorAll("p.error")) message.remove();
  for (const field of form.querySelectorAll("[aria-invalid]")) {
    field.removeAttribute("aria-invalid");
    describe(field, (id) => !id.startsWith("e-"));
  }
  for (const item of document.querySelectorAll("#problems [data-field]")) {
    const field = document.getElementById(item.dataset.field);
    if (!form.contains(field)) continue;
    const first = !field.hasAttribute("aria-invalid");
    const id = `e-${field.id.replace(/^f-/, "")}`;
    const ofCell = field.closest("#duty");
    const message = Object.assign(document.createElement("p"), { className: "error" });
    const whole = ofCell || field.id === "phases";
    message.append(...[...item.cloneNode(true).childNodes].filter((part) => whole || part.matches?.("span, .offer")));
    if (ofCell) document.getElementById("duty-errors").append(message);
    else if (field.matches("fieldset")) field.append(message);
    else (field.closest(".control") ?? field).after(message);
    if (!first) continue;
    message.querySelector("span").id = id;
    field.setAttribute("aria-invalid", "true");
    describe(field, () => true, id);
  }
}

function describe(field, keep, added) {
  const ids = [added, ...(field.getAttribute("aria-describedby") ?? "").split(" ").filter(keep)].filter(Boolean);
  if (ids.length) field.setAttribute("aria-describedby", ids.join(" "));
  else field.removeAttribute("aria-describedby");
}

// --- What is still being typed ----------------------------------------------------------------------------------------

// A number that ends in its decimal mark, a sign or an operator is no error of somebody who is about to type on, nor is the 0
// of a duration of 0.3, nor a size whose number follows.
const unfinishedNumber = (field) => "bySize" in field.dataset ? /[-+*/(.,eE=:]$|;[^:;]*$/.test(field.value.trim()) : field.inputMode === "decimal" && (field.name === "t" ? /(^0|[-+*/(.,eE=])$/ : /[-+*/(.,eE=]$/).test(field.value.trim());

// Neither is a phase with a torque and no speed yet, nor a move without its time.
function unfinishedRow() {
  const row = document.activeElement?.closest("#duty tbody tr");
  if (!row || row.querySelector('[aria-invalid="true"]')) return null;
  const given = (name) => row.querySelector(`[name="${name}"]`)?.value.trim();
  const filled = (row.querySelector("select") ? [["mv"], ["mt", "ma"]] : [["T"], ["n"], ["t"]]).map((names) => names.some(given));
  return (given("pn") || filled.includes(true)) && filled.includes(false) ? row : null;
}

document.addEventListener("focusout", (event) => {
  const row = event.target.closest("#duty tbody tr");
  const left = row && !unfinishedNumber(event.target) ? !row.contains(event.relatedTarget) : event.target.form === formOf();
  if (left && formOf().matches("[data-waiting]")) formOf().requestSubmit();
});

// Behind a text that ends in a unit of its own the field's unit does not stand as well.
document.addEventListener("input", ({ target }) => target.nextElementSibling?.matches(".unit") && (target.nextElementSibling.hidden = /[a-z]$/i.test(target.value)));

// --- Inputs that stand in the result ----------------------------------------------------------------------------------

// A link or button that chooses a gear, or pins one, changes an input at once, so that it is no less of the next request.
document.addEventListener("click", (event) => {
  const button = event.target.closest('#result :is(a[data-gear], button[form="application"]:is([name="gear"], [name="pin"], [name="unpin"]))');
  if (!button || !isPlain(event)) return;
  event.preventDefault();
  const chosen = document.getElementById("chosen-gear");
  const pinned = document.getElementById(`pinned-${button.value}`);
  if (button.dataset.gear || button.name === "gear") chosen.value = button.dataset.gear ?? button.value;
  else if (pinned) pinned.remove();
  else [chosen, ...document.querySelectorAll('[id^="pinned-"]')].at(-1).after(Object.assign(chosen.cloneNode(), { id: `pinned-${button.value}`, name: "pin", value: button.value }));
  settled = true;
  formOf().requestSubmit();
});

document.addEventListener("input", (event) => {
  const { form } = event.target;
  if (form?.id === "application" && !form.contains(event.target)) form.dispatchEvent(new Event("input"));
});

// --- Links, files and comparisons of the answer -----------------------------------------------------------------------

const isAnswered = () => !document.querySelector("#problems > *, [data-waiting], [data-stale]");

document.addEventListener("htmx:finally:request", (event) => {
  if (event.detail.ctx !== asked) return;
  asked = null;
  if (wanted?.isConnected) wanted.click();
  wanted = null;
});

// They are of what the form says or are refused: the answer that is shown may be that of before.
document.addEventListener(
  "click",
  (event) => {
    const button = event.target.closest("[data-copies-address], #files :is(a, [formaction]), .pin, [data-tries]");
    const waits = asked && !button?.matches(".pin");
    if (!button || (!waits && (isAnswered() || button.matches("[data-tries]")))) return;
    event.preventDefault();
    event.stopPropagation();
    if (waits) wanted = button;
    else document.querySelector(`#connection [data-state="${button.matches(".pin") ? "uncompared" : "unanswered"}"]`).hidden = false;
  },
  true,
);

// --- Saving, and another language or other units ----------------------------------------------------------------------

// The form as it stands is saved, although its answer may still be under way.
document.addEventListener("submit", (event) => {
  const form = formOf();
  if (!event.target.matches("form.save") || event.submitter?.hasAttribute("formaction")) return; // a file is of the answer
  if (form.matches("[data-waiting]") || document.querySelector("#problems > *")) {
    event.preventDefault();
    document.querySelector('#connection [data-state="unsaved"]').hidden = false;
    return;
  }
  if (document.querySelector("[data-stale]")) {
    event.preventDefault();
    document.querySelector('#connection [data-state="unreached"]').hidden = false;
    return;
  }
  event.target.elements.link.value = `/?${contentOf(form)}`;
});

// The page is loaded anew with what the form says, finished or not; the server turns it into the units of the link.
document.addEventListener("submit", async (event) => {
  const settings = event.target;
  if (!settings.matches("form.reader")) return;
  event.preventDefault();
  await fetch(settings.action, { method: "POST", body: new URLSearchParams(new FormData(settings, event.submitter)), redirect: "manual" });
  const form = formOf();
  if (form.method === "post") return form.submit(); // a cycle too long for an address is posted again
  note();
  const content = contentOf(form);
  if (content !== addressed) history.replaceState(history.state, "", `/?${content}`);
  location.reload();
});

history.replaceState({ at, content: contentOf(formOf()) }, "");
showSteps();

// Inputs that were typed or chosen before htmx took over the form are answered now.
const isTyped = (field) =>
  field.options ? [...field.options].some((option) => option.selected !== option.defaultSelected)
  : /checkbox|radio/.test(field.type) ? field.checked !== field.defaultChecked
  : "defaultValue" in field && field.value !== field.defaultValue;
const answerTyped = () => [...formOf().elements].some(isTyped) && formOf().requestSubmit();
document.addEventListener("htmx:after:process", answerTyped, { once: true });
