// Plots: data come when somebody unfolds one, then the library. Colours are names of the page's theme.

const CONFIG = { showSendToCloud: false, plotlyServerURL: "", displaylogo: false, displayModeBar: false, showTips: false, responsive: true };
const figures = new Map(); // place in the page -> the data that it shows

// --- Theme ------------------------------------------------------------------------------------------------------------

// A custom property keeps its light-dark() unresolved: only a property that uses it has a colour.
function palette(scheme) {
  const probe = document.body.appendChild(document.createElement("i"));
  probe.style.cssText = `position:absolute;visibility:hidden;forced-color-adjust:none;${scheme ? `color-scheme:${scheme}` : ""}`;
  const colours = new Map();
  const colour = (name) => {
    if (!colours.has(name)) {
      probe.style.color = name;
      colours.set(name, getComputedStyle(probe).color);
    }
    return colours.get(name);
  };
  return { colour, done: () => probe.remove() };
}

function themed(figure, scheme) {
  const { colour, done } = palette(scheme);
  const walk = (value) => {
    if (typeof value === "string") return value.includes("var(") ? value.replace(/var\(--[\w-]+\)/g, colour) : value;
    if (Array.isArray(value)) return typeof value[0] === "number" ? value : value.map(walk);
    if (value === null || typeof value !== "object") return value;
    return Object.fromEntries(Object.entries(value).map(([key, inner]) => [key, walk(inner)]));
  };
  const result = walk(figure);
  result.layout.font.family = getComputedStyle(document.body).fontFamily;
  done();
  return result;
}

// --- Library ----------------------------------------------------------------------------------------------------------

let library;
function load(address) {
  library ??= new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = address;
    script.onload = () => resolve(window.Plotly);
    script.onerror = () => {
      library = undefined; // a later plot tries again
      script.remove();
      reject(new Error("the plot library did not load"));
    };
    document.head.append(script);
  });
  return library;
}

// --- Drawing ----------------------------------------------------------------------------------------------------------

const placeIn = (plot) => plot.firstElementChild ?? plot.appendChild(document.createElement("div"));
const printing = matchMedia("print");
const PAPER_WIDTH = 640;

function draw(plot, { force = false, paper = printing.matches } = {}) {
  if (!window.Plotly || (!force && figures.get(plot) === plot.dataset.figure)) return;
  const { data, layout } = themed(JSON.parse(plot.dataset.figure), paper ? "light" : undefined);
  const place = placeIn(plot);
  if (paper) Object.assign(layout, { width: PAPER_WIDTH, height: 380, autosize: false });
  layout.dragmode = matchMedia("(pointer: coarse)").matches ? false : "zoom";
  const first = !figures.has(plot);
  figures.set(plot, plot.dataset.figure);
  window.Plotly.react(place, data, layout, CONFIG);
  if (first) place.on("plotly_relayout", () => follow(plot));
  follow(plot);
}

// The names follow the section that is shown; writing them is a relayout, too.
function follow(plot) {
  showWhether(plot);
  const place = placeIn(plot);
  const { xaxis, yaxis } = place._fullLayout;
  const annotations = window.namesAlong(place.data, { xaxis, yaxis }, { width: xaxis._length, height: yaxis._length });
  const written = JSON.stringify(annotations);
  if (place.dataset.names === written) return;
  place.dataset.names = written;
  window.Plotly.relayout(place, { annotations });
}

function showWhether(plot) {
  const axes = placeIn(plot).layout;
  const { layout } = JSON.parse(plot.dataset.figure);
  const enlarged = ["xaxis", "yaxis"].some((axis) => axes[axis].range.some((end, k) => end !== layout[axis].range[k]));
  plot.parentElement.toggleAttribute("data-enlarged", enlarged);
}

const watcher = new IntersectionObserver(
  (entries) => {
    for (const { isIntersecting, target } of entries) {
      if (isIntersecting) load(target.dataset.bundle).then(() => draw(target), console.warn);
    }
  },
  { rootMargin: "400px" },
);

function look() {
  for (const plot of figures.keys()) {
    if (plot.isConnected) continue;
    watcher.unobserve(plot);
    if (window.Plotly) window.Plotly.purge(placeIn(plot));
    figures.delete(plot);
  }
  for (const plot of document.querySelectorAll(".plot[data-figure]")) {
    watcher.observe(plot); // once more does no harm
    if (!figures.has(plot)) continue;
    draw(plot);
    showWhether(plot); // a morph takes the mark away
  }
}

const redraw = (options) => [...figures.keys()].filter((plot) => plot.isConnected).forEach((plot) => draw(plot, { force: true, ...options }));

document.addEventListener("htmx:after:swap", look);
new MutationObserver(look).observe(document.documentElement, { childList: true }); // history replaces the body
addEventListener("pageshow", look);
for (const query of ["(prefers-color-scheme: dark)", "(forced-colors: active)", "(prefers-contrast: more)"]) {
  matchMedia(query).addEventListener("change", () => redraw());
}
addEventListener("beforeprint", () => redraw({ paper: true }));
addEventListener("afterprint", () => redraw({ paper: false }));
look();

// --- Buttons ----------------------------------------------------------------------------------------------------------

document.addEventListener("click", (event) => {
  const button = event.target.closest("button[data-plot]");
  const plot = button && document.getElementById(button.dataset.plot);
  if (plot && button.dataset.save) save(plot, button.dataset.save);
  else if (plot && figures.has(plot)) whole(plot);
});

function whole(plot) {
  const { layout } = JSON.parse(plot.dataset.figure);
  window.Plotly.relayout(placeIn(plot), { "xaxis.range": layout.xaxis.range, "yaxis.range": layout.yaxis.range });
}

// A picture leaves the page that explains it, so it takes title and note along; always on white.
async function save(plot, format) {
  await load(plot.dataset.bundle);
  const { data, layout } = themed(JSON.parse(plot.dataset.figure), "light");
  const { title, note } = layout.meta;
  Object.assign(layout, {
    title: { text: title, font: { size: 15 }, x: 0.02, xanchor: "left" },
    margin: { l: 76, r: 28, t: 56, b: 110 },
    paper_bgcolor: "#fff",
    plot_bgcolor: "#fff",
    width: 900,
    height: 640,
  });
  layout.annotations = [
    ...window.namesAlong(data, layout, { width: 900 - 76 - 28, height: 640 - 56 - 110 }),
    { text: note, xref: "paper", yref: "paper", x: 0, y: 0, yshift: -70, xanchor: "left", yanchor: "top", showarrow: false, font: { size: 11 } },
  ];
  await window.Plotly.downloadImage({ data, layout, config: CONFIG }, { format, width: 900, height: 640, scale: format === "png" ? 2 : 1, filename: plot.dataset.file });
}

// --- One phase: its row, its step and its load are marked together ---------------------------------------------------

const ROW = 'tr[id^="phase-"], tr[id^="move-"]';
const PHASE = `[data-phase], ${ROW}`;
const listOf = (text) => (text ?? "").split(" ").filter(Boolean);

// The row of a move stands for the phases that the chart says are its own.
function placesOf(part) {
  if ("phase" in part.dataset) return listOf(part.dataset.phase);
  const [kind, row] = part.id.split("-");
  if (kind === "phase") return [row];
  return listOf(document.querySelector("[data-moves]")?.dataset.moves).flatMap((move, place) => (move === row ? [String(place)] : []));
}

let marked = [];

function markPhases(part) {
  marked = part ? placesOf(part) : [];
  for (const each of document.querySelectorAll(PHASE)) each.classList.toggle("marked", placesOf(each).some((place) => marked.includes(place)));
}

// The pointer goes before the focus, which stays where somebody types.
const phaseAt = (target) => target?.closest?.(PHASE) ?? null;
document.addEventListener("pointerover", (event) => markPhases(phaseAt(event.target) ?? phaseAt(document.activeElement)));
document.addEventListener("focusin", (event) => markPhases(phaseAt(event.target)));
document.addEventListener("focusout", (event) => markPhases(phaseAt(event.relatedTarget)));

// The rows stand in the form, which an answer leaves as it is: the drawing says which phase governs and which figures follow.
function markGoverning() {
  const governing = listOf(document.querySelector("[data-governing]")?.dataset.governing);
  for (const row of document.querySelectorAll(ROW)) row.classList.toggle("governing", placesOf(row).some((place) => governing.includes(place)));
  const followed = JSON.parse(document.querySelector("[data-followed]")?.dataset.followed ?? "{}");
  for (const [id, figure] of Object.entries(followed)) document.getElementById(id)?.setAttribute("placeholder", figure);
  markPhases(phaseAt(document.activeElement));
}
document.addEventListener("htmx:after:swap", markGoverning);
markGoverning();
