// Keys of an axis of a machine: save it back, the axes before and after it.

const KEYS = { "[": 'a[aria-keyshortcuts="["]', "]": 'a[aria-keyshortcuts="]"]' };

document.addEventListener("keydown", (event) => {
  const save = document.getElementById("save-axis");
  if (!save || document.querySelector("dialog[open]")) return;
  if ((event.ctrlKey || event.metaKey) && !event.altKey && event.key.toLowerCase() === "s") {
    event.preventDefault();
    save.click();
  } else if (!event.ctrlKey && !event.metaKey && Object.hasOwn(KEYS, event.key) && !event.target.matches("input:not([type=checkbox], [type=radio]), textarea, select")) {
    document.querySelector(KEYS[event.key])?.click();
  }
});
