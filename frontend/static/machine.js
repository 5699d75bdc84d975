// A machine's page: the effect of a change is said while it is typed, and the keys of its table.

const table = () => document.getElementById("axes");
const marks = () => [...table()?.querySelectorAll(".pick input") ?? []];
const isText = (element) => element.matches("textarea, select, input:not([type=checkbox], [type=radio])");

// --- The effect -------------------------------------------------------------------------------------------------------

let asked = null;
let waiting = 0;

async function sayEffect(form) {
  asked?.abort();
  asked = new AbortController();
  const body = new URLSearchParams(new FormData(form));
  body.set("do", "dry");
  try {
    const answer = await fetch(form.action, { method: "POST", body, signal: asked.signal });
    const page = new DOMParser().parseFromString(await answer.text(), "text/html");
    const same = page.getElementById(form.id);
    if (!same) return;
    form.querySelector("[data-effect]").replaceChildren(...same.querySelector("[data-effect]").childNodes);
    form.querySelector("[data-apply]").hidden = same.querySelector("[data-apply]").hidden;
  } catch (error) {
    if (error.name !== "AbortError") throw error;
  }
}

document.addEventListener("input", (event) => {
  const form = event.target.closest("form[data-dry]");
  if (!form || event.target.matches(".every")) return;
  form.querySelector("[data-apply]").hidden = true;
  clearTimeout(waiting);
  if (form.id === "changing" && !form.querySelector(".pick input:checked, [name=everything]:checked")) return;
  waiting = setTimeout(() => sayEffect(form), 400);
});

// --- Marking ----------------------------------------------------------------------------------------------------------

document.addEventListener("change", (event) => {
  if (!event.target.matches(".every")) return;
  for (const mark of marks()) mark.checked = event.target.checked;
  marks()[0]?.dispatchEvent(new Event("input", { bubbles: true }));
});

// --- Keys -------------------------------------------------------------------------------------------------------------

// The effect is said by itself: nobody has to ask for it.
for (const button of document.querySelectorAll("form[data-dry] [value=dry]")) button.hidden = true;

const KEYS = {
  "/": () => document.querySelector(".finding [type=search]")?.focus(),
  e: () => document.querySelector(".edit-every")?.click(),
  ArrowDown: () => step(1),
  ArrowUp: () => step(-1),
  Enter: () => table().querySelector("tr:focus-within th a")?.click(),
};

function step(by) {
  const found = marks();
  const at = found.findIndex((mark) => mark.closest("tr").contains(document.activeElement));
  found[Math.min(Math.max(at + by, 0), found.length - 1)]?.focus();
}

document.addEventListener("keydown", (event) => {
  if (event.altKey || event.isComposing) return;
  if (event.key === "Escape") {
    const close = document.querySelector(".every-axis.editing .every-head a");
    const marked = marks().filter((mark) => mark.checked);
    if (marked.length) for (const mark of marked) mark.checked = false;
    else close?.click();
    return;
  }
  if (isText(event.target)) return;
  if (event.ctrlKey || event.metaKey) {
    if (event.key !== "z") return;
    event.preventDefault();
    document.querySelector(".undo [value=undo]")?.click();
    return;
  }
  const key = KEYS[event.key] ?? KEYS[event.key.toLowerCase()];
  if (!key || (event.key === "Enter" && !event.target.matches(".pick input"))) return;
  event.preventDefault();
  key();
});

// --- Fewest kinds -----------------------------------------------------------------------------------------------------

// They take a second: the page does not wait for them.
async function loadKinds(place) {
  const answer = await fetch(place.dataset.load);
  if (!answer.ok) return;
  const page = new DOMParser().parseFromString(await answer.text(), "text/html");
  const found = page.getElementById("kinds");
  if (!found) return;
  // Steps that can be undone go along.
  const past = document.querySelectorAll(".undo [name=past]");
  for (const form of found.querySelectorAll("form")) form.append(...[...past].map((field) => field.cloneNode()));
  place.replaceWith(found);
}

const kinds = document.querySelector("#kinds[data-load]");
if (kinds) loadKinds(kinds);
