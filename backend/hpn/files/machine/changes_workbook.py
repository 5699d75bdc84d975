"""Differences of two documents as a workbook: axes in brief, and every input and figure that differs."""

from io import BytesIO

from hpn.account.lines import Line
from hpn.files.machine.changes import DifferencesExport, answer_lines, common_lines, effect, input_lines
from hpn.files.machine.gears import write_title
from hpn.files.machine.inputs import label_of
from hpn.files.workbook.sheet import Cell, Leaf, new_book
from hpn.words.reader import Reader
from hpn.words.wording import N_

AXIS_WIDTHS, VALUE_WIDTHS = (8, 28, 14, 14, 12, 12, 50), (8, 28, 40, 12, 22, 22, 9, 22)
MACHINE = N_("machine")
"""Mark of an axis's values that it takes from the machine."""


def workbook(export: DifferencesExport, reader: Reader) -> bytes:
    """Workbook of the differences; the same bytes for the same documents."""
    content = BytesIO()
    book, styles = new_book(content, export)
    for name, write in (
        (N_("Axes"), _write_axes),
        (N_("Inputs"), _write_inputs),
        (N_("Results"), _write_figures),
    ):
        write(Leaf(book.add_worksheet(reader.text(name)), styles, export, reader), export)
    book.close()
    return content.getvalue()


def _write_axes(leaf: Leaf, export: DifferencesExport) -> None:
    reader, differences, (one, other) = leaf.reader, export.differences, export.labels
    counts: dict[str, Cell] = {
        N_("From"): one,
        N_("To"): other,
        N_("Axes that differ"): reader.exact(len(differences.axes)),
        N_("Axes that are the same"): reader.exact(differences.same),
    }
    write_title(leaf, N_("Untitled machine"), counts)
    text, gear, share = reader.text, reader.text(N_("Gear")), reader.text(N_("Utilisation"))
    heads = [text(N_("Number")), text(N_("Axis")), f"{gear} {one}", f"{gear} {other}", f"{share} {one}"]
    leaf.heads(N_("Axes that differ"), *heads, f"{share} {other}", text(N_("Effect")), numbers=(0, 4, 5))
    for axis in differences.axes:
        sides = (axis.side_from, axis.side_to)
        leaf.put(0, axis.number, "figure")
        leaf.put(1, axis.name)
        for column, side in enumerate(sides, 2):
            leaf.put(column, side.gear if side else None)
            leaf.put(column + 2, side.utilisation if side else None, "share")
        leaf.put(6, effect(axis, export.sides(axis.number), reader), "quiet")
        leaf.row += 1
    leaf.page(AXIS_WIDTHS, across=True)


def _write_inputs(leaf: Leaf, export: DifferencesExport) -> None:
    reader = leaf.reader
    _write_heads(leaf, export, N_("Input"))
    pairs = zip(export.differences.common, common_lines(export), strict=True)
    for each, lines in pairs:
        _write_values(leaf, (None, reader.text(N_("every axis"))), reader.sentence(label_of(each.pointer)), lines)
    for axis in export.differences.axes:
        for each in axis.inputs:
            _write_values(leaf, (axis.number, axis.name), reader.sentence(label_of(each.pointer)), input_lines(each))
            marks = zip(export.labels, (each.inherited_from, each.inherited_to), strict=True)
            of_machine = [f"{label}: {reader.text(MACHINE)}" for label, inherited in marks if inherited]
            leaf.row -= 1
            leaf.put(7, ", ".join(of_machine), "quiet")
            leaf.row += 1
    leaf.page(VALUE_WIDTHS, across=True)


def _write_figures(leaf: Leaf, export: DifferencesExport) -> None:
    _write_heads(leaf, export, N_("Result"))
    for axis in export.differences.axes:
        for each in (*axis.verdicts, *axis.figures):
            lines = answer_lines(each, leaf.reader)
            _write_values(leaf, (axis.number, axis.name), lines[0].label(leaf.reader), lines)
    leaf.page(VALUE_WIDTHS, across=True)


def _write_heads(leaf: Leaf, export: DifferencesExport, kind: str) -> None:
    texts = (N_("Number"), N_("Axis"), kind, N_("Symbol"))
    heads = (*map(leaf.reader.text, texts), *export.labels, leaf.reader.text(N_("Unit")), "")
    for column, head in enumerate(heads):
        leaf.put(column, head, "head of numbers" if column in (0, 4, 5) else "head")
    leaf.sheet.freeze_panes(1, 2)
    leaf.sheet.repeat_rows(0)
    leaf.row = 1


def _write_values(leaf: Leaf, axis: tuple[int | None, str | None], label: str, lines: tuple[Line, Line]) -> None:
    leaf.put(0, axis[0], "figure")
    leaf.put(1, axis[1])
    leaf.put(2, label)
    leaf.put(3, lines[0].named.symbol, "quiet")
    for column, line in enumerate(lines, 4):
        leaf.put(column, line.value_for(leaf.reader), "figure")
    units = (line.unit for line in lines if isinstance(line.value, float | int) and line.unit)
    leaf.put(6, leaf.reader.unit(next(units, "")), "unit")
    leaf.row += 1
