"""Workbooks as tables: cells are read as they are shown, and no file, however made, causes a server error."""

import io
import re
import time
import zipfile
from collections.abc import Callable, Sequence
from datetime import date, datetime, timedelta
from datetime import time as clock
from html import unescape
from typing import Any
from urllib.parse import parse_qs, urlsplit

import openpyxl
import pytest
from openpyxl.workbook import Workbook
from starlette.testclient import TestClient

from hpn.tables.workbooks import MAXIMUM_BYTES, sheets_of
from tests.web.paste import ASKED

Cell = str | float | date | clock | timedelta | bool | None | tuple[Any, str]
HEADER: list[Cell] = ["Drehmoment [Nm]", "Drehzahl [1/min]", "Dauer [s]"]


def book(*rows: Sequence[Cell], name: str = "Tabelle1", into: Workbook | None = None) -> Workbook:
    """Workbook with a sheet of these rows; a pair is a value with its number format."""
    output = into or Workbook()
    sheet = output.create_sheet(name) if into or output.active is None else output.active
    sheet.title = name
    for k, row in enumerate(rows, start=1):
        for j, cell in enumerate(row, start=1):
            value, style = cell if isinstance(cell, tuple) else (cell, None)
            written = sheet.cell(k, j, value)
            written.number_format = style or written.number_format
    return output


def content(made: Workbook) -> bytes:
    out = io.BytesIO()
    made.save(out)
    return out.getvalue()


def answer(client: TestClient, file: bytes, **fields: str) -> Any:
    data = {"take": "replace", **fields}
    return client.post("/paste", data=data, files={"file": ("zyklus.xlsx", file)}, headers={"HX-Request": "true"})


def taken(reply: Any) -> list[tuple[str, ...]]:
    inputs = parse_qs(urlsplit(reply.headers["location"]).query, keep_blank_values=True)
    return list(zip(*(inputs[name] for name in ("T", "n", "t", "FRi", "FAi") if name in inputs), strict=True))


def said(reply: Any) -> str:
    return unescape(" ".join(ASKED.findall(reply.text)[0]))


@pytest.mark.parametrize(
    ("rows", "phases"),
    [
        ([HEADER, [40.5, 1250, 0.3]], [("40.5", "1250", "0.3")]),
        ([[40.5, 1250, 0.3]], [("40.5", "1250", "0.3")]),
        ([[1.234, 250, 3]], [("1.234", "250", "3")]),  # a number is unambiguous, unlike a text
        (
            [HEADER, [(1234.5, "#,##0.00"), (0.25, "0.000"), (0.123456789012345, "0.0")]],
            [("1234.5", "0.25", "0.123456789012345")],
        ),
        ([["T", "n", "t"], [(0.04, '0.00" kNm"'), (360, '0"°/s"'), (300, '0\\ "ms"')]], [("40", "60", "0.3")]),
        ([["T", "n", "Dauer"], [(40_000, '0.0," kNm"'), 250, 0.3]], [("40000", "250", "0.3")]),
        ([["T", "n", "t"], [(0.04, "0.000 [$kNm]"), (360, "0°/[$s]"), (3, "0 [$min-407]")]], [("40", "60", "180")]),
        ([["T", "n", "t"], [(-0.04, "_-* 0.00 [$kNm]_-;\\(0.00 [$kNm]\\)"), 250, 3]], [("-40", "250", "3")]),
        ([["T", "n", "t"], [40, 250, (90, '[<60]0" s";0" min"')]], [("40", "250", "5400")]),
        ([["T", "n", "t"], [40, 250, (9, '[<60]0" s";0" min"')]], [("40", "250", "9")]),
        ([["T", "n", "t"], [(-0.04, '0" Nm";-0.00" kNm"'), (0, '0" 1/min";;"-"??'), 3]], [("-40", "0", "3")]),
        ([["T", "n", "Dauer"], [40, 250, clock(0, 0, 3)]], [("40", "250", "3")]),
        ([HEADER, [40, 250, timedelta(hours=30, seconds=0.5)]], [("40", "250", "108000.5")]),
        ([["T", "n", "Dauer"], ["40,5", "250", "0,3"]], [("40.5", "250", "0.3")]),
        ([["T", "n", "Dauer"], ["40,5 Nm", 250, 0.3]], [("40.5", "250", "0.3")]),
        (
            [["Zyklus 7"], [], ["Nr.", *HEADER, "Text"], [1, 40, 250, 0.3, "auf"], [2, 20, 250, 0.2, "ab"]],
            [("40", "250", "0.3"), ("20", "250", "0.2")],
        ),
        (
            [["Drehmoment", "kNm", 0.04, 0.03], ["Drehzahl", "U/s", 4, 5], ["Dauer", "ms", 300, 200]],
            [("40", "240", "0.3"), ("30", "300", "0.2")],
        ),
        ([[None], [None, *HEADER], [None, 40, 250, 0.3]], [("40", "250", "0.3")]),
        ([HEADER, [40, 250, 3], [20, 250, 0.2], ["Summe", None, 3.2]], [("40", "250", "3"), ("20", "250", "0.2")]),
    ],
)
def test_workbook_becomes_what_its_cells_show(client: TestClient, rows: Any, phases: list[tuple[str, ...]]) -> None:
    assert taken(answer(client, content(book(*rows)))) == phases


@pytest.mark.parametrize(
    ("cells", "words"),
    [
        ([(0.4, "0%"), 250, 3], "40 % is not a number"),
        ([(40, "0 [$€-407]"), 250, "x"], "x is not a number"),
        ([40, 250, (clock(0, 3), "h:mm")], "0:03 may be hours or minutes; write 0:03:00 or 0:00:03"),
        ([40, 250, date(2026, 3, 1)], "is not a number"),
        ([True, 250, 3], "True is not a number"),
        ([40, "#DIV/0!", 3], "#DIV/0! is not a number"),
        (["=A1*2", 250, 3], "row 2: =A1*2 has no calculated value"),
        (["=A1*2", "=B1", "=C1"], "row 2: =A1*2 has no calculated value"),
        (["1,5", "2.5", 3], "different decimal marks"),
    ],
)
def test_cell_that_shows_no_number_is_refused(client: TestClient, cells: list[Cell], words: str) -> None:
    reply = answer(client, content(book(["T", "n", "Dauer", "FR"], [*cells, 1], [40, 250, 3, 1])))
    assert reply.status_code == 422
    assert words in said(reply)


@pytest.mark.parametrize("number_format", ["0.0,", "#,##0,", "0.00,;-0.00,"])
def test_number_that_a_format_shows_in_thousands_is_asked(client: TestClient, number_format: str) -> None:
    file = content(book(["T", "n", "Dauer"], [(40_250, number_format), 250, 3]))

    question = answer(client, file)
    assert question.status_code == 200
    assert "The workbook shows 40.25 where the cell holds 40250. Which number counts?" in said(question)
    of = re.findall(r'name="of" value="(\w+)"', question.text)[0]
    assert taken(answer(client, file, of=of, scales="shown")) == [("40.25", "250", "3")]
    assert taken(answer(client, file, of=of, scales="held")) == [("40250", "250", "3")]


def test_scaled_number_of_a_column_that_is_not_read_asks_nothing(client: TestClient) -> None:
    file = content(book(["T", "n", "Dauer", "Nr."], [40, 250, 3, (1000, "0,")], [20, 250, 1, (2000, "0,")]))

    assert taken(answer(client, file)) == [("40", "250", "3"), ("20", "250", "1")]


def test_dates_of_a_workbook_are_points_in_time(client: TestClient) -> None:
    rows: list[list[Cell]] = [[40, 250, datetime(2026, 3, 1, 8, 0, second, 500_000)] for second in (0, 2, 5)]
    file = content(book(["T", "n", "Zeitstempel"], *rows))
    of = re.findall(r'name="of" value="(\w+)"', answer(client, file).text)[0]

    assert taken(answer(client, file, of=of, times="starts")) == [("40", "250", "2"), ("40", "250", "3")]


def test_unit_of_a_format_that_is_none_of_its_column_is_refused(client: TestClient) -> None:
    reply = answer(client, content(book(["T", "n", "Dauer"], [(40, '0" €"'), 250, 3])))
    assert reply.status_code == 422
    assert "40 €: this unit does not fit" in said(reply)


@pytest.mark.parametrize(
    ("cell", "text"),
    [
        ((40, '0.0 "Nm" "max"'), "40 Nm max"),
        ((40, '[<60]0" Nm";0" kNm";0" mNm"'), '40 [<60]0" Nm";0" kNm";0" mNm"'),
        ((1500, "[<1000]0;0.0,"), "1500 [<1000]0;0.0,"),
        ((40, "0 [$€-407]"), "40 €"),
        (clock(0, 0, 3), "3 s"),
    ],
)
def test_a_format_that_may_mean_something_else_is_refused(client: TestClient, cell: Cell, text: str) -> None:
    reply = answer(client, content(book(["T", "n", "Dauer"], [cell, 250, 3])))
    assert reply.status_code == 422
    assert f"{text}: this unit does not fit" in said(reply)


def test_time_of_a_cell_is_refused_under_another_unit(client: TestClient) -> None:
    reply = answer(client, content(book(["T", "n", "Dauer [min]"], [40, 250, clock(0, 3)])))
    assert reply.status_code == 422
    assert "180 s: this unit does not fit column “Dauer [min]”" in said(reply)


def test_load_of_a_formula_without_a_value_is_refused_and_a_result_without_characters_is_blank(
    client: TestClient,
) -> None:
    output = content(book([*HEADER, "FR [N]"], [40, 250, 0.3, "=500*2"]))
    assert "row 2: =500*2 has no calculated value; open and save" in said(answer(client, output))
    blank = parts(output, lambda name, old: old.replace(b'<c r="D2">', b'<c r="D2" t="str">') if name == SHEET else old)
    assert taken(answer(client, blank)) == [("40", "250", "0.3")]


@pytest.mark.parametrize(("cells", "row"), [("D2:D3", 3), ("D2:E2", 2), ("C3:D3", 3)])
@pytest.mark.parametrize("script", [True, False])
def test_number_that_is_merged_over_others_is_refused(client: TestClient, cells: str, row: int, script: bool) -> None:
    output = book([*HEADER, "FR [N]", "FA [N]"], [40, 250, 0.3, 1500, 1], [20, 250, 0.2, None, 1])
    output.worksheets[0].merge_cells(cells)
    book([*HEADER], [40, 250, 0.3], name="other", into=output)
    sheet, whole = {"sheet": "Tabelle1", "take": "replace"}, content(output)  # saving again changes its time
    headers = {"HX-Request": "true"} if script else {}
    response = client.post("/paste", files={"file": ("a.xlsx", whole)}, headers=headers)
    hidden = {name: unescape(value) for name, value in re.findall(r'name="(of|book)" value="([^"]*)"', response.text)}
    again = {"file": ("a.xlsx", whole if script else b"")}
    reply = client.post("/paste", data={**hidden, **sheet}, files=again, headers=headers)
    assert reply.status_code == 422
    assert f"row {row}: the cells {cells} are merged; write a number into each of them" in said(reply)


def test_row_of_a_table_may_be_several_rows_high(client: TestClient) -> None:
    output = book(HEADER, [40, 250, 0.3], [None, None, None], [20, 250, 0.2])
    for column in "ABC":
        output.worksheets[0].merge_cells(f"{column}2:{column}3")
    assert taken(answer(client, content(output))) == [("40", "250", "0.3"), ("20", "250", "0.2")]


def test_hidden_rows_and_columns_are_named(client: TestClient) -> None:
    output = book([*HEADER, "FR [N]"], *([40, 250, 3 - k / 10, 1500] for k in range(9)))
    for row in (3, 4, 7):
        output.worksheets[0].row_dimensions[row].hidden = True
    for column in ("D", "H"):
        output.worksheets[0].column_dimensions[column].hidden = True
    page_text = answer(client, content(output), take="").text
    assert "Rows that are hidden in the workbook are read, too: 3–4, 7." in page_text
    assert "Columns that are hidden in the workbook are read, too: D." in page_text


def test_row_far_below_is_no_less_read(client: TestClient) -> None:
    far = b"<row/>" * 20_000 + b"<row><c><v>20</v></c><c><v>250</v></c><c><v>0.2</v></c></row></sheetData>"
    file = parts(VALID, lambda name, old: old.replace(b"</sheetData>", far) if name == SHEET else old)
    assert taken(answer(client, file)) == [("40", "250", "0.3"), ("20", "250", "0.2")]


def test_text_with_two_readings_is_asked_in_a_workbook_too(client: TestClient) -> None:
    file = content(book(["T", "n", "Dauer"], ["1,234", 250, 0.5]))
    reply = answer(client, file)
    assert "Which is the decimal mark?" in said(reply)
    of = re.search(r'name="of" value="(\w+)"', reply.text)
    assert of
    assert taken(answer(client, file, of=of[1], decimal=",")) == [("1.234", "250", "0.5")]
    assert taken(answer(client, file, of=of[1], decimal=".")) == [("1234", "250", "0.5")]


def test_torque_merged_over_two_phases_is_refused(client: TestClient) -> None:
    output = book(HEADER, [40, 250, 0.3], [None, 500, 0.2])
    output.worksheets[0].merge_cells("A2:A3")
    reply = answer(client, content(output))
    assert reply.status_code == 422
    assert "row 3: the cells A2:A3 are merged; write a number into each of them" in said(reply)


def test_merged_title_and_heading_are_read(client: TestClient) -> None:
    output = book(
        ["Lastzyklus", None, None],
        ["Last", None, "Dauer"],
        ["Drehmoment [Nm]", "Drehzahl [1/min]", "[s]"],
        [40, 250, 0.3],
    )
    for cells in ("A1:C1", "A2:B2"):
        output.worksheets[0].merge_cells(cells)
    assert taken(answer(client, content(output))) == [("40", "250", "0.3")]


def test_name_merged_over_some_columns_is_part_of_their_names(client: TestClient) -> None:
    def merged(name: str, title: str) -> str:
        output = book(
            [title, None, None, None],
            [None, name, None, None],
            ["Dauer [s]", "Drehmoment [Nm]", "Drehzahl [1/min]", "Temperatur"],
            [0.3, 4, 2500, 20],
        )
        for cells in ("A1:D1", "B2:C2"):
            output.worksheets[0].merge_cells(cells)
        return said(answer(client, content(output)))

    assert "Motorwelle Drehmoment [Nm], Motorwelle Drehzahl [1/min]: named after the motor" in merged(
        "Motorwelle", "Test"
    )
    assert "What is column “Kanal 7 Drehmoment [Nm]”?" in merged("Kanal 7", "Test")
    assert "What is column “Temperatur”?" in merged("Abtrieb", "Test")  # under no name and not in the title


@pytest.mark.parametrize("script", [True, False])
def test_sheet_is_asked_for_where_several_have_cells(client: TestClient, script: bool) -> None:
    output = book(HEADER, [40, 250, 0.3], name="Achse 1")
    book(HEADER, [1.234, 500, 3], name="Achse 2", into=output)
    output.create_sheet("leer")
    output.create_sheet("versteckt").append([1, 2, 3])
    output["versteckt"].sheet_state = "hidden"
    headers = {"HX-Request": "true"} if script else {}
    file = content(output)
    response = client.post("/paste", files={"file": ("a.xlsx", file)}, headers=headers)
    assert re.findall(r"<option>(.*?)</option>", response.text) == ["Achse 1", "Achse 2"]
    assert "Replace phases" not in response.text
    hidden = {name: unescape(value) for name, value in re.findall(r'name="(of|book)" value="([^"]*)"', response.text)}
    again = {"file": ("a.xlsx", file)} if script else {"file": ("", b"")}  # without script the file is not sent again
    reply = client.post("/paste", data={**hidden, "sheet": "Achse 2", "take": "replace"}, files=again, headers=headers)
    assert taken(reply) == [("1.234", "500", "3")]
    assert ("book" in hidden) is not script


# --- Files that nobody means well with --------------------------------------------------------------------------------


def parts(file: bytes, change: Callable[[str, bytes], bytes]) -> bytes:
    """Workbook with changed parts."""
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(file)) as old, zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            new.writestr(name, change(name, old.read(name)))
    return out.getvalue()


VALID = content(book(HEADER, [40, 250, 0.3]))
SHEET = "xl/worksheets/sheet1.xml"
ENTITIES = (
    '<!DOCTYPE x [<!ENTITY a "'
    + "9" * 100
    + '">'
    + "".join(f'<!ENTITY {chr(98 + k)} "{f"&{chr(97 + k)};" * 10}">' for k in range(9))
    + "]>"
)
HOSTILE = {
    "zip bomb": parts(VALID, lambda name, old: b" " * (MAXIMUM_BYTES + 1) if name == SHEET else old),
    "entities": parts(
        VALID, lambda name, old: ENTITIES.encode() + old.replace(b"<v>40</v>", b"<v>&j;</v>") if name == SHEET else old
    ),
    "outer entity": parts(
        VALID,
        lambda name, old: (
            b'<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]>' + old.replace(b"<v>40<", b"<v>&a;<")
            if name == SHEET
            else old
        ),
    ),
    "no sheet": parts(VALID, lambda name, old: b"" if name == SHEET else old),
    "no workbook": parts(VALID, lambda name, old: b"<a/>" if name == "xl/workbook.xml" else old),
    "cells without end": parts(
        VALID, lambda name, old: old.replace(b"</row>", b"<c/>" * 1_500_000 + b"</row>") if name == SHEET else old
    ),
    "merged without end": parts(
        VALID,
        lambda name, old: (
            old.replace(b"</sheetData>", b"</sheetData><mergeCells>" + b'<mergeCell ref="A2:XFD9999"/>' * 90_000)
            if name == SHEET
            else old
        ),
    ),
    "a row without end": parts(VALID, lambda name, old: old.replace(b'r="2"', b'r="999999999"')),
    "only the first bytes": VALID[:200],
    "a zip of something else": parts(VALID, lambda name, old: b"x"),
    "before XLSX": b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + b"\0" * 500,
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_workbook_is_refused_in_reasonable_time(client: TestClient, name: str) -> None:
    start = time.process_time()
    reply = answer(client, HOSTILE[name])
    assert reply.status_code == 422
    assert 'class="error"' in reply.text
    assert "root:" not in reply.text
    assert time.process_time() - start < 20


@pytest.mark.parametrize(
    "carried", ["x", "[]", '{"a": 1}', '{"a": [1]}', '{"a": [[1]]}', '{"a": [[[]]]}', '{"a": [[["x"]]]}', "{}"]
)
def test_carried_cells_that_are_none_are_refused(client: TestClient, carried: str) -> None:
    assert client.post("/paste", data={"book": carried}).status_code == 422


def test_size_that_a_workbook_states_of_itself_is_not_believed() -> None:
    file = parts(VALID, lambda name, old: old.replace(b'ref="A1:C2"', b'ref="A1:A1"') if name == SHEET else old)
    assert sheets_of(file)["Tabelle1"].rows == [[*map(str, HEADER)], ["40", "250", "0.3"]]
    assert openpyxl.load_workbook(io.BytesIO(file), read_only=True).active is not None
