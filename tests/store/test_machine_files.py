"""Files of machines over REST: of the working copy, of a revision, of an axis, and of differences."""

from io import BytesIO

import openpyxl
import pyarrow.parquet as pq
import pytest
from pypdf import PdfReader
from starlette.testclient import TestClient

from hpn.fleet.columns import OF_MACHINE
from hpn.fleet.machine_axes import axis_of
from tests.build import worked_example
from tests.machines import COMMON, axis

ADDRESS = "/api/v1/machines"
AXES = [
    axis("Turret", worked_example()),
    axis("Open", {}, 3),
    axis("Slow", worked_example(requirements={"life_h": 9e4})),
]


@pytest.fixture
def place(client: TestClient) -> str:
    """Address of a machine with revision A, whose first axis was renamed since."""
    place = str(client.post(ADDRESS, json={"title": "Line", "common": COMMON, "axes": AXES}).headers["location"])
    assert client.post(f"{place}/revisions", json={"label": "A", "author": "KR"}).status_code == 201
    tag = client.get(f"{place}/axes/1").headers["etag"]
    assert client.patch(f"{place}/axes/1", json={"name": "Head"}, headers={"If-Match": tag}).status_code == 200
    return place


def text_of(client: TestClient, address: str) -> str:
    answer = client.get(address)
    assert answer.status_code == 200, answer.text
    return " ".join(page.extract_text() for page in PdfReader(BytesIO(answer.content)).pages).replace("\u200b", "")


def test_the_report_is_of_the_working_copy_or_of_a_revision(client: TestClient, place: str) -> None:
    now, frozen = text_of(client, f"{place}/report.pdf"), text_of(client, f"{place}/report.pdf?revision=a&lang=de")
    assert "Head" in now and "Changed since A" in now and "Turret" not in now
    assert "Turret" in frozen and "Revision A" in frozen and "KR" in frozen and "Achse" in frozen


def test_axes_with_pages_are_chosen_and_a_wrong_choice_is_refused(client: TestClient, place: str) -> None:
    assert "axis 3 of 3" not in text_of(client, f"{place}/report.pdf?axes=1,2")
    assert "nine digits" in text_of(client, f"{place}/report.pdf?axes=3&full=1")
    for query in ("axes=4", "axes=x", "axes=", "full=7", "lang=fr", f"axes={'1,' * 1500}1"):
        assert client.get(f"{place}/report.pdf?{query}").status_code == 422, query
    for query in ("revision=B", "revision=today"):
        assert client.get(f"{place}/report.pdf?{query}").status_code == 404


def test_gear_list_and_tables_have_every_axis(client: TestClient, place: str) -> None:
    book = openpyxl.load_workbook(BytesIO(client.get(f"{place}/gears.xlsx").content))
    assert [row[1] for row in book["Axes"].iter_rows(min_row=2, values_only=True)] == ["Head", "Open", "Slow"]
    rows = pq.read_table(BytesIO(client.get(f"{place}/axes.parquet?revision=A").content)).to_pylist()
    assert [axis_of(row).name for row in rows] == ["Turret", "Open", "Slow"]
    head, *lines = client.get(f"{place}/axes.csv").text.splitlines()
    assert len(lines) == 3 and '"axis_name"' in head and set(OF_MACHINE) & set(rows[0])


def test_an_axis_has_files_of_its_own_and_an_open_one_has_none(client: TestClient, place: str) -> None:
    assert "Head" in text_of(client, f"{place}/axes/1/report.pdf")
    assert client.get(f"{place}/axes/3/submodel.aasx").content.startswith(b"PK")
    assert client.get(f"{place}/axes/2/report.pdf").status_code == 409
    assert client.get(f"{place}/axes/9/report.pdf").status_code == 404


def test_differences_are_files_too(client: TestClient, place: str) -> None:
    assert "Turret" in text_of(client, f"{place}/differences.pdf?from=A&to=now")
    book = openpyxl.load_workbook(BytesIO(client.get(f"{place}/differences.xlsx?from=A&to=now").content))
    assert [cell.value for cell in book["Inputs"][2]][:6] == [1, "Head", "Name", None, "Turret", "Head"]
    assert "Nothing differs" in text_of(client, f"{place}/differences.pdf?from=now&to=today")
    assert client.get(f"{place}/differences.pdf?from=today&to=today").status_code == 422
    assert client.get(f"{place}/differences.xlsx?from=A&to=B").status_code == 404
