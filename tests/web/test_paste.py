"""Pasting a table, and long cycles, over HTTP."""

import re
from html import unescape
from urllib.parse import parse_qs, quote, urlsplit

import pytest
from starlette.testclient import TestClient

from hpn.links.rows import ROWS_IN_TABLE
from hpn.web.door.access import MAXIMUM_QUERY_BYTES
from hpn.web.door.bodies import pairs_of
from hpn.web.form.link_reader import parse
from tests.web.paste import GERMAN, HTMX, LINK, LONG, cells, chosen, of, query_of


def test_preview_names_separator_columns_and_every_number(client: TestClient) -> None:
    page = client.post("/paste", data={"link": LINK, "text": GERMAN}, headers=HTMX)
    assert page.status_code == 200
    assert "<html" not in page.text
    assert "Column separator: tab." in page.text
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
    assert re.findall(r'<path d="([^"]*)"', page) == ["M0 30.0V15.0H66.7V0.0H100.0V30.0"] * 2
    assert "<figcaption" not in page and "cycle-words" not in page


def test_each_answer_shows_its_cycle_where_by_one_of_them_a_named_row_is_no_sum(client: TestClient) -> None:
    """With a decimal comma 1,900 is not the sum of the times; only the next question asks about it."""
    text = "Step\tT\tn\tt [ms]\nrise\t12\t1,250\t350\nrun\t5\t2,500\t1,200\nbrake\t-9\t1,250\t350\nSum\t\t\t1,900\n"
    page = client.post("/paste", data={"text": text}, headers=HTMX).text

    assert re.findall(r"<small>([^<]*)</small>", page) == [
        "speeds 1\u202f250\u202frpm to 2\u202f500\u202frpm, cycle 1.9\u202fs",
        "speeds 1.25\u202frpm to 2.5\u202frpm, cycle 0.701\u202fs",
    ]


def test_a_preview_shows_cells_as_written_and_as_read_and_skipped_rows_in_their_places(client: TestClient) -> None:
    text = "Infeed\n\nStep\tM [Nm]\tn [rpm]\tt [ms]\nrise\t12\t1250\t400\nrun\t5\t2500\t350\nSum\t\t\t750\n"
    page = client.post("/paste", data={"text": text}, headers=HTMX).text
    rows = re.findall(r'<th scope="row">(\d+)</th>(.*?)</tr>', page, re.S)

    assert [(int(number), re.findall(r"<s>(.*?)</s> skipped", row)) for number, row in rows] == [
        (1, ["Infeed"]),
        (4, []),
        (5, []),
        (6, ["Sum"]),
    ]
    assert re.findall(r"<small[^>]*>(.*?)</small>", page) == ["400", "350"]
    assert cells(page) == ["12", "1\u202f250", "0.4", "5", "2\u202f500", "0.35"]
    assert "4 columns, 4 of them read. All phases take 0.75 s." in " ".join(page.split())


def test_a_column_of_remarks_names_the_phases_unless_another_text_does(client: TestClient) -> None:
    alone = "M\tn\tt\tBemerkung\n12\t250\t3\theben\n5\t500\t1\tsenken\n"
    beside = "Schritt\tM\tn\tt\tBemerkung\nauf\t12\t250\t3\theben\nab\t5\t500\t1\tsenken\n"

    assert chosen(client.post("/paste", data={"text": alone}, headers=HTMX).text)["r3"] == "pn"
    assert chosen(client.post("/paste", data={"text": beside}, headers=HTMX).text)["r0"] == "pn"
    assert chosen(client.post("/paste", data={"text": beside}, headers=HTMX).text)["r4"] == "skip"


@pytest.mark.parametrize("headers", [HTMX, {}], ids=["with script", "without"])
def test_each_column_can_be_read_as_something_else(client: TestClient, headers: dict[str, str]) -> None:
    page = client.post("/paste", data={"link": LINK, "text": GERMAN}, headers=headers)
    choices = chosen(page.text) | {"of": of(page.text), "u2": "ms", "r0": "n", "r1": "T"}
    response = client.post("/paste", data={"link": LINK, "text": GERMAN, **choices}, headers=headers)
    assert chosen(response.text) == {"r0": "n", "u0": "", "r1": "T", "u1": "", "r2": "t", "u2": "ms"}
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
    assert "drops the worked example’s pause, emergency stop and ratio" in page.text
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
    inputs = parse_qs(urlsplit(reply.headers["location"]).query, keep_blank_values=True)
    assert inputs["T"] == ["40", "32", "5"]
    assert inputs["FRi"] == ["", "", "300"]
    assert client.get(reply.headers["location"]).status_code == 200


@pytest.mark.parametrize(
    ("take", "remaining"), [("append", ["phases.1.torque_Nm", "torque_Nm"]), ("replace", ["torque_Nm"])]
)
def test_the_tolerance_of_a_phase_stays_with_it_and_goes_with_it(
    client: TestClient, take: str, remaining: list[str]
) -> None:
    link = f"{LINK}&tol=T:5p&tol=T.2:10p"
    reply = client.post("/paste", data={"link": link, "text": "T\tn\tt\n5\t10\t1\n6\t20\t1", "take": take})
    question = parse(pairs_of(urlsplit(reply.headers["location"]).query)).application

    assert question is not None and sorted(question.tolerances or ()) == remaining


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
    """A table of 45,000 columns took five seconds, as each of its numbers was tried as a heading."""
    row = ";".join(["40.5"] * columns)
    page = client.post("/paste", data={"link": LINK, "text": f"{row}\n{row}"}, headers=HTMX)
    assert (page.status_code == 422) == refused
    assert ("there are more than 200 columns" in page.text) == refused


def test_a_table_with_a_column_for_each_phase_may_be_as_wide_as_a_cycle_is_long(client: TestClient) -> None:
    rows = ("Torque [Nm]", "Speed [rpm]", "Duration [s]")
    text = "\n".join(";".join([name, *map(str, range(1, 301))]) for name in rows)
    taken = client.post("/paste", data={"text": text, "take": "replace"})
    assert query_of(taken.headers["location"])["T"] == [str(k) for k in range(1, 301)]


@pytest.mark.parametrize("take", ["", "all", "x" * 999, "replace²", "1"])
def test_taking_what_is_not_there_only_shows(client: TestClient, take: str) -> None:
    assert client.post("/paste", data={"link": "%%%", "text": GERMAN, "take": take}).status_code == 200


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
        response = client.post("/paste", data={"text": text}, headers=HTMX)
        taken = client.post("/paste", data={"text": text, "take": "replace"}, follow_redirects=True)
        assert {response.status_code, taken.status_code} <= ({422} if cell in NO_NUMBERS else {200, 422}), repr(cell)


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
    assert re.findall(
        r'name="T" type="text" inputmode="decimal" value="([^"]*)"', page.text.partition("<template")[0]
    ) == ["", "32"]


@pytest.mark.parametrize(("head", "cell"), [("n [1/s]", "10"), ("n", "10 1/s")])
def test_a_speed_per_second_is_said_to_have_two_readings_in_the_readers_words(
    client: TestClient, head: str, cell: str
) -> None:
    reply = client.post("/paste", data={"text": f"T\t{head}\tt\n40\t{cell}\t3"}, headers={"Accept-Language": "de"})
    assert "kann U/s oder rad/s sein" in reply.text


def test_a_row_of_the_emergency_stop_goes_to_its_torque_and_takes_the_place_of_a_brake(client: TestClient) -> None:
    text = "Phase;T [Nm];n;t [s]\nA;40;250;3\nB;32;500;0.3\nE-stop;-200;250;0.1\nNot-Halt;150;250;0.1"
    page = client.post("/paste", data={"text": text}).text
    fields = {"text": text, "of": of(page), "stop": "stop", "link": "T=1&n=1&t=1&TB=8&tb=0.1&Nk=50&i=5"}
    page_text = client.post("/paste", data=fields).text
    reply = client.post("/paste", data={**fields, "take": "replace"}, follow_redirects=False)

    query = query_of(reply.headers["location"])
    assert (query["T"], query["Tk"], query["Nk"], query["i"]) == (["40", "32"], ["-200"], ["50"], ["5"])
    assert not {"TB", "tb"} & query.keys()
    assert "Row 4 is the emergency stop: −200\u202fNm." in unescape(page_text)
    assert "Row 5 is the emergency stop: 150\u202fNm." in unescape(page_text)
