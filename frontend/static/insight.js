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

document.addEventListener("click", (event) => {
  const button = event.target.closest("[data-unfold]");
  if (!button) return;
  const open = button.getAttribute("aria-checked") !== "true";
  button.setAttribute("aria-checked", open);
  for (const step of document.querySelectorAll(button.dataset.unfold)) step.open = open;
});
