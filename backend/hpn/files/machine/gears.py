"""Gear list of a machine as a workbook: gears to order, and every axis with its gear."""

from io import BytesIO
from typing import NamedTuple

from hpn.account.readings import life_of
from hpn.documents.gears import motor_of
from hpn.documents.revision import FrozenAxis
from hpn.documents.summary import gear_of, has_worst_case
from hpn.files.machine.export import MachineExport
from hpn.files.machine.words import STATUS, check_of, faults_of, ranges
from hpn.files.workbook.sheet import LONGEST_TEXT, VERDICT_STYLES, Cell, Leaf, new_book
from hpn.words.reader import Reader
from hpn.words.wording import N_

GEAR_HEADS = (
    N_("Ordering code"),
    N_("Gear"),
    N_("Axes"),
    N_("axes"),
    N_("gears"),
    N_("each"),
    N_("together"),
    N_("Motors"),
)
GEAR_WIDTHS = (26, 14, 44, 9, 9, 12, 12, 30)


class SheetColumn(NamedTuple):
    """Column of the axes: head, width, style of its cells, and the field with its unit."""

    head: str
    width: float
    style: str = "label"
    field: str = ""


WORST_CASE = SheetColumn(N_("Worst case"), 11, "share")
AXIS_COLUMNS = (
    SheetColumn(N_("Number"), 8, "figure"),
    SheetColumn(N_("Axis"), 28),
    SheetColumn(N_("Quantity"), 9, "figure"),
    SheetColumn(N_("Gear"), 13),
    SheetColumn(N_("Ordering code"), 24),
    SheetColumn(N_("Verdict"), 14, ""),
    SheetColumn(N_("Utilisation"), 11, "share"),
    WORST_CASE,
    SheetColumn(N_("Governing check"), 26, "quiet"),
    SheetColumn(N_("Shortest life"), 14, "figure", "shortest_life_h"),
    SheetColumn(N_("Life"), 16, "quiet"),
    SheetColumn(N_("Weight"), 11, "figure", "weight_kg"),
    SheetColumn(N_("Motor"), 22),
    SheetColumn(N_("Note"), 40, "quiet"),
)
"""Columns of the axes; that of the worst case only where an axis has tolerances. A verdict has its own style."""


def gears(export: MachineExport, reader: Reader) -> bytes:
    """Workbook of the gear list; the same bytes for the same document."""
    content = BytesIO()
    book, styles = new_book(content, export)
    for name, write in ((N_("Gear list"), _write_gears), (N_("Axes"), _write_axes)):
        write(Leaf(book.add_worksheet(reader.text(name)), styles, export, reader), export)
    book.close()
    return content.getvalue()


def write_title(leaf: Leaf, untitled: str, rows: dict[str, Cell]) -> None:
    """Write the title, the title block and further rows of a document."""
    heading, reader = leaf.export.heading, leaf.reader
    leaf.put(0, heading.title or reader.text(untitled), "title")
    leaf.sheet.set_row(0, 20)
    leaf.sheet.freeze_panes(1, 0)
    leaf.row = 1
    own: dict[str, Cell] = {
        N_("Reference"): heading.reference,
        N_("Revision"): heading.revision,
        N_("Author"): heading.author,
        N_("Saved"): reader.date(leaf.export.created) if leaf.export.created else "",
    }
    link = leaf.export.link if len(leaf.export.link) < LONGEST_TEXT else ""
    for label, value in (own | rows | {N_("Link"): link}).items():
        if value:
            leaf.put(0, reader.text(label), "quiet")
            leaf.put(1, value)
            leaf.row += 1


def _write_gears(leaf: Leaf, export: MachineExport) -> None:
    reader, order, each = leaf.reader, export.order, export.catalogue.by_designation
    versions: dict[str, Cell] = {
        N_("Engine"): ", ".join(export.summary.engine_versions),
        N_("Catalogue"): ", ".join(export.summary.catalogue_versions),
    }
    write_title(leaf, N_("Untitled machine"), versions)
    texts = [reader.text(head) for head in GEAR_HEADS]
    heads = [*texts[:5], *(leaf.head(text, "weight_kg") for text in texts[5:7]), texts[7]]
    leaf.heads(N_("Gear list"), *heads, numbers=range(3, 7))
    for gear in order.gears:
        known = each.get(gear.designation)
        for column, text in enumerate((gear.ordering_code, gear.designation, ranges(gear.axes))):
            leaf.put(column, text)
        masses = (reader.value(mass, "kg") for mass in (known.weight_kg if known else None, gear.weight_kg))
        for column, value in enumerate((len(gear.axes), gear.quantity, *masses), 3):
            leaf.put(column, value, "figure")
        leaf.put(7, ", ".join(gear.motors))
        leaf.row += 1
    sums = (sum(len(gear.axes) for gear in order.gears), sum(gear.quantity for gear in order.gears))
    leaf.put(0, reader.text(N_("Sum")), "section")
    for column, value in ((3, sums[0]), (4, sums[1]), (6, reader.value(order.weight_kg, "kg"))):
        leaf.put(column, value, "figure")
    leaf.row += 1
    leaf.page(GEAR_WIDTHS)


def _write_axes(leaf: Leaf, export: MachineExport) -> None:
    left_out = None if has_worst_case(export.document.axes) else WORST_CASE
    columns = [column for column in AXIS_COLUMNS if column is not left_out]
    for place, column in enumerate(columns):
        text = leaf.reader.text(column.head)
        is_number = column.style in ("figure", "share")
        leaf.put(
            place, leaf.head(text, column.field) if column.field else text, "head of numbers" if is_number else "head"
        )
    leaf.sheet.freeze_panes(1, 2)
    leaf.sheet.repeat_rows(0)
    for axis in export.document.axes:
        leaf.row += 1
        cells = zip(AXIS_COLUMNS, _cells(axis, leaf.reader), strict=True)
        verdict = VERDICT_STYLES.get(axis.answer.status, "open")
        for place, (column, value) in enumerate(each for each in cells if each[0] is not left_out):
            leaf.put(place, value, column.style or verdict)
    leaf.sheet.autofilter(0, 0, leaf.row, len(columns) - 1)
    leaf.page([column.width for column in columns], across=True)


def _cells(axis: FrozenAxis, reader: Reader) -> tuple[Cell, ...]:
    """Values of an axis, in the order of AXIS_COLUMNS."""
    answer = axis.answer
    life = None if answer.shortest_life_h is None else life_of(answer.shortest_life_h, answer.shortest_life_of)
    return (
        axis.number,
        axis.name,
        axis.quantity,
        gear_of(axis),
        axis.ordering_code,
        reader.text(STATUS[answer.status]),
        answer.utilisation,
        answer.worst_utilisation,
        "; ".join(faults_of(axis, reader)) or check_of(answer.governing_check, reader),
        reader.value(answer.shortest_life_h, "h"),
        None if life is None else _basis(life.check, life.basis, reader),
        reader.value(answer.weight_kg if gear_of(axis) else None, "kg"),
        motor_of(axis.application),
        axis.note,
    )


def _basis(check: str, basis: str, reader: Reader) -> str:
    return f"{reader.text(N_('gear') if check == 'life' else N_('bearing'))} {basis}"
