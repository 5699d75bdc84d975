"""Gear list and differences of a machine, read back: against the answers of its axes."""

from dataclasses import replace
from io import BytesIO

import openpyxl
import pytest

from hpn.catalogue import Catalogue, load_catalogue
from hpn.documents.revision import Frozen
from hpn.documents.summary import gear_of
from hpn.files.export import ExportTitle
from hpn.files.machine import changes_pdf, changes_workbook
from hpn.files.machine.changes import DifferencesExport
from hpn.files.machine.gears import gears
from hpn.words.reader import Reader
from tests.machines import COMMON, frozen, packing_line
from tests.report.cases import CREATED, language
from tests.report.machines import AMERICAN, LINK, TITLE, export_of, plain, with_and_without_tolerance
from tests.report.test_pdf import page_texts, read

ENGLISH, GERMAN = language("en"), language("de")


def rows_of(content: bytes, sheet: int) -> list[tuple[object, ...]]:
    book = openpyxl.load_workbook(BytesIO(content))
    return [row for row in book.worksheets[sheet].iter_rows(values_only=True) if any(cell is not None for cell in row)]


@pytest.mark.parametrize("reader", [ENGLISH, AMERICAN], ids=["SI", "US"])
def test_the_gear_list_weighs_what_the_answers_weigh(line: Frozen, catalogue: Catalogue, reader: Reader) -> None:
    """Two ways that agree: the list by ordering code, and the sum over the axes of their own answers."""
    book = gears(export_of(line, catalogue), reader)
    (summed,) = [row for row in rows_of(book, 0) if row[0] == "Sum"]
    with_gear = [each for each in line.axes if gear_of(each)]
    mass = sum(each.quantity * (each.answer.weight_kg or 0.0) for each in with_gear)
    assert summed[3:5] == (len(with_gear), sum(each.quantity for each in with_gear))
    assert summed[6] == pytest.approx(reader.value(mass, "kg"), rel=1e-12)
    table = {row[0]: row for row in rows_of(book, 1)[1:]}
    for each in line.axes:
        assert table[each.number][1:4] == (each.name, each.quantity, gear_of(each))
        assert table[each.number][6] == each.answer.utilisation
        assert table[each.number][8] == each.answer.shortest_life_h


def test_the_axes_of_the_gear_list_have_their_worst_case(line: Frozen, catalogue: Catalogue) -> None:
    """Two ways that agree: the column, and the largest torque of each stop over the limit of 256 Nm."""
    heads, near, far, bare = rows_of(gears(with_and_without_tolerance(catalogue), GERMAN), 1)
    place = heads.index("Ungünstigster Fall")

    assert heads[place - 1 : place + 2] == ("Auslastung", "Ungünstigster Fall", "Maßgebende Prüfung")
    assert (near[place], far[place]) == pytest.approx((240 / 256, 280 / 256), rel=1e-12) and bare[place] is None
    assert "Ungünstigster Fall" not in rows_of(gears(export_of(line, catalogue), GERMAN), 1)[0]


@pytest.fixture(scope="module")
def changed(line: Frozen) -> DifferencesExport:
    catalogue = load_catalogue()
    axes = packing_line()
    axes[5]["application"]["duty_cycle"]["phases"][0]["torque_Nm"] = 120.0
    axes[6]["name"] = "Magazine"
    axes[0]["application"]["requirements"] = {"utilisation": 0.8}
    del axes[39]
    common = COMMON | {"requirements": {"utilisation": 0.9, "life_h": 15000.0}}
    documents = (frozen(axes, catalogue, common, title=TITLE), line)
    return DifferencesExport(("A", "B"), documents, (catalogue, catalogue), LINK, ExportTitle(TITLE), CREATED)


def test_the_workbook_of_differences_has_every_input_and_figure(changed: DifferencesExport) -> None:
    book = changes_workbook.workbook(changed, ENGLISH)
    inputs = {(row[0], row[2]): row[4:7] for row in rows_of(book, 1)}
    assert inputs[(None, "Required gear life")] == (15000, 20000, "h")
    assert inputs[(6, "Torque, phase 1")] == (120, 87, "Nm")
    assert inputs[(7, "Name")][:2] == ("Magazine", "Magazine disc")
    assert inputs[(1, "Maximum utilisation")] == (80, 90, "%")
    found = changed.differences
    figures = rows_of(book, 2)[1:]
    assert len(figures) == sum(len(each.verdicts) + len(each.figures) for each in found.axes)
    table = rows_of(book, 0)
    assert [row[0] for row in table[-len(found.axes) :]] == [each.number for each in found.axes]


@pytest.mark.parametrize("reader", [ENGLISH, GERMAN], ids=["en", "de"])
def test_the_report_of_differences_shows_cells_gears_and_effects(changed: DifferencesExport, reader: Reader) -> None:
    document = changes_pdf.pdf(changed, reader)
    text = plain(" ".join(page_texts(document, len(read(document).pages))))
    for words in ("A → B", "120 Nm 87 Nm", "Magazine", plain(reader.with_unit(reader.exact(15000), "h"))):
        assert words in text
    assert reader.text("the same result") in text and reader.text("new") in text
    for each in changed.differences.axes:
        assert f"{each.number} {each.name}" in text


def test_nothing_that_differs_is_said_so(line: Frozen, changed: DifferencesExport) -> None:
    same = replace(changed, documents=(line, line))
    assert "Nothing differs." in plain(" ".join(page_texts(changes_pdf.pdf(same, ENGLISH), 1)))
