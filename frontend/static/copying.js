// Copies the text of an element, or the address of the page, which holds the whole application.
document.addEventListener("click", async (event) => {
  const button = event.target.closest("[data-copies], [data-copies-address]");
  if (!button) return;
  const source = document.getElementById(button.dataset.copies);
  try {
    await navigator.clipboard.writeText(source ? source.textContent : location.href);
    const label = button.textContent;
    button.textContent = button.dataset.done;
    setTimeout(() => (button.textContent = label), 1500);
  } catch {
    if (source) getSelection().selectAllChildren(source); // where the clipboard is out of reach, a key copies what is marked
    else prompt(button.textContent, location.href);
  }
});
