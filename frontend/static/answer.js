// Inputs that stand in the result, and what is done with an answer: links, files, saving.

import { contentOf, formOf, isOfForm, isPlain, isTicked } from "./form.js";
import { beginEdit, isAddressed, note } from "./undo.js";

// --- Inputs that stand in the result ----------------------------------------------------------------------------------

// A link or button that chooses a gear, or pins one, changes an input at once, so that it is no less of the next request.
document.addEventListener("click", (event) => {
  const button = event.target.closest('#result :is(a[data-gear], button[form="application"]:is([name="gear"], [name="pin"], [name="unpin"]))');
  if (!button || !isPlain(event)) return;
  event.preventDefault();
  const field = document.getElementById("chosen-gear");
  const pinned = document.getElementById(`pinned-${button.value}`);
  if (button.dataset.gear || button.name === "gear") field.value = button.dataset.gear ?? button.value;
  else if (pinned) pinned.remove();
  else [field, ...document.querySelectorAll('[id^="pinned-"]')].at(-1).after(Object.assign(field.cloneNode(), { id: `pinned-${button.value}`, name: "pin", value: button.value }));
  beginEdit();
  formOf().requestSubmit();
});

document.addEventListener("input", (event) => {
  const { form } = event.target;
  if (form?.id === "application" && !form.contains(event.target)) form.dispatchEvent(new Event("input"));
});

// --- Links, files and comparisons of the answer -----------------------------------------------------------------------

const isAnswered = () => !document.querySelector("#problems > *, [data-waiting], [data-stale]");

const flight = { ctx: null, button: null }; // the request that is under way, and what was pressed meanwhile

document.addEventListener("htmx:config:request", (event) => {
  if (isOfForm(event.detail.ctx) && !event.defaultPrevented) flight.ctx = event.detail.ctx;
});

document.addEventListener("htmx:finally:request", (event) => {
  if (event.detail.ctx !== flight.ctx) return;
  const { button } = flight;
  Object.assign(flight, { ctx: null, button: null });
  if (button?.isConnected) button.click();
});

// They are of what the form says or are refused: the answer that is shown may be that of before.
document.addEventListener(
  "click",
  (event) => {
    const button = event.target.closest("[data-copies-address], #files :is(a, [formaction]), .pin, [data-tries]");
    const waits = flight.ctx && !button?.matches(".pin");
    if (!button || (!waits && (isAnswered() || button.matches("[data-tries]")))) return;
    event.preventDefault();
    event.stopPropagation();
    if (waits) flight.button = button;
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
  if (!isAddressed(content)) history.replaceState(history.state, "", `${location.pathname}?${content}`);
  location.reload();
});

// Inputs that were typed or chosen before htmx took over the form are answered now.
const isTyped = (field) =>
  field.options ? [...field.options].some((option) => option.selected !== option.defaultSelected)
  : isTicked(field) ? field.checked !== field.defaultChecked
  : "defaultValue" in field && field.value !== field.defaultValue;
const answerTyped = () => [...formOf().elements].some(isTyped) && formOf().requestSubmit();
document.addEventListener("htmx:after:process", answerTyped, { once: true });
