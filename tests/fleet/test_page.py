"""The page of fleets without a browser: a table goes up, its columns are put right, and the result is kept."""

import csv
import gzip
import io
import re
from html import unescape
from pathlib import Path

import openpyxl
import pyarrow as pa
import pyarrow.feather as feather
import pyarrow.parquet as pq
import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.engine.selection import select
from hpn.links.writer import to_link
from hpn.tables.files import NO_TEXT
from hpn.tables.reading import Reading, reading_of
from hpn.web.axis_tables import WANTED
from hpn.web.columns import answer_in
from hpn.web.pages import machine_answers
from hpn.web.pages.answer_files import file_of
from hpn.words.reader import Reader
from hpn.words.wording import Sentence
from tests.fleet.page import GERMAN, HEAVY, HUB, fields_of, post
from tests.fleet.tables import REQUIRED, in_long_form, row_of, table_of, write
from tests.fuzz.costly import made
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
    assert re.search(r'Greifer</a>\s*</th>.*?class="reason"[^>]*>[^/]*/span> Torque: row 6: ', page, re.DOTALL)
    german = unescape(client.get(machine, headers={"Accept-Language": "de"}).text)
    assert re.search(
        r'class="reason"[^>]*>[^/]*/span> Drehmoment: Zeile 6: muss eine Zahl sein, z. B. 9.3, nicht "abc"\s*<', german
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
    shown = {axis: re.findall(r'class="percent">([^<]*)|class="limit" x="([^"]*)"', row) for axis, row in rows}
    at_u, whole = ("", "53.33%"), ("", "66.67%")
    assert list(shown.items()) == [
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


@pytest.mark.parametrize("form", ["list", "long"])
@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".arrow"])
def test_tables_of_hpn_fleet_are_taken_as_they_are(tmp_path: Path, suffix: str, form: str) -> None:
    rows = [row_of("one", HUB), row_of("two", HEAVY)]
    phases = [{name: row[name] for name in ("axis", *REQUIRED)} for row in rows]
    file = write(tmp_path / f"axes{suffix}", rows if form == "list" else in_long_form(phases))

    assert reading_of(file.read_bytes(), WANTED) == Reading(suffix=suffix)


def as_written_elsewhere(kind: str, folder: Path) -> bytes:
    """A table of two axes as another tool writes it."""
    rows = [row_of("one", HUB), row_of("two", HEAVY)]
    table, path = table_of(rows), folder / "file"
    if kind == ".feather":
        feather.write_feather(table, str(path), compression="lz4")
    elif kind == ".arrows":
        with pa.ipc.new_stream(str(path), table.schema) as stream:
            stream.write_table(table, max_chunksize=1)
    elif kind == ".csv.gz":
        path.write_bytes(gzip.compress(write(folder / "axes.csv", rows).read_bytes()))
    elif kind == "CSV with an index":
        write(folder / "axes.csv", [{"": number, **row} for number, row in enumerate(rows)]).rename(path)
    else:
        pq.write_table(table.append_column("__index_level_0__", pa.array([7, 8])), path)
    return path.read_bytes()


@pytest.mark.parametrize("kind", [".feather", ".arrows", ".csv.gz", "CSV with an index", "Parquet with an index"])
def test_tables_that_other_tools_write_are_sized_at_once(kind: str, client: TestClient, tmp_path: Path) -> None:
    sized = post(client, as_written_elsewhere(kind, tmp_path))

    assert sized.status_code == 303, sized.text
    place = sized.headers["location"]
    assert "two" in client.get(place).text
    assert to_link(Application.model_validate(HUB)) in unescape(client.get(f"{place}/axes/1").text)


@pytest.mark.parametrize("kind", [".csv.gz", ".arrows"])
def test_gzip_and_streams_with_other_headings_are_read(kind: str, tmp_path: Path) -> None:
    row = {"Antrieb": "A", "Moment Nm": 12.5, "Drehzahl rpm": 1234.567, "Zeitdauer s": 1e-3}
    sink = io.BytesIO()
    if kind == ".arrows":
        table = pa.Table.from_pylist([row])
        with pa.ipc.new_stream(sink, table.schema) as stream:
            stream.write_table(table)
    else:
        sink.write(gzip.compress(f"{','.join(row)}\n{','.join(map(str, row.values()))}\n".encode()))

    table = reading_of(sink.getvalue(), WANTED).table

    assert table is not None
    assert table.axes == ({"axis": "A", "torque_Nm": [12.5], "speed_rpm": [1234.567], "duration_s": [1e-3]},)


@pytest.mark.parametrize(
    "content",
    [
        gzip.compress(gzip.compress(b"axis")),
        b"\x1f\x8bno gzip at all",
    ],
    ids=["gzip in gzip", "no gzip"],
)
def test_gzip_without_a_table_is_said(content: bytes) -> None:
    table = reading_of(content, WANTED).table
    assert table is not None and table.problem == Sentence(NO_TEXT)


def test_a_table_of_hpn_fleet_is_sized_at_once(client: TestClient, tmp_path: Path) -> None:
    file = write(tmp_path / "axes.csv", [row_of("one", HUB), row_of("two", HEAVY)])

    sized = post(client, file.read_bytes())

    assert sized.status_code == 303, sized.text
    assert to_link(Application.model_validate(HUB)) in unescape(client.get(f"{sized.headers['location']}/axes/1").text)


def test_names_of_phases_reach_the_link_of_their_axis(client: TestClient) -> None:
    table = "Achse;Phase;Moment [Nm];Drehzahl [1/min];Dauer [s]\nA;hoch;40;250;1\nA;runter;32;500;2\n"

    sized = post(client, fields={**fields_of(post(client, table.encode()).text), "size": "1"})

    assert sized.status_code == 303
    assert "n=250&t=1&pn=hoch&T=32&n=500&t=2&pn=runter" in unescape(
        client.get(f"{sized.headers['location']}/axes/1").text
    )


def test_typed_tables_with_other_headings_are_read_with_every_digit(tmp_path: Path) -> None:
    exact = 0.1 + 0.2
    row = {"Antrieb": "A", "Moment Nm": exact, "Drehzahl rpm": 1234.567, "Zeitdauer s": 1e-3}
    pq.write_table(pa.Table.from_pylist([row]), tmp_path / "axes.parquet")

    table = reading_of((tmp_path / "axes.parquet").read_bytes(), WANTED).table

    assert table is not None
    assert table.axes == ({"axis": "A", "torque_Nm": [exact], "speed_rpm": [1234.567], "duration_s": [1e-3]},)


@pytest.mark.parametrize(
    ("content", "status", "said"),
    [
        (b"", 422, "choose a file"),
        (b"PAR1 but not really", 422, "can’t be read as Parquet"),
        (b"\xd0\xcf\x11\xe0 old", 422, "old format"),
        (b'{"axis": 1, "torque_Nm": [1], "speed_rpm": [2], "duration_s": [3]}\n', 422, "JSON are no table of axes"),
        (b"axis,torque_Nm,speed_rpm\n1,2,3\n", 422, "The table: column duration_s is missing"),
        (b"hello", 422, ""),
    ],
)
def test_a_file_that_can_not_be_read_says_so(client: TestClient, content: bytes, status: int, said: str) -> None:
    answer = post(client, content)

    assert answer.status_code == status
    assert said in unescape(answer.text) and 'role="alert"' in answer.text


def test_a_reader_who_changes_language_over_a_table_comes_back_to_the_page_of_tables(client: TestClient) -> None:
    page = post(client, GERMAN.encode()).text

    assert re.findall(r'name="back" value="([^"]*)"', page) == ["/machines"]


def test_a_table_that_is_too_large_for_the_page_is_told_where_there_is_room(client: TestClient) -> None:
    rows = "".join(f"A{number};1;{number % 100};1\n" for number in range(37_600))

    answer = post(client, f"Achse;Moment [Nm];Drehzahl [1/min];Dauer [s]\n{rows}".encode())

    assert answer.status_code == 422
    assert "leave out the columns" in answer.text and "POST /api/v1/fleet, which have no such limit" in answer.text


def test_a_file_that_stands_for_too_much_is_a_413_and_what_was_typed_is_kept(client: TestClient) -> None:
    files = {"file": ("a.arrow", made("Arrow with a long text"))}

    answer = client.post("/machines", data={"text": "typed before"}, files=files)

    assert answer.status_code == 413
    assert "too much memory or time" in answer.text and "typed before" in answer.text


def test_an_axis_whose_name_is_too_long_is_a_rejected_one(client: TestClient, tmp_path: Path) -> None:
    """The same as over REST and by the command, since it is refused where tables are read."""
    rows = [{**row_of("x", HUB), "axis": "a" * 5000}, row_of("two", HUB)]
    content = write(tmp_path / "axes.csv", rows).read_bytes()

    sized = post(client, content)
    page = client.get(sized.headers["location"]).text
    answers = client.post("/api/v1/fleet", content=content, headers={"Content-Type": "text/csv"})

    assert "must have at most 1000 characters" in page and "a" * 1000 in page and "a" * 1001 not in page
    first, second = csv.DictReader(io.StringIO(answers.text))
    assert (first["axis"], first["error"]) == ("a" * 1000, "axis: must have at most 1000 characters")
    assert second["error"] == ""


@pytest.mark.parametrize("form", ["cells", "typed"])
def test_an_axis_that_is_torn_apart_is_one_rejected_row(form: str, client: TestClient) -> None:
    head = "Axis;Torque [Nm];Speed [rpm];Duration [s]" if form == "cells" else "axis,torque_Nm,speed_rpm,duration_s"
    rows = [f"{name},40,{speed},1" for name, speed in (("a", 100), ("b", 100), ("a", 200), ("c", 0), ("a", 9e9))]
    text = "\n".join([head, *(row.replace(",", ";") if form == "cells" else row for row in rows)])

    sized = post(client, text.encode())
    if sized.status_code == 200:
        sized = post(client, fields={**fields_of(sized.text), "size": "1"})

    answers = pq.read_table(io.BytesIO(client.get(f"{sized.headers['location']}/axes.parquet").content)).to_pylist()
    assert [row["axis"] for row in answers] == ["a", "b", "c"]
    assert answers[0]["error"] == "axis: must be unique, with its rows together"
    assert [bool(row["error"]) for row in answers] == [True, False, True]


@pytest.mark.parametrize("count", [10_001, 2])
def test_a_table_with_more_than_a_machine_has_is_told_where_there_is_room(
    count: int, client: TestClient, tmp_path: Path
) -> None:
    phases = 1 if count > 2 else 100_001
    lists = {name: [[1.0] * phases] * count for name in ("torque_Nm", "speed_rpm", "duration_s")}
    pq.write_table(pa.table({"axis": [str(number) for number in range(count)], **lists}), tmp_path / "axes.parquet")

    answer = post(client, (tmp_path / "axes.parquet").read_bytes())

    assert answer.status_code == 413
    assert "the limit of a page is" in answer.text and "POST /api/v1/fleet" in answer.text


def test_reasons_are_kept_as_codes_and_values(client: TestClient, machine: str, service: FastAPI) -> None:
    assert client.portal is not None
    saved = client.portal.call(service.state.store.find_machine, machine.rpartition("/")[2])

    (fault,) = answer_in(saved.items[2].answer).faults

    assert (fault.pointer, fault.code) == ("/torque_Nm", "float_type")
    assert fault.told == Sentence(
        "row {number}: {reason}",
        {"number": "6", "reason": Sentence("must be a number, such as 9.3, not {found}", {"found": '"abc"'})},
    )
