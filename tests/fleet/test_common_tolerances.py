"""Tolerances of every axis, edited on the machine's page and inherited by its axes."""

import re
from html import unescape
from typing import Any

import pytest
from starlette.testclient import TestClient

from tests.fleet.page import HUB
from tests.fleet.test_machine_changes import kept, past_of, send
from tests.fleet.test_machine_page import BELT, text_of


@pytest.fixture
def machine(client: TestClient) -> str:
    """Address of a machine of two axes without tolerances."""
    axes = [{"name": name, "application": each} for name, each in zip("AB", (BELT, HUB), strict=True)]
    return str(client.post("/api/v1/machines", json={"title": "Line", "axes": axes}).json()["url"])


def form(client: TestClient, machine: str, language: str = "en") -> dict[str, str]:
    """Fields of the form of the common values, as a browser sends them."""
    page = client.get(f"{machine}?edit=common", headers={"Accept-Language": language}).text
    part = page[page.index('id="every-axis"') :].partition("</form>")[0]
    result = {}
    for field in re.findall(r"<input[^>]*>", part):
        named = dict(re.findall(r'([a-z]+)="([^"]*)"', field))
        if "name" in named and (named["type"] != "checkbox" or " checked" in field):
            result[named["name"]] = unescape(named.get("value", ""))
    return result


def tolerances(client: TestClient, machine: str) -> Any:
    """Common tolerances over REST."""
    return kept(client, machine)["common"].get("tolerances")


def test_tolerances_of_every_axis_are_set_on_the_page_as_rest_sets_them(client: TestClient, machine: str) -> None:
    fields = {**form(client, machine), "target": "common", "tol_T": "5", "tol_Tk": "+5 −2", "tol_JL": "0.01 kgm²"}
    before = kept(client, machine)
    dry = send(client, machine, *fields.items(), ("do", "dry"))
    assert dry.status_code == 200 and kept(client, machine) == before

    page = send(client, machine, *fields.items(), ("do", "apply"))

    assert page.status_code == 200, text_of(page.text)
    after = kept(client, machine)
    assert after["common"]["tolerances"]["torque_Nm"] == {"percent": 5.0}
    assert after["common"]["tolerances"]["emergency_stop.torque_Nm"] == {
        "minus": {"percent": 2.0},
        "plus": {"percent": 5.0},
    }
    assert after["axes"][0]["answer"]["worst_utilisation"] > after["axes"][0]["answer"]["utilisation"]
    client.patch(f"/api/v1{machine}", json={"common": after["common"]})
    assert kept(client, machine) == after
    undone = send(client, machine, ("do", "undo"), past=past_of(page.text))
    assert undone.status_code == 200 and kept(client, machine) == before


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_form_that_is_sent_as_it_was_opened_changes_no_tolerance(
    client: TestClient, machine: str, language: str
) -> None:
    inputs = {
        "torque_Nm": {"percent": 12.5},
        "phases.1.torque_Nm": {"percent": 30.0},
        "pause_s": {"minus": {"absolute": 0.0}, "plus": {"absolute": 0.25}},
        "requirements.load_inertia_kgm2": {"absolute": 0.00125},
    }
    client.patch(f"/api/v1{machine}", json={"common": {"tolerances": inputs}})
    kept_before = tolerances(client, machine)

    for fields in (form(client, machine, language), {**form(client, machine, language), "fw": "1"}):
        answer = send(client, machine, *fields.items(), ("do", "apply"))
        assert answer.status_code == 200, text_of(answer.text)
        assert tolerances(client, machine) == kept_before

    blank = {**form(client, machine, language), "tol_T": ""}
    send(client, machine, *blank.items(), ("do", "apply"))
    assert tolerances(client, machine) == {name: each for name, each in kept_before.items() if name != "torque_Nm"}


@pytest.mark.parametrize("wrong", ["x", "5 parsec", "+5 +3", "1e999", "-1e9", "150 %%", "🙂" * 60])
def test_a_tolerance_that_is_none_is_refused_beside_its_field(client: TestClient, machine: str, wrong: str) -> None:
    before = kept(client, machine)

    answer = send(client, machine, *{**form(client, machine), "tol_T": wrong}.items(), ("do", "apply"))

    assert answer.status_code == 422 and kept(client, machine) == before
    assert 'id="e-tol_T"' in answer.text and 'aria-invalid="true"' in answer.text


def test_two_people_meet_on_one_tolerance_alone(client: TestClient, machine: str) -> None:
    mine = {**form(client, machine), "tol_T": "5"}
    client.patch(f"/api/v1{machine}", json={"common": {"tolerances": {"pause_s": {"percent": 3}}}})
    assert send(client, machine, *mine.items(), ("do", "apply")).status_code == 200
    assert set(tolerances(client, machine)) == {"torque_Nm", "pause_s"}

    again = {**form(client, machine), "tol_T": "9"}
    client.patch(f"/api/v1{machine}", json={"common": {"tolerances": {"torque_Nm": {"percent": 7}}}})
    same = send(client, machine, *again.items(), ("do", "apply"))
    assert same.status_code == 409 and "somebody else has set 7 % since" in unescape(same.text).replace("\u202f", " ")


def test_gears_are_judged_by_the_worst_case_by_one_switch(client: TestClient, machine: str) -> None:
    fields = form(client, machine)
    assert "ot" not in fields

    send(client, machine, *{**fields, "tol_T": "10", "ot": "1"}.items(), ("do", "apply"))

    assert kept(client, machine)["common"]["requirements"] == {"over_tolerance": True}
    assert "Gears judged by the worst case" in text_of(client.get(machine).text)
    fields = form(client, machine)
    assert fields["ot"] == "1"
    del fields["ot"]
    send(client, machine, *fields.items(), ("do", "apply"))
    assert "over_tolerance" not in (kept(client, machine)["common"].get("requirements") or {})


def test_an_axis_shows_the_tolerances_of_its_machine_and_leaves_one_out(client: TestClient, machine: str) -> None:
    client.patch(
        f"/api/v1{machine}",
        json={
            "common": {
                "tolerances": {"torque_Nm": {"percent": 10}, "emergency_stop.torque_Nm": {"percent": 4}},
                "requirements": {"over_tolerance": True},
            }
        },
    )

    page = client.get(f"{machine}/axes/1").text

    field = next(each for each in re.findall(r"<input[^>]*>", page) if 'name="tol_T"' in each)
    assert 'value=""' in field and re.search(r'placeholder="10\s%"', unescape(field))
    message = text_of(page[page.index("of-machine-tolerances") :].partition("</ul>")[0])
    assert "±10 % from the machine" in message and "±4 % not asked here" in message
    switch = next(each for each in re.findall(r"<input[^>]*>", page) if 'name="ot"' in each)
    assert 'type="checkbox"' in switch and " checked" in switch and " disabled" in switch

    query = "T=21&n=150&t=0.3&tp=0.4"
    left = client.get(f"{machine}/axes/1?{query}&do=without:tolerances.torque_Nm").text
    assert 'name="wo" value="tolerances.torque_Nm"' in left and "±10 % not for this axis" in text_of(left)
    saved = client.post(f"{machine}/axes/1/save", data={"link": f"?{query}&wo=tolerances.torque_Nm", "v": "1"})
    assert saved.status_code == 303, text_of(saved.text)
    axis = kept(client, machine)["axes"][0]
    assert axis["without"] == ["tolerances.torque_Nm"] and axis["answer"]["holds"] is None

    own = client.get(f"{machine}/axes/1?{query}&tol=T:3p").text
    assert "this axis has its own" in text_of(own) and re.search(r'name="tol_T"[^>]*value="3\s%"', unescape(own))


@pytest.mark.parametrize("press", ["without:tolerances.x", "common:tolerances..", "without:tolerances.phases.9.mass"])
def test_a_button_for_no_tolerance_changes_nothing(client: TestClient, machine: str, press: str) -> None:
    client.patch(f"/api/v1{machine}", json={"common": {"tolerances": {"torque_Nm": {"percent": 10}}}})

    page = client.get(f"{machine}/axes/1", params={"T": 21, "n": 150, "t": 0.3, "tp": 0.4, "do": press})

    assert page.status_code in (200, 422) and 'name="wo"' not in page.text
