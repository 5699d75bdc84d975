"""The gear list of a machine as a workbook: gears to order, and every axis with its gear."""

from io import BytesIO

from hpn.account.readings import life_of
from hpn.documents.summary import gear_of
from hpn.files.machine.export import MachineExport
from hpn.files.machine.words import STATUS, check_of, faults_of, ranges
from hpn.files.workbook.sheet import LONGEST_TEXT, VERDICT_STYLES, Cell, Leaf, new_book
from hpn.words.reader import Reader
from hpn.words.wording import N_

GEAR_HEADS = (N_("Ordering code"), N_("Gear"), N_("Axes"), N_("axes"), N_("gears"), N_("each"), N_("together"))
AXIS_HEADS = (
    *(N_("Number"), N_("Axis"), N_("Quantity"), N_("Gear"), N_("Ordering code"), N_("Verdict"), N_("Utilisation")),
    *(N_("Governing check"), N_("Shortest life"), N_("Life"), N_("Weight"), N_("Note")),
)
GEAR_WIDTHS, AXIS_WIDTHS = (26, 14, 44, 9, 9, 12, 12), (8, 28, 9, 13, 24, 14, 11, 26, 14, 16, 11, 40)


def gears(export: MachineExport, reader: Reader) -> bytes:
    """The workbook; the same bytes for the same document."""
    content = BytesIO()
    book, styles = new_book(content, export)
    for name, write in ((N_("Gear list"), _write_gears), (N_("Axes"), _write_axes)):
        write(Leaf(book.add_worksheet(reader.text(name)), styles, export, reader), export)
    book.close()
    return content.getvalue()


def write_title(leaf: Leaf, untitled: str, rows: dict[str, Cell]) -> None:
    """Write title and what else there is to say of a document."""
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
    heads = [*texts[:5], *(leaf.head(text, "weight_kg") for text in texts[5:])]
    leaf.heads(N_("Gear list"), *heads, numbers=range(3, 7))
    for gear in order.gears:
        known = each.get(gear.designation)
        for column, text in enumerate((gear.ordering_code, gear.designation, ranges(gear.axes))):
            leaf.put(column, text)
        masses = (reader.value(mass, "kg") for mass in (known.weight_kg if known else None, gear.weight_kg))
        for column, value in enumerate((len(gear.axes), gear.quantity, *masses), 3):
            leaf.put(column, value, "figure")
        leaf.row += 1
    sums = (sum(len(gear.axes) for gear in order.gears), sum(gear.quantity for gear in order.gears))
    leaf.put(0, reader.text(N_("Sum")), "section")
    for column, value in ((3, sums[0]), (4, sums[1]), (6, reader.value(order.weight_kg, "kg"))):
        leaf.put(column, value, "figure")
    leaf.row += 1
    leaf.page(GEAR_WIDTHS)


def _write_axes(leaf: Leaf, export: MachineExport) -> None:
    reader = leaf.reader
    heads = [reader.text(head) for head in AXIS_HEADS]
    heads[8], heads[10] = leaf.head(heads[8], "shortest_life_h"), leaf.head(heads[10], "weight_kg")
    for column, head in enumerate(heads):
        leaf.put(column, head, "head of numbers" if column in (0, 2, 6, 8, 10) else "head")
    leaf.sheet.freeze_panes(1, 2)
    leaf.sheet.repeat_rows(0)
    for axis in export.document.axes:
        leaf.row += 1
        answer, style = axis.answer, VERDICT_STYLES.get(axis.answer.status, "open")
        life = None if answer.shortest_life_h is None else life_of(answer.shortest_life_h, answer.shortest_life_of)
        faults = "; ".join(faults_of(axis, reader))
        weight = answer.weight_kg if gear_of(axis) else None
        cells: tuple[tuple[Cell, str], ...] = (
            (axis.number, "figure"),
            (axis.name, "label"),
            (axis.quantity, "figure"),
            (gear_of(axis), "label"),
            (axis.ordering_code, "label"),
            (reader.text(STATUS[answer.status]), style),
            (answer.utilisation, "share"),
            (faults or check_of(answer.governing_check, reader), "quiet"),
            (reader.value(answer.shortest_life_h, "h"), "figure"),
            (None if life is None else _basis(life.check, life.basis, reader), "quiet"),
            (reader.value(weight, "kg"), "figure"),
            (axis.note, "quiet"),
        )
        for column, (value, named) in enumerate(cells):
            leaf.put(column, value, named)
    leaf.sheet.autofilter(0, 0, leaf.row, len(heads) - 1)
    leaf.page(AXIS_WIDTHS, across=True)


def _basis(check: str, basis: str, reader: Reader) -> str:
    return f"{reader.text(N_('gear') if check == 'life' else N_('bearing'))} {basis}"
