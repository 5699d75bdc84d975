// The section of the result that is shown: one at a time, by a tab, a link within the page, or the address.

const wide = matchMedia("(min-width: 1024px)");

const sectionOf = (element) => element?.closest(".section")?.id;

function show(id) {
  document.querySelector("main").dataset.section = id;
  mark();
}

export function mark() {
  const { section } = document.querySelector("main").dataset;
  for (const tab of document.querySelectorAll(".tabs a")) {
    if (tab.hash === `#${section}`) tab.setAttribute("aria-current", "true");
    else tab.removeAttribute("aria-current");
  }
}

// A link within the page is no edit, and takes no entry of the history. Its target is shown: the section, the fold; where
// there is no section yet, the result. The address keeps a section, so that a reload comes back to it.
document.addEventListener("click", (event) => {
  const link = event.target.closest('a[href^="#"]');
  const target = link && (document.getElementById(link.hash.slice(1)) ?? document.getElementById("result"));
  if (!target || event.button || event.ctrlKey || event.metaKey || event.shiftKey || event.altKey) return;
  event.preventDefault();
  const section = sectionOf(target);
  if (section) {
    show(section);
    history.replaceState(history.state, "", `${location.pathname}${location.search}${section === "overview" ? "" : `#${section}`}`);
  }
  target.closest("details")?.setAttribute("open", "");
  if (wide.matches && target.id === section) scrollTo({ top: 0 });
  else target.scrollIntoView({ block: target.matches("input, select") ? "center" : "start" });
  if (!link.matches(".tabs a")) (target.matches("fieldset") ? target.querySelector("input") : target).focus({ preventScroll: true });
});

const showAddressed = () => show(sectionOf(document.getElementById(location.hash.slice(1))) ?? "overview");
const toTop = () => wide.matches && location.hash && scrollTo({ top: 0 });

showAddressed();
addEventListener("load", toTop);
addEventListener("hashchange", () => {
  showAddressed();
  toTop();
});

// Heads of tables stick below the title block, which is as high as what it says.
const measurer = new ResizeObserver(([{ target }]) => document.body.style.setProperty("--head", `${target.offsetHeight}px`));

export function measure() {
  for (const head of document.querySelectorAll(".head")) measurer.observe(head);
}
measure();
