// Requests of the form. Typing asks for the result alone, so that nothing typed is ever overwritten; other columns, another way,
// Back and files bring another form. Everything hangs on the document, because the form may be replaced.

import { contentOf, fieldsOf, formOf, isOfForm, isTicked, valueOf } from "./form.js";
import { awaited, mark, unfold } from "./messages.js";
import { begin, isReplacing, later, typed } from "./replacing.js";
import { arrived, note, restoring, showAddress, showSteps } from "./undo.js";

// Forms that may be too long for an address are posted. htmx takes the method before the request can be changed.
function choose() {
  const form = formOf();
  const isLong = form && (restoring()?.content ?? contentOf(form)).length > 8000;
  form?.setAttribute("hx-method", isLong ? "post" : form.method);
}

for (const kind of ["input", "submit"]) document.addEventListener(kind, choose, true);

const replacesForm = (ctx) => ctx?.hx?.retarget === "#application";

document.addEventListener("htmx:config:request", (event) => {
  const { ctx } = event.detail;
  if (!isOfForm(ctx)) return;
  const form = formOf();
  const { submitter } = ctx.request;
  const press = submitter?.name === "do" ? submitter : null;
  const restores = restoring();
  if (isReplacing() && !restores) {
    event.preventDefault();
    return press ? later(() => document.getElementById(press.id)?.click()) : typed();
  }
  if (restores) restored(ctx, restores);
  else note();
  const waits = awaited(!press && !restores && ctx.sourceEvent.type === "input" ? ctx.sourceEvent.target : null);
  form.toggleAttribute("data-waiting", waits);
  if (waits) return event.preventDefault();
  Object.assign(ctx, { before: restores?.before ?? fieldsOf(form), restores, asked: contentOf(form) });
  if (press || restores) begin(ctx);
});

function restored(ctx, { content }) {
  ctx.request.body = new FormData();
  for (const [name, value] of new URLSearchParams(content)) ctx.request.body.append(name, value);
  ctx.request.headers["HX-Target"] = "form#application";
}

// --- Another form: what was unfolded and typed meanwhile stays, and the focus in its cell -----------------------------

document.addEventListener("htmx:before:swap", (event) => {
  const { ctx } = event.detail;
  if (!replacesForm(ctx)) return;
  const form = formOf();
  const field = document.activeElement;
  ctx.kept = {
    open: [...form.querySelectorAll("details[open]")].map((part) => part.id),
    given: [...form.elements].filter((each) => ctx.before?.has(each.id) && ctx.before.get(each.id) !== valueOf(each)).map((each) => [each.id, valueOf(each)]),
    focus: field.matches("#duty tbody :is(input, select)") && !ctx.restores ? [field.id, field.selectionStart, field.selectionEnd] : null,
  };
});

document.addEventListener("htmx:after:swap", (event) => {
  const { ctx } = event.detail;
  if (!isOfForm(ctx) && !ctx?.kept) return;
  if (ctx.kept) put(ctx);
  else {
    showAddress(ctx);
    mark();
    if (formOf().matches("[data-waiting]")) awaited(document.activeElement); // an earlier request's result does not name the input
  }
  showSteps();
  unfold();
});

function put(ctx) {
  const { open, given, focus } = ctx.kept;
  for (const id of open) document.getElementById(id)?.setAttribute("open", "");
  arrived(ctx);
  showAddress(ctx);
  for (const [id, value] of given) {
    const field = document.getElementById(id);
    if (!field) continue;
    field[isTicked(field) ? "checked" : "value"] = value;
    typed();
  }
  if (!focus) return;
  const [id, ...range] = focus;
  const place = document.getElementById(id);
  place?.focus();
  place?.setSelectionRange?.(...range);
}
