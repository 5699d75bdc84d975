// Dialogs, pasting into the duty table, and the keys. Everything hangs on the document, because the body is replaced
// when somebody goes back in history.

import "./copying.js";

import { contentOf, formOf, isText } from "./form.js";

// --- Dialogs ----------------------------------------------------------------------------------------------------------

document.addEventListener("click", (event) => {
  const opener = event.target.closest("[data-opens]");
  const dialog = opener && document.getElementById(opener.dataset.opens);
  if (!dialog) return;
  event.preventDefault();
  if (dialog.id === "paste") openPaste("");
  else dialog.showModal();
});

function openPaste(text) {
  const dialog = document.getElementById("paste");
  const form = dialog.querySelector("form");
  form.reset();
  form.elements.text.value = text;
  document.getElementById("paste-preview").replaceChildren();
  dialog.showModal();
  form.elements.text.focus();
  if (text) form.requestSubmit();
}

// --- Pasting ----------------------------------------------------------------------------------------------------------

// One cell pastes as ever; several open the dialog, where is seen what they are read as.
const ofSeveralCells = (text) => /[\t\n;]|, |,.*,.*[.]/.test(text.trim());

document.addEventListener("paste", (event) => {
  if (!event.target.closest?.("#duty")) return;
  const text = event.clipboardData.getData("text/plain");
  if (!ofSeveralCells(text)) return;
  event.preventDefault();
  openPaste(text);
});

document.addEventListener("htmx:config:request", (event) => {
  const { ctx } = event.detail;
  if (ctx.sourceElement.id !== "paste-form") return;
  const form = formOf();
  if (!form) return; // the page of its own brings its link along
  ctx.request.body.set("link", contentOf(form));
});

// These forms ask some moments after a choice: the answer to the choice before would put that one back into the form.
document.addEventListener("input", (event) => {
  const { form } = event.target;
  if (form?.matches("#paste-form, #ordering-form")) form.dispatchEvent(new Event("htmx:abort"));
});

const lastFocus = { preview: null, form: null }; // the places that the focus comes back to

// The preview is exchanged whole, so that each choice shows what the server read; who answers keeps the place.
document.addEventListener("htmx:before:swap", (event) => {
  if (event.detail.ctx?.sourceElement.id === "paste-form") lastFocus.preview = document.activeElement.closest("#paste-preview :is(select, input)")?.id;
});

document.addEventListener("htmx:after:swap", (event) => {
  const { ctx } = event.detail;
  if (ctx?.sourceElement.id !== "paste-form") return;
  if (ctx.kept) {
    document.getElementById("paste").close();
    document.querySelector("#duty input, #phases")?.focus();
  } else if (lastFocus.preview) {
    document.getElementById(lastFocus.preview)?.focus();
  } else if (ctx.sourceEvent.type === "submit") {
    document.querySelector("#paste-preview :is(select.asked, .asked input, .take button)")?.focus({ preventScroll: false });
  }
});

// --- Keys -------------------------------------------------------------------------------------------------------------

const ROW_KEYS = { ArrowUp: "up", ArrowDown: "down", Delete: "remove" };

function keyInForm(event) {
  if (event.altKey && event.key === "Enter") return press("add");
  const row = event.target.closest("#duty tbody tr");
  const name = ROW_KEYS[event.key];
  if (event.key === "Enter" && !event.ctrlKey && row && event.target.matches("input")) return below(event.target);
  if (event.altKey && name && row) return press(`${name}-${row.id.split("-")[1]}`);
  if (event.ctrlKey && event.key === "Enter") {
    const result = document.getElementById("result");
    lastFocus.form = event.target.id;
    result.focus();
    return true;
  }
  return false;
}

// As in a spreadsheet: down the column, and behind the last row a new one.
function below({ id, name }) {
  const column = [...document.querySelectorAll(`#duty tbody input[name="${name}"]`)];
  const next = column.slice(column.findIndex((cell) => cell.id === id) + 1).find((cell) => cell.checkVisibility({ visibilityProperty: true }));
  next?.select();
  return Boolean(next) || press("add");
}

function openMenu(row) {
  const number = row.id.split("-")[1];
  document.querySelector(`[popovertarget="row-${number}"]`).click();
  document.getElementById(`up-${number}`).focus();
  return true;
}

function press(id) {
  const button = document.getElementById(id);
  button?.click();
  return Boolean(button);
}

const asksMenu = ({ key, shiftKey, target }) => (key === "ContextMenu" || (key === "F10" && shiftKey)) && target.closest("#duty tbody tr");

document.addEventListener("keyup", (event) => event.key === "ContextMenu" && asksMenu(event) && event.preventDefault());

document.addEventListener("keydown", (event) => {
  if (document.querySelector("dialog[open]")) return;
  const plain = !event.ctrlKey && !event.metaKey && !event.altKey;
  if (plain && event.key === "?" && !isText(event.target)) document.getElementById("shortcuts")?.showModal();
  else if (plain && event.key === "Escape" && event.target.id === "result") document.getElementById(lastFocus.form)?.focus();
  else if (asksMenu(event) && openMenu(event.target.closest("#duty tbody tr"))) event.preventDefault();
  else if (!event.shiftKey && formOf()?.contains(event.target) && keyInForm(event)) event.preventDefault();
});

// --- A gear by its name -----------------------------------------------------------------------------------------------

document.addEventListener("submit", async (event) => {
  const field = event.target.matches("[data-finds]") ? event.target.elements.gear : null;
  const name = field?.value.trim();
  if (!name || !formOf()) return;
  event.preventDefault();
  const reply = await fetch(`/api/v1/catalogue/${encodeURIComponent(name)}`).catch(() => null);
  if (reply?.status === 404) {
    field.setCustomValidity(field.dataset.unknown);
    field.reportValidity();
    return;
  }
  document.getElementById("chosen-gear").value = name;
  formOf().requestSubmit();
});

document.addEventListener("input", (event) => event.target.matches("[data-unknown]") && event.target.setCustomValidity(""));
