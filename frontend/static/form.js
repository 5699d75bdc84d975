// The form and its fields.

export const formOf = () => document.getElementById("application");
const besides = (name) => name.startsWith("at_") || name.startsWith("give-"); // of the result, with which they come and go
export const contentOf = (form) => new URLSearchParams([...new FormData(form)].filter(([name]) => !besides(name))).toString();
export const isTicked = (field) => /checkbox|radio/.test(field.type);
export const valueOf = (field) => (isTicked(field) ? field.checked : field.value);
export const fieldsOf = (form) => new Map([...form.elements].filter((field) => field.id).map((field) => [field.id, valueOf(field)]));
export const isOfForm = (ctx) => ctx?.sourceElement?.id === "application";
export const isPlain = (click) => !click.button && !click.ctrlKey && !click.metaKey && !click.shiftKey && !click.altKey;
export const isText = (element) => element.matches("textarea, select, input:not([type=checkbox], [type=radio], [type=button], [type=submit], [type=file])");
