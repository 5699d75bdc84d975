"""The page of fleets without a browser: a table goes up, its columns are put right, and the result is kept."""

import csv
import io
import re
from html import unescape
from pathlib import Path

import openpyxl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.engine.selection import select
from hpn.links.writer import to_link
from hpn.web.columns import answer_in
from hpn.web.pages import machine_answers
from hpn.web.pages.answer_files import file_of
from hpn.words.reader import Reader
from hpn.words.wording import Sentence
from tests.fleet.page import GERMAN, HEAVY, HUB, fields_of, post
from tests.fleet.tables import row_of, write
from tests.state import state_of


def test_german_headings_are_read_and_can_be_put_right(client: TestClient) -> None:
    first = post(client, GERMAN.replace("Drehzahl [1/min]", "Wert").encode())
    assert "What is column “Wert”?" in unescape(first.text)
    german = client.post("/machines", data=fields_of(first.text), headers={"Accept-Language": "de"})
    assert "Was ist Spalte „Wert“?" in unescape(german.text)

    second = post(client, fields={**fields_of(first.text), "r3": "n", "u3": "rev_per_s"})

    assert "3 axes" in unescape(second.text) and 'name="size"' in second.text
    assert fields_of(second.text)["u3"] == "rev_per_s"


def test_a_button_skips_all_columns_that_nobody_knows(client: TestClient) -> None:
    first = post(client, b"Axis;Torque [Nm];Speed [rpm];Duration [s];Temp A;Temp B\nA;12,5;250;0,3;20;21\n")
    page = unescape(first.text)
    assert page.index("Skip 2 columns that were not recognised") < page.index("What is column “Temp A”?")

    skipped = post(client, fields={**fields_of(first.text), "rest": "skip"})

    assert "1 axis" in unescape(skipped.text) and 'name="rest"' not in skipped.text
    assert post(client, fields={**fields_of(skipped.text), "size": "1"}).status_code == 303


def test_a_machine_shows_each_axis_with_its_link(client: TestClient, machine: str, service: FastAPI) -> None:
    page = unescape(client.get(machine).text)

    applications = [Application.model_validate(HUB), Application.model_validate(HEAVY)]
    for number, (name, application) in enumerate(zip(("Hub Ä", "Band"), applications, strict=True), 1):
        assert f'<a href="{machine}/axes/{number}">{name}</a>' in page
        assert to_link(application) in unescape(client.get(f"{machine}/axes/{number}").text)
    assert f'<td class="gear">{select(applications[0], service.state.catalogue).selected}</td>' in page
    assert "No gear; nearest HPN-" in page
    weight = next(
        g.weight_kg for g in service.state.catalogue.gears if f'<td class="gear">{g.designation}</td>' in page
    )
    assert re.search(rf'Weight, all gears</p>\s*<p class="value">\s*<data class="quantity" value="{weight}">', page)
    assert re.search(r'Greifer</a>\s*</th>.*?class="reason"[^>]*>[^/]*/span> Torque in row 6 ', page, re.DOTALL)
    german = unescape(client.get(machine, headers={"Accept-Language": "de"}).text)
    assert re.search(
        r'class="reason"[^>]*>[^/]*/span> Drehmoment in Zeile 6 muss eine Zahl sein, z. B. 9.3, nicht "abc"\s*<', german
    )


@pytest.mark.parametrize(
    ("query", "axes"),
    [
        ("", ["Band", "Greifer", "Hub Ä"]),
        ("?sort=place", ["Hub Ä", "Band", "Greifer"]),
        ("?sort=axis", ["Band", "Greifer", "Hub Ä"]),
        ("?sort=-utilisation", ["Band", "Hub Ä", "Greifer"]),
        ("?sort=frequency", ["Hub Ä", "Band", "Greifer"]),
        ("?show=todo", ["Band", "Greifer"]),
        ("?show=changed", []),
        ("?search=HUB", ["Hub Ä"]),
        ("?search=hpn-", ["Band", "Hub Ä"]),
        ("?gear=HPN-11A-3", []),
        ("?sort=nothing&show=all&part=x", ["Band", "Greifer", "Hub Ä"]),
        ("?part=99", []),
    ],
)
def test_axes_are_sorted_and_chosen_by_the_address(
    client: TestClient, machine: str, query: str, axes: list[str]
) -> None:
    page = unescape(client.get(machine + query).text)

    rows = re.findall(
        r'<tr class="(?:suitable|unsuitable|open)[^>]*>.*?<th scope="row"[^>]*>\s*(?:<a [^>]*>)?([^<]*)',
        page,
        re.DOTALL,
    )
    assert [row.strip() for row in rows] == axes


WITH_RESERVE = """axis,torque_Nm,speed_rpm,duration_s,requirements.utilisation,requirements.sizes,requirements.ratios,\
requirements.weight_kg,emergency_stop.torque_Nm,emergency_stop.count
just over,64.0032,100,1,0.8,20A,5,,,
too heavy,20,100,1,0.8,20A,5,2.5,,
no stop,20,100,1,0.8,20A,5,,900,1
just within,63.9968,100,1,0.8,20A,5,,,
"""


def test_the_share_of_an_axis_is_told_from_what_its_governing_check_may_use(client: TestClient) -> None:
    """64.0032 of 80 Nm are 80.004 %; of the permitted 2.5 kg all may be used; a stop that is never allowed is worst."""
    first = post(client, WITH_RESERVE.encode())
    sized = post(client, fields={**fields_of(first.text), "size": "1"})
    page = re.sub(r"\s+", " ", client.get(sized.headers["location"]).text)
    rows = re.findall(r'<th scope="row" class="axis"> ?<a [^>]*>([^<]+)</a>(.*?)</tr>', page)
    by_name = {axis: re.findall(r'class="percent">([^<]*)|class="limit" x="([^"]*)"', row) for axis, row in rows}
    at_u, whole = ("", "53.33%"), ("", "66.67%")
    assert list(by_name.items()) == [
        ("no stop", []),
        ("too heavy", [whole, ("104 %", "")]),
        ("just over", [at_u, ("80.004 %", "")]),
        ("just within", [at_u, ("79.996 %", "")]),
    ]
    assert re.search(r'class="cell largest">.*?class="percent">79.996', page)


def test_files_hold_the_answers(client: TestClient, machine: str) -> None:
    parquet = pq.read_table(io.BytesIO(client.get(f"{machine}/axes.parquet").content)).to_pylist()
    text = list(csv.DictReader(io.StringIO(client.get(f"{machine}/axes.csv").content.decode())))
    sheet = openpyxl.load_workbook(io.BytesIO(client.get(f"{machine}/axes.xlsx").content)).active

    assert [row["axis"] for row in parquet] == [row["axis"] for row in text] == ["Hub Ä", "Band", "Greifer"]
    assert sheet is not None
    header, *rows = sheet.iter_rows(values_only=True)
    assert [dict(zip(header, row, strict=True)) for row in rows] == parquet
    assert list(parquet[0])[-1] == "error" and parquet[0]["selected"] and parquet[1]["suitable"] == 0


HOSTILE = [
    "=1+1",
    "+cmd|' /C calc'!A0",
    "-2+3",
    "@SUM(A1)",
    "\t=1",
    "\r=1",
    "-7",
    "+1.5e3",
    "plain",
    "a=1",
    "x" * 1_000,  # as many characters as an axis may have
]


def test_no_cell_of_the_file_for_excel_begins_a_formula_and_the_workbook_comes_first(
    client: TestClient, tmp_path: Path
) -> None:
    table = write(tmp_path / "axes.parquet", [row_of(name, HUB) for name in HOSTILE]).read_bytes()
    place = post(client, table).headers["location"]

    csv_rows = list(csv.reader(io.StringIO(client.get(f"{place}/axes.csv").content.decode(), newline="")))
    sheet = openpyxl.load_workbook(io.BytesIO(client.get(f"{place}/axes.xlsx").content)).active
    typed = pq.read_table(io.BytesIO(client.get(f"{place}/axes.parquet").content))
    rest = client.post("/api/v1/fleet", content=table, headers={"Content-Type": "application/vnd.apache.parquet"})

    harmless = [f"'{name}" for name in HOSTILE[:6]] + HOSTILE[6:]
    assert [row[0] for row in csv_rows[1:]] == harmless
    assert sheet is not None
    cells = [row[0] for row in sheet.iter_rows(min_row=2)]
    assert {cell.data_type for cell in cells} == {"s"}
    assert [str(cell.value).replace("_x000D_", "\r") for cell in cells] == HOSTILE
    assert typed["axis"].to_pylist() == pq.read_table(io.BytesIO(rest.content))["axis"].to_pylist() == HOSTILE
    assert re.findall(r'href="[^"]*/axes\.(\w+)"', client.get(place).text) == ["xlsx", "csv", "parquet"]


def test_a_name_of_a_machine_that_was_saved_before_names_had_a_bound_is_cut_in_the_workbook_alone(
    service: FastAPI, client: TestClient, machine: str
) -> None:
    assert client.portal is not None
    saved = client.portal.call(service.state.store.find_machine, machine.rpartition("/")[2])
    table = machine_answers.answers_of(saved).slice(0, 1)
    long = table.set_column(0, "axis", pa.array(["x" * 40_000]))

    book, typed = (file_of(long, saved.created, suffix, Reader("en")) for suffix in ("xlsx", "parquet"))

    sheet = openpyxl.load_workbook(io.BytesIO(book)).active
    assert sheet is not None
    assert sheet["A2"].value == "x" * 32_766 + "…"  # no cell of XLSX holds more
    assert pq.read_table(io.BytesIO(typed))["axis"].to_pylist() == ["x" * 40_000]


def test_files_of_a_machine_are_made_in_the_process_beside_the_service(client: TestClient, machine: str) -> None:
    pool = state_of(client).pools["exports"]
    pool.beside.close()

    for suffix in ("xlsx", "csv", "parquet"):
        assert client.get(f"{machine}/axes.{suffix}").status_code == 200
        assert pool.beside._process is not None and pool.beside._process.poll() is None
        pool.beside.close()


def test_reasons_of_a_file_for_people_are_in_the_readers_language(client: TestClient, machine: str) -> None:
    def errors(language: str) -> dict[str, list[str | None]]:
        files = {
            suffix: client.get(f"{machine}/axes.{suffix}", headers={"Accept-Language": language})
            for suffix in ("csv", "xlsx", "parquet")
        }
        assert {file.headers["Vary"] for file in files.values()} >= {"Accept-Language, Cookie"}
        sheet = openpyxl.load_workbook(io.BytesIO(files["xlsx"].content)).active
        assert sheet is not None
        return {
            "csv": [row["error"] or None for row in csv.DictReader(io.StringIO(files["csv"].content.decode()))],
            "xlsx": [cell.value for cell in list(sheet.columns)[-1][1:]],
            "parquet": pq.read_table(io.BytesIO(files["parquet"].content))["error"].to_pylist(),
        }

    english = [None, None, 'torque_Nm: row 6: must be a number, such as 9.3, not "abc"']
    german = [None, None, 'torque_Nm: Zeile 6: muss eine Zahl sein, z. B. 9.3, nicht "abc"']
    assert errors("en") == {"csv": english, "xlsx": english, "parquet": english}
    assert errors("de") == {"csv": german, "xlsx": german, "parquet": english}


@pytest.mark.parametrize("suffix", ["csv", "xlsx", "parquet"])
def test_a_browser_gets_the_page_of_a_machine_that_is_gone_for_its_files_too(client: TestClient, suffix: str) -> None:
    browser = {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"}

    page = client.get(f"/machines/nowhere/axes.{suffix}", headers=browser)
    problem = client.get(f"/machines/nowhere/axes.{suffix}")

    assert page.status_code == problem.status_code == 404
    assert "There is no such machine." in page.text and page.headers["content-type"].startswith("text/html")
    assert problem.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize("rest", ["", "/saved?cursor=a%2Fb&T=1", "/id/axes.csv", "/id/rename", "/%3Fa//b?c=%22"])
def test_the_address_of_older_links_leads_to_the_same_place(client: TestClient, method: str, rest: str) -> None:
    answer = client.request(method, f"/fleets{rest}", follow_redirects=False)

    assert (answer.status_code, answer.headers["Location"]) == (308, f"/machines{rest}")


def test_a_table_that_is_sent_to_the_older_address_arrives_whole(client: TestClient) -> None:
    answer = client.post("/fleets", files={"file": ("axes", GERMAN.encode("cp1252"))}, follow_redirects=True)

    assert [past.status_code for past in answer.history] == [308]
    assert answer.status_code == 200 and "Columns and rows" in answer.text


def test_reasons_are_kept_as_codes_and_values(client: TestClient, machine: str, service: FastAPI) -> None:
    assert client.portal is not None
    saved = client.portal.call(service.state.store.find_machine, machine.rpartition("/")[2])

    (fault,) = answer_in(saved.items[2].answer).faults

    assert (fault.pointer, fault.code) == ("/torque_Nm", "float_type")
    assert fault.wording == Sentence(
        "row {number}: {reason}",
        {"number": "6", "reason": Sentence("must be a number, such as 9.3, not {found}", {"found": '"abc"'})},
    )
