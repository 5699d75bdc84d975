"""Tables of axes in workbooks: formats, merged cells, formulas."""

import io
import zipfile
from typing import Any

import pytest
from openpyxl import Workbook

from hpn.links.symbols import AXIS_INPUTS
from hpn.tables.axes import read_axes
from hpn.tables.columns import Choices
from hpn.tables.table import Table
from hpn.tables.workbooks import sheets_of
from tests.web.axes import HEAD, WIRE, asked


def test_a_number_that_a_workbook_shows_in_thousands_is_asked() -> None:
    table = sheet_of("0.0", "0.9")
    assert table.choice("scales") is None
    book = Workbook()
    sheet: Any = book.active
    sheet.append(HEAD.split(";"))
    sheet.append(["A", 40_000, 250, 1])
    sheet["B2"].number_format = "0.0,"
    book.save(file := io.BytesIO())
    grid = next(iter(sheets_of(file.getvalue()).values())).grid()

    assert asked(read_axes(grid, AXIS_INPUTS, assumed=WIRE)) == [
        "The workbook shows 40 where the cell holds 40000. Which number counts?"
    ]
    for scales, torque in (("shown", 40), ("held", 40_000)):
        assert read_axes(grid, AXIS_INPUTS, Choices(scales=scales), WIRE).axes[0]["torque_Nm"] == [torque]


def sheet_of(format_: str, *values: str) -> Table:
    """Table of a workbook; its columns of weight (format 0.0) and efficiency (`format_`) hold the texts as numbers."""
    book = Workbook()
    sheet: Any = book.active
    sheet.append([*HEAD.split(";"), "m", "eta"])
    for place in range(len(values)):
        sheet.append(["ABC"[place], 1, 9, 1, 1000 + place, 1000 + place])
        sheet.cell(place + 2, 5).number_format = "0.0"
        sheet.cell(place + 2, 6).number_format = format_
    book.save(file := io.BytesIO())
    written = io.BytesIO()
    with zipfile.ZipFile(file) as before, zipfile.ZipFile(written, "w") as after:
        for name in before.namelist():
            text = before.read(name)
            for place, value in enumerate(values):
                text = text.replace(b"<v>%d</v>" % (1000 + place), b"<v>%b</v>" % value.encode())
            after.writestr(name, text)
    (read_,) = sheets_of(written.getvalue()).values()
    return read_axes(read_.grid(), AXIS_INPUTS, Choices(roles={4: "m", 5: "eta"}, units={4: "kg"}), WIRE)


HEADED = (*HEAD.split(";"), "Lebensdauer [h]")


def merged(*rows: tuple[object, ...], cells: str) -> Table:
    """Table of a workbook with merged cells."""
    book = Workbook()
    sheet: Any = book.active
    for row in (HEADED, *rows):
        sheet.append(row)
    sheet.merge_cells(cells)
    book.save(file := io.BytesIO())
    (read_,) = sheets_of(file.getvalue()).values()
    return read_axes(read_.grid(), AXIS_INPUTS, Choices(roles={4: "Lh"}), WIRE)


def test_merged_names_and_inputs_of_an_axis_count_for_its_rows() -> None:
    named = merged((7, 40, 250, 1, 20_000), (None, 32, 500, 3, None), (8, 1, 1, 1, 5), cells="A2:A3")
    lasting = merged((7, 40, 250, 1, 20_000), (7, 32, 500, 3, None), (8, 1, 1, 1, 5), cells="E2:E3")

    assert named.axes == lasting.axes
    assert [axis["requirements.life_h"] for axis in named.axes] == [20_000, 5]


@pytest.mark.parametrize(("cells", "field"), [("B2:B3", "torque_Nm"), ("E3:E4", "requirements.life_h")])
def test_a_number_that_is_merged_over_phases_or_axes_is_none_of_theirs(cells: str, field: str) -> None:
    axes = merged((7, 40, 250, 1, None), (7, None, 500, 3, 20_000), (8, 1, 1, 1, None), cells=cells).axes

    assert cells in str([axis.get(field) for axis in axes])


def test_a_formula_without_a_value_spoils_its_axis() -> None:
    axes = merged((7, "=20*2", 250, 1, None), (8, 1, 1, 1, None), cells="G1:G2").axes

    assert [axis["torque_Nm"] for axis in axes] == [["=20*2"], [1]]


def test_a_percentage_of_a_workbook_is_the_number_that_it_holds() -> None:
    axes = sheet_of("0%", "0.95", "1E-05").axes

    assert [axis["requirements.efficiency"] for axis in axes] == [0.95, 1e-5]


@pytest.mark.parametrize("format_", ["0%", "0.0"])
def test_an_infinite_number_of_a_workbook_spoils_its_axis_alone(format_: str) -> None:
    axes = sheet_of(format_, "1E+999", "-1E+999", "0.5").axes

    read_as = [(axis["requirements.weight_kg"], axis["requirements.efficiency"]) for axis in axes]
    assert read_as == [("inf", "inf"), ("-inf", "-inf"), (0.5, 0.5)]
