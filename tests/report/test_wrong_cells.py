"""The workbook with cells that the service would refuse: none is rated, each says what would be right."""

from typing import Any

import pytest
from openpyxl.workbook import Workbook

from hpn.catalogue import Catalogue
from tests.build import Json, cycle, phase, worked_example
from tests.report.cases import EVERYTHING
from tests.report.conftest import Recalculate
from tests.report.test_workbook import LOADED, beside, candidates, got, opened, put

STOPPED = worked_example(emergency_stop={"torque_Nm": 100, "count": 10})
VARYING = cycle(phase(40, 100, 1, peak_torque_Nm=45, peak_speed_rpm=120, rms_torque_Nm=41))
BENEATH = 3 + 20

WRONG: dict[str, tuple[Json, list[tuple[Any, ...]], str]] = {
    "stop torque as text": (STOPPED, [("T_k", "200 Nm")], "must be a number from −1 000 000 to 1 000 000"),
    "stop torque that is too large": (STOPPED, [("T_k", 1e7)], "must be a number from −1 000 000 to 1 000 000"),
    "count without its torque": (STOPPED, [("T_k", None)], "must be a number from −1 000 000 to 1 000 000"),
    "half a stop": (STOPPED, [("N_k", 2.5)], "must be a whole number from 0 to 1·10¹⁵"),
    "negative count": (STOPPED, [("N_k", -1)], "must be a whole number from 0 to 1·10¹⁵"),
    "radial load as text": (LOADED, [("F_R", "5000 N")], "must be a number from −1 000 000 000 to 1 000 000 000"),
    "load coefficient with a comma": (LOADED, [("f_w", "1,5")], "must be a number from 1 to 3"),
    "load coefficient below 1": (LOADED, [("f_w", 0.5)], "must be a number from 1 to 3"),
    "no load coefficient": (LOADED, [("f_w", None)], "must be a number from 1 to 3"),
    "no bearing life": (LOADED, [("L_b", None)], "must be a number above 0, at most 1 000 000 000"),
    "basis in words": (LOADED, [("life_basis", "L10 (90 %)")], "must be one of L50, L10"),
    "unknown model": (LOADED, [("model", "foo")], "must be one of linear, iso281"),
    "model that no formula has": (LOADED, [("model", "digitised")], "must be one of linear, iso281"),
    "no utilisation": (STOPPED, [("u", None)], "must be a number above 0, at most 1"),
    "utilisation of 200": (STOPPED, [("u", 2)], "must be a number above 0, at most 1"),
    "efficiency 0": (
        worked_example(requirements={"efficiency": 0.9, "motor": {"peak_torque_Nm": 1000}}),
        [("eta", 0)],
        "must be a number above 0, at most 1",
    ),
    "error in a cell": (STOPPED, [("pause_s", "=1/0")], "must be a number from 0 to 1 000 000 000"),
    "negative duration": (STOPPED, [("duration_s", -3)], ""),
    "duration as text": (STOPPED, [("duration_s", "3 s", 1)], ""),
    "row without a duration": (STOPPED, [("torque_Nm", 400, 3), ("speed_rpm", 100, 3)], ""),
    "row without a torque": (STOPPED, [("speed_rpm", 100, 3), ("duration_s", 1, 3)], ""),
    "load without a phase": (LOADED, [("radial_N", 100, 5)], ""),
    "torque that is too large": (STOPPED, [("torque_Nm", -2e6)], ""),
    "torque above its peak": (VARYING, [("torque_Nm", 140)], ""),
    "speed above its peak": (VARYING, [("speed_rpm", -140)], ""),
    "peak speed at rest": (VARYING, [("speed_rpm", 0)], ""),
    "RMS above the peak": (VARYING, [("rms_torque_Nm", 46)], ""),
    "no speed at all": (cycle(phase(0, 100)), [("speed_rpm", 0)], ""),
    "phase beneath the last row": (
        STOPPED,
        [("torque_Nm", 400, BENEATH), ("speed_rpm", 100, BENEATH), ("duration_s", 1, BENEATH)],
        "",
    ),
}
"""Saved application, values by cell (and row of a block), and the remark in the row of the input then."""

RIGHT: dict[str, tuple[Json, list[tuple[Any, ...]]]] = {
    "ends of the bounds": (LOADED, [("f_w", 3), ("u", 1), ("L_b", 1e9), ("pause_s", 0), ("T_k", -1e6), ("N_k", 0)]),
    "nothing that may be left out": (EVERYTHING, [(name, None) for name in ("T_k", "N_k", "F_R", "eta", "pause_s")]),
    "peaks as large as the phase": (VARYING, [("peak_torque_Nm", 40), ("peak_speed_rpm", 100), ("rms_torque_Nm", 40)]),
    "phase taken out": (STOPPED, [(name, None, 1) for name in ("torque_Nm", "speed_rpm", "duration_s")]),
}  # fmt: skip

WORDS = {
    "en": ("Candidates", "Selection", "unrated", "not rated", "passes"),
    "de": ("Kandidaten", "Auswahl", "nicht bewertet", "nicht bewertet", "erfüllt"),
}


def changed(case: Json, cells: list[tuple[Any, ...]], catalogue: Catalogue, code: str = "en") -> Workbook:
    """The workbook of a case with other values in its cells."""
    book = opened(case, catalogue, code=code)
    for cell, value, *row in cells:
        put(book, cell, value, *row)
    return book


@pytest.mark.parametrize("code", ["en", "de"])
def test_no_gear_is_rated_while_an_input_is_wrong(code: str, catalogue: Catalogue, recalculate: Recalculate) -> None:
    listed, overview, unrated, not_rated, passes = WORDS[code]
    books = {f"{name} {code}": changed(*WRONG[name][:2], catalogue, code) for name in WRONG}
    for name, fresh in recalculate(books).items():
        assert got(fresh, "wrong_inputs") > 0, name
        gears = [
            row for row in fresh[listed].iter_rows(min_row=2, values_only=True) if row[0] in catalogue.by_designation
        ]
        assert {row[1] for row in gears} == {unrated}, name
        checks = {row[5] for row in fresh[overview].iter_rows(values_only=True)}
        assert not_rated in checks and passes not in checks, name
        assert beside(fresh, "wrong_inputs"), name


def test_a_wrong_input_says_what_would_be_right(catalogue: Catalogue, recalculate: Recalculate) -> None:
    books = {name: changed(*WRONG[name][:2], catalogue) for name in WRONG if WRONG[name][2]}
    for name, fresh in recalculate(books).items():
        _, [(cell, *_)], said = WRONG[name]
        assert _remark(fresh, cell).replace("\N{NARROW NO-BREAK SPACE}", " ") == said, name
        assert got(fresh, "wrong_inputs") == 1, name


def test_right_inputs_are_not_called_wrong(catalogue: Catalogue, recalculate: Recalculate) -> None:
    for name, fresh in recalculate({name: changed(*RIGHT[name], catalogue) for name in RIGHT}).items():
        assert got(fresh, "wrong_inputs") == 0, name
        assert not beside(fresh, "wrong_inputs"), name
        assert {row["Verdict"] for row in candidates(fresh).values()} != {"unrated"}, name


def test_a_row_inserted_without_its_formulas_does_not_pass(catalogue: Catalogue, recalculate: Recalculate) -> None:
    book = opened(LOADED, catalogue)
    for column in ("radial_used", "axial_used"):
        put(book, column, None, 1)  # what a program leaves in the columns of formulas of a row that it inserts
    assert got(recalculate({"inserted": book})["inserted"], "wrong_inputs") == 1


def test_wrong_cells_are_red_and_refused_as_they_are_typed(catalogue: Catalogue) -> None:
    book = opened(LOADED, catalogue)
    inputs = {cell for name in ("T_k", "f_w", "life_basis", "model", "u") for cell in _cells(book, name)}
    phases = {cell for name in ("torque_Nm", "duration_s", "rms_torque_Nm") for cell in _cells(book, name)}
    sheet, cells = book["Inputs"], inputs | phases
    assert cells <= {str(rule.sqref) for rule in sheet.data_validations.dataValidation}
    assert cells <= {str(block.sqref) for block in sheet.conditional_formatting}
    told = {rule.error for rule in sheet.data_validations.dataValidation}
    assert "must be a number from 0 to 1 000 000; at most the peak torque".replace(" 000", "\u202f000") in told


def _remark(book: Workbook, name: str) -> str:
    """Remark at the end of an input's row."""
    sheet, cell = next(iter(book.defined_names[name].destinations))
    return str(book[sheet][cell.replace("$", "")].offset(column=7).value)


def _cells(book: Workbook, name: str) -> list[str]:
    return [cells.replace("$", "") for _, cells in book.defined_names[name].destinations]
