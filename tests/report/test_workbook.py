"""The workbook, recalculated by LibreOffice: it says what the service says, as saved and when inputs change."""

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from io import BytesIO
from typing import Any
from zipfile import ZipFile

import openpyxl
import pytest
from openpyxl.workbook import Workbook

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from hpn.files.export import LOSS_FREE, LOWER_BOUND
from hpn.files.workbook.formulas import MOTOR_TORQUES
from tests.build import Json, answer, cycle, phase, worked_example
from tests.conftest import Supplement
from tests.report.cases import CASES, EVERYTHING, export_of, language, workbook
from tests.report.conftest import Recalculate
from tests.wire import EXPLANATIONS

ENGLISH = language("en")
SMALL_CASES = {name: case for name, case in CASES.items() if name != "ten thousand phases"}

LOADED = worked_example(output_load={"radial_N": 700, "axial_N": 200})


def opened(application: Json, catalogue: Catalogue, *, values: bool = False, code: str = "en") -> Workbook:
    """The workbook on an application: its formulas, or the values saved beside them."""
    content = workbook(export_of(application, catalogue), language(code))
    return openpyxl.load_workbook(BytesIO(content), data_only=values)


def put(book: Workbook, name: str, value: Any, row: int = 0) -> None:
    """Write into the cell of a defined name, or into a row of its block."""
    sheet, cells = next(iter(book.defined_names[name].destinations))
    first = cells.replace("$", "").partition(":")[0]
    book[sheet][first].offset(row=row).value = value


def got(book: Workbook, name: str) -> Any:
    """Value of the cell of a defined name."""
    sheet, cells = next(iter(book.defined_names[name].destinations))
    return book[sheet][cells.replace("$", "")].value


def column(book: Workbook, name: str) -> list[Any]:
    """Values of the block of a defined name."""
    sheet, cells = next(iter(book.defined_names[name].destinations))
    return [row[0].value for row in book[sheet][cells.replace("$", "")]]


def beside(book: Workbook, name: str) -> Any:
    """Source in the row of a defined name."""
    sheet, cell = next(iter(book.defined_names[name].destinations))
    return book[sheet][cell.replace("$", "")].offset(column=2).value


def candidates(book: Workbook) -> dict[str, dict[str, Any]]:
    """Rows of the list of candidates by designation, by their heads."""
    rows = list(book["Candidates"].iter_rows(values_only=True))
    return {str(row[0]): dict(zip(map(str, rows[0]), row, strict=True)) for row in rows[1:] if row[0]}


def same(one: Any, other: Any) -> bool:
    """Equal but for the order of floating-point operations."""
    if isinstance(one, int | float) and isinstance(other, int | float):
        return math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-300)
    return (one or None) == (other or None)


def assert_agrees(book: Workbook, reply: Mapping[str, Any]) -> None:
    """Every candidate has the verdict and the utilisations of the reply."""
    rows = candidates(book)
    for candidate in reply["candidates"]:
        row, name = rows[candidate["designation"]], candidate["designation"]
        assert row["Verdict"] == candidate["status"], name
        if candidate["utilisation"] is not None:
            assert same(row["Utilisation"], candidate["utilisation"]), name
        for check in candidate["checks"]:
            if check["utilisation"] is not None:
                shown = row[EXPLANATIONS[check["code"]].title]
                assert same(shown, check["utilisation"]), (name, check, shown)


def test_recalculated_as_saved_no_cell_changes(catalogue: Catalogue, recalculate: Recalculate) -> None:
    fresh = recalculate({name: opened(case, catalogue) for name, case in SMALL_CASES.items()})
    for name, case in SMALL_CASES.items():
        for sheet in opened(case, catalogue, values=True):
            for row in sheet.iter_rows():
                for cell in row:
                    value = fresh[name][sheet.title][cell.coordinate].value
                    assert same(cell.value, value), (name, sheet.title, cell.coordinate, cell.value, value)
        assert_agrees(fresh[name], answer(case, catalogue))


def test_figures_are_numbers_with_every_digit(catalogue: Catalogue) -> None:
    uneven = 0.1 + 0.2  # needs 17 digits; the writer of workbooks keeps 16
    asked = {"life_h": 1e4 * uneven, "ratios": [5]}
    case = cycle(phase(uneven, 100 * uneven), output_load={"radial_N": uneven}, requirements=asked)
    book = opened(case, catalogue, values=True)
    assert got(book, "F_R") == uneven
    assert got(book, "L_10_req") == 1e4 * uneven
    assert [column(book, name)[0] for name in ("torque_Nm", "speed_rpm")] == [uneven, 100 * uneven]
    for application in (case, EVERYTHING):
        for sheet in opened(application, catalogue, values=True):
            texts = (cell.value for row in sheet.iter_rows() for cell in row if isinstance(cell.value, str))
            assert [text for text in texts if re.fullmatch(r"[<>≤≥]?\s*[-−]?[\d.,\s]*\d", text)] in (
                [],
                ["3, 5, 10, 25"],  # the ratios to choose from
                [ENGINE_VERSION],
            )


def _merged(application: Json, part: str, **values: Any) -> Json:
    return application | {part: {**application.get(part, {}), **values}}


CHANGES: dict[str, tuple[Json, list[tuple[Any, ...]], Json]] = {
    "torque of a phase": (
        worked_example(),
        [("torque_Nm", 60, 1)],
        worked_example() | cycle(phase(40, 250, 0.3), phase(60, 500, 3), phase(20, 250, 0.4), pause_s=4),
    ),
    "a phase more": (
        worked_example(),
        [("torque_Nm", -90, 3), ("speed_rpm", -100, 3), ("duration_s", 0.5, 3)],
        worked_example()
        | cycle(phase(40, 250, 0.3), phase(32, 500, 3), phase(20, 250, 0.4), phase(-90, -100, 0.5), pause_s=4),
    ),
    "pause": (worked_example(), [("pause_s", 0)], _merged(worked_example(), "duty_cycle", pause_s=0)),
    "stop torque and count": (
        worked_example(),
        [("T_k", -250), ("N_k", 2_000_000)],
        worked_example(emergency_stop={"torque_Nm": -250, "count": 2_000_000}),
    ),
    "no stop": (worked_example(), [("T_k", None)], {k: v for k, v in worked_example().items() if k[0] != "e"}),
    "a load where there was none": (
        worked_example(),
        [("F_R", -700), ("f_w", 1.5)],
        worked_example(output_load={"radial_N": -700, "load_coefficient": 1.5}),
    ),
    "load of one phase": (
        LOADED,
        [("radial_N", 1500, 1), ("axial_N", 0, 2)],
        LOADED
        | cycle(phase(40, 250, 0.3), phase(32, 500, 3, radial_N=1500), phase(20, 250, 0.4, axial_N=0), pause_s=4),
    ),
    "model and basis": (
        LOADED,
        [("model", "iso281"), ("life_basis", "L10"), ("L_b", 5000)],
        _merged(LOADED, "output_load", model="iso281", life_basis="L10", life_h=5000),
    ),
    "requirements": (
        EVERYTHING,
        [("u", 0.5), ("eta", None), ("L_10_req", 2e6), ("m_req", 1), ("t_amb", -5), ("j_req", None), ("n_mot", 2000)],
        _merged(
            EVERYTHING,
            "requirements",
            utilisation=0.5,
            efficiency=None,
            life_h=2e6,
            weight_kg=1,
            ambient_temperature_degC=-5,
            backlash_arcmin=None,
            motor={"maximum_speed_rpm": 2000, "peak_torque_Nm": 20, "rated_torque_Nm": 8},
        ),
    ),
}
"""Saved application, values by cell (and row of a block), and the application that they make of it."""


def test_changed_inputs_recalculate_to_what_the_service_says(catalogue: Catalogue, recalculate: Recalculate) -> None:
    books = {}
    for name, (saved, cells, _) in CHANGES.items():
        books[name] = opened(saved, catalogue)
        for cell, value, *row in cells:
            put(books[name], cell, value, *row)
    fresh = recalculate(books)
    for name, (_, _, meant) in CHANGES.items():
        reply = answer(meant, catalogue)
        assert_agrees(fresh[name], reply)
        assert same(got(fresh[name], "T_av"), reply["duty"]["average_torque_Nm"]), name
        assert same(got(fresh[name], "n_out_av"), reply["duty"]["average_output_speed_rpm"]), name
        chosen = next(c for c in reply["candidates"] if c["designation"] == got(fresh[name], "gear"))
        for cell, field in {
            "L_10": "life_L10_h",
            "L_b50": "bearing_life_L50_h",
            "T_mot_rms": "motor_rated_torque_Nm",
        }.items():
            if chosen[field] is not None:
                assert same(got(fresh[name], cell), chosen[field]), (name, cell)
        if chosen["momentary_peak_count"] is not None:
            assert got(fresh[name], "N_k_max") == chosen["momentary_peak_count"], name


def test_another_gear_can_be_chosen_in_the_sheet(catalogue: Catalogue, recalculate: Recalculate) -> None:
    book = opened(worked_example(), catalogue)
    put(book, "gear", "HPN-14A-5")
    fresh = recalculate({"other": book})["other"]
    gear = catalogue.by_designation["HPN-14A-5"]
    assert (got(fresh, "T_N"), got(fresh, "T_M")) == (gear.rated_torque_Nm, gear.momentary_peak_torque_Nm)
    status = {row[0].value: row[5].value for row in fresh["Selection"].iter_rows() if row[5].value}
    assert status["Load limit 1: average torque [Nm]"] == "fails"
    assert status["Load limit 2: repeated peak torque [Nm]"] == "passes"


def test_german_workbook_calculates_the_same(catalogue: Catalogue, recalculate: Recalculate) -> None:
    fresh = recalculate({"german": opened(EVERYTHING, catalogue, code="de")})["german"]
    reply = answer(EVERYTHING, catalogue)
    rows = {row[0]: row for row in fresh["Kandidaten"].iter_rows(values_only=True)}
    german = {"suitable": "geeignet", "unsuitable": "ungeeignet", "unrated": "nicht bewertet"}
    for candidate in reply["candidates"]:
        assert rows[candidate["designation"]][1] == german[candidate["status"]]


def test_german_workbook_writes_units_as_the_page_does(catalogue: Catalogue) -> None:
    book = opened(EVERYTHING, catalogue, code="de")
    texts = [cell.value for sheet in book for row in sheet.iter_rows() for cell in row if isinstance(cell.value, str)]
    assert "Drehzahl [min⁻¹]" in texts
    assert not [shown for shown in texts if not shown.startswith("=") and re.search(r"\brpm\b", shown)]


def test_a_figure_that_no_formula_gives_stands_as_saved(supplemented: Supplement, recalculate: Recalculate) -> None:
    curve = "size,load_coefficient,axial_N,radial_N,source\n20A,1,2200,0,p\n20A,1,1500,900,p\n20A,1,0,1800,p\n"
    efficiency = "size,ratio,torque_Nm,efficiency,source\n20A,5,10,0.9,p\n20A,5,80,0.95,p\n"
    catalogue = supplemented(bearing_envelopes=curve, efficiency=efficiency)
    asked = worked_example(
        output_load={"radial_N": 700, "model": "digitised"},
        requirements={"sizes": ["20A"], "motor": {"peak_torque_Nm": 20, "rated_torque_Nm": 8}},
    )
    fresh = recalculate({"supplied": opened(asked, catalogue)})["supplied"]
    assert_agrees(fresh, answer(asked, catalogue))


CURVE = "size,ratio,torque_Nm,efficiency,source\n20A,5,10,0.5,p\n20A,5,40,0.85,p\n20A,5,80,0.9,p\n"
ABOVE_CURVE = cycle(
    phase(100, 100, 1), phase(20, 100, 9), requirements={"sizes": ["20A"], "motor": {"rated_torque_Nm": 8}}
)
"""The largest torque lies beyond the end of the curve, the other one within it."""


def test_an_efficiency_curve_counts_in_every_phase(supplemented: Supplement, recalculate: Recalculate) -> None:
    catalogue = supplemented(efficiency=CURVE)
    export = export_of(ABOVE_CURVE, catalogue)
    lost = replace(export, catalogue=None)
    books = {
        "kept": opened(ABOVE_CURVE, catalogue),
        "lost": openpyxl.load_workbook(BytesIO(workbook(lost, ENGLISH))),
        "stated": opened(_merged(ABOVE_CURVE, "requirements", efficiency=0.9), catalogue),
    }
    fresh = recalculate(books)
    assert_agrees(fresh["kept"], export.reply)
    assert_agrees(fresh["lost"], export.reply)
    assert_agrees(fresh["stated"], answer(_merged(ABOVE_CURVE, "requirements", efficiency=0.9), catalogue))
    judged = next(c for c in export.reply["candidates"] if c["designation"] == "HPN-20A-5")
    # By hand: 100 / (5 · 0.9) = 22.222 and 20 / (5 · 0.61667) = 6.4865, so that the RMS of 1 s and 9 s is 9.3408.
    assert math.isclose(judged["motor_rated_torque_Nm"], 9.3408, rel_tol=1e-5)
    assert same(
        candidates(fresh["kept"])["HPN-20A-5"][f"T_rms/(i·η) [Nm], {LOWER_BOUND}"], judged["motor_rated_torque_Nm"]
    )


def test_motor_torques_without_an_efficiency_are_a_lower_bound_until_one_is_stated(
    catalogue: Catalogue, recalculate: Recalculate
) -> None:
    book = opened(worked_example(), catalogue)
    put(book, "eta", 0.9)
    fresh = recalculate({"stated": book})["stated"]
    assert [beside(opened(worked_example(), catalogue, values=True), name) for name in MOTOR_TORQUES] == [LOSS_FREE] * 2
    assert [beside(fresh, name) or "" for name in MOTOR_TORQUES] == ["", ""]


@pytest.mark.parametrize(
    ("torque", "efficiency", "bound"), [(60, None, False), (100, None, False), (5, None, False), (100, 0.9, False)]
)
def test_a_motor_torque_is_a_lower_bound_without_an_efficiency_and_none_beyond_a_curve(
    supplemented: Supplement, torque: float, efficiency: float | None, bound: bool
) -> None:
    asked = cycle(phase(0, 100), phase(-torque, 9), requirements={"efficiency": efficiency})
    export = export_of(asked, supplemented(efficiency=CURVE))
    assert {
        name: export.is_lower_bound(next(c for c in export.candidates if c["designation"] == name))
        for name in ("HPN-20A-5", "HPN-20A-4")
    } == {"HPN-20A-5": bound, "HPN-20A-4": efficiency is None}


def test_RMS_torque_is_that_of_the_output_under_an_efficiency_curve(
    supplemented: Supplement, recalculate: Recalculate
) -> None:
    within = cycle(phase(40, 100, 1), phase(20, 100, 9), requirements={"sizes": ["20A"], "ratios": [5]})
    catalogue = supplemented(efficiency=CURVE)
    saved = got(opened(within, catalogue, values=True), "T_rms")
    fresh = got(recalculate({"within": opened(within, catalogue)})["within"], "T_rms")
    assert same(saved, fresh)
    assert same(saved, math.sqrt((40**2 * 1 + 20**2 * 9) / 10))


def test_a_check_that_is_not_rated_is_saved_blank_as_its_formula_gives_it(supplemented: Supplement) -> None:
    columns = "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source"
    catalogue = supplemented(ratings=f"{columns}\n40A,5,752,,,p\n")
    asked = cycle(phase(10, 90), emergency_stop={"torque_Nm": 700}, requirements={"sizes": ["40A"], "ratios": [5]})
    book = opened(asked, catalogue, values=True)
    assert (got(book, "N_k_max"), got(book, "L_10") or None) == ("unlimited", None)


def test_figures_of_another_catalogue_are_not_used(
    catalogue: Catalogue, supplemented: Supplement, recalculate: Recalculate
) -> None:
    export = export_of(EVERYTHING, catalogue)
    later = supplemented(weights="size,stages,weight_kg,source\n20A,1,3.6,p\n")
    aged = type(export)(**{**vars(export), "catalogue": later})
    book = openpyxl.load_workbook(BytesIO(workbook(aged, ENGLISH)))
    assert_agrees(recalculate({"aged": book})["aged"], export.reply)


@pytest.mark.parametrize("text", ["=1+1", "+A1", "@SUM(A1)", '=HYPERLINK("http://evil.example")', "{=1}"])
def test_no_text_becomes_a_formula(text: str, catalogue: Catalogue) -> None:
    content = workbook(export_of(worked_example(), catalogue, title=text, reference=text), ENGLISH)
    sheet = openpyxl.load_workbook(BytesIO(content))["Selection"]
    assert sheet["A1"].value == text
    assert sheet["A1"].data_type == "s"
    assert b"hyperlink" not in b"".join(ZipFile(BytesIO(content)).read(n) for n in ZipFile(BytesIO(content)).namelist())


def test_every_phase_of_a_long_cycle_is_there(catalogue: Catalogue) -> None:
    export = export_of(CASES["ten thousand phases"], catalogue)
    book = openpyxl.load_workbook(BytesIO(workbook(export, ENGLISH)), read_only=True)
    sheet, cells = next(iter(book.defined_names["torque_Nm"].destinations))
    first = int(cells.split("$")[2].rstrip(":"))
    rows = book[sheet].iter_rows(min_row=first, max_row=first + 9_999, min_col=2, max_col=2, values_only=True)
    torques = [row[0] for row in rows]
    given = [phase.torque_Nm for phase in export.application.duty_cycle.load_phases]
    assert torques == pytest.approx(given, rel=1e-15)  # a workbook holds sixteen digits


def test_the_same_selection_gives_the_same_bytes(catalogue: Catalogue) -> None:
    one, other = (workbook(export_of(EVERYTHING, catalogue), ENGLISH) for _ in range(2))
    assert one == other


def test_inputs_that_are_not_given_are_folded(catalogue: Catalogue) -> None:
    sheet = opened(worked_example(), catalogue)["Inputs"]
    folded = {row[0].value for place, row in enumerate(sheet.iter_rows(), 1) if sheet.row_dimensions[place].hidden}
    assert "Required gear life" in folded
    assert not folded & {"Emergency-stop torque", "Maximum utilisation", "Phase"}
