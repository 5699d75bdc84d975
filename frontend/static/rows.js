// Rows of phases and moves: added, moved, removed and filled on the page, which is an edit like any other. They are numbered as the
// server's blank row says. Without script, and beyond the most that a table has, the server does the same.

import { isReplacing, later } from "./replacing.js";
import { edit } from "./undo.js";

const arrival = { rows: [] }; // rows of the form that has come, by their places in the one that they were pressed in
const FIRST = '[name="T"], [name="mv"]';
const rows = () => [...document.querySelectorAll("#duty tbody tr")];
const blank = () => document.getElementById("blank-row");
const cellIn = (row, name) => row.querySelector(`[name="${name}"]`);

const CHANGES = {
  up: (row) => row.previousElementSibling?.before(row),
  down: (row) => row.nextElementSibling?.after(row),
  add: () => document.querySelector("#duty tbody").append(blank().content.firstElementChild.cloneNode(true)),
  remove(row) {
    row.remove();
    if (!rows().length) CHANGES.add();
  },
};

document.addEventListener("htmx:after:swap", ({ detail: { ctx } }) => ctx?.kept && (arrival.rows = rows()));

function change(does, row) {
  if (does !== "add" && !row?.isConnected) return;
  const at = rows().indexOf(row);
  const cell = document.activeElement.closest("#duty tbody :is(input, select)");
  const range = [cell?.selectionStart, cell?.selectionEnd];
  edit(() => {
    CHANGES[does](row);
    rows().forEach(number);
  });
  const place = does === "add" ? rows().at(-1) : row.isConnected ? row : (rows()[at] ?? rows().at(-1));
  const goal = does === "add" || !cell ? place.querySelector(FIRST) : cellIn(place, cell.name);
  goal.focus();
  if (goal !== document.activeElement) place.querySelector(FIRST).focus(); // a cell that this kind of move has not
  else if (goal === cell) goal.setSelectionRange?.(...range);
  else if (cell && does === "remove") goal.select?.();
}

const partsOf = (row) => [row, ...row.querySelectorAll("input, select, button, [popover]")];

function number(row, at) {
  const parts = partsOf(row);
  row.cells[0].textContent = at + 1;
  partsOf(blank().content.firstElementChild).forEach((part, k) => {
    for (const { name, value } of part.attributes) if (value.includes("{")) parts[k].setAttribute(name, value.replace("{k}", at + 1).replace("{at}", at));
  });
}

// A number that is offered in place of a text.
function fill(field, text) {
  edit(() => {
    field.value = text;
    field.nextElementSibling?.matches(".unit") && (field.nextElementSibling.hidden = false);
  });
  field.focus();
}

document.addEventListener("click", (event) => {
  const button = event.target.closest('button[name="do"]');
  if (!button) return;
  const [does, what] = button.value.split(":");
  const field = does === "take" && document.querySelector(`#application input[id="${what}"]`);
  if (field) {
    event.preventDefault();
    fill(field, button.value.slice(does.length + what.length + 2));
  } else if (blank() && Object.hasOwn(CHANGES, does) && (does !== "add" || rows().length < blank().dataset.most)) {
    event.preventDefault();
    button.closest("[popover]")?.hidePopover(); // and the focus is where it came from
    if (isReplacing()) later(() => change(does, arrival.rows[what - 1]));
    else change(does, rows()[what - 1]);
  }
});
