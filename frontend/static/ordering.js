// The ordering code follows what is chosen; the server does the same where there is no script.

function put(form) {
  const { output, motor } = form.elements;
  const field = form.querySelector("[name=motor]");
  const typed = field.value.trim();
  const valid = typed !== "" && new RegExp(`^(?:${field.pattern})$`).test(typed);
  const wrong = typed !== "" && !valid;
  form.querySelector("output").textContent = [form.dataset.designation, output.value, ...(valid ? [motor.value.trim().toUpperCase()] : [])].join("-");
  field.toggleAttribute("aria-invalid", wrong);
  if (wrong) field.setAttribute("aria-invalid", "true");
  form.querySelector(".error").hidden = !wrong;
}

document.addEventListener("input", (event) => {
  const form = event.target.closest("form.ordering");
  if (form) put(form);
});
document.addEventListener("submit", (event) => {
  if (event.target.matches("form.ordering")) event.preventDefault();
});
document.addEventListener("htmx:after:swap", () => document.querySelectorAll("form.ordering").forEach(put));

document.addEventListener("click", async (event) => {
  const button = event.target.closest("[data-copies]");
  if (!button) return;
  const source = document.getElementById(button.dataset.copies);
  try {
    await navigator.clipboard.writeText(source.textContent);
    const label = button.textContent;
    button.textContent = button.dataset.done;
    setTimeout(() => (button.textContent = label), 1500);
  } catch {
    getSelection().selectAllChildren(source); // where the clipboard is out of reach, a key copies what is marked
  }
});
