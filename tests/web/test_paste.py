"""Pasting a table, opening a file, long cycles and the files that the page gives away, over HTTP."""

import io
import json
import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from html import escape, unescape
from urllib.parse import parse_qs, quote, urlsplit

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.door.pools import PLACES
from hpn.web.form.link_reader import MAXIMUM_QUERY_BYTES, ROWS_IN_TABLE
from tests.fuzz.costly import made
from tests.state import state_of

LINK = "T=40&n=250&t=0.3&T=32&n=500&t=3&tp=4&Tk=200&i=5"
GERMAN = "Drehmoment [Nm]\tDrehzahl [1/min]\tDauer [s]\r\n9,3\t1.250\t0,3\r\n-12,5\t500\t1,25\r\n"
LONG = "".join(f"40.{k % 10};{250 + k % 90};0.25\n" for k in range(4000))
HTMX = {"HX-Request": "true"}


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    app = create_app()
    yield TestClient(app, follow_redirects=False)
    app.state.pools.close()  # files are read in a process


def query_of(location: str) -> dict[str, list[str]]:
    return parse_qs(urlsplit(location).query)


def cells(page: str) -> list[str]:
    """Cells of the rows of a preview."""
    return re.findall(r"<td>(?:<mark>)?([^<]+)(?:</mark>)?</td>", page)


def chosen(page: str) -> dict[str, str]:
    """Value of each select of a preview; blank where it is asked."""
    selects = re.findall(r'<select name="(\w+)".*?</select>', page, re.DOTALL)
    found = re.findall(r'<select name="(\w+)"[^>]*>.*?<option(?: value="([^"]*)")? selected', page, re.DOTALL)
    assert len(found) == len(selects)
    return dict(found)


def of(page: str) -> str:
    """Digest that the choices of a preview are tied to."""
    found = re.search(r'name="of" value="(\w+)"', page)
    assert found
    return found[1]


def test_preview_names_separator_columns_and_every_number(client: TestClient) -> None:
    page = client.post("/paste", data={"link": LINK, "text": GERMAN}, headers=HTMX)
    assert page.status_code == 200
    assert "<html" not in page.text
    assert "Columns apart by tab." in page.text
    assert chosen(page.text) == {"r0": "T", "u0": "Nm", "r1": "n", "u1": "rpm", "r2": "t", "u2": "s"}
    assert cells(page.text) == ["9.3", "1\u202f250", "0.3", "\N{MINUS SIGN}12.5", "500", "1.25"]


def test_an_open_question_shows_what_each_answer_makes_of_the_table(client: TestClient) -> None:
    page = client.post("/paste", data={"link": LINK, "text": "12\t1,250\t2\n-4\t2,500\t1\n"}, headers=HTMX).text
    tiles = re.findall(
        r'type="radio"\s+name="decimal".*?value="(.)"( checked)?>\s*<b>([^<]*)</b>\s*<small>([^<]*)', page
    )

    assert tiles == [
        (".", "", "a point: 1\u202f250", "speeds 1\u202f250\u202frpm to 2\u202f500\u202frpm, cycle 3\u202fs"),
        (",", "", "a comma: 1.250", "speeds 1.25\u202frpm to 2.5\u202frpm, cycle 3\u202fs"),
    ]
    assert "disabled" in page


@pytest.mark.parametrize("headers", [HTMX, {}], ids=["with script", "without"])
def test_each_column_can_be_read_as_something_else(client: TestClient, headers: dict[str, str]) -> None:
    page = client.post("/paste", data={"link": LINK, "text": GERMAN}, headers=headers)
    choices = chosen(page.text) | {"of": of(page.text), "u2": "ms", "r0": "n", "r1": "T"}
    asked = client.post("/paste", data={"link": LINK, "text": GERMAN, **choices}, headers=headers)
    assert chosen(asked.text) == {"r0": "n", "u0": "", "r1": "T", "u1": "", "r2": "t", "u2": "ms"}
    choices |= {"u0": "rpm", "u1": "Nm"}
    again = client.post("/paste", data={"link": LINK, "text": GERMAN, **choices}, headers=headers)
    assert chosen(again.text) == {"r0": "n", "u0": "rpm", "r1": "T", "u1": "Nm", "r2": "t", "u2": "ms"}
    took = client.post("/paste", data={"text": GERMAN, **choices, "take": "replace"}, headers=headers)
    assert query_of(took.headers["location"]) == {
        "T": ["1250", "500"],
        "n": ["9.3", "-12.5"],
        "t": ["0.0003", "0.00125"],
    }


@pytest.mark.parametrize("headers", [HTMX, {}], ids=["with script", "without"])
def test_a_button_before_the_questions_skips_all_columns_that_nobody_knows(
    client: TestClient, headers: dict[str, str]
) -> None:
    text = "T;n;Dauer;Temp A;Temp B\n40;250;0,3;20;21"
    page = client.post("/paste", data={"text": text}, headers=headers).text
    button = page.index('name="rest" value="skip"')
    assert "Skip 2 columns that were not recognised" in page
    assert button < page.index("What is column")

    skipped = client.post("/paste", data={"text": text, **chosen(page), "of": of(page), "rest": "skip"}).text
    assert chosen(skipped)["r3"] == chosen(skipped)["r4"] == "skip"
    assert 'name="rest"' not in skipped
    took = client.post("/paste", data={"text": text, **chosen(skipped), "of": of(skipped), "take": "replace"})
    assert query_of(took.headers["location"])["T"] == ["40"]


def test_nothing_is_taken_while_anything_is_asked(client: TestClient) -> None:
    page = client.post("/paste", data={"link": LINK, "text": "1.234\t250\t3", "take": "replace"}, headers=HTMX)
    assert page.status_code == 200
    assert "Which is the decimal mark?" in page.text
    assert cells(page.text) == ["1.234", "250", "3"]
    assert "<mark>1.234</mark>" in page.text
    buttons = re.findall(r"<button[^>]*name=\"take\"[^>]*>", page.text)
    assert len(buttons) == 2 and all("disabled" in button for button in buttons)


EXAMPLE = "T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
EXAMPLE_IN_US = (
    "written=de.lb_in&was=Nm:40 Nm:32 Nm:20 Nm:200&T=354,03&n=250&t=0,3&T=283,22&n=500&t=3&T=177,01&n=250&t=0,4"
    "&tp=4&Tk=1770,1&Nk=&FR=&i=5"
)


@pytest.mark.parametrize("link", [EXAMPLE, EXAMPLE_IN_US], ids=["as a link", "as the form shows it"])
def test_table_in_place_of_the_worked_example_starts_without_its_pause_stop_and_ratio(
    client: TestClient, link: str
) -> None:
    page = client.post("/paste", data={"link": link, "text": GERMAN}, headers=HTMX)
    assert "leaves out the worked example’s pause, emergency stop and ratio" in page.text
    assert "Append" not in page.text
    took = client.post("/paste", data={"link": link, "text": GERMAN, "take": "replace"})
    assert query_of(took.headers["location"]).keys() == {"T", "n", "t"}


def test_changed_example_keeps_what_it_says(client: TestClient) -> None:
    link = EXAMPLE.replace("tp=4", "tp=5")
    page = client.post("/paste", data={"link": link, "text": GERMAN}, headers=HTMX)
    assert "worked example" not in page.text
    took = client.post("/paste", data={"link": link, "text": GERMAN, "take": "replace"})
    assert {"tp", "Tk", "i"} <= query_of(took.headers["location"]).keys()


def test_taking_replaces_the_phases_and_keeps_everything_else(client: TestClient) -> None:
    reply = client.post("/paste", data={"link": LINK, "text": GERMAN, "take": "replace"})
    assert reply.status_code == 303
    assert query_of(reply.headers["location"]) == {
        "T": ["9.3", "-12.5"],
        "n": ["1250", "500"],
        "t": ["0.3", "1.25"],
        "tp": ["4"],
        "Tk": ["200"],
        "i": ["5"],
    }


def test_adding_puts_the_phases_behind_those_there(client: TestClient) -> None:
    reply = client.post("/paste", data={"link": LINK, "text": "T\tn\tt\tFR\n5\t10\t1\t300", "take": "append"})
    given = parse_qs(urlsplit(reply.headers["location"]).query, keep_blank_values=True)
    assert given["T"] == ["40", "32", "5"]
    assert given["FRi"] == ["", "", "300"]
    assert client.get(reply.headers["location"]).status_code == 200


@pytest.mark.parametrize(
    "text", ["40\tx\t3", "40\t250", "T\tn\tt", "{", '{"duty_cycle": {"phases": [{"torque_Nm": "a"}]}}']
)
def test_a_table_that_can_not_be_taken_is_a_422_that_says_why(client: TestClient, text: str) -> None:
    page = client.post("/paste", data={"link": LINK, "text": text, "take": "replace"})
    assert page.status_code == 422
    assert 'class="error"' in page.text
    assert quote("T=40")[0] in page.text and 'value="T=40' in page.text


@pytest.mark.parametrize(("columns", "refused"), [(200, False), (201, True), (45_000, True)])
def test_more_columns_than_any_table_has_are_refused(client: TestClient, columns: int, refused: bool) -> None:
    """A table of 45,000 columns took five seconds: each of its numbers was looked at as a heading."""
    row = ";".join(["40.5"] * columns)
    page = client.post("/paste", data={"link": LINK, "text": f"{row}\n{row}"}, headers=HTMX)
    assert (page.status_code == 422) == refused
    assert ("there are more than 200 columns" in page.text) == refused


def test_a_table_with_a_column_for_each_phase_may_be_as_wide_as_a_cycle_is_long(client: TestClient) -> None:
    rows = ("Torque [Nm]", "Speed [rpm]", "Duration [s]")
    text = "\n".join(";".join([name, *map(str, range(1, 301))]) for name in rows)
    taken = client.post("/paste", data={"text": text, "take": "replace"})
    assert query_of(taken.headers["location"])["T"] == [str(k) for k in range(1, 301)]


def test_error_in_a_json_file_names_the_field(client: TestClient) -> None:
    body = {"duty_cycle": {"phases": [{"torque_Nm": 1, "speed_rpm": 1, "duration_s": -1}]}}
    page = client.post("/paste", files={"file": ("a.json", json.dumps(body))})
    assert page.status_code == 422
    assert "/duty_cycle/phases/0/duration_s" in page.text


@pytest.mark.parametrize("take", ["", "all", "x" * 999, "replace²", "1"])
def test_taking_what_is_not_there_only_shows(client: TestClient, take: str) -> None:
    assert client.post("/paste", data={"link": "%%%", "text": GERMAN, "take": take}).status_code == 200


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_files_are_read_in_the_encodings_of_spreadsheets(client: TestClient, encoding: str) -> None:
    text = GERMAN.replace("\t", ";").replace("Dauer", "Zeit")
    page = client.post("/paste", files={"file": ("zyklus.csv", text.encode(encoding))}, data={"link": LINK})
    assert page.status_code == 200
    assert "Columns apart by semicolon" in page.text
    assert chosen(page.text)["r2"] == "t"


@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be", "utf-32-le", "utf-32-be"])
def test_files_are_read_in_the_encoding_that_their_mark_promises(client: TestClient, encoding: str) -> None:
    content = ("\ufeff" + GERMAN).encode(encoding)
    page = client.post("/paste", files={"file": ("zyklus.txt", content)}, headers=HTMX)
    assert page.status_code == 200
    assert "<td>9.3</td>" in page.text


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\xef\xbb\xbf40\t250\t3\n4\xfc\t1\t1\n", "as UTF-8, but in line 2 the byte 0xfc, number 14"),
        (b"\xef\xbb\xbf40\t250\t3\xc3", "as UTF-8, but in line 1 the byte 0xc3, number 12"),
        ("\ufeff40\t250\t3\n".encode("utf-16-le")[:-1], "as UTF-16-LE, but in line 1 the byte 0x0a, number 19"),
        ("\ufeff4\n".encode("utf-16-be") + b"\xd8\x00\x00\x34", "as UTF-16-BE, but in line 2 the byte 0xd8, number 7"),
        ("\ufeff40".encode("utf-32-le") + b"\xff\xff\xff\xff", "as UTF-32-LE, but in line 1 the byte 0xff, number 13"),
        ("40\t250\t3\n".encode("utf-16-le"), "the file is no text: save the sheet as CSV"),
        (b"40\t250\t3\x81", "the file is no text: save the sheet as CSV"),
    ],
)
def test_a_byte_that_breaks_the_promise_of_the_mark_is_named_with_its_place(
    client: TestClient, content: bytes, words: str
) -> None:
    page = client.post("/paste", files={"file": ("zyklus.csv", content)})
    assert page.status_code == 422
    assert words in page.text


NO_NUMBERS = [
    *(
        "e6",
        "E6",
        "+",
        "-",
        "+e6",
        "-e6",
        ".",
        ",",
        ".e6",
        ",e6",
        "+.",
        "-,",
        "e",
        "1e",
        "1e+",
        "e+6",
        "--1",
        "1-",
        "+-1",
    ),
    *(
        "1e6e6",
        "0x10",
        "1_0",
        "nan",
        "inf",
        "∞",
        "\N{MINUS SIGN}",
        "\N{MINUS SIGN}e6",
        "'",
        "1'",
        "²",
        "١",
        "'000",
        "1" * 401,
    ),
    *("1\x002", "1\ufeff2", "\x00"),
]
ODD_NUMBERS = [
    "1e999",
    "1e-999",
    "-1e999",
    "9" * 399,
    "1,000.",
    "1.000,",
    ",000",
    ".5e3",
    "5.e3",
    "1 2",
    "\u202f1",
    " ",
]


@pytest.mark.parametrize("column", [0, 1, 2])
def test_no_odd_cell_is_an_error_of_the_server(client: TestClient, column: int) -> None:
    for cell in NO_NUMBERS + ODD_NUMBERS:
        cells = ["1", "2", "3"]
        cells[column] = cell
        text = "\t".join(cells)
        shown = client.post("/paste", data={"text": text}, headers=HTMX)
        taken = client.post("/paste", data={"text": text, "take": "replace"}, follow_redirects=True)
        assert {shown.status_code, taken.status_code} <= ({422} if cell in NO_NUMBERS else {200, 422}), repr(cell)


def test_a_workbook_is_refused_with_a_way_on(client: TestClient) -> None:
    page = client.post("/paste", files={"file": ("a.xlsx", b"PK\x03\x04\x00\x00")})
    assert page.status_code == 422
    assert "save it as XLSX or CSV" in page.text


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


def test_cycle_too_long_for_an_address_is_answered_where_it_is_taken(client: TestClient) -> None:
    page = client.post("/paste", data={"link": LINK, "text": LONG, "take": "replace"}, headers=HTMX)
    assert page.status_code == 200
    assert page.headers["HX-Push-Url"] == "/paste"
    assert '<textarea id="phases"' in page.text
    assert "too long for a link" in page.text
    again = client.post("/", data={"phases": LONG.replace(";", "\t"), "tp": "4", "Tk": "200", "i": "5"}, headers=HTMX)
    figures = [re.findall(r'<data class="quantity" value="([^"]*)"', text) for text in (page.text, again.text)]
    assert figures[0] == figures[1] != []


def test_error_in_a_long_cycle_names_the_phase_and_keeps_the_text(client: TestClient) -> None:
    text = LONG.replace("40.7;", "40,7;", 1)
    page = client.post("/", data={"phases": text}, headers=HTMX)
    assert page.status_code == 422
    assert "Phase 8, Torque: write 40.7" in page.text
    assert "\n40,7;257;0.25\n" in page.text


def test_rows_turn_into_text_only_beyond_what_a_table_holds(client: TestClient) -> None:
    for count, marker in ((ROWS_IN_TABLE, 'id="T-0"'), (ROWS_IN_TABLE + 1, 'id="phases"')):
        page = client.get("/?" + "&".join(["T=40&n=250&t=1"] * count))
        assert marker in page.text


def test_body_beyond_the_limit_is_413(client: TestClient) -> None:
    assert client.post("/paste", data={"text": "1" * 2_100_000}).status_code == 413
    assert client.post("/", data={"phases": "1" * 2_100_000}).status_code == 413


def test_long_link_is_told_the_way_to_paste(client: TestClient) -> None:
    assert 'href="/paste"' in client.get("/?T=" + "9" * MAXIMUM_QUERY_BYTES).text


def test_row_edits_are_applied_in_the_order_they_were_pressed(client: TestClient) -> None:
    page = client.get(f"/?{LINK}&do=add&do=remove:1&do=up:2", headers=HTMX)
    assert re.findall(r'name="T" type="text" inputmode="decimal" value="([^"]*)"', page.text) == ["", "32"]


@pytest.mark.parametrize(("head", "cell"), [("n [1/s]", "10"), ("n", "10 1/s")])
def test_a_speed_per_second_is_said_to_have_two_readings_in_the_readers_words(
    client: TestClient, head: str, cell: str
) -> None:
    reply = client.post("/paste", data={"text": f"T\t{head}\tt\n40\t{cell}\t3"}, headers={"Accept-Language": "de"})
    assert "kann U/s oder rad/s sein" in reply.text


def test_a_file_that_is_no_text_is_refused_in_the_readers_language(client: TestClient) -> None:
    reply = client.post("/paste", files={"file": ("a.bin", b"\x7fELF\0\0")}, headers={"Accept-Language": "de"})

    assert reply.status_code == 422
    assert "die Datei ist kein Text" in reply.text


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
    """Every place for files is taken by others."""
    pool, places = state_of(client).pools["files"], PLACES["files"]
    with ExitStack() as stack:
        for _ in range(sum(places)):
            stack.enter_context(pool.place())
        yield


def quoted(link: str) -> str:
    """A link as it stands in the form."""
    return f'value="{escape(link)}"'


@pytest.mark.parametrize("script", [True, False])
def test_a_cycle_may_come_as_parquet(client: TestClient, script: bool) -> None:
    file, headers = io.BytesIO(), HTMX if script else {}
    pq.write_table(pa.table({"torque_Nm": [40.5, 32], "speed_rpm": [250, 500], "duration_s": [0.3, 3]}), file)
    shown = client.post("/paste", files={"file": ("cycle.parquet", file.getvalue())}, headers=headers)
    assert shown.status_code == 200
    hidden = {name: unescape(value) for name, value in re.findall(r'name="(of|book)" value="([^"]*)"', shown.text)}
    again = {"file": ("cycle.parquet", file.getvalue() if script else b"")}

    reply = client.post("/paste", data={**hidden, "take": "replace"}, files=again, headers=headers)

    query = query_of(reply.headers["location"])
    assert (query["T"], query["n"], query["t"]) == (["40.5", "32"], ["250", "500"], ["0.3", "3"])
