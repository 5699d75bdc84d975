"""The workbook in the reader's units: it computes in those of the wire, and converts by formula."""

from io import BytesIO
from typing import Any

import openpyxl
import pytest

from hpn.catalogue import Catalogue
from hpn.files.export import DIGITS
from hpn.files.workbook.workbook import workbook
from hpn.words.reader import Reader
from hpn.words.units import PRESETS
from tests.report.cases import EVERYTHING, language, typed_export_of

AMERICAN = Reader("en", PRESETS["US"], DIGITS)
LETTER, A4 = 1, 9


@pytest.fixture(scope="module")
def files(catalogue: Catalogue) -> tuple[bytes, bytes]:
    """A workbook for a reader of SI units, and one for a reader of US units."""
    export = typed_export_of(EVERYTHING, catalogue)
    return workbook(export, language("en")), workbook(export, AMERICAN)


def sheets(file: bytes, *, values: bool = False) -> list[Any]:
    """Sheets of a workbook, with formulas or with the values that were saved."""
    return openpyxl.load_workbook(BytesIO(file), data_only=values).worksheets


def test_computed_figures_are_the_same_for_every_reader(files: tuple[bytes, bytes]) -> None:
    for own, other in zip(*map(sheets, files), strict=True):
        notes = [row[0].row for row in own.iter_rows() if row[0].value == "Assumptions and notes"]
        for row in own.iter_rows(max_row=notes[0] if notes else None):
            for cell in row:
                assert cell.value in (None, other[cell.coordinate].value), (own.title, cell.coordinate)
        assert (own.page_setup.paperSize, other.page_setup.paperSize) == (A4, LETTER)


def test_figures_stand_beside_in_the_readers_units(files: tuple[bytes, bytes]) -> None:
    formulas, values = sheets(files[1]), sheets(files[1], values=True)
    rows = {row[0].value: (sheet, row) for sheet in (1, 0) for row in values[sheet].iter_rows()}
    for label, wire, shown, unit in (
        ("Average torque", 32.0210, 283.411, "lb·in"),
        ("Emergency-stop torque", 200, 1770.15, "lb·in"),
        ("Ambient temperature", 25, 77, "°F"),
        ("Weight", 2.6, 5.732, "lb"),
    ):
        sheet, row = rows[label]
        value, *_, own, symbol = row[2:7] if sheet == 0 else row[2:6]
        assert (value.value, own.value, symbol.value) == (pytest.approx(wire, 1e-4), pytest.approx(shown, 1e-4), unit)
        formula = formulas[sheet][own.coordinate].value
        assert formula.startswith(f"=IF(ISNUMBER({value.coordinate}),{value.coordinate}*")
    assert "Torque [lb·in]" in [cell.value for row in values[1].iter_rows() for cell in row]
    assert "T_N [lb·in]" in [cell.value for cell in values[2][1]]
