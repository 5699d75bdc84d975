"""Remedy, calculation and pinned gears of the page over HTTP."""

import re
from collections.abc import Iterator
from urllib.parse import quote

import pytest
from httpx2 import Response
from msgspec import structs
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.catalogue import Catalogue, GearList, load_catalogue
from hpn.engine import selection
from hpn.engine.duty import Duty
from hpn.engine.evaluation import Evaluation, evaluate
from hpn.web.app import create_app
from tests.web.test_pages import EXAMPLE, HTMX

CATALOGUE = load_catalogue()


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    with TestClient(create_app()) as client:
        yield client


def compared(html: str) -> list[str]:
    """Gears of the comparison, from left to right."""
    match = re.search("Comparison of ([^<]*)", html)
    return match[1].split(", ") if match else []


def pins(html: str) -> list[str]:
    """Pins in the form."""
    return re.findall('name="pin" id="[^"]*" value="([^"]*)"', html)


def test_without_pins_the_nearest_smaller_miss_stands_beside_the_selected_gear(client: TestClient) -> None:
    html = client.get(EXAMPLE).text
    assert compared(html) == ["HPN-20A-5", "HPN-14A-5"]
    assert pins(html) == []


@pytest.mark.parametrize("link", [EXAMPLE, f"{EXAMPLE}&i=4&size=20A&gear=HPN-11A-35", EXAMPLE.replace("&i=5", "")])
@pytest.mark.parametrize("headers", [{}, HTMX])
def test_page_judges_each_gear_of_the_catalogue_once(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, link: str, headers: dict[str, str]
) -> None:
    judged: list[str] = []

    def counted(duty: Duty, gears: GearList, catalogue: Catalogue) -> Evaluation:
        judged.extend(gear.designation for gear in gears.rows)
        return evaluate(duty, gears, catalogue)

    monkeypatch.setattr(selection, "evaluate", counted)
    assert client.get(link, headers=headers).status_code == 200
    assert sorted(judged) == sorted(gear.designation for gear in CATALOGUE.gears)


def test_gear_that_ratios_leave_out_is_judged_as_without_them() -> None:
    application = Application.worked_example()
    free = application.requirements.model_copy(update={"ratios": None})
    every = selection.select(application.model_copy(update={"requirements": free}), CATALOGUE)
    unranked = {candidate.designation: structs.replace(candidate, rank=None) for candidate in every.candidates}
    judged = selection.judge(application, CATALOGUE)
    left_out = judged.left_out()
    allowed = {candidate.designation for candidate in judged.selection().candidates}
    assert {candidate.designation for candidate in left_out} == unranked.keys() - allowed
    assert all(candidate == unranked[candidate.designation] for candidate in left_out)


def test_pins_stand_beside_the_chosen_gear_in_their_order_and_each_once(client: TestClient) -> None:
    html = client.get(EXAMPLE + "&pin=32-5&pin=HPN-20A-5&pin=HPN-32A-05&gear=HPN-14A-5").text
    assert compared(html) == ["HPN-14A-5", "HPN-32A-5", "HPN-20A-5"]
    assert pins(html) == ["HPN-32A-5", "HPN-20A-5"]


def test_pins_stay_in_the_address_and_with_another_gear(client: TestClient) -> None:
    part = client.get(EXAMPLE + "&pin=HPN-32A-5", headers=HTMX)
    assert part.headers["HX-Push-Url"] == EXAMPLE + "&pin=HPN-32A-5"
    assert 'form="application" name="pin" id="pinned-HPN-32A-5" value="HPN-32A-5"' in part.text
    other = re.search('<button type="submit" form="application" name="gear" value="HPN-14A-5"', part.text)
    assert other and "&gear=HPN-14A-5&pin=HPN-32A-5" in _pushed(client, EXAMPLE + "&pin=HPN-32A-5&gear=HPN-14A-5")


def _pushed(client: TestClient, address: str) -> str:
    return str(client.get(address, headers=HTMX).headers["HX-Push-Url"])


def test_a_button_takes_a_pin_away(client: TestClient) -> None:
    assert pins(client.get(EXAMPLE + "&pin=HPN-32A-5&pin=HPN-14A-5&unpin=HPN-32A-5").text) == ["HPN-14A-5"]


@pytest.mark.parametrize("headers", [{}, HTMX], ids=["page", "part"])
@pytest.mark.parametrize(
    ("query", "message"),
    [
        ("&pin=HPN-99A-5", "HPN-99A-5 is not a gear of the catalogue"),
        ("&pin=" + quote('"><script>'), "&gt;&lt;script&gt; is not a gear of the catalogue"),
        (
            "".join(f"&pin=HPN-20A-{ratio}" for ratio in (3, 4, 5, 7, 10)),
            "at most 4 gears can be pinned; the link gives 5",
        ),
    ],
)
def test_pins_that_cannot_be_are_422_and_say_why(
    client: TestClient, query: str, message: str, headers: dict[str, str]
) -> None:
    response = client.get(EXAMPLE + query, headers=headers)
    assert response.status_code == 422
    assert message in response.text


def test_thousands_of_pins_are_refused_without_a_message_for_each(client: TestClient) -> None:
    response = client.get(EXAMPLE + "&pin=HPN-1A-1" * 4000)
    assert response.status_code == 422
    assert 0 < response.text.count("HPN-1A-1 is not a gear") < 20
    assert pins(response.text) == []


def test_full_pins_offer_no_more(client: TestClient) -> None:
    html = client.get(EXAMPLE + "".join(f"&pin=HPN-{size}A-5" for size in (11, 14, 20, 32))).text
    assert "remove one to pin another" in html
    assert 'aria-label="Compare HPN-40A-5"' not in html


def test_rejected_gear_leads_with_its_remedy_and_offers_to_try_it(client: TestClient) -> None:
    html = client.get(EXAMPLE + "&gear=HPN-14A-5").text
    text = re.sub(r"<[^>]*>", "", html).replace("\u202f", " ")
    assert text.count("Fits if torques drop to 90.5 % and Tk to 107 Nm.") >= 2
    assert verdict(client.get(*tries(html)).text) == ("HPN-14A-5", "suitable")


def tries(html: str) -> list[str]:
    """Addresses behind each "Try it"."""
    return [link.replace("&amp;", "&") for link in re.findall(r'data-tries="[^"]*" href="([^"]*)">Try it', html)]


def verdict(html: str) -> tuple[str, str]:
    """Gear and status in the head of the result."""
    match = re.search(r'<h2 class="designation".*?>(HPN-\w+-\d+)<.*?<span class="status (\w+)"', html, re.DOTALL)
    assert match
    return match[1], match[2]


def test_each_change_of_a_remedy_has_its_own_link_that_makes_the_gear_fit(client: TestClient) -> None:
    html = client.get(EXAMPLE + "&Lh=2000000&gear=HPN-20A-5").text
    assert len(tries(html)) == 2
    for link in tries(html):
        assert verdict(client.get(link).text) == ("HPN-20A-5", "suitable")


def test_nearest_lighter_gear_offers_each_change_that_makes_it_fit(client: TestClient) -> None:
    html = client.get(EXAMPLE + "&FR=500&FA=200").text
    assert verdict(html) == ("HPN-20A-5", "suitable")
    assert len(tries(html)) == 2
    for link in tries(html):
        assert verdict(client.get(link).text) == ("HPN-14A-5", "suitable")


def test_only_the_chosen_gear_pinned_still_has_another_beside_it(client: TestClient) -> None:
    assert compared(client.get(EXAMPLE + "&pin=HPN-20A-5").text) == ["HPN-20A-5", "HPN-14A-5"]


def test_area_of_use_is_a_note_in_the_result(client: TestClient) -> None:
    assert "Use in this area (medical equipment) needs a risk assessment" in client.get(EXAMPLE + "&aa=medical").text


def test_a_long_cycle_pins_by_buttons_instead_of_long_links(client: TestClient) -> None:
    query = "/?" + "&".join(["T=40&n=250&t=0.3"] * 300)
    html = client.get(query + "&pin=HPN-14A-5").text
    assert '<button class="pin" type="submit" form="application" name="pin" value="HPN-20A-5"' in html
    assert '<button class="pin pinned" type="submit" form="application" name="unpin" value="HPN-14A-5"' in html


def test_calculation_stands_on_the_page_in_MathML(client: TestClient) -> None:
    html = client.get(EXAMPLE).text
    assert html.count("<math ") > 15
    assert re.search(r'<section class="section panel calculation" id="calculation"', html)
    assert "1\u202f167\u202f275.94" in html


def changes(client: TestClient, target: str, unfolded: str = "", query: str = EXAMPLE) -> Response:
    """Reply to a script that asks for a part of the page, with some parts of the result unfolded."""
    return client.get(query, headers={**HTMX, "HX-Target": target, "HPN-Parts": unfolded})


RESULT = "section#result"


def test_typing_brings_neither_the_form_nor_what_is_folded_away(client: TestClient) -> None:
    html = changes(client, RESULT).text
    assert 'id="application"' not in html
    assert 'id="calculation"' in html
    assert "<math" not in html
    assert "data-figure" not in html
    assert html.count('name="link" value="/?T=40&amp;') == 1  # the link for files comes, too


def test_an_unfolded_part_comes_alone_or_with_the_result(client: TestClient) -> None:
    alone = changes(client, "details#calculation")
    assert "<math" in alone.text
    assert "comparison" not in alone.text
    assert "HX-Push-Url" not in alone.headers
    assert "HPN-Parts" in alone.headers["Vary"]
    assert "data-figure" in changes(client, "details#bearing_figure").text
    assert "<math" in changes(client, RESULT, "calculation").text


def test_typing_something_wrong_brings_a_list_that_names_its_fields_and_nothing_else(client: TestClient) -> None:
    response = changes(client, RESULT, query="/?T=fast&n=250&t=0.3&u=2")
    assert response.status_code == 422
    assert re.findall(r'data-field="([^"]*)"', response.text) == ["T-0", "f-u"]
    assert "is not a number" in response.text
    assert "<input" not in response.text
    assert len(response.content) < 1000


@pytest.mark.parametrize(
    ("target", "query"), [(RESULT, "&do=add"), ("form#application", ""), ("div#paste-preview", "")]
)
def test_an_edit_that_takes_the_place_of_inputs_brings_the_form(client: TestClient, target: str, query: str) -> None:
    response = changes(client, target, query=EXAMPLE + query)
    assert response.text.lstrip().startswith('<form id="application"')
    assert response.headers["HX-Retarget"] == "#application"
    assert 'hx-target="#result"' in response.text


@pytest.mark.parametrize("count", [100, 300, 1000])
def test_an_edit_of_a_long_cycle_is_as_short_as_one_of_a_short_cycle_but_for_its_link(
    client: TestClient, count: int
) -> None:
    short = changes(client, RESULT, query="/?T=40&n=250&t=0.3").text
    query = "/?" + "&".join(f"T={20 + k % 20}&n={100 + k % 90}&t=0.{1 + k % 9}" for k in range(count))
    html = changes(client, RESULT, query=query).text
    assert "<math" not in html
    assert html.count(f'value="{query.replace("&", "&amp;")}"') == 1
    assert html.count(query.replace("&", "&amp;")[1:]) <= 6  # the pages that a short one is carried to
    assert (
        len(html) < len(short) + 6 * 1.4 * min(len(query), 4000) + 1.4 * len(query) + 25_000
    )  # 200 steps of the chart


def test_a_part_of_a_long_cycle_is_fetched_with_the_fields_of_the_form(client: TestClient) -> None:
    rows = "\n".join(["40 250 0.3"] * 300)
    page = client.post("/", data={"phases": rows}).text
    place = re.search(r'id="calculation"\s+data-part="([0-9a-f]{8})"\s+hx-post="/"\s+hx-include="#application', page)
    assert place
    part = client.post("/", data={"phases": rows}, headers=HTMX | {"HX-Target": "section#calculation"})
    assert "<math" in part.text
    assert f'data-part="{place[1]}"' in part.text  # of the same answer, which the script checks


def test_a_form_with_a_fault_has_no_parts(client: TestClient) -> None:
    part = client.get("/?T=40&n=x&t=1", headers=HTMX | {"HX-Target": "section#bearing"})
    assert (part.status_code, part.text) == (204, "")
