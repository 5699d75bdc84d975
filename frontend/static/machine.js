// A machine's page: the effect of a change is said while it is typed, and the keys of its table.

const table = () => document.getElementById("axes");
const marks = () => [...table()?.querySelectorAll(".pick input") ?? []];
const isText = (element) => element.matches("textarea, select, input:not([type=checkbox], [type=radio])");

// --- Changes: counted while they are made, and given up where somebody stops them ----------------------------------------

let pending = null;
let waiting = 0;

// Page that answers a form; `tell` gets every count on the way.
async function send(form, action, tell, signal) {
  const body = new URLSearchParams(new FormData(form));
  body.set("do", action);
  const headers = { Accept: "text/event-stream, text/html" };
  const answer = await fetch(form.action, { method: "POST", body, headers, signal });
  if (!answer.headers.get("Content-Type")?.startsWith("text/event-stream")) return answer.text();
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  for (let rest = ""; ;) {
    const { value, done } = await reader.read();
    if (done) throw new Error("the answer broke off");
    const events = (rest + value).split("\n\n");
    rest = events.pop();
    for (const event of events) {
      const count = JSON.parse(event.slice("data: ".length));
      if ("page" in count) return count.page;
      tell(count);
    }
  }
}

const pageOf = (text) => new DOMParser().parseFromString(text, "text/html");

async function sayEffect(form) {
  pending?.abort();
  pending = new AbortController();
  const effect = form.querySelector("[data-effect]");
  try {
    const tell = (count) => { if (count.done) effect.textContent = count.text; };
    const text = await send(form, "dry", tell, pending.signal);
    const same = pageOf(text).getElementById(form.id);
    if (!same) return;
    if ("overtaken" in same.dataset) return showTheirs(text);
    effect.classList.remove("refused");
    effect.replaceChildren(...same.querySelector("[data-effect]").childNodes);
    form.querySelector("[data-apply]").hidden = same.querySelector("[data-apply]").hidden;
  } catch (error) {
    if (error.name === "AbortError") return;
    effect.textContent = document.querySelector("[data-end=broken]").textContent;
    effect.classList.add("refused");
    form.querySelector("[data-apply]").hidden = false; // for when the server answers
  }
}

// Somebody else was faster: the page with theirs, and what was typed here in the fields.
function showTheirs(text) {
  const { id } = document.activeElement;
  show(text);
  document.getElementById(id)?.focus();
}

document.addEventListener("input", (event) => {
  const form = event.target.closest("form[data-dry]");
  if (!form || event.target.matches(".every")) return;
  pending?.abort(); // its answer is to what was typed before
  form.querySelector("[data-apply]").hidden = true;
  clearTimeout(waiting);
  if (form.id === "changing" && !form.querySelector(".pick input:checked, [name=everything]:checked")) return;
  waiting = setTimeout(() => sayEffect(form), 400);
});

function show(text) {
  const page = pageOf(text);
  const main = page.querySelector("main");
  document.querySelector("main").replaceWith(main);
  document.title = page.title;
  keepAddress(main);
  begin();
  main.querySelector(".machine-strap:not([hidden]), .effect.refused, [role=alert]")?.scrollIntoView({ block: "nearest" });
}

// Once the form of the common values is closed, the address doesn't open it again.
function keepAddress(main) {
  const address = new URL(location.href);
  if (address.searchParams.get("edit") !== "common" || main.querySelector(".every-axis.editing")) return;
  address.searchParams.delete("edit");
  history.replaceState(history.state, "", address);
}

// A long change: its count, and the button that stops it. What is stopped has changed nothing, and stays in the fields.
async function change(form, action) {
  clearTimeout(waiting);
  pending?.abort();
  const stopping = new AbortController();
  const strap = document.getElementById("work");
  const stop = strap.querySelector("button");
  const [count, bar] = [strap.querySelector("[data-count]"), strap.querySelector("progress")];
  const timer = setTimeout(() => { strap.hidden = false; }, 400);
  say("");
  stop.disabled = false;
  stop.onclick = () => stopping.abort();
  try {
    show(await send(form, action, (now) => {
      count.textContent = now.text;
      bar.max = now.of || 1;
      bar.value = now.done;
      stop.disabled = now.saving;
    }, stopping.signal));
  } catch (error) {
    await tellEnd(error.name === "AbortError" ? "stopped" : "broken", strap.dataset.state);
  } finally {
    clearTimeout(timer);
    strap.hidden = true;
  }
}

// The end of a change without its answer: the page stays as it is, unless the machine is another one by now.
async function tellEnd(end, before) {
  try {
    const text = await (await fetch(location.href)).text();
    if (pageOf(text).getElementById("work")?.dataset.state !== before) {
      show(text);
      return say("meanwhile");
    }
  } catch {
    return say("broken");
  }
  say(end);
}

function say(end) {
  for (const line of document.querySelectorAll("[data-end]")) line.hidden = line.dataset.end !== end;
  document.querySelector("[data-end]:not([hidden])")?.scrollIntoView({ block: "nearest" });
}

document.addEventListener("submit", (event) => {
  const form = event.target;
  if (!form.matches("form[action$='/change'], form[action*='/change?']") || !event.submitter) return;
  event.preventDefault();
  change(form, event.submitter.value);
});

// --- Marking ----------------------------------------------------------------------------------------------------------

document.addEventListener("change", (event) => {
  if (!event.target.matches(".every")) return;
  for (const mark of marks()) mark.checked = event.target.checked;
  marks()[0]?.dispatchEvent(new Event("input", { bubbles: true }));
});

// --- Keys -------------------------------------------------------------------------------------------------------------

const KEYS = {
  "/": () => document.querySelector(".finding [type=search]")?.focus(),
  e: () => document.querySelector(".edit-every")?.click(),
  ArrowDown: () => step(1),
  ArrowUp: () => step(-1),
  Enter: () => table().querySelector("tr:focus-within th a")?.click(),
};

function step(by) {
  const all = marks();
  const at = all.findIndex((mark) => mark.closest("tr").contains(document.activeElement));
  all[Math.min(Math.max(at + by, 0), all.length - 1)]?.focus();
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

// --- What takes its time ----------------------------------------------------------------------------------------------

// The page does not wait for fewest kinds, nor for what changed in a large machine.
async function load(place) {
  const answer = await fetch(place.dataset.load);
  if (!answer.ok) return;
  const page = new DOMParser().parseFromString(await answer.text(), "text/html");
  const part = page.getElementById(place.id);
  if (!part) return;
  // Steps that can be undone go along.
  const past = document.querySelectorAll(".undo [name=past]");
  for (const form of part.querySelectorAll("form")) form.append(...[...past].map((field) => field.cloneNode()));
  place.replaceWith(part);
}

function begin() {
  // The effect is said by itself: nobody has to ask for it.
  for (const button of document.querySelectorAll("form[data-dry] [value=dry]")) button.hidden = true;
  for (const place of document.querySelectorAll("[data-load]")) load(place);
}

begin();
