"""Spreadsheets as LibreOffice saves them in German and English: CSV as shown, and XLSX; each gives the same cycle."""

from pathlib import Path

import pytest
from openpyxl.workbook import Workbook
from starlette.testclient import TestClient

from hpn.web.app import create_app
from tests.report.conftest import Convert

LANGUAGES = {"german": "407", "english": "409"}
HEADINGS = {
    "german": ("Nr.", "Drehmoment [Nm]", "Drehzahl [1/min]", "Dauer [s]", "Bemerkung"),
    "english": ("No.", "Torque (Nm)", "Speed (rpm)", "Duration (s)", "Remark"),
}
PHASES = [(1234.5, 1250.0, 0.25), (-32.0, 500.0, 3.0), (20.125, 2500.0, 0.5)]
LOCATION = "/?T=1234.50&n=1250&t=0.25&T=-32.00&n=500&t=3.00&T=20.13&n=2500&t=0.50"
CSV = "csv:Text - txt - csv (StarCalc):{mark},34,76,1,,0,false,true"


@pytest.fixture(scope="module")
def books() -> dict[str, Workbook]:
    return {name: _book(name) for name in LANGUAGES}


def _book(name: str) -> Workbook:
    book = Workbook()
    sheet = book.create_sheet("Lastzyklus, Achse 7", 0)
    sheet.append(["Lastzyklus, Achse 7"])
    sheet.append(HEADINGS[name])
    for number, phase in enumerate(PHASES, start=1):
        sheet.append([number, *phase, "Übergang"])
        for cell, places in zip(sheet[sheet.max_row][1:4], ("#,##0.00", "#,##0", "0.00"), strict=True):
            cell.number_format = f"[$-{LANGUAGES[name]}]{places}"
    sheet.append(["Summe" if name == "german" else "Total", None, None, 3.75])
    return book


def taken(path: Path) -> str:
    """Address to which a file of a duty cycle redirects."""
    client = TestClient(create_app(), follow_redirects=False)
    reply = client.post("/paste", data={"take": "replace"}, files={"file": (path.name, path.read_bytes())})
    assert reply.status_code == 303, reply.text
    return str(reply.headers["location"])


def test_csv_as_shown_is_read_in_both_languages(convert: Convert, books: dict[str, Workbook]) -> None:
    files = convert(books, CSV.format(mark=44))  # commas between the columns, so that German numbers stand in quotes
    assert '"1.234,50"' in files["german"].read_text() and '"1,234.50"' in files["english"].read_text()
    assert {name: taken(path) for name, path in files.items()} == dict.fromkeys(LANGUAGES, LOCATION)


@pytest.mark.soak
@pytest.mark.parametrize("mark", [59, 9], ids=["semicolons", "tabs"])
def test_csv_by_other_marks_is_read_in_both_languages(convert: Convert, books: dict[str, Workbook], mark: int) -> None:
    files = convert(books, CSV.format(mark=mark))
    assert {name: taken(path) for name, path in files.items()} == dict.fromkeys(LANGUAGES, LOCATION)


@pytest.mark.soak
def test_workbook_that_libreoffice_saved_keeps_every_digit(convert: Convert, books: dict[str, Workbook]) -> None:
    files = convert(books, "xlsx")
    exact = "/?T=1234.5&n=1250&t=0.25&T=-32&n=500&t=3&T=20.125&n=2500&t=0.5"
    assert {name: taken(path) for name, path in files.items()} == dict.fromkeys(LANGUAGES, exact)
