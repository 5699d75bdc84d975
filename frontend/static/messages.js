// Messages beside the fields, and what is still being typed.

import { formOf } from "./form.js";

// The result lists what is wrong; each message stands beside the field that it names, of a cell below its table.
export function mark() {
  const form = formOf();
  for (const message of form.querySelectorAll("p.error")) message.remove();
  for (const field of form.querySelectorAll("[aria-invalid]")) {
    for (const name of ["aria-invalid", "data-missing"]) field.removeAttribute(name);
    describe(field, (id) => !id.startsWith("e-"));
  }
  for (const item of document.querySelectorAll("#problems [data-field]")) {
    const field = document.getElementById(item.dataset.field);
    if (!form.contains(field)) continue;
    const first = !field.hasAttribute("aria-invalid");
    const id = `e-${field.id.replace(/^f-/, "")}`;
    const ofCell = field.closest("#duty");
    const message = Object.assign(document.createElement("p"), { className: "error" });
    message.toggleAttribute("data-missing", item.matches("[data-missing]"));
    const whole = ofCell || field.id === "phases";
    message.append(...[...item.cloneNode(true).childNodes].filter((part) => whole || part.matches?.("span, .offer")));
    if (ofCell) document.getElementById("duty-errors").append(message);
    else if (field.matches("fieldset")) field.append(message);
    else (field.closest(".control") ?? field).after(message);
    if (!first) continue;
    message.querySelector("span").id = id;
    field.setAttribute("aria-invalid", "true");
    field.toggleAttribute("data-missing", item.matches("[data-missing]"));
    describe(field, () => true, id);
  }
}

function describe(field, keep, added) {
  const ids = [added, ...(field.getAttribute("aria-describedby") ?? "").split(" ").filter(keep)].filter(Boolean);
  if (ids.length) field.setAttribute("aria-describedby", ids.join(" "));
  else field.removeAttribute("aria-describedby");
}

// Nothing works unseen: what is wrong is unfolded.
export function unfold() {
  for (const field of document.querySelectorAll('#application details:not([open]) [aria-invalid="true"]')) field.closest("details").open = true;
}

// A number that ends in its decimal mark, a sign or an operator is no error of somebody who is about to type on, nor is the 0
// of a duration of 0.3.
const unfinishedNumber = (field) => field.inputMode === "decimal" && (field.name === "t" ? /(^0|[-+*/(.,eE=])$/ : /[-+*/(.,eE=]$/).test(field.value.trim());

// Neither is a phase with a torque and no speed yet, nor a move without its time: what each needs at least, of several one.
const RAMPS = ["ma", "mta", "mtd", "md2"];
const OF_PROFILE = { dwell: [["mt"]], modified_sine: [["ms"], ["mt"]], triangular: [["ms"], ["mt", "mn", "ma"]] };

function needs(row, textOf) {
  const profile = row.querySelector("select")?.value;
  if (profile === undefined) return [["T"], ["n"], ["t"]];
  return [["mv"], ...(OF_PROFILE[profile] ?? [["ms"], textOf("mn") && !textOf("mt") ? RAMPS : ["mt"]])];
}

// The first cell that the row of the focus still lacks, where something stands in that row.
function missingCell() {
  const row = document.activeElement?.closest("#duty tbody tr");
  if (!row || row.querySelector('[aria-invalid="true"]')) return null;
  const cell = (name) => row.querySelector(`[name="${name}"]`);
  const textOf = (name) => cell(name)?.value.trim();
  const parts = needs(row, textOf);
  const lacking = parts.find((names) => !names.some(textOf));
  return lacking && (textOf("pn") || parts.some((names) => names.some(textOf))) ? lacking.map(cell).find(Boolean) : null;
}

// True where the request of a field waits for an input, which is named below the table and in the head of the result.
export function awaited(field) {
  const input = field && (missingCell() ?? (unfinishedNumber(field) ? field : null));
  for (const each of document.querySelectorAll("#duty [data-awaited]")) each.removeAttribute("data-awaited");
  if (!input) return false;
  if (input !== field) input.setAttribute("data-awaited", "");
  for (const link of document.querySelectorAll("[data-names-awaited]")) {
    link.href = `#${input.id}`;
    link.textContent = input.getAttribute("aria-label") ?? input.labels[0]?.firstElementChild.textContent;
  }
  return true;
}

document.addEventListener("focusout", (event) => {
  const row = event.target.closest("#duty tbody tr");
  const hasLeft = row && !unfinishedNumber(event.target) ? !row.contains(event.relatedTarget) : event.target.form === formOf();
  if (hasLeft && formOf().matches("[data-waiting]")) formOf().requestSubmit();
});

// A tolerance that is a number alone is percent.
document.addEventListener("change", ({ target }) => target.matches(".tolerance") && (target.value = target.value.replace(/^[\d.,]+$/, "$& %")));

// Behind a text that ends in a unit of its own the field's unit does not stand as well.
document.addEventListener("input", ({ target }) => target.nextElementSibling?.matches(".unit") && (target.nextElementSibling.hidden = /[a-z]$/i.test(target.value)));
