"""The workbook: every number of the reply with all of its digits, nothing to type, and the printed equations live."""

import math
import re
from dataclasses import replace
from io import BytesIO
from typing import Any
from zipfile import ZipFile

import openpyxl
import pytest
from openpyxl.workbook import Workbook

from hpn.account.inputs import LOADS, REQUIREMENTS
from hpn.account.readings import figure_symbol
from hpn.catalogue import Catalogue
from hpn.engine.candidates import FIGURES
from hpn.files.export import LOWER_BOUND, Export
from hpn.files.workbook.workbook import workbook
from hpn.words.quantities import CANDIDATE, INPUTS
from hpn.words.reader import Reader
from hpn.words.terms import VERDICTS
from hpn.words.units import PRESETS, suffix_of
from tests.build import Json, answer, candidate, cycle, phase, worked_example
from tests.conftest import Supplement
from tests.report.cases import CASES, EVERYTHING, MOVING, language, typed_export_of
from tests.report.conftest import Recalculate

ENGLISH, GERMAN = language("en"), language("de")
AMERICAN = Reader("en", PRESETS["US"], ENGLISH.digits)
SMALL: dict[str, Json] = {name: case for name, case in CASES.items() if name != "ten thousand phases"} | MOVING


def opened(export: Export, reader: Reader = ENGLISH, *, values: bool = True) -> Workbook:
    """The workbook on an export: the values saved in its cells, or its formulas."""
    return openpyxl.load_workbook(BytesIO(workbook(export, reader)), data_only=values)


def rows(book: Workbook, sheet: str) -> list[list[Any]]:
    """Rows of a sheet, without what is blank at their ends."""
    return [list(row) for row in book[sheet].iter_rows(values_only=True)]


def line(book: Workbook, sheet: str, label: str) -> list[Any]:
    """Last row that begins with a label: figures stand below the checks."""
    return [row for row in rows(book, sheet) if row[0] == label][-1]


def assert_lists(book: Workbook, reply: Json) -> None:
    """Every candidate stands with the verdict and the utilisations of the reply, to the last digit."""
    listed = candidates(book)
    assert list(listed) == [gear["designation"] for gear in reply["candidates"]]
    for gear in reply["candidates"]:
        row = listed[gear["designation"]]
        assert (row["Verdict"], row["Rank"]) == (VERDICTS[gear["status"]], gear["rank"])
        assert row["Utilisation"] == gear["utilisation"]
        for check in gear["checks"]:
            assert row[reply["check_definitions"][check["code"]]["title"]] == check["utilisation"], check["code"]


def candidates(book: Workbook, sheet: str = "Candidates") -> dict[str, dict[str, Any]]:
    """Rows of the list of candidates by designation, by their heads."""
    heads, *lines = rows(book, sheet)
    return {str(row[0]): dict(zip(map(str, heads), row, strict=True)) for row in lines if row[0]}


@pytest.mark.parametrize("case", SMALL)
def test_every_candidate_has_the_numbers_of_the_reply_with_all_their_digits(case: str, catalogue: Catalogue) -> None:
    export = typed_export_of(SMALL[case], catalogue)
    book, selection = opened(export), export.selection

    assert_lists(book, answer(SMALL[case], catalogue))
    listed = candidates(book)
    for gear in selection.candidates:
        row = listed[gear.designation]
        for name in FIGURES:
            symbol = figure_symbol(name, adds_at_motor=selection.adds_at_motor) or CANDIDATE[name].name
            unit = ENGLISH.unit(suffix_of(name))
            view = row.get(f"{symbol} [{unit}]" if unit else symbol)
            assert view == getattr(gear, name) or (view == "unlimited" and getattr(gear, name) is None), name


@pytest.mark.parametrize("case", SMALL)
def test_the_first_sheet_reads_as_the_page_does(case: str, catalogue: Catalogue) -> None:
    export = typed_export_of(SMALL[case], catalogue)
    book = opened(export)
    first = [row[0] for row in rows(book, "Selection")].index("Check") + 1

    for row, line_of in zip(rows(book, "Selection")[first:], export.account.checks, strict=False):
        check, reading = line_of.result, line_of.reading
        title, relation, demand, limit, unit, used, verdict, *_ = row
        assert title == export.selection.check_definitions[check.code].title
        assert (relation or "", unit or "") == (reading.relation, ENGLISH.unit(reading.unit)), check.code
        assert demand == ("unlimited" if reading.has_unlimited_demand else reading.demand), check.code
        assert limit == ("unlimited" if reading.has_unlimited_limit else reading.limit), check.code
        assert (used, verdict) == (check.utilisation, VERDICTS[check.status]), check.code
    for notice in export.selection.notices:
        assert ENGLISH.sentence(notice.sentence) in [row[0] for row in rows(book, "Selection")]


@pytest.mark.parametrize("case", SMALL)
def test_inputs_are_those_of_the_application(case: str, catalogue: Catalogue) -> None:
    export = typed_export_of(SMALL[case], catalogue)
    book = opened(export)

    by_name = {row[0]: row[2] for row in rows(book, "Inputs") if row[0]}
    values = {line.code: line.value for line in (*export.account.loads, *export.account.requirements)}
    for path in (*LOADS, *REQUIREMENTS):
        if path not in values:
            assert INPUTS[path].name not in by_name, path
        elif isinstance(values[path], float):
            assert by_name[INPUTS[path].name] == values[path], path
    phases = export.application.duty_cycle.load_phases
    place = [row[0] for row in rows(book, "Inputs")].index("Duty cycle") + 2
    table = rows(book, "Inputs")[place : place + len(phases)]
    first = 2 if export.application.duty_cycle.motion else 1
    assert [row[first : first + 3] for row in table] == [[p.torque_Nm, p.speed_rpm, p.duration_s] for p in phases]


@pytest.mark.parametrize("case", SMALL)
def test_there_is_nothing_to_type_but_phases_pause_and_T_k_of_the_printed_equations(
    case: str, catalogue: Catalogue
) -> None:
    book = opened(typed_export_of(SMALL[case], catalogue), values=False)

    for sheet in book:
        cells = [cell for row in sheet.iter_rows() for cell in row]
        if sheet.title != "Equations":
            assert not [cell for cell in cells if isinstance(cell.value, str) and cell.value.startswith("=")]
            assert all(cell.protection.locked for cell in cells)
    if "Equations" in book.sheetnames:
        sheet = book["Equations"]
        unlocked = {cell.coordinate for row in sheet.iter_rows() for cell in row if not cell.protection.locked}
        labels = [row[0].value for row in sheet.iter_rows()]
        first, last = labels.index("Inputs") + 1, sheet.max_row
        assert sheet.protection.sheet
        assert unlocked
        assert all(first <= int(re.sub("[A-Z]", "", place)) <= last for place in unlocked)


def put(book: Workbook, label: str, value: Any, column: int = 3, row: int = 0) -> None:
    """Write into a cell of the sheet of equations: the row of a label, or one of those below it."""
    sheet = book["Equations"]
    places = [cell.row for cell in sheet["A"] if cell.value == label]
    sheet.cell(places[-1] + row, column).value = value


def assert_agrees(book: Workbook, reply: Json, gear: str) -> None:
    """The live equations say what `select` answers for a gear."""
    judged, duty = candidate(reply, gear), reply["duty"]
    figures = {
        "Average torque": duty["average_torque_Nm"],
        "Average output speed": duty["average_output_speed_rpm"],
        "Maximum torque": duty["maximum_torque_Nm"],
        "Average input speed": judged["average_input_speed_rpm"],
        "Maximum input speed": judged["maximum_input_speed_rpm"],
        "Gear life": judged["life_L10_h"],
        "Permitted emergency stops": judged["momentary_peak_count"],
    }
    sheet = [row for row in rows(book, "Equations") if row[0]]
    by_name = {row[0]: row[2] for row in reversed(sheet)}  # names of figures stand above those of checks
    for name, value in figures.items():
        view = by_name[name]
        assert (value is None and view in (None, "", "unlimited")) or math.isclose(view, value, rel_tol=1e-12), name
    definitions = reply["check_definitions"]
    for check in judged["checks"]:
        lines = [row for row in sheet if row[0] == definitions[check["code"]]["title"] and row[6]]
        if lines and check["utilisation"] is not None:
            assert math.isclose(lines[0][4], check["utilisation"], rel_tol=1e-12), check["code"]
            assert lines[0][5] == {"pass": "passes", "fail": "fails"}[check["status"]], check["code"]


def test_the_printed_equations_recalculate_to_what_select_answers(
    catalogue: Catalogue, recalculate: Recalculate
) -> None:
    """LibreOffice calculates what was saved, and what follows from changed cells; the engine answers independently."""
    changed = cycle(
        phase(55, 250, 0.3), phase(-32, 500, 3), phase(20, 250, 0.4), pause_s=1, emergency_stop={"torque_Nm": -180}
    )
    by_name = {name: case for name, case in SMALL.items() if name not in ("extremes", "not rated")}
    exports = {name: typed_export_of(case, catalogue) for name, case in by_name.items()}
    books = {name: opened(export, values=False) for name, export in exports.items()}
    books["changed"] = opened(exports["example"], values=False)
    put(books["changed"], "Pause", 1)
    put(books["changed"], "Emergency-stop torque", -180)
    put(books["changed"], "Phase", 55, 2, 1)
    put(books["changed"], "Phase", -32, 2, 2)
    fresh = recalculate(books)

    for name, case in by_name.items():
        assert_agrees(fresh[name], answer(case, catalogue), exports[name].candidate.designation)
        saved = [cell for row in rows(opened(exports[name]), "Equations") for cell in row if isinstance(cell, float)]
        again = [cell for row in rows(fresh[name], "Equations") for cell in row if isinstance(cell, int | float)]
        assert len(again) >= len(saved)
    assert_agrees(fresh["changed"], answer(changed, catalogue), "HPN-20A-5")


def test_numbers_stand_in_the_readers_units(catalogue: Catalogue) -> None:
    export = typed_export_of(EVERYTHING, catalogue)
    book = opened(export, AMERICAN)

    for sheet, label, wire, factor, unit in (
        ("Selection", "Average torque", export.selection.duty.average_torque_Nm, 1 / 0.1129848290276167, "lb·in"),
        ("Inputs", "Emergency-stop torque", 200, 1 / 0.1129848290276167, "lb·in"),
        ("Selection", "Weight", 2.6, 1 / 0.45359237, "lb"),
    ):
        _, _, value, symbol, *_ = line(book, sheet, label)
        assert (value, symbol) == (pytest.approx(wire * factor, rel=1e-12), unit)
    assert line(book, "Inputs", "Ambient temperature")[2:4] == [77, "°F"]
    papers = [opened(export, reader)["Selection"].page_setup.paperSize for reader in (ENGLISH, AMERICAN)]
    assert papers == [9, 1]  # A4 and US letter


def test_german_workbook_has_the_same_numbers_and_the_page_s_units(catalogue: Catalogue) -> None:
    export = typed_export_of(EVERYTHING, catalogue)
    english, german = opened(export), opened(export, GERMAN)

    for own, other in zip(english, german, strict=True):
        pairs = zip(own.iter_rows(values_only=True), other.iter_rows(values_only=True), strict=True)
        for row, again in pairs:
            assert [cell for cell in row if isinstance(cell, float)] == [c for c in again if isinstance(c, float)]
    values = [sheet for sheet in german if sheet.sheet_state == "visible"]
    texts = [cell for sheet in values for row in sheet.iter_rows(values_only=True) for cell in row if cell]
    assert "n [min⁻¹]" in texts
    assert not [text for text in texts if isinstance(text, str) and re.search(r"\brpm\b", text)]


def test_a_motion_stands_with_mechanism_moves_and_phases(catalogue: Catalogue) -> None:
    book = opened(typed_export_of(MOVING["rotary table"], catalogue), GERMAN)
    values = [[cell for cell in row if cell is not None] for row in book["Eingaben"].iter_rows(values_only=True)]

    assert ["Mechanismus", "Drehachse"] in values
    assert ["Trägheitsmoment", "J", 0.8, "kg·m²"] in values
    assert ["1 turn", "Trapez", 90, 0.8, 900] in values


def test_a_motor_torque_says_that_it_is_a_lower_bound(catalogue: Catalogue) -> None:
    for efficiency, notice in ((None, LOWER_BOUND), (0.9, None)):
        export = typed_export_of(worked_example(requirements={"efficiency": efficiency}), catalogue)
        assert line(opened(export), "Selection", CANDIDATE["motor_peak_torque_Nm"].name)[4] == notice


@pytest.mark.parametrize(
    ("torque", "efficiency", "bound"), [(60, None, False), (100, None, False), (5, None, False), (100, 0.9, False)]
)
def test_a_motor_torque_is_a_lower_bound_without_an_efficiency_and_none_beyond_a_curve(
    supplemented: Supplement, torque: float, efficiency: float | None, bound: bool
) -> None:
    curve = "size,ratio,torque_Nm,efficiency,source\n20A,5,10,0.5,p\n20A,5,40,0.85,p\n20A,5,80,0.9,p\n"
    question = cycle(phase(0, 100), phase(-torque, 9), requirements={"efficiency": efficiency})
    export = typed_export_of(question, supplemented(efficiency=curve))
    gears = {gear.designation: gear for gear in export.selection.candidates}
    assert {name: export.account.of(gears[name]).is_lower_bound for name in ("HPN-20A-5", "HPN-20A-4")} == {
        "HPN-20A-5": bound,
        "HPN-20A-4": efficiency is None,
    }


def test_figures_of_another_catalogue_are_not_used(catalogue: Catalogue, supplemented: Supplement) -> None:
    export = typed_export_of(EVERYTHING, catalogue)
    aged = replace(export, catalogue=supplemented(weights="size,stages,weight_kg,source\n20A,1,3.6,p\n"))
    book = opened(aged)

    assert "Equations" not in book.sheetnames
    assert "not kept" in line(book, "Selection", "Catalogue")[1]
    assert not [row for row in rows(book, "Selection") if row[0] == "Published figures"]
    by_name = {name: row["Utilisation"] for name, row in candidates(book).items()}
    assert by_name == {gear.designation: gear.utilisation for gear in export.selection.candidates}


@pytest.mark.parametrize("text", ["=1+1", "+A1", "@SUM(A1)", '=HYPERLINK("http://evil.example")', "{=1}"])
def test_no_text_becomes_a_formula(text: str, catalogue: Catalogue) -> None:
    content = workbook(typed_export_of(worked_example(), catalogue, title=text, reference=text), ENGLISH)
    sheet = openpyxl.load_workbook(BytesIO(content))["Selection"]
    assert sheet["A1"].value == text
    assert sheet["A1"].data_type == "s"
    assert b"hyperlink" not in b"".join(ZipFile(BytesIO(content)).read(n) for n in ZipFile(BytesIO(content)).namelist())


def test_every_phase_of_a_long_cycle_is_there_with_all_digits(catalogue: Catalogue) -> None:
    export = typed_export_of(CASES["ten thousand phases"], catalogue)
    book = openpyxl.load_workbook(BytesIO(workbook(export, ENGLISH)), read_only=True)
    torques = [row[1] for row in book["Inputs"].iter_rows(values_only=True)][-10_000:]
    assert torques == [phase.torque_Nm for phase in export.application.duty_cycle.load_phases]


def test_the_same_selection_gives_the_same_bytes(catalogue: Catalogue) -> None:
    one, other = (workbook(typed_export_of(EVERYTHING, catalogue), ENGLISH) for _ in range(2))
    assert one == other
