// Pins gears without leaving the page, and opens or folds the trivial steps of the calculation at once.

const plain = (event) => !event.button && !event.ctrlKey && !event.metaKey && !event.shiftKey && !event.altKey;

let toggle = null; // the gear whose toggle was pressed and keeps the focus, wherever the answer puts it

document.addEventListener("click", (event) => {
  const button = event.target.closest("[data-pin]");
  if (!button || !plain(event)) return;
  event.preventDefault();
  const value = button.dataset.pin;
  const pins = [...document.querySelectorAll('#result > input[name="pin"]')];
  const pinned = pins.find((field) => field.value === value);
  if (pinned) pinned.remove();
  else {
    const field = Object.assign(document.createElement("input"), { type: "hidden", name: "pin", id: `pinned-${value}`, value });
    field.setAttribute("form", "application");
    (pins.at(-1) ?? document.getElementById("chosen-gear")).after(field);
  }
  toggle = button.id;
  document.getElementById("application").requestSubmit();
});

document.addEventListener("htmx:after:swap", (event) => {
  if (!toggle || event.detail.ctx?.sourceElement.id !== "application") return;
  // A column that is taken out takes its toggle along; the one in the list of candidates stays.
  const place = document.getElementById(toggle) ?? document.getElementById(toggle.replace("pin-column-", "pin-"));
  if (document.activeElement === document.body) place?.focus({ preventScroll: true });
  toggle = null;
});

// Steps may also be opened one by one: the switch is on while all of them are open.
const stepsOf = (button) => [...document.querySelectorAll(button.dataset.unfold)];
const allOpen = (button) => stepsOf(button).every((step) => step.open);

let opened = false; // what the switch was last set to

function showState() {
  for (const button of document.querySelectorAll("[data-unfold]")) button.setAttribute("aria-checked", allOpen(button));
}

document.addEventListener("click", (event) => {
  const button = event.target.closest("[data-unfold]");
  if (!button) return;
  opened = !allOpen(button);
  for (const step of stepsOf(button)) step.open = opened;
  showState();
});

// A calculation that is fetched anew, and not merged into the one before, has its steps as the switch says.
document.addEventListener("htmx:after:swap", (event) => {
  if (!opened || !event.detail.ctx?.sourceElement.matches("[data-part]")) return;
  for (const button of document.querySelectorAll("[data-unfold]")) for (const step of stepsOf(button)) step.open = true;
});

document.addEventListener("toggle", showState, true);
document.addEventListener("htmx:after:swap", showState);

// The explanation of a check is fetched from its own page when somebody opens it.
document.addEventListener("click", async (event) => {
  const link = event.target.closest("[data-explains]");
  if (!link || !plain(event)) return;
  event.preventDefault();
  const place = document.getElementById("about-check");
  const reply = await fetch(link.formAction).catch(() => null);
  if (!reply?.ok) return location.assign(link.formAction);
  const page = new DOMParser().parseFromString(await reply.text(), "text/html");
  const title = Object.assign(document.createElement("h3"), { id: "about-check-title", textContent: page.querySelector("#check h2").textContent });
  place.replaceChildren(title, page.querySelector("#check .explanation"));
  place.tabIndex = -1;
  place.showPopover();
  place.focus();
  place.addEventListener("toggle", (closing) => closing.newState === "closed" && link.focus(), { once: true });
});
