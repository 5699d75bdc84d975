"""Files that the page opens and files that it offers, over HTTP."""

import io
import json
import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from html import escape, unescape

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from starlette.testclient import TestClient

from hpn.web.door.pools import PLACES
from tests.fuzz.costly import made
from tests.state import state_of
from tests.web.paste import GERMAN, HTMX, LINK, LONG, cells, chosen, query_of


def test_error_in_a_json_file_names_the_field(client: TestClient) -> None:
    body = {"duty_cycle": {"phases": [{"torque_Nm": 1, "speed_rpm": 1, "duration_s": -1}]}}
    page = client.post("/paste", files={"file": ("a.json", json.dumps(body))})
    assert page.status_code == 422
    assert "/duty_cycle/phases/0/duration_s" in page.text


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_files_are_read_in_the_encodings_of_spreadsheets(client: TestClient, encoding: str) -> None:
    text = GERMAN.replace("\t", ";").replace("Dauer", "Zeit")
    page = client.post("/paste", files={"file": ("zyklus.csv", text.encode(encoding))}, data={"link": LINK})
    assert page.status_code == 200
    assert "Column separator: semicolon" in page.text
    assert chosen(page.text)["r2"] == "t"


@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be", "utf-32-le", "utf-32-be"])
def test_files_are_read_in_the_encoding_that_their_mark_promises(client: TestClient, encoding: str) -> None:
    content = ("\ufeff" + GERMAN).encode(encoding)
    page = client.post("/paste", files={"file": ("zyklus.txt", content)}, headers=HTMX)
    assert page.status_code == 200
    assert "9.3" in cells(page.text)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\xef\xbb\xbf40\t250\t3\n4\xfc\t1\t1\n", "as UTF-8, but in line 2 the byte 0xfc, number 14"),
        (b"\xef\xbb\xbf40\t250\t3\xc3", "as UTF-8, but in line 1 the byte 0xc3, number 12"),
        ("\ufeff40\t250\t3\n".encode("utf-16-le")[:-1], "as UTF-16-LE, but in line 1 the byte 0x0a, number 19"),
        ("\ufeff4\n".encode("utf-16-be") + b"\xd8\x00\x00\x34", "as UTF-16-BE, but in line 2 the byte 0xd8, number 7"),
        ("\ufeff40".encode("utf-32-le") + b"\xff\xff\xff\xff", "as UTF-32-LE, but in line 1 the byte 0xff, number 13"),
        ("40\t250\t3\n".encode("utf-16-le"), "the file is not text: save the sheet as CSV"),
        (b"40\t250\t3\x81", "the file is not text: save the sheet as CSV"),
    ],
)
def test_a_byte_that_breaks_the_promise_of_the_mark_is_named_with_its_place(
    client: TestClient, content: bytes, words: str
) -> None:
    page = client.post("/paste", files={"file": ("zyklus.csv", content)})
    assert page.status_code == 422
    assert words in page.text


def test_a_workbook_is_refused_with_a_way_on(client: TestClient) -> None:
    page = client.post("/paste", files={"file": ("a.xlsx", b"PK\x03\x04\x00\x00")})
    assert page.status_code == 422
    assert "save it as XLSX or CSV" in page.text


def test_a_file_that_is_no_text_is_refused_in_the_readers_language(client: TestClient) -> None:
    reply = client.post("/paste", files={"file": ("a.bin", b"\x7fELF\0\0")}, headers={"Accept-Language": "de"})

    assert reply.status_code == 422
    assert "die Datei ist kein Text" in reply.text


@pytest.mark.parametrize("script", [True, False])
def test_a_cycle_may_come_as_parquet(client: TestClient, script: bool) -> None:
    file, headers = io.BytesIO(), HTMX if script else {}
    pq.write_table(pa.table({"torque_Nm": [40.5, 32], "speed_rpm": [250, 500], "duration_s": [0.3, 3]}), file)
    response = client.post("/paste", files={"file": ("cycle.parquet", file.getvalue())}, headers=headers)
    assert response.status_code == 200
    hidden = {name: unescape(value) for name, value in re.findall(r'name="(of|book)" value="([^"]*)"', response.text)}
    again = {"file": ("cycle.parquet", file.getvalue() if script else b"")}

    reply = client.post("/paste", data={**hidden, "take": "replace"}, files=again, headers=headers)

    query = query_of(reply.headers["location"])
    assert (query["T"], query["n"], query["t"]) == (["40.5", "32"], ["250", "500"], ["0.3", "3"])


def test_application_goes_out_as_a_file_and_comes_back_as_the_same_link(client: TestClient) -> None:
    link = f"/?{LINK}&FR=500&fw=1.2&bl=7"
    document = client.get(link.replace("/?", "/application.json?"))
    assert document.headers["content-disposition"] == 'attachment; filename="application.json"'
    reply = client.post("/api/v1/select", content=document.content, headers={"content-type": "application/json"})
    assert reply.status_code == 200
    opened = client.post("/paste", files={"file": ("application.json", document.content)})
    assert opened.status_code == 303
    assert query_of(opened.headers["location"]) == query_of(link)


@pytest.mark.parametrize("decimal", [".", ","])
def test_cycle_goes_out_as_csv_and_comes_back(client: TestClient, decimal: str) -> None:
    named = "&pn=%22a%22%2C+b%3B+c&T=3&n=1&t=1&FRi=&pn=1.0"
    table = client.get(f"/cycle.csv?T=40.5&n=250&t=0.3&FRi=500{named}&decimal={decimal}")
    assert table.headers["content-type"].startswith("text/csv")
    assert f"40{decimal}5" in table.text
    back = client.post("/paste", data={"text": table.text, "take": "replace"})
    assert query_of(back.headers["location"]) == {
        "T": ["40.5", "3"],
        "n": ["250", "1"],
        "t": ["0.3", "1"],
        "FRi": ["500"],
        "pn": ['"a", b; c', "1.0"],
    }


def test_a_name_is_no_formula_of_a_spreadsheet(client: TestClient) -> None:
    table = client.get("/cycle.csv?T=40&n=250&t=0.3&pn=%3DHYPERLINK(1)").text
    assert table.splitlines()[1].endswith(",'=HYPERLINK(1)")


@pytest.mark.parametrize(
    "path", ["/application.json?T=x&n=1&t=1", "/cycle.csv?T=1&n=1&t=1&decimal=;", "/cycle.csv?T=&n=&t="]
)
def test_file_of_a_wrong_link_is_422(client: TestClient, path: str) -> None:
    reply = client.get(path)
    assert reply.status_code == 422
    assert reply.json()["detail"]


# --- Files that are read beside the service ---------------------------------------------------------------------------


@pytest.mark.parametrize("script", [True, False])
def test_a_file_that_stands_for_too_much_is_a_413_and_the_form_is_kept(client: TestClient, script: bool) -> None:
    files, headers = {"file": ("a.arrow", made("Arrow with a long text"))}, HTMX if script else {}
    reply = client.post("/paste", data={"link": LINK}, files=files, headers={**headers, "Accept-Language": "de"})

    assert reply.status_code == 413
    assert "braucht zu viel Speicher oder Zeit" in reply.text
    assert script or quoted(LINK) in reply.text


def test_where_all_places_are_taken_the_file_is_to_be_sent_again_and_the_form_is_kept(client: TestClient) -> None:
    with taken_places(client):
        reply = client.post("/paste", data={"link": LINK}, files={"file": ("a.csv", GERMAN.encode())})
        short = client.post("/paste", data={"link": LINK, "text": GERMAN})
        long = client.post("/paste", data={"link": LINK, "text": LONG})

    assert (reply.status_code, short.status_code, long.status_code) == (503, 200, 503)
    assert int(reply.headers["Retry-After"]) > 0 and quoted(LINK) in reply.text
    assert "40.9;339;0.25" in long.text


@contextmanager
def taken_places(client: TestClient) -> Iterator[None]:
    """Take all places of the pool for files."""
    pool, places = state_of(client).pools["files"], PLACES["files"]
    with ExitStack() as stack:
        for _ in range(sum(places)):
            stack.enter_context(pool.place())
        yield


def quoted(link: str) -> str:
    """Link in the form's HTML."""
    return f'value="{escape(link)}"'
