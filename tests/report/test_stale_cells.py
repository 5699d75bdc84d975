"""Saved figures of a workbook that no formula gives: not rated once an input behind them is changed."""

from dataclasses import replace
from io import BytesIO
from typing import Any

import openpyxl
import pytest
from openpyxl.workbook import Workbook

from hpn.catalogue import Catalogue
from hpn.engine.checks import BY_CODE
from hpn.files.workbook import workbook as sheets
from hpn.files.workbook.unchanged import inputs_behind
from tests.build import Json, answer, worked_example
from tests.conftest import Supplement
from tests.property.test_varying_remedy import MOTORS
from tests.report.cases import EVERYTHING, language, typed_export_of
from tests.report.conftest import Recalculate
from tests.report.test_motion_workbook import LISTED
from tests.report.test_workbook import assert_agrees, beside, candidates, got, opened, put

DIGITISED = "size,load_coefficient,axial_N,radial_N,source\n20A,1,2200,0,p\n20A,1,1500,900,p\n20A,1,0,1800,p\n"
CURVE = "size,ratio,torque_Nm,efficiency,source\n20A,5,10,0.9,p\n20A,5,80,0.95,p\n"
SUPPLIED = worked_example(
    output_load={"radial_N": 700, "model": "digitised"},
    requirements={"sizes": ["20A"], "ratios": [5], "motor": {"peak_torque_Nm": 20, "rated_torque_Nm": 8}},
)

OUTDATED = "not available: inputs that it depends on were changed"
LOAD, LIFE = (BY_CODE[code].title for code in ("output_bearing_load", "output_bearing_life"))
PEAK, RMS = (f"{BY_CODE[code].title} [Nm]" for code in ("motor_peak_torque", "motor_rated_torque"))
WEIGHT, AMBIENT = f"{BY_CODE['weight'].title} [kg]", f"{BY_CODE['ambient_temperature'].title} [°C]"

Change = tuple[str, Any] | tuple[str, Any, int]
"""Values by the cell, or the column and row, that they are written into."""

WITH_SUPPLEMENT: dict[str, tuple[list[Change], set[str]]] = {
    "as saved": ([], set()),
    "heavier load": ([("F_R", 1e6)], {LOAD, LIFE}),
    "lighter load": ([("F_R", 1)], {LOAD, LIFE}),
    "load of a phase": ([("axial_N", 1e5, 1)], {LOAD, LIFE}),
    "load coefficient": ([("f_w", 3)], {LOAD, LIFE}),
    "speed": ([("speed_rpm", 90, 1)], {LIFE, PEAK, RMS}),
    "longer phase": ([("duration_s", 90)], {LIFE, PEAK, RMS}),
    "torque": ([("torque_Nm", 90)], {PEAK, RMS}),
    "RMS of a phase": ([("rms_torque_Nm", 0)], {PEAK, RMS}),
    "efficiency": ([("eta", 1)], {PEAK, RMS}),
    "life of the bearing": ([("L_b", 1)], set()),
    "other requirement": ([("m_req", 100)], set()),
}
"""Changes of a selection with figures of a supplement, and the checks that are then not rated."""

WITHOUT_CATALOGUE: dict[str, tuple[Json, list[Change], set[str]]] = {
    "weight that is not asked for": (worked_example(), [("torque_Nm", 39)], set()),
    "weight that was not asked for": (worked_example(), [("m_req", 100)], {WEIGHT}),
    "temperature that was not asked for": (worked_example(), [("t_amb", 20)], {AMBIENT}),
    "load that there was not": (worked_example(), [("F_R", 1)], {LOAD, LIFE}),
    "other weight": (EVERYTHING, [("m_req", 1e-3)], {WEIGHT}),
    "other temperature": (EVERYTHING, [("t_amb", 500)], {AMBIENT}),
    "other torque": (EVERYTHING, [("torque_Nm", 39)], set()),
    "other load": (EVERYTHING, [("F_A", 1e5)], {LOAD, LIFE}),
}
"""Likewise, of selections whose catalogue is not at hand."""


def checks(book: Workbook) -> dict[str, tuple[Any, ...]]:
    """Demand, limit, utilisation and verdict of each check of the chosen gear, among the other rows of the sheet."""
    return {str(row[0]): row[2:6] for row in book["Selection"].iter_rows(values_only=True) if row[0]}


def not_rated(book: Workbook) -> set[str]:
    """Checks of the chosen gear that are not rated."""
    return {title for title, row in checks(book).items() if row[3] == "not rated"}


def aged(case: Json, catalogue: Catalogue) -> Workbook:
    """The workbook of a selection whose catalogue is not at hand."""
    export = replace(typed_export_of(case, catalogue), catalogue=None)
    return openpyxl.load_workbook(BytesIO(sheets.workbook(export, language("en"))))


def changed(book: Workbook, cells: list[Change]) -> Workbook:
    """A workbook with other values in its cells."""
    for change in cells:
        put(book, *change)
    return book


def assert_not_rated(book: Workbook, titles: set[str], name: str) -> None:
    """Those checks of the chosen gear alone are not rated, and no gear is suitable then."""
    assert not_rated(book) == titles, name
    listed = candidates(book)
    assert (listed[got(book, "gear")]["Verdict"] in ("unrated", "unsuitable")) == bool(titles), name
    assert not titles or "suitable" not in {row["Verdict"] for row in listed.values()}, name


def test_digitised_loads_and_torques_by_a_curve_are_not_rated_once_inputs_behind_them_change(
    supplemented: Supplement, recalculate: Recalculate
) -> None:
    supplied = supplemented(bearing_envelopes=DIGITISED, efficiency=CURVE)
    books = {name: changed(opened(SUPPLIED, supplied), cells) for name, (cells, _) in WITH_SUPPLEMENT.items()}
    fresh = recalculate(books)
    assert_agrees(fresh["as saved"], answer(SUPPLIED, supplied))
    for name, book in fresh.items():
        unknown = WITH_SUPPLEMENT[name][1]
        assert_not_rated(book, unknown, name)
        for cell, title in {"P_max": LOAD, "P_m": LIFE, "T_mot_peak": PEAK, "T_mot_rms": RMS}.items():
            assert (beside(book, cell) == OUTDATED) == (title in unknown), (name, cell)
            assert (not got(book, cell)) == (title in unknown), (name, cell)


def test_a_check_by_figures_of_a_lost_catalogue_is_not_rated_once_inputs_behind_it_change(
    catalogue: Catalogue, recalculate: Recalculate
) -> None:
    books = {name: changed(aged(case, catalogue), cells) for name, (case, cells, _) in WITHOUT_CATALOGUE.items()}
    for name, book in recalculate(books).items():
        assert_not_rated(book, WITHOUT_CATALOGUE[name][2], name)


def test_without_its_catalogue_a_listed_motor_is_not_rated_once_the_duty_cycle_changes(
    supplemented: Supplement, recalculate: Recalculate
) -> None:
    supplied = supplemented(motors=MOTORS)
    cells: dict[str, list[Change]] = {
        "speed": [("speed_rpm", 1)],
        "torque": [("torque_Nm", 1)],
        "inertia": [("J_L", 0.2)],
        "saved": [],
    }
    books = {name: changed(aged(LISTED, supplied), cell) for name, cell in cells.items()}
    assert {name: not_rated(book) for name, book in recalculate(books).items()} == {
        "speed": {"Motor speed [rpm]", "Motor rated speed [rpm]"},
        "torque": {PEAK, RMS},
        "inertia": {BY_CODE["inertia_ratio"].title},
        "saved": set(),
    }


@pytest.mark.parametrize(
    ("name", "inputs"),
    [
        ("P_max", {"radial_used", "axial_used", "radial_N", "axial_N", "F_R", "F_A", "f_w", "model"}),
        ("T_mot_peak", {"torque_Nm", "peak_torque_Nm", "eta"}),
        ("weight", {"m_req"}),
        ("inertia_ratio", {"J_L", "J_m", "r_J"}),
    ],
)
def test_inputs_behind_a_figure(name: str, inputs: set[str]) -> None:
    """By hand: of what the equation of the bearing's load and that of the motor's peak take, the ratings left out."""
    assert inputs_behind(name) == inputs
