// Signs of an answer that is on its way or doesn't come: busy after a moment, then a message; nothing typed is lost.

const BUSY_AFTER = 300;
const SLOW_AFTER = 3000;
const RETRIES = [1000, 2000, 4000, 8000, 15000];

let timers = [];
let retry = null;
let tries = 0;
let latest = null; // the request whose answer counts

const resultOf = () => document.getElementById("result");
const message = (state, detail = "") => {
  for (const line of document.querySelectorAll("#connection [data-state]")) {
    const stays = state && line.dataset.state === "unreached"; // until there is an answer, however often it is tried
    if (!stays && line.hidden !== (line.dataset.state !== state)) line.hidden = line.dataset.state !== state;
    const place = line.querySelector("[data-detail]");
    if (place) place.textContent = detail;
  }
};
const stopTimers = () => (timers.forEach(clearTimeout), (timers = []));
const ofForm = (event) => event.detail.ctx?.sourceElement?.id === "application";
const ours = (event) => ofForm(event) || event.detail.ctx?.sourceElement?.id === "paste-form";

document.addEventListener("htmx:before:request", (event) => {
  if (!ours(event)) return;
  latest = event.detail.ctx;
  stopTimers();
  timers = [
    setTimeout(() => ofForm(event) && resultOf()?.setAttribute("aria-busy", "true"), BUSY_AFTER), // a table changes nothing yet
    setTimeout(() => tries || message("slow"), SLOW_AFTER),
  ];
});

function settled() {
  stopTimers();
  for (const line of document.querySelectorAll('#connection [data-state="slow"]')) line.hidden = true;
  resultOf()?.removeAttribute("aria-busy");
}

function failed(event, state, detail) {
  settled();
  if (ofForm(event)) resultOf()?.setAttribute("data-stale", "");
  message(state, detail);
  clearTimeout(retry);
  if (state === "lost") retry = setTimeout(again, RETRIES[Math.min(tries++, RETRIES.length - 1)]);
}

function again() {
  clearTimeout(retry);
  document.getElementById("application")?.requestSubmit();
}

// A reply that is no page (an overloaded server, a proxy's error) must never take the form's place.
document.addEventListener("htmx:before:swap", (event) => {
  if (!ours(event)) return;
  const { response, text } = event.detail.ctx;
  if (response.headers.get("content-type")?.startsWith("text/html") && response.status < 500) return;
  event.preventDefault();
  let detail = "";
  try {
    detail = JSON.parse(text).detail ?? "";
  } catch {
    detail = String(response.status);
  }
  failed(event, "refused", detail);
});

document.addEventListener("htmx:after:swap", (event) => {
  if (!ours(event)) return;
  settled();
  clearTimeout(retry);
  tries = 0;
  resultOf()?.removeAttribute("data-stale");
  message(null);
});

document.addEventListener("htmx:error", (event) => ours(event) && event.detail.ctx.status !== "swapped" && failed(event, "lost"));
addEventListener("online", () => tries && again());
document.addEventListener("click", (event) => event.target.closest("[data-retry]") && again());

document.addEventListener("htmx:finally:request", (event) => event.detail.ctx === latest && settled());

// A cycle that no address holds would be lost with the page, and so would what nobody has answered.
let downloading = false;
document.addEventListener("submit", (event) => {
  downloading = Boolean(event.submitter?.hasAttribute("formaction"));
  setTimeout(() => (downloading = false), 1000);
});
addEventListener("beforeunload", (event) => {
  if (!downloading && document.querySelector("[data-unsaved], [data-stale]")) event.preventDefault();
});
