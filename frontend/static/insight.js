// Shows the explanation of a check when it has come.

document.addEventListener("htmx:after:swap", (event) => {
  const place = event.detail.ctx?.target;
  if (place?.id !== "about-check") return;
  place.showPopover(); // closing it leads back to the name of the check
  place.focus();
});
