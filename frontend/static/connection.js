// Signs of an answer that is on its way or doesn't come: busy after a moment, then a message; nothing typed is lost.

import { formOf, isOfForm } from "./form.js";

const BUSY_AFTER = 300;
const SLOW_AFTER = 3000;
const LONGEST_RETRY = 15000;

// Of the latest request, whose answer counts; `tries` are those without an answer so far.
const line = { ctx: null, timers: [], tries: 0, downloads: false };

const resultOf = () => document.getElementById("result");
const ofForm = (event) => isOfForm(event.detail.ctx);
const ours = (event) => ofForm(event) || event.detail.ctx?.sourceElement?.id === "paste-form";
const retry = () => formOf()?.requestSubmit();

function show(state, detail = "") {
  for (const line of document.querySelectorAll("#connection [data-state]")) {
    const stays = state && line.dataset.state === "unreached"; // until there is an answer, however often it is tried
    if (!stays) line.hidden = line.dataset.state !== state;
  }
  document.querySelector("#connection [data-detail]").textContent = detail;
}

function settle() {
  line.timers.forEach(clearTimeout);
  document.querySelector('#connection [data-state="slow"]').hidden = true;
  resultOf()?.removeAttribute("aria-busy");
}

document.addEventListener("htmx:before:request", (event) => {
  if (!ours(event)) return;
  line.ctx = event.detail.ctx;
  line.timers.forEach(clearTimeout);
  line.timers = [
    setTimeout(() => ofForm(event) && resultOf()?.setAttribute("aria-busy", "true"), BUSY_AFTER), // a table changes nothing yet
    setTimeout(() => line.tries || show("slow"), SLOW_AFTER),
  ];
});

function fail(event, state, detail) {
  settle();
  if (ofForm(event)) resultOf()?.setAttribute("data-stale", "");
  show(state, detail);
  if (state === "lost") line.timers = [setTimeout(retry, Math.min(1000 * 2 ** line.tries++, LONGEST_RETRY))];
}

// A reply that is no part of the page (an overloaded server, a proxy's error or login) must never take the form's place.
document.addEventListener("htmx:before:swap", (event) => {
  if (!ours(event)) return;
  const { response, text } = event.detail.ctx;
  const isPart = response.headers.get("content-type")?.startsWith("text/html") && !/<(html|body)\b/i.test(text);
  if (isPart && response.status < 500) return;
  event.preventDefault();
  const isProblem = response.headers.get("content-type")?.startsWith("application/problem+json");
  fail(event, "refused", `${isProblem ? JSON.parse(text).detail : `HTTP ${response.status}`}.`);
});

document.addEventListener("htmx:after:swap", (event) => {
  if (!ours(event)) return;
  settle();
  line.tries = 0;
  resultOf()?.removeAttribute("data-stale");
  show(null);
});

document.addEventListener("htmx:error", (event) => ours(event) && event.detail.ctx.status !== "swapped" && fail(event, "lost"));
document.addEventListener("htmx:finally:request", (event) => event.detail.ctx === line.ctx && !line.tries && settle());
addEventListener("online", () => line.tries && retry());
document.addEventListener("click", ({ target }) => {
  if (target.closest("[data-retry]")) retry();
  if (target.closest("[data-goes]")) formOf().querySelector('[aria-invalid="true"]')?.focus();
});

// A cycle that no address holds would be lost with the page, and so would what nobody has answered.
document.addEventListener("submit", (event) => {
  line.downloads = Boolean(event.submitter?.hasAttribute("formaction"));
  setTimeout(() => (line.downloads = false), 1000);
});
addEventListener("beforeunload", (event) => {
  if (!line.downloads && document.querySelector("[data-unsaved], [data-stale]")) event.preventDefault();
});
