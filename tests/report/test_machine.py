"""Files of a machine, read back: report, gear list and differences against the answers of its axes."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from io import BytesIO

import openpyxl
import pytest
from msgspec import structs

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue, load_catalogue
from hpn.documents.revision import Frozen
from hpn.documents.summary import gear_of, order_of, summary_of
from hpn.engine.checks import name_of
from hpn.engine.selection import select
from hpn.files.export import ExportTitle
from hpn.files.machine import changes_pdf, changes_workbook
from hpn.files.machine.axis_page import axis_page
from hpn.files.machine.changes import DifferencesExport
from hpn.files.machine.content import content
from hpn.files.machine.export import MOST_FULL, MOST_PAGES, MachineExport, exports_of, pages_of
from hpn.files.machine.gears import gears
from hpn.files.machine.pdf import pdf
from hpn.files.machine.words import ranges
from hpn.words.reader import Reader
from hpn.words.units import PRESETS
from tests.build import TURNING, cycle, phase, worked_example
from tests.machines import COMMON, axis, frozen, packing_line
from tests.report.cases import CREATED, language
from tests.report.test_pdf import page_texts, read

ENGLISH, GERMAN = language("en"), language("de")
AMERICAN = Reader("en", PRESETS["US"], ENGLISH.digits)
LINK = "https://hpn.example/machines/0123456789abcdefghijkl?revision=B"
TITLE = "Packing line VP-40"


def export_of(document: Frozen, catalogue: Catalogue, before: Frozen | None = None) -> MachineExport:
    heading = ExportTitle(TITLE, "HB-2431", "MA", "B")
    return MachineExport(document, catalogue, LINK, heading, CREATED, None, ("A", before) if before else None)


def plain(text: str) -> str:
    """Text of a page in one line, with plain spaces."""
    return " ".join(text.replace("\u200b", "").replace("\u202f", " ").split())


@pytest.fixture(scope="module")
def line() -> Frozen:
    return frozen(packing_line(pallet=3), load_catalogue(), COMMON, title=TITLE)


@pytest.fixture(scope="module")
def pages(line: Frozen) -> Callable[[Reader], list[str]]:
    """Texts of the pages of the report on the line, each made once."""
    catalogue = load_catalogue()
    before = frozen(packing_line(), catalogue, COMMON, title=TITLE)

    @cache
    def made(reader: Reader) -> list[str]:
        document = pdf(export_of(line, catalogue, before), reader)
        return [plain(each) for each in page_texts(document, len(read(document).pages))]

    return made


# --- Title page and table ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("reader", [ENGLISH, GERMAN, AMERICAN], ids=lambda reader: reader.marker or "en")
def test_the_title_page_says_what_the_answers_say(
    line: Frozen, catalogue: Catalogue, pages: Callable[[Reader], list[str]], reader: Reader
) -> None:
    title, summary = pages(reader)[0], summary_of(line, catalogue)
    order = order_of(line.axes, catalogue)
    for gear in order.gears:
        assert gear.ordering_code in title
        assert plain(reader.with_unit(reader.figure(gear.weight_kg, "kg"), "kg")) in title
    weight = plain(reader.with_unit(reader.figure(summary.weight_kg, "kg"), "kg"))
    assert weight in title and plain(reader.percent(summary.utilisation, 0.9)) in title
    assert f"{summary.suitable} {plain(reader.text('of {count} axes suitable').format(count=40))}" in title
    assert plain(reader.figure(summary.shortest_life_h, "h")) in title
    for wanting in (34, 38, 13):
        assert f"{wanting} {line.axes[wanting - 1].name}" in title
    assert LINK in title.replace(" ", "") and "HB-2431" in title


BEYOND = worked_example(tolerances={"emergency_stop.torque_Nm": {"percent": 40}})
"""An application whose selected gear passes at 200 Nm, and fails at 280 Nm."""


def test_the_title_page_names_axes_that_do_not_hold_over_their_tolerance(catalogue: Catalogue) -> None:
    within = worked_example(tolerances={"emergency_stop.torque_Nm": {"percent": 20}})
    axes = [axis("near", within), axis("far", BEYOND), axis("exact", worked_example())]
    export = export_of(frozen(axes, catalogue), catalogue)
    summary = content(export, pages_of(export.document), ENGLISH)["summary"]

    assert [each.answer.status for each in export.document.axes] == ["suitable"] * 3
    assert summary["word"] == "1 suitable as given, but not over the whole tolerance: 2"
    assert summary["status"] == "unrated"


def test_the_page_of_an_axis_says_that_its_gear_fails_inside_the_tolerance(catalogue: Catalogue) -> None:
    export = export_of(frozen([axis("far", BEYOND)], catalogue), catalogue)
    (page,) = content(export, pages_of(export.document), ENGLISH)["pages"]

    told = "".join(map(str, page["selection"]["verdict"]["text"]))
    assert "Fails inside the tolerance" in told


def test_the_shortest_life_and_the_largest_utilisation_are_those_of_suitable_axes(
    line: Frozen, catalogue: Catalogue
) -> None:
    """Two ways that agree: the summary, and the answers sorted by themselves."""
    summary, sound = summary_of(line, catalogue), [one for one in line.axes if one.answer.status == "suitable"]
    lives = sorted((one.answer.shortest_life_h, one.number) for one in sound if one.answer.shortest_life_h is not None)
    used = sorted((one.answer.utilisation or 0.0, -one.number) for one in sound)

    assert len(lives) > 1 and lives[0][0] < lives[-1][0]
    assert (summary.shortest_life_h, summary.shortest_life_axis) == lives[0]
    assert (summary.utilisation, summary.utilisation_axis) == (used[-1][0], -used[-1][1])


def test_kinds_are_counted_by_designation(catalogue: Catalogue) -> None:
    """Two codes of one gear are two lines of the order and one kind, as the fewest kinds count them."""
    gear = select(Application.model_validate(worked_example()), catalogue).selected
    axes = [axis("bare", worked_example()), axis("coded", worked_example(), ordering_code=f"{gear}-J6-BH-AF1")]
    document = frozen(axes, catalogue)

    assert len(order_of(document.axes, catalogue).gears) == 2
    assert summary_of(document, catalogue).kinds == 1


@pytest.mark.parametrize("reader", [ENGLISH, GERMAN], ids=["en", "de"])
def test_the_table_has_every_axis_with_gear_check_utilisation_and_life(
    line: Frozen, pages: Callable[[Reader], list[str]], reader: Reader
) -> None:
    table = pages(reader)[1]
    for each in line.axes:
        answer = each.answer
        assert f"{each.number} {each.name}" in table
        if answer.status == "open":
            assert plain(f"{reader.text('Speed')}, Phase 2: {reader.text('is required')}").lower() in table.lower()
            continue
        assert (gear_of(each) or answer.designation or "") in table
        assert reader.text(name_of(answer.governing_check or "")) in table
        bound = 0.8 if each.number == 20 else 0.9
        assert plain(reader.percent(answer.utilisation, bound)) in table
        assert plain(reader.figure(answer.shortest_life_h, "h")) in table


def test_what_changed_since_the_revision_before_is_marked(pages: Callable[[Reader], list[str]]) -> None:
    title, table = pages(ENGLISH)[:2]
    assert "Changed since A" in title and table.count("△") == 2  # the legend and the pallet lift


# --- Pages of axes ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("reader", [ENGLISH, GERMAN, AMERICAN], ids=lambda reader: reader.marker or "en")
def test_a_page_has_the_figures_that_select_answers_for_its_axis(
    line: Frozen, catalogue: Catalogue, pages: Callable[[Reader], list[str]], reader: Reader
) -> None:
    """Two ways that agree: the page, of axes judged together, and `select` of each axis alone."""
    texts = pages(reader)[2:]
    for number in (2, 19, 34, 38):
        asked = Application.model_validate_json(bytes(line.axes[number - 1].resolved))
        selection = select(asked, catalogue)
        shown = selection.candidate(line.axes[number - 1].answer.designation or "")
        name = line.axes[number - 1].name or ""
        place = next(place for place, text in enumerate(texts) if f"{number} {name}" in text)
        page = " ".join(texts[place : place + 2])  # long remedies take a few checks to a second page
        assert shown is not None and shown.designation in page
        for check in shown.checks:
            assert plain(reader.percent(check.utilisation, 1.0 if check.code in ("weight", "length") else 0.9)) in page
        for torque in (asked.duty_cycle.load_phases[0].torque_Nm, asked.duty_cycle.load_phases[1].torque_Nm):
            assert plain(reader.exact(torque, "Nm")) in page


def test_every_axis_has_its_page_and_an_open_one_says_why(line: Frozen, pages: Callable[[Reader], list[str]]) -> None:
    texts = pages(ENGLISH)[2:]
    for each in line.axes:
        assert any(f"{each.number} {each.name} axis {each.number} of 40 · quantity {each.quantity}" in t for t in texts)
    erector = next(text for text in texts if "13 Carton erector" in text)
    assert "Open: this axis has no answer." in erector and "Speed, phase 2: is required" in erector


def test_values_of_the_machine_are_marked_and_own_ones_are_not(line: Frozen, catalogue: Catalogue) -> None:
    ram = line.axes[19]
    ((_, export),) = exports_of(export_of(line, catalogue), [ram])
    page = axis_page(ram, export, (20, 40), ENGLISH, full=False)
    rows = {row["code"]: row["is_inherited"] for row in page["selection"]["requirements"] + page["selection"]["loads"]}
    assert rows["requirements.life_h"] and rows["rank_by"]
    assert not rows["requirements.utilisation"] and not rows["duty_cycle.pause_s"]


def test_a_revision_whose_answer_is_another_says_so_on_its_page(line: Frozen, catalogue: Catalogue) -> None:
    gantry = line.axes[0]
    aged = structs.replace(gantry, answer=structs.replace(gantry.answer, utilisation=0.5, engine_version="1.0.4"))
    ((_, export),) = exports_of(export_of(line, catalogue), [aged])
    told = axis_page(aged, export, (1, 40), ENGLISH, full=False)["was"]
    assert "1.0.4" in told and "50" in told
    assert axis_page(gantry, export, (1, 40), ENGLISH, full=False)["was"] == ""


def test_the_whole_calculation_has_equations_and_a_motion_its_moves(catalogue: Catalogue) -> None:
    axes = [axis("Turret", worked_example()), axis("Swivel", {"duty_cycle": {"motion": TURNING}})]
    document = pdf(export_of(frozen(axes, catalogue, COMMON), catalogue), ENGLISH, full=True)
    text = plain(" ".join(page_texts(document, len(read(document).pages))))
    assert text.count("to nine digits") >= 2 and "Assumptions" in text and "turn" in text


def test_hostile_names_and_notes_are_printed_as_they_are(catalogue: Catalogue) -> None:
    hostile = '#eval("1") $x$ <label> "'
    axes = [axis(hostile, worked_example(), note="*b* @ref བོད"), axis("", {"duty_cycle": 7, "more": [[1]]})]
    document = pdf(export_of(frozen(axes, catalogue), catalogue), ENGLISH)
    text = plain(" ".join(page_texts(document, len(read(document).pages))))
    assert '#eval("1")' in text and "@ref" in text


# --- Bounds -----------------------------------------------------------------------------------------------------------


def many(count: int, catalogue: Catalogue) -> Frozen:
    """A machine of many axes that are all alike, each with its own number."""
    (one,) = frozen([axis("a", cycle(phase(10, 100)))], catalogue).axes
    line = frozen([], catalogue)
    return structs.replace(line, axes=tuple(structs.replace(one, number=number) for number in range(1, count + 1)))


def test_pages_go_up_to_their_bound_and_beyond_it_a_list_chooses(catalogue: Catalogue) -> None:
    within, beyond = many(MOST_PAGES, catalogue), many(MOST_PAGES + 1, catalogue)
    assert len(pages_of(within).axes) == MOST_PAGES
    assert pages_of(beyond).axes == ()
    assert [each.number for each in pages_of(beyond, "3,7-9, 501").axes] == [3, 7, 8, 9, 501]
    assert pages_of(beyond, "none").axes == ()
    assert len(pages_of(within, f"1-{MOST_FULL}", full=True).axes) == MOST_FULL
    notes = content(export_of(beyond, catalogue), pages_of(beyond), ENGLISH)["notices"]
    assert "at most 500" in notes[0][0]


@pytest.mark.parametrize("text", ["", "x", "3-", "7-3", "0", "3;4", "1-501", "99999999", "502", "٣"])
def test_a_list_of_axes_that_is_none_is_refused(text: str, catalogue: Catalogue) -> None:
    with pytest.raises(InputError):
        pages_of(many(MOST_PAGES + 1, catalogue), text)


def test_too_many_whole_calculations_are_refused(catalogue: Catalogue) -> None:
    with pytest.raises(InputError, match="100"):
        pages_of(many(MOST_FULL + 1, catalogue), full=True)


def test_a_large_machine_has_its_axes_in_lines(catalogue: Catalogue) -> None:
    machine = many(1200, catalogue)
    data = content(export_of(machine, catalogue), pages_of(machine), ENGLISH)
    assert data["axes"] is None and sum(group.count("\n") + 1 for group in data["axes_listing"]["groups"]) == 1200
    assert pdf(export_of(machine, catalogue), ENGLISH).startswith(b"%PDF")


def test_numbers_are_written_in_ranges() -> None:
    assert ranges([4, 1, 2, 3, 7, 9, 10]) == "1–4, 7, 9, 10"


# --- Workbooks --------------------------------------------------------------------------------------------------------


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
    assert inputs[(1, "Maximum utilisation")][:2] == (0.8, 0.9)
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
