"""Notes grouped by their use: each with its reason, its subject, and an action that works without script."""

import re
from collections.abc import Iterator
from html import unescape
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from hpn.engine.notice import NOTICES, Notice
from hpn.web.app import create_app
from hpn.web.pages.notes import head_and_reason, note_groups
from hpn.web.settings import Settings

STOP = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&tp=4&FR=500&FA=200&fw=1.2&Tk=200"
OFF_CENTRE = "/?T=40&n=250&t=0.3&FR=400&xR=45"
EDIT = {"HX-Request": "true", "HX-Target": "section#result"}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    folder: Path = tmp_path_factory.mktemp("notes")
    with TestClient(create_app(Settings(database_url=f"sqlite:///{folder}/s.sqlite3"))) as client:
        yield client


def notes(page: str) -> str:
    match = re.search(r'<section class="section panel notes".*', page, re.DOTALL)
    assert match
    return match[0]


def test_every_notice_has_its_group_and_says_what_it_touches() -> None:
    codes = [code for code in NOTICES if code not in ("gears_unrated", "gear_far_below_motor")]  # parts of others
    for group in note_groups([Notice(code, "") for code in codes], None):
        for note in group.notes:
            assert note.touches, note.notice.code


@pytest.mark.parametrize(
    ("text", "head", "reason"),
    [
        ("A is so: b follows.", "A is so", "B follows."),
        ("A (eq. 17.9) is so; η is 1.", "A (eq. 17.9) is so", "η is 1."),
        ("HPN-40A is not rated. The table is missing.", "HPN-40A is not rated", "The table is missing."),
        ("A is so: T_R / η is more.", "A is so", "T_R / η is more."),
        ("Es gilt z. B. Gleichung 3.", "Es gilt z. B. Gleichung 3", ""),
    ],
)
def test_a_notice_is_parted_into_claim_and_reason(text: str, head: str, reason: str) -> None:
    assert head_and_reason(text) == (head, reason)


def test_groups_stand_in_their_order_each_with_its_count(client: TestClient) -> None:
    heads = re.findall(r'<h3 id="notes-\w+">\s*([^<]+?)\s*<span class="hint">(\d+)', notes(client.get(STOP).text))

    assert heads == [("Decide", "2"), ("Assumed", "4"), ("Not rated", "1"), ("Good to know", "1")]


def test_a_missing_input_is_typed_beside_its_note_and_stands_in_the_form_then(client: TestClient) -> None:
    page = client.get(STOP).text
    assert '<input name="give-Nk" form="application"' in notes(page)

    edit = client.get(STOP + "&Nk=&give-Nk=1000", headers=EDIT)

    assert re.search(r'id="f-Nk"[^>]*value="1000"', edit.text)
    assert "&Nk=1000" in edit.headers["HX-Push-Url"]
    assert "without the number of stops" not in edit.text


def test_it_is_read_in_the_units_of_the_reader(client: TestClient) -> None:
    """As in the form's own field: a German comma, and a life in years of 8766 h."""
    german = client.get(OFF_CENTRE + "&written=de&xc=&give-xc=21%2C5", headers=EDIT | {"Accept-Language": "de"})

    assert "&xc=21.5" in german.headers["HX-Push-Url"]


def test_a_blank_one_changes_nothing(client: TestClient) -> None:
    before = client.get(STOP, headers=EDIT).headers["HX-Push-Url"]
    assert client.get(STOP + "&Nk=&give-Nk=+", headers=EDIT).headers["HX-Push-Url"] == before


@pytest.mark.parametrize("name", ["give-", "give-nothing", "give-T", "give-xc-20A-1", "give-Nk-20A"])
def test_what_stands_for_no_field_is_no_error(client: TestClient, name: str) -> None:
    assert client.get(f"{STOP}&{name}=%00x").status_code in (200, 422)


@pytest.mark.parametrize(
    ("press", "says"), [("iso281", "&bm=iso281"), ("by_L10", "&Lbb=L10"), ("one_way", "&lr=0"), ("linear", "fw=1.2")]
)
def test_a_button_gives_its_value(client: TestClient, press: str, says: str) -> None:
    assert says in client.get(f"{STOP}&do={press}", headers=EDIT).headers["HX-Push-Url"]


def test_a_gear_that_is_not_rated_leads_to_where_its_figures_are_entered(client: TestClient) -> None:
    link = re.search(r'<a href="(/catalogue/HPN-40A-[^"]*)">Enter its figures', notes(client.get(STOP).text))

    assert link
    assert "Enter them" in client.get(unescape(link[1])).text


def test_a_saved_page_has_the_notes_without_actions(client: TestClient) -> None:
    part = notes(client.post("/selections", data={"link": STOP}).text)

    assert "Decide" in part
    assert "give-Nk" not in part
    assert 'name="do"' not in part
