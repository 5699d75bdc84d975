// Sections of the result, one at a time. Those out of sight are left out of an answer and requested when they come into
// sight.

import { contentOf, formOf, isOfForm } from "./form.js";
import { mark, measure } from "./shown.js";

const AHEAD = 400; // pixels below the edge of the window that count as in sight

const isPart = (element) => element.matches("[data-part]");
const isSeen = (part) => part.checkVisibility() && (part.localName !== "details" || part.open) && part.getBoundingClientRect().top < innerHeight + AHEAD;
const isEmpty = (part) => !part.querySelector(":scope > :not(h2, h3, summary)");
const addressOf = (part) => document.getElementById(part.id)?.dataset.part;
const bring = (part) => isEmpty(part) && isSeen(part) && htmx.trigger(part, "unfold");

// --- What is in sight -------------------------------------------------------------------------------------------------

const answered = { content: contentOf(formOf()) }; // what the form said when the answer came that is shown
const isAnswered = () => !document.querySelector("#problems > *, [data-waiting]");

document.addEventListener("htmx:config:request", (event) => {
  const { ctx } = event.detail;
  if (ctx.sourceElement.id === "application") {
    ctx.request.headers["HPN-Parts"] = [...document.querySelectorAll("[data-part]")].filter(isSeen).map((part) => part.id).join(" ");
  } else if (isPart(ctx.sourceElement)) {
    ctx.partOf = addressOf(ctx.sourceElement);
    if (isAnswered()) return;
    // While an input is refused or missing, the parts are those of the answer of before.
    ctx.request.body = new FormData();
    for (const [name, value] of new URLSearchParams(answered.content)) ctx.request.body.append(name, value);
  }
});

document.addEventListener("htmx:after:swap", ({ detail: { ctx } }) => {
  if ((isOfForm(ctx) || ctx?.kept) && isAnswered()) answered.content = ctx.kept ? contentOf(formOf()) : ctx.asked;
});

const watcher = new IntersectionObserver((entries) => entries.forEach(({ target, isIntersecting }) => isIntersecting && bring(target)), { rootMargin: `0px 0px ${AHEAD}px` });

function watch() {
  measure();
  for (const part of document.querySelectorAll("[data-part]")) {
    watcher.observe(part); // once more does no harm
    bring(part);
  }
}

document.addEventListener("toggle", (event) => isPart(event.target) && bring(event.target), true);
document.addEventListener("htmx:after:swap", () => {
  mark();
  watch();
});
watch();
addEventListener("hashchange", watch);

// A part belongs to the answer that it was requested for: beside a later one it would be wrong, and is requested again.
const isOutdated = (ctx) => ctx.partOf !== undefined && ctx.partOf !== addressOf(ctx.sourceElement);

document.addEventListener("htmx:before:swap", (event) => isOutdated(event.detail.ctx) && event.preventDefault());
document.addEventListener("htmx:finally:request", (event) => {
  const { ctx } = event.detail;
  const part = isOutdated(ctx) ? document.getElementById(ctx.sourceElement.id) : null;
  if (part) bring(part);
});
