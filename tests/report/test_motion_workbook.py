"""The workbook of motions and of phases that vary, recalculated by LibreOffice."""

from dataclasses import replace
from io import BytesIO
from typing import Any

import openpyxl
import pytest
from openpyxl.workbook import Workbook

from hpn.catalogue import Catalogue
from hpn.engine.checks import BY_CODE
from hpn.files.export import LOSS_FREE
from hpn.files.workbook import workbook as sheets
from hpn.files.workbook.formulas import MOTOR_TORQUES
from hpn.web.api.samples import TURNING
from tests.build import Json, answer, cycle, phase
from tests.conftest import Supplement
from tests.property.test_varying_remedy import MOTORS
from tests.report.cases import CASES, MOTOR, MOVING, language, typed_export_of
from tests.report.conftest import Recalculate
from tests.report.test_workbook import (
    ABOVE_CURVE,
    CURVE,
    assert_agrees,
    beside,
    candidates,
    got,
    opened,
    put,
    same,
)

GERMAN = language("de")


def filled(book: Workbook) -> dict[str, Any]:
    """Values of all cells by sheet and place."""
    return {
        f"{sheet.title}!{cell.coordinate}": cell.value for sheet in book for row in sheet.iter_rows() for cell in row
    }


LISTED: Json = cycle(
    phase(5, 100, 1, peak_torque_Nm=9),
    requirements={
        "sizes": ["11A", "20A"],
        "motor": {"designation": "M 8", "inertia_ratio": 5},
        "load_inertia_kgm2": 0.1,
    },
)


def test_recalculated_as_saved_no_cell_changes(
    catalogue: Catalogue, supplemented: Supplement, recalculate: Recalculate
) -> None:
    cases = {name: (case, catalogue) for name, case in MOVING.items()} | {
        "listed": (LISTED, supplemented(motors=MOTORS))
    }
    fresh = recalculate({name: opened(*case) for name, case in cases.items()})
    for name, case in cases.items():
        calculated = filled(fresh[name])
        for place, value in filled(opened(*case, values=True)).items():
            assert same(value, calculated[place]), (name, place, value, calculated[place])
        assert_agrees(fresh[name], answer(*case))


VARYING = MOVING["phases that vary"]
CHANGED = VARYING | {
    "duty_cycle": cycle(
        phase(40, 250, 0.3, peak_torque_Nm=75, peak_speed_rpm=400, rms_torque_Nm=50, radial_N=500),
        phase(-32, 500, 3.0, peak_speed_rpm=620),
        phase(20, 250, 0.4),
        phase(0, 0, 1, peak_torque_Nm=60, rms_torque_Nm=35),
        pause_s=4.0,
    )["duty_cycle"]
}


def test_changed_peaks_and_RMS_recalculate_to_what_the_service_says(
    catalogue: Catalogue, recalculate: Recalculate
) -> None:
    book = opened(VARYING, catalogue)
    for name, value, row in (
        *(("peak_torque_Nm", 75, 0), ("rms_torque_Nm", 50, 0), ("peak_torque_Nm", None, 1), ("peak_speed_rpm", 620, 1)),
        *(("torque_Nm", 0, 3), ("speed_rpm", 0, 3), ("duration_s", 1, 3)),
        *(("peak_torque_Nm", 60, 3), ("rms_torque_Nm", 35, 3)),
    ):
        put(book, name, value, row)
    fresh = recalculate({"changed": book})["changed"]
    reply = answer(CHANGED, catalogue)
    assert_agrees(fresh, reply)
    for cell, field in {
        "T_max": "maximum_torque_Nm",
        "T_av": "average_torque_Nm",
        "n_out_max": "maximum_output_speed_rpm",
    }.items():
        assert same(got(fresh, cell), reply["duty"][field]), cell


def test_a_motion_has_a_sheet_of_its_own_in_every_language_and_unit(catalogue: Catalogue) -> None:
    export = typed_export_of(MOVING["rotary table"], catalogue)
    book = openpyxl.load_workbook(BytesIO(sheets.workbook(export, GERMAN)))
    rows = [[cell for cell in row if cell is not None] for row in book["Bewegung"].iter_rows(values_only=True)]
    assert ["Mechanismus", "Drehachse"] in [[cell for cell in row if cell][:2] for row in rows]
    assert ["Trägheitsmoment", "J", 0.8, "kg·m²"] in rows
    assert ["1 turn", "Trapez", 90, 0.8, 900] in rows


def test_columns_of_phases_that_vary_are_folded_unless_used(catalogue: Catalogue) -> None:
    plain, varying = (
        opened(case, catalogue)["Inputs"].column_dimensions for case in (CASES["example"], MOVING["phases that vary"])
    )
    assert plain["G"].hidden
    assert not varying["G"].hidden


def test_motor_torques_along_a_motion_stand_as_saved_and_say_so(catalogue: Catalogue, recalculate: Recalculate) -> None:
    book = opened(MOVING["rotary table"], catalogue, values=True)
    for name in MOTOR_TORQUES:
        assert beside(book, name) == f"as saved: along the motion, with the motor’s own inertia; {LOSS_FREE}"
    assert (got(book, "J_L"), beside(book, "J_L")) == (TURNING["mechanism"]["inertia_kgm2"], "of the motion")
    free = MOVING["rotary table"] | {"requirements": {"motor": {k: v for k, v in MOTOR.items() if "inertia" not in k}}}
    loose = opened(free, catalogue)
    assert str(got(loose, "T_mot_peak")).startswith("=")
    assert_agrees(recalculate({"loose": loose})["loose"], answer(free, catalogue))


def judged(book: Workbook) -> dict[str, tuple[Any, ...]]:
    """Demand, limit, utilisation and verdict of each check on the first sheet, by what stands first in its row."""
    return {str(row[0]): row[2:6] for row in book["Selection"].iter_rows(values_only=True, max_col=6)}


SCREW = {"type": "ball_screw", "mass_kg": 400, "lead_mm": 20, "incline_deg": 90, "ratio": 2}
RISE = {"profile": "s_curve", "distance_mm": 600, "speed_mm_per_s": 150, "acceleration_mm_per_s2": 800}
FALL = {"profile": "trapezoidal", "distance_mm": -600, "time_s": 8}
LIFTED: Json = {
    "duty_cycle": {"motion": {"mechanism": SCREW, "moves": [RISE, FALL]}, "pause_s": 1},
    "requirements": {
        "efficiency": 0.9,
        "motor": {"inertia_kgm2": 0.001, "inertia_ratio": 3, "peak_torque_Nm": 10, "rated_torque_Nm": 4},
    },
}
AT_MOTOR = ("motor_peak_torque", "motor_rated_torque")


def test_another_gear_has_its_own_motor_torques_along_a_motion(catalogue: Catalogue, recalculate: Recalculate) -> None:
    replies = {candidate["designation"]: candidate for candidate in answer(LIFTED, catalogue)["candidates"]}
    books = {gear: opened(LIFTED, catalogue) for gear in ("HPN-14A-3", "HPN-20A-5", "HPN-14A-10", "HPN-40A-50")}
    for gear, book in books.items():
        put(book, "gear", gear)
    found = set()
    for gear, book in recalculate(books).items():
        rows = judged(book)
        for check in replies[gear]["checks"]:
            if check["code"] in AT_MOTOR:
                demand, limit, used, verdict = rows[f"{BY_CODE[check['code']].title} [Nm]"]
                assert same(demand, check["demand"]) and same(limit, check["limit"])
                assert same(used, check["utilisation"])
                assert verdict == {"pass": "passes", "fail": "fails"}[check["status"]], (gear, check)
                found.add(verdict)
    assert found == {"passes", "fails"}


def test_motor_torques_with_the_motors_own_inertia_have_the_symbols_of_the_report(catalogue: Catalogue) -> None:
    texts = {
        str(cell.value)
        for sheet in opened(LIFTED, catalogue)
        for row in sheet.iter_rows()
        for cell in row
        if cell.value
    }
    assert {"T_in,max", "T_in,rms", "T_in,max ≤ T_mot", "T_in,rms ≤ T_mot,N"} <= texts
    assert not [text for text in texts if "/(i·η)" in text or ("/ (i · η)" in text and "≤" in text)]


def test_motor_torques_are_unknown_once_an_input_behind_them_is_changed(
    catalogue: Catalogue, recalculate: Recalculate
) -> None:
    changes: dict[str, tuple[str, Any]] = {
        **{name: (name, value) for name, value in (("eta", 0.5), ("J_m", 0.002), ("J_L", 1), ("pause_s", 9))},
        **{name: (name, 3) for name in ("torque_Nm", "speed_rpm", "duration_s", "peak_torque_Nm", "rms_torque_Nm")},
    }
    books = {"saved": opened(LIFTED, catalogue), "other": opened(LIFTED, catalogue)}
    put(books["other"], "m_req", 9)
    for name, (cell, value) in changes.items():
        put(books.setdefault(name, opened(LIFTED, catalogue)), cell, value)
    fresh = recalculate(books)
    assert "suitable" in {row["Verdict"] for row in candidates(fresh["saved"]).values()}
    for name, book in fresh.items():
        rows, known = judged(book), name in ("saved", "other")
        for code, cell in zip(AT_MOTOR, MOTOR_TORQUES, strict=True):
            assert (rows[f"{BY_CODE[code].title} [Nm]"][3] == "not rated") == (not known), (name, code)
            assert (beside(book, cell) == "not available: inputs that it depends on were changed") == (not known), name
        if not known:
            assert rows["Verdict"][0] != "suitable", name
            assert not [row for row in candidates(book).values() if row["Verdict"] == "suitable"], name


def test_a_cell_that_nothing_follows_from_is_no_input(catalogue: Catalogue) -> None:
    yellow = {
        name: {cell: colour(opened(case, catalogue), cell) == "FFFFF8DC" for cell in ("eta", "J_L", "J_m")}
        for name, case in (("lifted", LIFTED), ("steady", CASES["example"]))
    }
    assert yellow == {
        "lifted": {"eta": False, "J_L": False, "J_m": True},
        "steady": {"eta": True, "J_L": True, "J_m": True},
    }


def colour(book: Workbook, name: str) -> str:
    """Colour of the cell of a defined name."""
    sheet, cell = next(iter(book.defined_names[name].destinations))
    return str(book[sheet][cell.replace("$", "")].fill.fgColor.rgb)


def test_a_motor_inertia_that_is_added_leaves_no_torque_without_it(
    catalogue: Catalogue, recalculate: Recalculate
) -> None:
    case = LIFTED | {"requirements": {"motor": {"peak_torque_Nm": 12}}}
    book = opened(case, catalogue)
    put(book, "J_m", 0.01)
    fresh = recalculate({"added": book})["added"]
    assert judged(fresh)["Motor peak torque [Nm]"][3] == "not rated"


def test_a_gear_with_an_efficiency_curve_keeps_its_own_motor_torques_in_the_sheet(
    supplemented: Supplement, recalculate: Recalculate
) -> None:
    supplied = supplemented(efficiency=CURVE)
    replies = {candidate["designation"]: candidate for candidate in answer(ABOVE_CURVE, supplied)["candidates"]}
    books = {gear: opened(ABOVE_CURVE, supplied) for gear in ("HPN-20A-5", "HPN-20A-4")}
    for gear, book in books.items():
        put(book, "gear", gear)
    for gear, book in recalculate(books).items():
        assert same(got(book, "T_mot_rms"), replies[gear]["motor_rated_torque_Nm"]), gear


@pytest.mark.parametrize("name", ["rotary table", "phases that vary"])
def test_without_its_catalogue_a_workbook_says_what_was_saved(
    name: str, catalogue: Catalogue, supplemented: Supplement, recalculate: Recalculate
) -> None:
    export = replace(typed_export_of(MOVING[name], catalogue), catalogue=None)
    book = openpyxl.load_workbook(BytesIO(sheets.workbook(export, language("en"))))
    fresh = recalculate({"aged": book})["aged"]
    assert_agrees(fresh, answer(MOVING[name], catalogue))
    assert candidates(fresh)


def test_limits_of_a_listed_motor_stay_as_saved_without_the_catalogue(
    supplemented: Supplement, recalculate: Recalculate
) -> None:
    supplied = supplemented(motors=MOTORS)
    export = replace(typed_export_of(LISTED, supplied), catalogue=None)
    book = openpyxl.load_workbook(BytesIO(sheets.workbook(export, language("en"))))
    assert_agrees(recalculate({"aged": book})["aged"], answer(LISTED, supplied))
