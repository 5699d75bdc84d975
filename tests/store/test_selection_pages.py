"""The page of a saved selection, and saving from the live page without script."""

import html
import re
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.engine.checks import BY_CODE
from hpn.links.writer import to_link
from hpn.store.saved import packed, unpacked
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import Json, cycle, phase, worked_example
from tests.conftest import Supplement
from tests.state import state_of
from tests.store.drafts import WEAKER

LINK = to_link(Application.model_validate(worked_example(requirements={"ratios": [5]})))


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    """A client of a running service."""
    settings = Settings(database_url=f"sqlite:///{tmp_path}/store.sqlite3")
    with TestClient(create_app(settings), follow_redirects=False) as client:
        yield client


def sent(client: TestClient, **fields: str) -> str:
    """Address of the page that the form leads to."""
    response = client.post("/selections", data={"link": LINK} | fields)
    assert response.status_code == 303, response.text
    return str(response.headers["location"])


def test_the_form_saves_and_leads_to_the_page(client: TestClient) -> None:
    address = sent(client, title="Axis <7>", ref="4711")

    page = client.get(address)

    assert page.status_code == 200
    assert "Axis &lt;7&gt;" in page.text
    assert "<7>" not in page.text
    again = LINK + "&title=Axis+%3C7%3E&ref=4711"
    for text in ("HPN-20A-5", "<dd>4711</dd>", "Today the result is the same", f'href="{html.escape(again)}"'):
        assert text in page.text


def once_of(page: str) -> str:
    """One-time key of a page, the same at each of its buttons that save."""
    keys = re.findall(r'name="once" value="([^"]*)"', page)
    assert len(keys) == page.count('action="/selections"') > 0
    (key,) = set(keys)
    return str(key)


def count(client: TestClient) -> int:
    return len(client.get("/api/v1/selections").json()["selections"])


def test_a_form_sent_twice_saves_once(client: TestClient) -> None:
    once = once_of(client.get(LINK).text)

    addresses = [sent(client, title="Axis 7", once=once) for _ in range(2)]

    assert re.fullmatch(r"[A-Za-z0-9_-]{22}", once)
    assert addresses[0] == addresses[1]
    assert count(client) == 1


def test_a_form_sent_again_with_another_title_saves_another(client: TestClient) -> None:
    once = once_of(client.get(LINK).text)

    assert sent(client, title="Axis 7", once=once) != sent(client, title="Axis 8", once=once)


def test_every_form_has_a_key_of_its_own(client: TestClient) -> None:
    first, second = (once_of(client.get(LINK).text) for _ in range(2))

    assert first != second
    assert sent(client, once=first) != sent(client, once=second)


def test_a_form_without_a_key_that_can_be_one_saves_each_time(client: TestClient) -> None:
    for once in ("", "x", "é" * 22, "A" * 200):
        assert sent(client, once=once)

    assert count(client) == 4


def test_a_form_that_comes_back_keeps_its_key(client: TestClient) -> None:
    once = once_of(client.get(LINK).text)

    response = client.post("/selections", data={"link": LINK, "title": "a\x07b", "once": once})

    assert once_of(response.text) == once


def test_a_form_whose_selection_was_deleted_says_so_and_can_be_sent_anew(client: TestClient) -> None:
    once = once_of(client.get(LINK).text)
    client.delete(f"/api/v1{sent(client, once=once)}")

    response = client.post("/selections", data={"link": LINK, "once": once})

    assert response.status_code == 410
    assert "has since been deleted" in response.text
    assert count(client) == 0
    assert sent(client, once=once_of(response.text))
    assert count(client) == 1


def test_labels_can_be_left_blank(client: TestClient) -> None:
    saved = client.get(f"/api/v1{sent(client, title='', ref=' ')}").json()

    assert (saved["title"], saved["reference"]) == (None, None)


def test_a_label_that_cannot_be_comes_back_with_what_was_typed_and_a_message(client: TestClient) -> None:
    response = client.post("/selections", data={"link": LINK, "title": "a\x07b", "ref": "4711"})

    assert response.status_code == 422
    assert 'value="4711"' in response.text
    assert 'aria-describedby="e-title"' in response.text
    assert "must not contain control characters" in response.text
    assert f'value="{html.escape(LINK)}"' in response.text


@pytest.mark.parametrize(
    "fields", [{}, {"link": ""}, {"link": "/?T=x&n=1&t=1"}, {"link": "/?T=1&n=1&t=1&i=6"}, {"link": "/?no=1"}]
)
def test_a_link_that_is_no_application_is_not_saved(client: TestClient, fields: Json) -> None:
    response = client.post("/selections", data=fields | {"title": "t"})

    assert response.status_code == 422
    assert client.get("/api/v1/selections").json()["selections"] == []


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Sec-Fetch-Site": "same-origin"}, 303),
        ({"Sec-Fetch-Site": "cross-site"}, 403),
        ({"Sec-Fetch-Site": "same-site"}, 403),
        ({"Origin": "http://testserver"}, 303),
        ({"Origin": "http://other.example"}, 403),
        ({"Origin": "null"}, 403),
        ({}, 303),
    ],
)
def test_only_our_own_page_can_send_the_form(client: TestClient, headers: dict[str, str], status: int) -> None:
    assert client.post("/selections", data={"link": LINK}, headers=headers).status_code == status


def test_another_candidate_can_be_looked_at(client: TestClient) -> None:
    page = client.get(sent(client) + "?gear=HPN-32A-5")

    assert "of HPN-32A-5" in page.text


@pytest.mark.parametrize(("size", "content"), [("40A", "–"), ("20A", "unlimited")])
def test_life_is_unlimited_only_where_the_gear_is_rated(client: TestClient, size: str, content: str) -> None:
    question = cycle(phase(0, 10), requirements={"sizes": [size], "ratios": [5], "backlash_arcmin": 4})
    page = client.get(sent(client, link=to_link(Application.model_validate(question)))).text

    life = re.search("<dt[^>]*>Gear life.*?</dt><dd>(.*?)</dd>", page)
    assert life and re.sub("<[^>]*>", "", life[1]) == content


def test_a_result_that_differs_today_stands_beside_the_saved_one(client: TestClient, supplemented: Supplement) -> None:
    address = sent(client)
    catalogue = supplemented(ratings=WEAKER)
    state_of(client).catalogue = catalogue

    page = client.get(address)

    assert "Differences today" in page.text
    assert page.text.index("Selected gear</th>") < page.text.index("Load limit 1: average torque: Utilisation")
    assert re.search(r'>HPN-20A-5</a>\s*<span class="standing"><span class="status suitable">', page.text)


def test_sentences_that_only_read_otherwise_are_no_other_result(client: TestClient, tmp_path: Path) -> None:
    address, remedy = sent(client), BY_CODE["average_torque"].remedy.encode()
    with sqlite3.connect(tmp_path / "store.sqlite3") as database:
        ((content,),) = database.execute("SELECT result_packed FROM revisions")
        old = unpacked(content).replace(remedy, b"Rest.").replace(b'"text":"', b'"text":"Note: ', 1)
        database.execute("UPDATE revisions SET result_packed = ?", [packed(old)])

    page = " ".join(client.get(address).text.split())

    assert "Today the result is the same" in page and "Differences today" not in page
    assert re.search(r"<summary>2 sentences read otherwise today</summary>.*Rest\.", page)


def test_a_page_that_is_not_there_says_so_in_words(client: TestClient) -> None:
    response = client.get("/selections/AAAAAAAAAAAAAAAAAAAAAA")

    assert response.status_code == 404
    assert response.headers["content-type"].startswith("text/html")
    assert "There is no saved selection at this address" in response.text


def test_an_address_that_a_document_broke_with_unseen_characters_leads_to_the_selection(client: TestClient) -> None:
    address = sent(client)
    broken = f"{address[:20]}%E2%80%8B{address[20:]}%EF%BB%BF"

    reply = client.get(f"{broken}?gear=HPN-32A-5")

    assert reply.status_code == 308
    assert reply.headers["location"] == f"{address}?gear=HPN-32A-5"
    assert client.get(broken).headers["location"] == address
    for nothing in ("%E2%80%8B", "%E2%80%8B..", "compare%E2%80%8B"):
        assert client.get(f"/selections/{nothing}").status_code == 404


def test_the_explanations_of_a_saved_selection_have_the_facts_that_bear_on_each_check(client: TestClient) -> None:
    page = client.get(sent(client)).text
    check = client.get("/checks/maximum_input_speed").text

    facts = re.findall("<dt>Handbook</dt><dd>(.*?)<span", check)
    assert facts
    assert all(fact in page.partition('id="about-maximum_input_speed"')[2] for fact in facts)


# --- Revisions --------------------------------------------------------------------------------------------------------


def text_of(page: str) -> str:
    """Text of a page, its white space single."""
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", page)).split())


def frozen(client: TestClient, place: str, label: str, **application: Json) -> None:
    """Freeze the worked example with other parts as the next revision of a selection."""
    body = {"application": worked_example(**application), "label": label, "note": f"note of {label}"}
    assert client.post(f"/api/v1{place}/revisions", json=body).status_code == 201


def test_the_verdict_comes_before_the_input_and_the_chain_names_every_revision(client: TestClient) -> None:
    place = sent(client, title="Turret", rev="A")
    frozen(client, place, "B")

    page = client.get(place).text

    assert page.index('class="saved-title"') < page.index('id="verdict"') < page.index('id="inputs-heading"')
    assert "Revision B of 2" in text_of(page) and f'href="{place}?revision=A"' in page
    assert f'href="{place}/revisions"' in page and "The working copy has changed" not in text_of(page)


def test_the_chain_names_the_gear_of_each_revision(client: TestClient) -> None:
    place = sent(client, title="Turret", rev="A")
    frozen(client, place, "B", requirements={"ratios": [7]})

    page = client.get(place).text
    chain = text_of(page[page.index('<ol class="chain') : page.index("</ol>", page.index('<ol class="chain'))])

    for label, before in (("B", "this one"), ("A", "Revision A")):
        answer = client.get(f"/api/v1/machines/{place.rpartition('/')[2]}/revisions/{label}").json()["axes"][0][
            "answer"
        ]
        used = f"{answer['utilisation']:.0%}".replace("%", " %")
        match = re.search(rf"{before} \d{{4}}-\d\d-\d\d (.*?)(?= A |$)", chain)
        assert match and f"{answer['selected']}, {used}" in match[1].replace("\u202f", " "), chain


@pytest.mark.parametrize(("load", "changes"), [({}, 1), ({"output_load": {"radial_N": 500.0, "axial_N": 200.0}}, 2)])
def test_what_would_make_a_lighter_gear_fit_is_taken_into_a_copy(client: TestClient, load: Json, changes: int) -> None:
    """In the copy the lighter gear passes with the changed input, and what is saved stays to the byte."""
    link = to_link(Application.model_validate(worked_example(requirements={"ratios": [5]}, **load)))
    address = sent(client, link=link, title="Turret")
    page, record = client.get(address).text, client.get(f"/api/v1{address}").content
    fails = page[page.index("Nearest lighter gear") :]
    lighter = re.search(r"HPN-[0-9]+A-[0-9]+", fails)
    copies = [html.unescape(link) for link in re.findall(r'<a href="([^"]*)">in a copy</a>', fails)]

    assert lighter and len(set(copies)) == len(copies) == changes and "Try it" not in page
    for copied in copies:
        copy = client.get(copied).text
        verdict = copy[copy.index('id="verdict"') : copy.index("</h2>", copy.index('id="verdict"'))]
        assert lighter[0] in verdict and 'class="status suitable"' in verdict and 'id="application"' in copy
    assert client.get(f"/api/v1{address}").content == record


def test_an_earlier_revision_leads_to_the_latest_and_its_gears_stay_its_own(client: TestClient) -> None:
    place = sent(client, title="Turret", rev="A")
    frozen(client, place, "B", requirements={"ratios": [7]})

    page = client.get(f"{place}?revision=A").text

    assert "There is a newer revision." in text_of(page) and "Revision A of 2" in text_of(page)
    assert f'href="{place}?revision=A&amp;gear=HPN-32A-5"' in page
    assert f'href="{place}?gear=' not in page
    for file in ("report.pdf", "report.xlsx"):
        address = f"/api/v1{place}/{file}?revision=A"
        assert f'href="{address}"' in page and client.get(address).status_code == 200


def test_a_line_leads_to_a_newer_working_copy(client: TestClient) -> None:
    place = sent(client, title="Turret", rev="A")
    id = place.rpartition("/")[2]
    patch = {"application": {"emergency_stop": {"torque_Nm": 100}}}
    changed = client.patch(
        f"/api/v1/machines/{id}/axes/1", json=patch, headers={"Content-Type": "application/merge-patch+json"}
    )
    assert changed.status_code == 200, changed.text

    page = client.get(place).text

    assert "The working copy has changed since revision A." in text_of(page)
    assert f'href="/machines/{id}/axes/1"' in page and f'href="{place}/revisions?from=A&amp;to=now"' in page


@pytest.mark.parametrize("suffix", ["", "/revisions"])
def test_what_today_says_is_saved_as_the_next_revision_of_what_was_saved(
    client: TestClient, supplemented: Supplement, suffix: str
) -> None:
    place = sent(client, title="Turret", rev="A")
    before = client.get(f"/api/v1{place}").json()["result"]
    assert "Save today’s as" not in client.get(place + suffix).text
    state_of(client).catalogue = supplemented(ratings=WEAKER)

    page = client.get(place + suffix).text
    form = re.search(r'<form class="save-today".*?</form>', page, re.DOTALL)
    assert form is not None and "Save today’s as B" in form[0]
    fields = {name: html.unescape(text) for name, text in re.findall(r'name="(\w+)"\s+value="([^"]*)"', form[0])}
    saved = client.post(f"{place}/revisions", data=fields)

    assert saved.status_code == 303, saved.text
    latest = client.get(f"/api/v1{place}").json()
    assert latest["label"] == "B" and latest["result"]["selected"] != before["selected"]
    assert latest["today"]["differences"] == []
    assert client.get(f"/api/v1{place}?revision=A").json()["result"] == before
    assert "engine" in latest["revisions"][0]["note"]
