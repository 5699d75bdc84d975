"""Motor lists on the pages, sent what no browser sends and no data sheet says: refused in words, shown as text."""

import json
import random
import re
from collections.abc import Iterator
from html import unescape
from html.parser import HTMLParser
from urllib.parse import quote

import pytest
from httpx2 import Response
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.fuzz.mutation import mutated
from tests.web.sheets import cells, typed
from tests.web.test_motor_list_pages import SHEET, hidden, kept, sent

CURVED = """Motor;J [kg·cm²];n_max [rpm];curve speed [rpm];M S1 [Nm];curve peak torque [Nm]
S60;0.4;6000;0;2.8;7.2
S60;0.4;6000;3000;2.4;7.2
S80;1.1;5000;0;5.6;16
S80;1.1;5000;5000;3;6
"""
COLUMNS = "Motor;continuous 0 rpm [Nm];peak 0 rpm [Nm];continuous 3000 rpm [Nm];peak 3000 rpm [Nm]\nS60;2.8;7.2;1.5;3\n"
WORDS = (
    b"Motor;Nm;rpm;kg\xc2\xb7cm\xc2\xb2;M_N [Nm];curve speed [rpm];continuous 0 rpm;peak;[;];(;);\t;\n;\r\n;,;.".split(
        b";"
    )
)
SCRIPT = '"><script>alert(1)</script><img src=x onerror=alert(1)>'
LINK = "T=5&n=100&t=1"
READ, SAID = (200, 422), (200, 303, 409, 413, 422)
"""Statuses of a table that is shown as it is read, and of one that may be kept."""


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A client that shows a mistake of the service as an answer 500."""
    file = tmp_path_factory.mktemp("hostile") / "store.sqlite3"
    app = create_app(Settings(database_url=f"sqlite:///{file}", log_level="error"))
    with TestClient(app, raise_server_exceptions=False) as client:
        yield client


@pytest.fixture(scope="module")
def place(hostile: TestClient) -> str:
    """Address of a kept list, which nothing in this file may change."""
    return kept(hostile, "Kept", SHEET)


class _Elements(HTMLParser):
    """Elements of a page that a script of another could be in."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.foreign: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if (tag == "script" and "src" not in given and given.get("type") is None) or given.get("src") == "x":
            self.foreign.append(tag)
        self.foreign += [f"{tag} {name}" for name in given if name.startswith("on")]


def require_plain(page: Response) -> None:
    """No text of another becomes a part of the page."""
    if page.headers.get("content-type", "").startswith("text/html"):
        assert _Elements(page.text).foreign == []
    else:
        assert page.status_code != 200


def names(hostile: TestClient) -> list[str]:
    """Names of the lists that are kept."""
    return [one["name"] for one in hostile.get("/api/v1/motor-lists").json()["lists"]]


# --- Addresses --------------------------------------------------------------------------------------------------------

IDS = ("x", "server", "SERVER", "%2e%2e%2f", "%00", "a%00b", "%ff%fe", "-1", "0", SCRIPT, "\u202e", "9" * 3000)


@pytest.mark.parametrize("id", IDS)
@pytest.mark.parametrize(("method", "end"), [("GET", ""), ("POST", "/save"), ("POST", "/delete")])
def test_an_id_of_no_list_is_said_and_never_shown_as_markup(
    hostile: TestClient, id: str, method: str, end: str
) -> None:
    before, address = names(hostile), f"/motor-lists/{quote(id, safe='%.')}{end}"
    data = {"text": SHEET, "name": "Other", "keep": "1", "version": "1"} if method == "POST" else None
    page = hostile.request(method, address, data=data, follow_redirects=False)

    is_shown = (id, method) == ("server", "GET")  # motors.csv, which has no motor here
    assert page.status_code in ((200,) if is_shown else (307, 403, 404, 405, 414, 422))
    require_plain(page)
    assert names(hostile) == before


# --- Names ------------------------------------------------------------------------------------------------------------


def test_markup_in_names_and_headings_is_shown_as_text_on_every_page(hostile: TestClient) -> None:
    cell = SCRIPT.replace('"', "'")
    text = f"Motor;M_N [Nm];M_max [Nm];n_max [rpm];{cell}\n{cell}\t;5;15;6000;{cell}\nplain;5;15;6000;1\n"
    asked = sent(hostile, {"text": text, "name": SCRIPT, "keep": "1", "link": SCRIPT})
    require_plain(asked)
    answer = sent(hostile, {**hidden(asked.text), "rest": "skip", "name": SCRIPT, "keep": "1", "link": LINK})
    assert answer.status_code == 303, answer.text
    id = answer.headers["location"].rpartition("list=")[2]

    pages = [hostile.get(path) for path in (answer.headers["location"], f"/motor-lists/{id}", "/motor-lists")]
    for page in pages:
        assert page.status_code == 200
        assert "onerror" in unescape(page.text)
        require_plain(page)
    assert cell in unescape(pages[0].text)
    assert hostile.post(f"/motor-lists/{id}/delete", data={"version": "1"}, follow_redirects=False).status_code == 303


@pytest.mark.parametrize("name", ["x" * 10_000, "a\u200bb", "\u202egnp", "\x00", "\x1b[31m", " ", ""])
def test_a_name_that_is_none_is_refused_in_words(hostile: TestClient, name: str) -> None:
    before = names(hostile)
    page = sent(hostile, {"text": SHEET, "name": name, "keep": "1"})

    assert page.status_code == 422
    assert re.search(r'class="[^"]*error', page.text)
    assert names(hostile) == before


@pytest.mark.parametrize(
    "link", ["//elsewhere.example", "\r\nSet-Cookie: a=b", "javascript:alert(1)", "https://elsewhere.example/?a", "#"]
)
def test_a_link_leads_to_the_pairs_of_this_service_and_nowhere_else(hostile: TestClient, link: str) -> None:
    answer = sent(hostile, {"text": SHEET, "name": "Linked", "keep": "1", "link": link})

    assert answer.status_code == 303
    assert answer.headers["location"].startswith("/pairs?")
    assert "set-cookie" not in answer.headers
    id = re.search(r"list=([^&]*)$", answer.headers["location"])
    assert id
    assert hostile.get(answer.headers["location"]).status_code in READ
    assert hostile.delete(f"/api/v1/motor-lists/{id[1]}").status_code == 204


# --- Versions ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", ["0", "2", "-1", "1.0", "x", "²", "9" * 400, " 1", "1e0"])
@pytest.mark.parametrize("end", ["save", "delete"])
def test_another_version_than_the_one_that_is_kept_changes_nothing(
    hostile: TestClient, place: str, version: str, end: str
) -> None:
    before = hostile.get(f"/api/v1{place}")
    fields = {"text": SHEET.replace("0.64", "0.9"), "name": "Changed", "keep": "1", "version": version}
    page = hostile.post(f"{place}/{end}", data=fields, follow_redirects=False)

    assert page.status_code == 412
    after = hostile.get(f"/api/v1{place}")
    assert (after.content, after.headers["etag"]) == (before.content, before.headers["etag"])


def test_a_form_from_elsewhere_changes_nothing(hostile: TestClient, place: str) -> None:
    before = hostile.get(f"/api/v1{place}").content
    for path in ("/motor-lists", f"{place}/save", f"{place}/delete"):
        data = {"text": SHEET, "name": "Elsewhere", "keep": "1", "version": "1"}
        page = hostile.post(path, data=data, headers={"origin": "http://elsewhere.example"}, follow_redirects=False)
        assert page.status_code == 403
    assert hostile.get(f"/api/v1{place}").content == before
    assert "Elsewhere" not in names(hostile)


# --- Sizes ------------------------------------------------------------------------------------------------------------


def rows(count: int) -> str:
    return "Motor;M_N [Nm];M_max [Nm]\n" + "".join(f"M {k};5;15\n" for k in range(count))


def points(count: int) -> str:
    head = "Motor;curve speed [rpm];M S1 [Nm];curve peak torque [Nm]\n"
    return head + "".join(f"S60;{k};2;3\n" for k in range(count))


@pytest.mark.parametrize(
    "text",
    [
        rows(5001),
        rows(21_000),
        points(51),
        points(20_500),
        "Motor;M_N [Nm];" + "x;" * 20_000 + "\nA;1;" + "1;" * 20_000,
        "Motor;M_N [Nm]\n" + "A" * 200_000 + ";1",
        "Motor;M_N [Nm]\nA;" + "9" * 200_000,
        "Motor;" + "M_N [Nm] " * 20_000 + "\nA;1",
        "Motor;"
        + ";".join(f"{side} {n} rpm [Nm]" for n in range(60) for side in ("continuous", "peak"))
        + "\nA"
        + ";1" * 120,
        "Motor;" + "continuous peak " * 5000 + "1 rpm;peak 1 rpm\nA;1;1",
        "\n" * 100_000,
        ";" * 300_000,
        "[" * 100_000 + ";(\nA;1",
    ],
    ids=[
        "motors",
        "rows",
        "points",
        "rows of points",
        "columns",
        "name",
        "digits",
        "heading",
        "speeds",
        "words",
        "lines",
        "blank",
        "brackets",
    ],
)
def test_a_table_beyond_all_bounds_is_refused_or_asked_about_and_never_kept(hostile: TestClient, text: str) -> None:
    page = sent(hostile, {"text": text, "name": "Large", "keep": "1"})

    assert page.status_code in (200, 413, 422)
    assert len(page.content) < 3_000_000
    assert "Large" not in names(hostile)


# --- Cells ------------------------------------------------------------------------------------------------------------

FIGURES = {"M_N [Nm]": "5", "M_max [Nm]": "15", "n_max [rpm]": "6000", "J_m [kg·cm²]": "0.4", "m [kg]": "2"}
BEYOND = (
    "1e400",
    "-1e400",
    "nan",
    "inf",
    "-Infinity",
    "-5",
    "1e309",
    "9" * 5000,
    "0x10",
    "٣٫٥",
    "½",
    "=1+1",
    "\x00",
    "1 2 3",
)


@pytest.mark.parametrize("number", BEYOND)
@pytest.mark.parametrize("heading", FIGURES)
def test_a_cell_that_is_no_figure_of_a_motor_never_becomes_one(hostile: TestClient, heading: str, number: str) -> None:
    cells = FIGURES | {heading: number}
    text = ";".join(("Motor", *cells)) + "\n" + ";".join(("A", *cells.values())) + "\n"
    page = sent(
        hostile, {"text": text + ";".join(("B", *FIGURES.values())), "name": "Cells", "keep": "1", "zeros": "unknown"}
    )

    assert page.status_code in SAID
    if page.status_code == 303:
        place = page.headers["location"]
        motors = hostile.get(f"/api/v1{place}").json()["motors"]
        hostile.delete(f"/api/v1{place}")
        for motor in motors:
            figures = [value for name, value in motor.items() if isinstance(value, float)]
            assert all(0 < value < 1e7 for value in figures), motor


@pytest.mark.parametrize(
    "rows",
    [
        "S60;0;2.8;7.2\nS60;0;2.8;7.2",
        "S60;3000;2.8;7.2\nS60;6000;2.8;7.2",
        "S60;0;2.8;7.2\nS60;-3000;2.4;7.2",
        "S60;0;2.8;7.2\nS60;3000;9;7.2",
        "S60;0;2.8;1\nS60;3000;2.4;7.2",
        "S60;0;2.8;7.2\nS60;3000;nan;7.2",
        "S60;0;2.8;7.2\nS60;1e400;2.4;7.2",
        "S60;0;2.8;7.2",
    ],
    ids=["twice", "not from 0", "negative", "above the peak", "below", "nan", "endless", "one point"],
)
def test_points_that_are_no_curve_are_never_one(hostile: TestClient, rows: str) -> None:
    text = f"Motor;curve speed [rpm];M S1 [Nm];curve peak torque [Nm]\n{rows}\n"
    page = sent(hostile, {"text": text, "name": "No curve", "keep": "1"})

    assert page.status_code in READ
    assert "No curve" not in names(hostile)


@pytest.mark.parametrize(
    "fields",
    [
        {"table": "no base64"},
        {"table": "A" * 100_000},
        {"table": "eJwDAAAAAAE="},
        {"r0": SCRIPT, "u0": SCRIPT, "r999999": "Tm", "u999999": "Nm"},
        {"r1": "ncv", "r2": "ncv", "r3": "ncv"},
        {"r-1": "Tm", "r1e3": "Tm", "u": "Nm", "r٣": "Tm"},
        {
            "decimal": SCRIPT,
            "blanks": "x" * 50_000,
            "zeros": "\x00",
            "twins": "all",
            "rest": SCRIPT,
            "sheet": "9" * 400,
        },
        {"of": SCRIPT, "sheet": "../../etc/passwd", "heading": "-1"},
    ],
)
def test_answers_to_no_question_are_no_mistake_of_the_service(hostile: TestClient, fields: dict[str, str]) -> None:
    text = {} if "table" in fields else {"text": CURVED}
    page = sent(hostile, text | fields)

    assert page.status_code in READ
    require_plain(page)


def test_broken_versions_of_a_data_sheet_are_read_asked_or_refused(hostile: TestClient, soak: bool) -> None:
    """A list that is kept has a page, is read over REST, is ranked or refused, and is edited as its own text."""
    corpus, met = [text.encode() for text in (SHEET, CURVED, COLUMNS)], set[int]()
    for seed in range(3000 if soak else 150):
        content = mutated(random.Random(seed), corpus, WORDS)
        name = f"Broken {seed}"
        fields = {"name": name, "keep": "1", "zeros": "unknown", "blanks": "unknown", "twins": "first", "rest": "skip"}
        fields["points"] = "skip"
        files: dict[str, tuple[str | None, bytes | str]] = {field: (None, said) for field, said in fields.items()}
        files["file"] = ("motors.csv", content)
        answer = hostile.post("/motor-lists", files=files, follow_redirects=False)
        met.add(answer.status_code)
        assert answer.status_code in SAID, (seed, answer.text)
        require_plain(answer)
        if answer.status_code == 303:
            require_usable(hostile, answer.headers["location"], name, seed)
    assert {200, 303, 422} <= met


def require_usable(hostile: TestClient, place: str, name: str, seed: int) -> None:
    """A kept list is shown, ranked, saved again as it is shown, and deleted."""
    page, listed = hostile.get(place), hostile.get(f"/api/v1{place}")
    assert (page.status_code, listed.status_code) == (200, 200), seed
    motors = listed.json()["motors"]
    assert json.loads(json.dumps(motors, allow_nan=False)) == motors
    id = place.rpartition("/")[2]
    assert hostile.get(f"/pairs?{LINK}&list={id}").status_code in READ, seed
    fields = cells(page.text)
    again = typed(hostile, fields, f"{place}/save")
    assert again.status_code == 303, (seed, fields)
    assert hostile.get(f"/api/v1{place}").json()["motors"] == motors, (seed, fields)
    assert hostile.delete(f"/api/v1{place}").status_code == 204
