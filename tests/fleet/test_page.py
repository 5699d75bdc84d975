"""The page of fleets without a browser: a table goes up, its columns are put right, and the result is kept."""

import csv
import hashlib
import io
import json
import re
from collections.abc import Iterator
from html import unescape
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import openpyxl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.selection import select
from hpn.fleet import listing
from hpn.fleet.listing import as_parquet, kept_listing_of
from hpn.fleet.run import Order, size_fleet
from hpn.store import FleetDraft
from hpn.store.fleets import MOST_OF_CALLER
from hpn.tables.columns import NO_CHOICES
from hpn.tables.files import Contents, contents_of
from hpn.web.app import create_app
from hpn.web.door.problems import Problem
from hpn.web.form.link_writer import to_link
from hpn.web.pages import fleet_result
from hpn.web.pages.fleet_files import file_of
from hpn.web.pages.fleet_upload import WANTED, best_reading
from hpn.web.settings import Settings
from hpn.words.reader import Reader
from hpn.words.wording import Sentence
from tests.fleet.tables import in_long_form, row_of, write
from tests.fuzz.costly import made
from tests.state import state_of
from tests.store.test_fleets import MOST_BYTES

GERMAN = """Maschine 7;;;;;
Achse;Nr.;Drehmoment [Nm];Drehzahl [1/min];Dauer [ms];Lebensdauer Getriebe [h]
Hub Ä;1;12,5;250;300;20000
;2;8;500;2000,5;
Band;1;9000;100;500;
Greifer;1;abc;100;500;
"""
HUB = {
    "duty_cycle": {
        "phases": [
            {"torque_Nm": 12.5, "speed_rpm": 250, "duration_s": 0.3},
            {"torque_Nm": 8, "speed_rpm": 500, "duration_s": 2.0005},
        ]
    },
    "requirements": {"life_h": 20000},
}
HEAVY = {"duty_cycle": {"phases": [{"torque_Nm": 9000, "speed_rpm": 100, "duration_s": 0.5}]}}


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> FastAPI:
    return create_app(Settings(database_url=f"sqlite:///{tmp_path_factory.mktemp('fleets') / 'fleets.sqlite3'}"))


@pytest.fixture(scope="module")
def client(service: FastAPI) -> Iterator[TestClient]:
    with TestClient(service, follow_redirects=False) as client:
        yield client


def post(client: TestClient, content: bytes = b"", fields: dict[str, str] | None = None) -> Any:
    """What the form answers."""
    files = {"file": ("axes", content)} if content else {"file": ("", b"")}
    return client.post("/fleets", data=fields or {}, files=files)


def fields_of(page: str) -> dict[str, str]:
    """What a form would send as it stands: hidden fields, and choices that are made."""
    fields = dict(re.findall(r'<input type="hidden" name="(\w+)" value="([^"]*)"', page))
    for name, options in re.findall(r'<select name="(\w+)"[^>]*>(.*?)</select>', page, re.DOTALL):
        chosen = re.search(r'value="([^"]*)" selected', options)
        fields[name] = chosen[1] if chosen else ""
    return fields


@pytest.fixture(scope="module")
def fleet(client: TestClient) -> str:
    """Address of the fleet of the German table."""
    read = post(client, GERMAN.encode("cp1252"))
    assert read.status_code == 200, read.text
    sized = post(client, fields={**fields_of(read.text), "size": "1"})
    assert sized.status_code == 303, sized.text
    return str(sized.headers["location"])


def test_german_headings_are_read_and_can_be_put_right(client: TestClient) -> None:
    first = post(client, GERMAN.replace("Drehzahl [1/min]", "Wert").encode())
    assert "What is column “Wert”?" in unescape(first.text)
    german = client.post("/fleets", data=fields_of(first.text), headers={"Accept-Language": "de"})
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


def test_a_fleet_shows_each_axis_with_its_link(client: TestClient, fleet: str, service: FastAPI) -> None:
    page = unescape(client.get(fleet).text)

    applications = [Application.model_validate(HUB), Application.model_validate(HEAVY)]
    for name, application in zip(("Hub Ä", "Band"), applications, strict=True):
        assert f'<a href="{to_link(application)}&{urlencode({"title": name})}">{name}</a>' in page
    assert f"</span> {select(applications[0], service.state.catalogue).selected}</td>" in page
    assert "nearest: " in page
    assert re.search(r'Greifer</th>.*?class="reason"[^>]*>torque_Nm: ', page, re.DOTALL)
    german = unescape(client.get(fleet, headers={"Accept-Language": "de"}).text)
    assert re.search(r'class="reason"[^>]*>torque_Nm: Phase 1: muss eine Zahl sein, z. B. 9.3, nicht "abc"<', german)


@pytest.mark.parametrize(
    ("query", "axes"),
    [
        ("", ["Hub Ä", "Band", "Greifer"]),
        ("?sort=axis", ["Band", "Hub Ä", "Greifer"]),
        ("?sort=-utilisation", ["Band", "Hub Ä", "Greifer"]),
        ("?show=unsuitable", ["Band"]),
        ("?show=rejected", ["Greifer"]),
        ("?search=HUB", ["Hub Ä"]),
        ("?gear=HPN-11A-3", []),
        ("?sort=nothing&show=all&part=x", ["Hub Ä", "Band", "Greifer"]),
        ("?part=99", []),
    ],
)
def test_axes_are_sorted_and_chosen_by_the_address(client: TestClient, fleet: str, query: str, axes: list[str]) -> None:
    page = unescape(client.get(fleet + query).text)

    rows = re.findall(r'<tr class="(?:selected|unsuitable|rejected)">\s*<th scope="row">(?:<a [^>]*>)?([^<]*)', page)
    assert rows == axes


def test_files_hold_the_answers(client: TestClient, fleet: str) -> None:
    parquet = pq.read_table(io.BytesIO(client.get(f"{fleet}/axes.parquet").content)).to_pylist()
    text = list(csv.DictReader(io.StringIO(client.get(f"{fleet}/axes.csv").content.decode())))
    sheet = openpyxl.load_workbook(io.BytesIO(client.get(f"{fleet}/axes.xlsx").content)).active

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
    table = write(tmp_path / "axes.ndjson", [row_of(name, HUB) for name in HOSTILE]).read_bytes()
    place = post(client, table).headers["location"]

    csv_rows = list(csv.reader(io.StringIO(client.get(f"{place}/axes.csv").content.decode(), newline="")))
    sheet = openpyxl.load_workbook(io.BytesIO(client.get(f"{place}/axes.xlsx").content)).active
    typed = pq.read_table(io.BytesIO(client.get(f"{place}/axes.parquet").content))
    rest = client.post("/api/v1/fleet", content=table, headers={"Content-Type": "application/x-ndjson"})

    harmless = [f"'{name}" for name in HOSTILE[:6]] + HOSTILE[6:]
    assert [row[0] for row in csv_rows[1:]] == harmless
    assert sheet is not None
    cells = [row[0] for row in sheet.iter_rows(min_row=2)]
    assert {cell.data_type for cell in cells} == {"s"}
    assert [str(cell.value).replace("_x000D_", "\r") for cell in cells] == HOSTILE
    assert typed["axis"].to_pylist() == [json.loads(line)["axis"] for line in rest.text.splitlines()] == HOSTILE
    assert re.findall(r'href="[^"]*/axes\.(\w+)"', client.get(place).text) == ["xlsx", "csv", "parquet"]


def test_a_name_of_a_fleet_that_was_saved_before_names_had_a_bound_is_cut_in_the_workbook_alone(
    service: FastAPI, client: TestClient, fleet: str
) -> None:
    assert client.portal is not None
    saved = client.portal.call(service.state.store.find_fleet, fleet.rpartition("/")[2])
    table = pq.read_table(io.BytesIO(saved.answers)).slice(0, 1)
    long = as_parquet(table.set_column(0, "axis", pa.array(["x" * 40_000])))

    book, typed = (file_of(long, saved.created, suffix, Reader("en")) for suffix in ("xlsx", "parquet"))

    sheet = openpyxl.load_workbook(io.BytesIO(book)).active
    assert sheet is not None
    assert sheet["A2"].value == "x" * 32_766 + "…"  # no cell of XLSX holds more
    assert pq.read_table(io.BytesIO(typed))["axis"].to_pylist() == ["x" * 40_000]


def test_files_of_a_fleet_are_made_in_the_process_beside_the_service(client: TestClient, fleet: str) -> None:
    pool = state_of(client).pools["exports"]
    pool.apart.close()

    for suffix in ("xlsx", "csv", "parquet"):
        assert client.get(f"{fleet}/axes.{suffix}").status_code == 200
        assert pool.apart._process is not None and pool.apart._process.poll() is None
        pool.apart.close()


def test_reasons_of_a_file_for_people_are_in_the_readers_language(client: TestClient, fleet: str) -> None:
    def errors(language: str) -> dict[str, list[str | None]]:
        files = {
            suffix: client.get(f"{fleet}/axes.{suffix}", headers={"Accept-Language": language})
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

    english = [None, None, 'torque_Nm: phase 1: must be a number, such as 9.3, not "abc"']
    german = [None, None, 'torque_Nm: Phase 1: muss eine Zahl sein, z. B. 9.3, nicht "abc"']
    assert errors("en") == {"csv": english, "xlsx": english, "parquet": english}
    assert errors("de") == {"csv": german, "xlsx": german, "parquet": english}


@pytest.mark.parametrize("suffix", ["csv", "xlsx", "parquet"])
def test_a_browser_gets_the_page_of_a_fleet_that_is_gone_for_its_files_too(client: TestClient, suffix: str) -> None:
    browser = {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"}

    page = client.get(f"/fleets/nowhere/axes.{suffix}", headers=browser)
    problem = client.get(f"/fleets/nowhere/axes.{suffix}")

    assert page.status_code == problem.status_code == 404
    assert "There is no such fleet." in page.text and page.headers["content-type"].startswith("text/html")
    assert problem.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize("form", ["list", "long"])
@pytest.mark.parametrize("suffix", [".csv", ".ndjson", ".parquet", ".arrow"])
def test_tables_of_hpn_fleet_are_taken_as_they_are(tmp_path: Path, suffix: str, form: str) -> None:
    rows = [row_of("one", HUB), row_of("two", HEAVY)]
    file = write(tmp_path / f"axes{suffix}", rows if form == "list" else in_long_form(rows)[0])

    assert contents_of(file.read_bytes(), WANTED) == Contents(suffix=suffix)


def test_a_table_of_hpn_fleet_is_sized_at_once(client: TestClient, tmp_path: Path) -> None:
    file = write(tmp_path / "axes.csv", [row_of("one", HUB), row_of("two", HEAVY)])

    sized = post(client, file.read_bytes())

    assert sized.status_code == 303, sized.text
    assert to_link(Application.model_validate(HUB)) in unescape(client.get(sized.headers["location"]).text)


@pytest.mark.parametrize("suffix", [".parquet", ".ndjson"])
def test_typed_tables_with_other_headings_are_read_with_every_digit(tmp_path: Path, suffix: str) -> None:
    exact = 0.1 + 0.2
    row = {"Antrieb": "A", "Moment Nm": exact, "Drehzahl rpm": 1234.567, "Zeitdauer s": 1e-3}
    file = tmp_path / f"axes{suffix}"
    if suffix == ".parquet":
        pq.write_table(pa.Table.from_pylist([row]), file)
    else:
        file.write_text(json.dumps(row))

    grids = contents_of(file.read_bytes(), WANTED).sheets[""]

    assert not isinstance(grids, Sentence)
    axes = best_reading(grids, NO_CHOICES, ()).axes
    assert axes == ({"axis": "A", "torque_Nm": [exact], "speed_rpm": [1234.567], "duration_s": [1e-3]},)


@pytest.mark.parametrize(
    ("content", "status", "said"),
    [
        (b"", 422, "choose a file"),
        (b"PAR1 but not really", 422, "can’t be read as Parquet"),
        (b"\xd0\xcf\x11\xe0 old", 422, "old format"),
        (b'{"axis": 1, "torque_Nm": [1], "speed_rpm": [2], "duration_s": [3], "price": 4}\n', 422, "price"),
        (b"hello", 422, ""),
    ],
)
def test_what_can_not_be_read_is_said(client: TestClient, content: bytes, status: int, said: str) -> None:
    answer = post(client, content)

    assert answer.status_code == status
    assert said in unescape(answer.text) and 'role="alert"' in answer.text


@pytest.fixture(scope="module")
def kept(client: TestClient, service: FastAPI, fleet: str) -> FleetDraft:
    """What was kept of the fleet of the German table."""
    assert client.portal is not None
    found = client.portal.call(service.state.store.find_fleet, fleet.rpartition("/")[2])
    return FleetDraft(**{name: getattr(found, name) for name in FleetDraft.__dataclass_fields__ if name != "caller"})


def keep(client: TestClient, service: FastAPI, draft: FleetDraft) -> str:
    """Address of a fleet that is kept as if it had just been sized."""
    assert client.portal is not None
    return f"/fleets/{client.portal.call(service.state.store.keep_fleet, draft, MOST_BYTES)}"


def test_a_fleet_is_saved_listed_and_never_changed(client: TestClient, service: FastAPI, kept: FleetDraft) -> None:
    address = keep(client, service, kept)
    assert "Save as a project" in client.get(address).text

    wrong = client.post(address, data={"title": "x" * 300, "ref": "P-7"})
    assert wrong.status_code == 422 and 'value="P-7"' in wrong.text and "at most 200" in unescape(wrong.text)
    assert client.post(address, data={"title": "Line <4>", "ref": "P-7", "author": "", "rev": "B"}).status_code == 303
    client.post(address, data={"title": "another"})

    page = client.get(address).text
    assert "Line &lt;4&gt;" in page and "Save as a project" not in page and "What differs today" not in page
    assert f'<a href="{address}">Line &lt;4&gt;</a>' in client.get("/fleets/saved").text
    assert client.post(f"{address}/delete").status_code == 303
    assert client.get(address).status_code == 404


def test_a_saved_fleet_is_renamed_on_its_page(client: TestClient, service: FastAPI, kept: FleetDraft) -> None:
    address = keep(client, service, kept)
    assert client.post(f"{address}/rename", data={"title": "early"}).status_code == 404
    client.post(address, data={"title": "Line 4", "ref": "P-7", "author": "MM", "rev": "B"})
    assert f'action="{address}/rename"' in client.get(address).text

    wrong = client.post(f"{address}/rename", data={"title": "x" * 300})
    assert wrong.status_code == 422 and "at most 200" in unescape(wrong.text)
    renamed = client.post(f"{address}/rename", data={"title": "Line <5>", "ref": ""})

    assert renamed.status_code == 303 and renamed.headers["location"] == address
    page = client.get(address).text
    assert "<h1>Line &lt;5&gt;</h1>" in page and "P-7" not in page and "MM" in page


def test_names_of_fleets_that_look_like_others_are_refused(
    client: TestClient, service: FastAPI, kept: FleetDraft
) -> None:
    address = keep(client, service, kept)
    for name in ("title", "ref", "author", "rev"):
        wrong = client.post(address, data={name: "Line\u200b 4"})
        assert wrong.status_code == 422 and "U+200B ZERO WIDTH SPACE" in wrong.text
    client.post(address, data={"title": "Line 4"})

    wrong = client.post(f"{address}/rename", data={"title": "Line 4", "ref": "\U000e0041"})

    assert wrong.status_code == 422 and "Reference: must not contain U+E0041" in unescape(wrong.text)


def test_a_fleet_says_what_differs_today(client: TestClient, service: FastAPI, fleet: str, tmp_path: Path) -> None:
    then = select(Application.model_validate(HUB), service.state.catalogue).candidates[0]
    columns = "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source\n"
    (tmp_path / "ratings.csv").write_text(f"{columns}{then.size},{then.ratio},0.4,0.3,0.5,weaker\n")
    url = service.state.settings.database_url
    with TestClient(create_app(Settings(database_url=url, catalogue_supplement=tmp_path))) as later:
        page = unescape(later.get(fleet).text)
        now = select(Application.model_validate(HUB), state_of(later).catalogue).selected

    assert "1 axis gets another answer." in page
    changed = page[page.index("What differs today") : page.index('id="fleet-count"')]
    assert changed.index(then.designation) < changed.index(str(now))
    assert "What differs today" not in client.get(fleet).text


def test_only_the_owner_s_key_renames_and_deletes_a_fleet(kept: FleetDraft, tmp_path: Path) -> None:
    keys = {name: f"key of {name}" for name in ("anna", "bert")}
    pairs = [f"{name}:{hashlib.sha256(key.encode()).hexdigest()}" for name, key in keys.items()]
    settings = Settings.model_validate({"database_url": f"sqlite:///{tmp_path / 'db'}", "api_keys": " ".join(pairs)})
    anna, bert = ({"X-API-Key": key} for key in keys.values())
    service = create_app(settings)
    with TestClient(service, follow_redirects=False) as client:
        address = keep(client, service, kept)
        for guarded in ("/fleets", address, f"{address}/delete"):
            assert client.post(guarded, data={"text": "x"}).status_code == 401
        client.headers |= anna
        client.post(address, data={"title": "Line 4"})

        assert client.post(f"{address}/delete", headers=bert).status_code == 403
        assert client.post(f"{address}/rename", data={"title": "Bert’s"}, headers=bert).status_code == 403
        assert client.post(f"{address}/delete", headers={"X-API-Key": ""}).status_code == 401
        assert client.get(address).status_code == 200
        assert client.post(f"{address}/delete").status_code == 303
        assert client.get(address).status_code == 404


@pytest.fixture
def keyed(tmp_path: Path) -> Iterator[TestClient]:
    """A service with keys."""
    pairs = [f"{name}:{hashlib.sha256(name.encode()).hexdigest()}" for name in ("anna", "bert", "admin")]
    settings = Settings.model_validate({"database_url": f"sqlite:///{tmp_path / 'db'}", "api_keys": " ".join(pairs)})
    with TestClient(create_app(settings), follow_redirects=False) as client:
        yield client


def test_what_a_key_has_calculated_only_that_key_sees_and_saves(keyed: TestClient, tmp_path: Path) -> None:
    anna, bert, admin = ({"X-API-Key": name} for name in ("anna", "bert", "admin"))
    table = write(tmp_path / "axes.csv", [row_of("one", HUB)]).read_bytes()
    sized = keyed.post("/fleets", files={"file": ("axes.csv", table)}, headers=anna)
    assert sized.status_code == 303, sized.text
    place = sized.headers["location"]

    for other in (bert, admin):
        for address in (place, f"{place}/axes.csv", f"{place}/delete"):
            seen = keyed.get(address, headers=other)
            assert seen.status_code == 403 and "one" not in seen.text
        assert keyed.post(place, data={"title": "taken"}, headers=other).status_code == 403
        assert keyed.post(f"{place}/delete", headers=other).status_code == 403
    assert keyed.get(place).status_code == 401  # the browser asks for the key
    assert "Only the key that calculated" in keyed.get(place, headers=bert | {"Accept": "text/html"}).text

    assert keyed.get(place, headers=anna).status_code == 200
    assert keyed.post(place, data={"title": "Line 4"}, headers=anna).status_code == 303
    assert keyed.get(place, headers=bert).status_code == 200  # what is saved is there for all


def test_a_caller_with_many_unsaved_fleets_is_told_what_to_do(keyed: TestClient, tmp_path: Path) -> None:
    table = write(tmp_path / "axes.csv", [row_of("one", HUB)]).read_bytes()
    sized = keyed.post("/fleets", files={"file": ("axes.csv", table)}, headers={"X-API-Key": "anna"})
    store, place = state_of(keyed).store, sized.headers["location"]
    assert keyed.portal is not None
    found = keyed.portal.call(store.find_fleet, place.rpartition("/")[2])
    caller = hashlib.sha256(b"key anna").hexdigest()
    names = set(FleetDraft.__dataclass_fields__) - {"caller"}
    draft = FleetDraft(**{name: getattr(found, name) for name in names}, caller=caller)
    for _ in range(MOST_OF_CALLER - 1):
        keyed.portal.call(store.keep_fleet, draft, MOST_BYTES)

    refused = keyed.post("/fleets", files={"file": ("axes.csv", table)}, headers={"X-API-Key": "anna"})

    assert (refused.status_code, int(refused.headers["retry-after"]) > 0) == (429, True)
    assert "20 of them are yours" in refused.text
    assert keyed.post("/fleets", files={"file": ("a.csv", table)}, headers={"X-API-Key": "bert"}).status_code == 303
    assert keyed.post(f"{place}/delete", headers={"X-API-Key": "anna"}).status_code == 303
    assert keyed.post("/fleets", files={"file": ("a.csv", table)}, headers={"X-API-Key": "anna"}).status_code == 303


def test_where_unsaved_fleets_take_all_their_room_a_new_one_is_refused(tmp_path: Path) -> None:
    table = write(tmp_path / "axes.csv", [row_of("one", HUB)]).read_bytes()
    settings = Settings(database_url=f"sqlite:///{tmp_path / 'db'}", maximum_unsaved_fleet_bytes=1000)
    with TestClient(create_app(settings), follow_redirects=False) as client:
        refused = post(client, table)

        assert refused.status_code == 503 and "take the room there is for them" in refused.text
        assert client.post("/api/v1/fleet", content=table, headers={"Content-Type": "text/csv"}).status_code == 200


def test_a_reader_who_changes_language_over_a_table_comes_back_to_the_page_of_tables(client: TestClient) -> None:
    page = post(client, GERMAN.encode()).text

    assert re.findall(r'name="back" value="([^"]*)"', page) == ["/fleets"]


def test_a_table_that_is_too_large_for_the_page_is_told_where_there_is_room(client: TestClient) -> None:
    rows = "".join(f"A{number};1;{number % 100};1\n" for number in range(37_600))

    answer = post(client, f"Achse;Moment [Nm];Drehzahl [1/min];Dauer [s]\n{rows}".encode())

    assert answer.status_code == 422
    assert "leave out the columns" in answer.text and "POST /api/v1/fleet, which have no such limit" in answer.text


def test_a_file_that_stands_for_too_much_is_a_413_and_what_was_typed_is_kept(client: TestClient) -> None:
    files = {"file": ("a.arrow", made("Arrow with a long text"))}

    answer = client.post("/fleets", data={"text": "typed before"}, files=files)

    assert answer.status_code == 413
    assert "too much memory or time" in answer.text and "typed before" in answer.text


def test_an_axis_whose_name_is_too_long_is_a_rejected_one(client: TestClient) -> None:
    """The same as over REST and by the command, since it is refused where tables are read."""
    rows = [{**row_of("x", HUB), "axis": "a" * 5000}, row_of("two", HUB)]
    content = "".join(json.dumps(row) + "\n" for row in rows).encode()

    sized = post(client, content)
    page = client.get(sized.headers["location"]).text
    answers = client.post("/api/v1/fleet", content=content, headers={"Content-Type": "application/x-ndjson"})

    assert "must have at most 1000 characters" in page and "a" * 1000 in page and "a" * 1001 not in page
    first, second = map(json.loads, answers.text.splitlines())
    assert (first["axis"], first["error"]) == ("a" * 1000, "axis: must have at most 1000 characters")
    assert second["error"] is None


def test_what_a_fleet_was_asked_is_kept_up_to_a_size(
    tmp_path: Path, catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch
) -> None:
    axes, answers = write(tmp_path / "axes.ndjson", [row_of("one", HUB)]), tmp_path / "answers.parquet"
    size_fleet(Order(axes, answers), catalogue)
    assert fleet_result.draft_of(kept_listing_of(axes, answers, catalogue), catalogue).selected == 1
    monkeypatch.setattr(listing, "MOST_BYTES", 100)
    with pytest.raises(Problem) as refused:
        fleet_result.draft_of(kept_listing_of(axes, answers, catalogue), catalogue)
    assert refused.value.status_code == 413 and "hpn fleet" in refused.value.detail
