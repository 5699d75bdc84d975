// Pins gears without leaving the page, and opens or folds the trivial steps of the calculation at once.

const plain = (event) => !event.button && !event.ctrlKey && !event.metaKey && !event.shiftKey && !event.altKey;

document.addEventListener("click", (event) => {
  const link = event.target.closest("a[data-pin]");
  if (!link || !plain(event)) return;
  event.preventDefault();
  const form = document.getElementById("application");
  for (const field of form.querySelectorAll('input[name="pin"]')) field.remove();
  const gear = form.querySelector('input[name="gear"]');
  for (const value of new URL(link.href).searchParams.getAll("pin").reverse()) {
    gear.after(Object.assign(document.createElement("input"), { type: "hidden", name: "pin", value }));
  }
  form.requestSubmit();
});

// Steps may also be opened one by one: the switch is on while all of them are open.
const stepsOf = (button) => [...document.querySelectorAll(button.dataset.unfold)];
const allOpen = (button) => stepsOf(button).every((step) => step.open);

function showState() {
  for (const button of document.querySelectorAll("[data-unfold]")) button.setAttribute("aria-checked", allOpen(button));
}

document.addEventListener("click", (event) => {
  const button = event.target.closest("[data-unfold]");
  if (!button) return;
  const open = !allOpen(button);
  for (const step of stepsOf(button)) step.open = open;
  showState();
});

document.addEventListener("toggle", showState, true);
document.addEventListener("htmx:after:swap", showState);
