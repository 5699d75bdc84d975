"""Changes of a machine from its page: the effect is said before, every change can be undone, and two people meet."""

import re
from html import unescape
from typing import Any
from urllib.parse import urlencode

import pytest
from starlette.testclient import TestClient

from tests.fleet.page import HEAVY, HUB
from tests.fleet.test_machine_page import BELT, COMMON, text_of

Pairs = list[tuple[str, str]]


@pytest.fixture
def machine(client: TestClient) -> str:
    """Address of a machine of three axes."""
    applications = (BELT, {**HUB, "requirements": {"utilisation": 0.8, "ratios": [5, 10]}}, HEAVY)
    axes = [{"name": name, "application": each} for name, each in zip("ABC", applications, strict=True)]
    saved = client.post("/api/v1/machines", json={"title": "Line", "common": COMMON, "axes": axes})
    assert saved.status_code == 201, saved.text
    return str(saved.json()["url"])


def send(client: TestClient, machine: str, *pairs: tuple[str, str], past: Pairs | None = None) -> Any:
    """Answer to the form of the page."""
    content = urlencode([*pairs, *(past or [])])
    headers = {"Content-Type": "application/x-www-form-urlencoded"}
    return client.post(f"{machine}/change", content=content, headers=headers)


def past_of(page: str) -> Pairs:
    """Fields that the button Undo of a page sends."""
    form = re.search(r'<form class="undo".*?</form>', page, re.DOTALL)
    return re.findall(r'name="(past)" value="([^"]*)"', form[0]) if form else []


def opened(client: TestClient, machine: str, language: str = "en") -> dict[str, str]:
    """Fields of the opened form of the common values, as a browser sends them."""
    page = client.get(f"{machine}?edit=common", headers={"Accept-Language": language}).text
    part = page[page.index('id="every-axis"') :]
    part = part[: part.index("</form>")]
    fields = dict(re.findall(r'<input type="hidden" name="(\w+)" value="([^"]*)"', part))
    fields |= dict(re.findall(r'name="(\w+)"\s+type="text"[^>]*?value="([^"]*)"', part))
    return {name: unescape(text) for name, text in fields.items()}


def kept(client: TestClient, machine: str) -> dict[str, Any]:
    """The machine over REST, without what a change counts."""
    reply: dict[str, Any] = client.get(f"/api/v1{machine}").json()
    axes = [{n: v for n, v in axis.items() if n not in ("updated", "updated_by")} for axis in reply["axes"]]
    return {"common": reply["common"], "order": reply["order"], "axes": axes}


def test_common_values_say_their_effect_before_they_are_set_as_rest_sets_them(client: TestClient, machine: str) -> None:
    """The page's change and a merge patch over REST leave the same machine."""
    before = kept(client, machine)
    fields = {**opened(client, machine), "u": "0.5"}

    dry = send(client, machine, *fields.items(), ("do", "dry"))
    assert dry.status_code == 200 and kept(client, machine) == before
    effect = text_of(dry.text[dry.text.index("data-effect") :][:1500])
    assert "1 of 3 takes another gear: A HPN-" in effect and "No axis loses its gear." in effect

    set_ = send(client, machine, *fields.items(), ("do", "apply"))
    assert set_.status_code == 200
    after = kept(client, machine)
    assert after["common"]["requirements"]["utilisation"] == 0.5
    undone = send(client, machine, ("do", "undo"), past=past_of(set_.text))
    assert "Undone." in undone.text and kept(client, machine) == before
    client.patch(f"/api/v1{machine}", json={"common": {"requirements": {"utilisation": 0.5}}})
    assert kept(client, machine) == after


def test_a_decimal_comma_is_read_as_in_the_form_and_a_wrong_value_changes_nothing(
    client: TestClient, machine: str
) -> None:
    german = {**opened(client, machine, "de"), "fw": "1,35"}
    assert send(client, machine, *german.items(), ("do", "apply")).status_code == 200
    assert kept(client, machine)["common"]["output_load"]["load_coefficient"] == 1.35

    before = kept(client, machine)
    for wrong in ("x", "-1", "7"):
        answer = send(client, machine, *{**opened(client, machine), "u": wrong}.items(), ("do", "apply"))
        assert answer.status_code == 422 and kept(client, machine) == before


def test_marked_axes_take_a_value_and_every_change_is_undone_in_turn(client: TestClient, machine: str) -> None:
    first = kept(client, machine)
    marked = (("target", "axes"), ("axis", "1:1"), ("axis", "2:1"))

    dry = send(client, machine, *marked, ("field", "u"), ("u", "0.4"), ("do", "dry"))
    assert dry.status_code == 200 and kept(client, machine) == first and "of 2 take" in text_of(dry.text)
    page = send(client, machine, *marked, ("field", "u"), ("u", "0.4"), ("do", "apply")).text
    own = [axis["application"].get("requirements") for axis in kept(client, machine)["axes"]]
    assert own == [{"utilisation": 0.4}, {"utilisation": 0.4, "ratios": [5, 10]}, None]

    steps: list[tuple[tuple[str, str], ...]] = [
        (("axis", "2:2"), ("field", "quantity"), ("quantity", "7"), ("do", "apply")),
        (("axis", "2:3"), ("field", "i"), ("i", "10"), ("i", "7"), ("do", "apply")),
        (("axis", "2:4"), ("field", "u"), ("do", "inherit")),
        (("axis", "2:5"), ("do", "copy")),
        (("axis", "1:2"), ("axis", "2:5"), ("do", "remove")),
    ]
    for step in steps:
        answer = send(client, machine, ("target", "axes"), *step, past=past_of(page))
        assert answer.status_code == 200, step
        page = answer.text
    assert [axis["name"] for axis in kept(client, machine)["axes"]] == ["C", "B"]
    copy = kept(client, machine)["axes"][1]
    assert (copy["number"], copy["quantity"], copy["application"]["requirements"]) == (4, 7, {"ratios": [10, 7]})

    for _ in range(len(steps) + 1):
        page = send(client, machine, ("do", "undo"), past=past_of(page)).text
        assert "Undone." in page
    assert past_of(page) == [] and kept(client, machine) == first


def test_somebody_faster_on_the_same_axis_is_shown_and_nothing_is_lost(client: TestClient, machine: str) -> None:
    yours = (("target", "axes"), ("axis", "1:1"), ("field", "u"), ("u", "0.7"), ("do", "apply"))
    client.patch(f"/api/v1{machine}/axes/1", json={"application": {"requirements": {"utilisation": 0.6}}})
    theirs = kept(client, machine)

    page = send(client, machine, *yours)

    assert page.status_code == 409 and "Somebody else has changed this" in page.text
    assert kept(client, machine) == theirs and 'value="0.7"' in page.text and "u 60 %" in text_of(page.text)
    again = re.search(r'name="axis"\s+value="(1:2)"[^>]*checked', page.text)
    assert again is not None  # the same axis is marked in the state that is shown
    assert re.search(r"data-apply\s*>Set for", page.text)  # and there is the button that applies again
    assert send(client, machine, *((n, "1:2" if n == "axis" else v) for n, v in yours)).status_code == 200
    assert kept(client, machine)["axes"][0]["application"]["requirements"] == {"utilisation": 0.7}


def test_two_people_meet_on_one_common_value_alone(client: TestClient, machine: str) -> None:
    mine = opened(client, machine)
    client.patch(f"/api/v1{machine}", json={"common": {"requirements": {"life_h": 30000}}})

    other = send(client, machine, *{**mine, "fw": "1.4"}.items(), ("do", "apply"))
    assert other.status_code == 200
    common = kept(client, machine)["common"]
    assert (common["requirements"]["life_h"], common["output_load"]["load_coefficient"]) == (30000, 1.4)

    same = send(client, machine, *{**mine, "fw": "1.5"}.items(), ("do", "apply"))
    assert same.status_code == 409 and "somebody else has set 1.4 since" in unescape(same.text)
    assert 'value="1.5"' in same.text and 'value="30000"' in same.text
    assert re.search(r"data-apply\s*>\s*Apply to", same.text)
    assert kept(client, machine)["common"] == common


def test_undo_leaves_what_somebody_else_has_set_since(client: TestClient, machine: str) -> None:
    page = send(
        client, machine, ("target", "axes"), ("axis", "1:1"), ("field", "u"), ("u", "0.7"), ("do", "apply")
    ).text
    client.patch(f"/api/v1{machine}/axes/1", json={"quantity": 9})  # another value of the axis
    taken = send(client, machine, ("do", "undo"), past=past_of(page))
    assert taken.status_code == 200 and kept(client, machine)["axes"][0]["quantity"] == 9

    page = send(
        client, machine, ("target", "axes"), ("axis", "1:4"), ("field", "u"), ("u", "0.7"), ("do", "apply")
    ).text
    client.patch(f"/api/v1{machine}/axes/1", json={"application": {"requirements": {"utilisation": 0.65}}})
    refused = send(client, machine, ("do", "undo"), past=past_of(page))
    assert refused.status_code == 409 and "Not undone" in refused.text
    assert kept(client, machine)["axes"][0]["application"]["requirements"] == {"utilisation": 0.65}


@pytest.mark.parametrize(
    "pairs",
    [
        [("do", "apply")],
        [("do", "undo"), ("past", "eJyrrgUAAXUA+Q==")],
        [("do", "undo"), ("past", "\x00")],
        [("target", "axes"), ("axis", "1:1:1"), ("axis", "x"), ("do", "remove")],
        [("target", "axes"), ("everything", "1"), ("field", "nothing"), ("u", "1e999"), ("do", "apply")],
        [("target", "axes"), ("everything", "1"), ("field", "quantity"), ("quantity", "9" * 30), ("do", "apply")],
        [("target", "common"), ("before", "%"), ("Lbb", "L11"), ("size", "99Z"), ("do", "apply")],
    ],
)
def test_no_form_makes_a_fault_or_changes_what_it_does_not_name(client: TestClient, machine: str, pairs: Pairs) -> None:
    before = kept(client, machine)

    answer = send(client, machine, *pairs)

    assert answer.status_code in (200, 409, 422) and kept(client, machine) == before


def test_fewest_kinds_stand_beside_the_machine_as_rest_gives_them(client: TestClient, machine: str) -> None:
    kinds = client.get(f"/api/v1{machine}/kinds").json()
    page = client.get(f"{machine}/kinds").text

    fewer = kinds["kinds"][1:]
    assert fewer and all(gear in page for gear in fewer[-1]["gears"])
    assert all(change["to"] in page for change in fewer[-1]["changes"]) and "<svg" in page
    assert f'data-load="{machine}/kinds"' in client.get(machine).text


def test_fewest_kinds_name_the_axes_that_the_first_step_changes_already(client: TestClient, machine: str) -> None:
    """The first step is the lightest set of as many kinds as now, whatever heavier gear an axis has ordered."""
    client.patch(f"/api/v1{machine}/axes/2", json={"ordering_code": "HPN-32A-5"}).raise_for_status()
    first = client.get(f"/api/v1{machine}/kinds").json()["kinds"][0]
    (change,) = first["changes"]

    assert (change["axis"], change["from"]) == (2, "HPN-32A-5")
    page = text_of(client.get(f"{machine}/kinds").text)
    assert f"The comparison begins with one axis changed: B: HPN-32A-5 → {change['to']}" in page


def test_a_gear_that_many_axes_force_names_three_of_them_and_counts_the_others(client: TestClient) -> None:
    only = {**BELT, "requirements": {"sizes": ["20A"], "ratios": [5]}}
    saved = client.post("/api/v1/machines", json={"axes": [{"name": name, "application": only} for name in "ABCDEF"]})

    page = text_of(client.get(f"{saved.json()['url']}/kinds").text)

    assert "HPN-20A-5 is forced by A, B, C and 3 more." in page


def test_a_step_of_fewest_kinds_is_taken_as_own_values_and_undone(client: TestClient, machine: str) -> None:
    """The machine then has the kinds, and the mass, that the step has promised."""
    before, steps = kept(client, machine), client.get(f"/api/v1{machine}/kinds").json()["kinds"]
    client.patch(f"/api/v1{machine}/axes/1", json={"ordering_code": steps[0]["gears"][0]})
    coded, least = kept(client, machine), client.get(f"/api/v1{machine}/kinds").json()["kinds"][-1]

    page = send(client, machine, ("do", "kinds"), ("count", str(least["count"])))

    assert page.status_code == 200
    gears = client.get(f"/api/v1{machine}/gears").json()
    assert sorted(gear["designation"] for gear in gears["gears"]) == sorted(least["gears"])
    assert gears["weight_kg"] == pytest.approx(least["weight_kg"], rel=1e-12)  # a sum in another order
    assert send(client, machine, ("do", "kinds"), ("count", "77")).status_code == 422
    send(client, machine, ("do", "undo"), past=past_of(page.text))
    assert kept(client, machine) == coded != before


def test_the_address_of_a_change_leads_back_to_the_machine(client: TestClient, machine: str) -> None:
    assert client.get(f"{machine}/change").headers["location"] == machine
    assert client.post(f"{machine}/change", data={"do": "apply"}, headers={"Origin": "http://else"}).status_code == 403
    assert send(client, "/machines/nothing", ("do", "apply")).status_code == 404
