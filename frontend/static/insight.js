// Opens or folds the trivial steps of the calculation at once, and shows the explanation of a check.

let opened = false; // what the switch says; a step may be opened by its own line, too

function unfold() {
  for (const button of document.querySelectorAll("[data-unfold]")) {
    button.setAttribute("aria-checked", opened);
    for (const step of document.querySelectorAll(button.dataset.unfold)) step.open = opened;
  }
}

document.addEventListener("click", (event) => {
  if (!event.target.closest("[data-unfold]")) return;
  opened = !opened;
  unfold();
});

document.addEventListener("htmx:after:swap", (event) => {
  const place = event.detail.ctx?.target;
  if (opened) unfold(); // a calculation that is fetched anew comes folded
  if (place?.id !== "about-check") return;
  place.showPopover(); // closing it leads back to the name of the check
  place.focus();
});
