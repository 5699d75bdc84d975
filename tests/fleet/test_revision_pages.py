"""Pages of revisions: the chain, two states compared cell by cell, the next one saved, and one shown read-only."""

import re
from typing import Any

import pytest
from starlette.testclient import TestClient

from tests.build import worked_example
from tests.fleet.test_machine_page import MACHINE, row, text_of

PATCH = {"Content-Type": "application/merge-patch+json"}


@pytest.fixture
def machine(client: TestClient) -> str:
    """Address of a machine with the revision A."""
    place = str(client.post("/api/v1/machines", json=MACHINE).json()["url"])
    assert client.post(f"/api/v1{place}/revisions", json={"label": "A", "author": "MA"}).status_code == 201
    return place


def change(client: TestClient, place: str, number: int, patch: dict[str, Any]) -> None:
    answer = client.patch(f"/api/v1{place}/axes/{number}", json=patch, headers=PATCH)
    assert answer.status_code == 200, answer.text


def heavier(client: TestClient, place: str) -> None:
    """The first axis with twice its torque."""
    phases = [{"torque_Nm": 42, "speed_rpm": 150, "duration_s": 0.3}]
    change(client, place, 1, {"application": {"duty_cycle": {"phases": phases}}})


def test_the_comparison_has_the_cells_and_figures_that_rest_gives(client: TestClient, machine: str) -> None:
    heavier(client, machine)
    reply = client.get(f"/api/v1{machine}/differences?from=A&to=now").json()
    page = client.get(f"{machine}/revisions").text
    view = row(page, "Infeed belt")

    (axis,) = reply["axes"]
    assert [(each["from"], each["to"]) for each in axis["inputs"]] == [(21, 42)]
    assert "Torque, phase 1 21 Nm 42 Nm" in view and str(axis["to"]["gear"]) in view
    assert "1 cell on 1 of 4 axes" in text_of(page) and "3 axes are the same in input and result." in text_of(page)
    assert re.findall(r'id="axis-(\d+)"', client.get(f"{machine}/revisions?show=all").text)[0] == "1"
    assert len(re.findall(r'id="axis-', client.get(f"{machine}/revisions?show=all").text)) == 4
    for suffix in ("pdf", "xlsx"):
        link = f"/api/v1{machine}/differences.{suffix}?from=A&to=now"
        assert link.replace("&", "&amp;") in page and client.get(link).status_code == 200


def test_a_common_value_that_differs_counts_once_and_for_every_axis(client: TestClient, machine: str) -> None:
    client.patch(f"/api/v1{machine}", json={"common": {"requirements": {"utilisation": 0.77}}}).raise_for_status()

    assert "1 cell on 0 of 4 axes, one for every axis" in text_of(client.get(f"{machine}/revisions").text)


def test_results_of_an_axis_stand_under_result(client: TestClient, machine: str) -> None:
    def head(page: str) -> str:
        return re.search(r'<span class="cell-row">\s*<span>(.*?)</span>', page)[1]  # type: ignore[index]

    common = {"tolerances": {"torque_Nm": {"percent": 5}}}
    client.patch(f"/api/v1{machine}", json={"common": common}).raise_for_status()
    results = client.get(f"{machine}/revisions?from=A&to=now").text
    assert head(results) == "Result" and "Utilisation in the worst case" in row(results, "Infeed belt")
    heavier(client, machine)
    both = client.get(f"{machine}/revisions?from=A&to=now").text

    assert head(both) == "Input or result"
    assert "Result Utilisation in the worst case – " in row(both, "Press ram")
    assert "Torque, phase 1 21 Nm 42 Nm" in row(both, "Infeed belt") and "Result" not in row(both, "Infeed belt")


def test_the_head_of_a_comparison_says_the_largest_utilisation_as_its_axis_does(client: TestClient) -> None:
    """Of T_k = 204.5 Nm on HPN-20A-5 that is 204.5 / 256, which rounds to the user's u and is below it."""
    stop = worked_example(emergency_stop={"torque_Nm": 204.5}, requirements={"ratios": [5]})
    axes = [{"name": "Infeed belt", "application": stop}]
    content = {"axes": axes, "common": {"requirements": {"utilisation": 0.8}}}
    place = str(client.post("/api/v1/machines", json=content).json()["url"])
    assert client.post(f"/api/v1{place}/revisions", json={"label": "A"}).status_code == 201
    change(client, place, 1, {"quantity": 7})

    page = client.get(f"{place}/revisions").text

    assert "79.9 %" in row(client.get(place).text, "Infeed belt")
    assert "Largest utilisation 79.9 % → 79.9 % " in text_of(page)
    assert re.search(r"Weight [\d.]+ kg → [\d.]+ kg", text_of(page))


def test_the_next_revision_is_saved_from_the_page_and_a_taken_label_offers_another(
    client: TestClient, machine: str
) -> None:
    heavier(client, machine)
    page = client.get(machine).text
    assert "Save revision B" in text_of(page)
    version = re.search(r'action="[^"]*/revisions".*?name="version" value="(\d+)"', page, re.DOTALL)
    assert version is not None
    sent = {"version": version[1], "label": "B", "author": "LO", "checked": "KR", "note": "twice the torque"}

    saved = client.post(f"{machine}/revisions", data=sent, follow_redirects=False)
    again = client.post(f"{machine}/revisions", data=sent)

    assert (saved.status_code, saved.headers["location"]) == (303, f"{machine}/revisions")
    (line, _) = client.get(f"/api/v1{machine}/revisions").json()["revisions"]
    assert [line[name] for name in ("label", "author", "checked", "note")] == ["B", "LO", "KR", "twice the torque"]
    assert again.status_code == 409 and "choose another label" in text_of(again.text) and 'value="C"' in again.text
    assert "as revision B" in text_of(again.text)
    wrong = client.post(f"{machine}/revisions", data={"label": "now"})
    assert wrong.status_code == 422 and "reserved" in text_of(wrong.text)


def test_a_revision_of_a_machine_is_shown_as_it_was_and_takes_no_change(client: TestClient, machine: str) -> None:
    before = row(client.get(machine).text, "Infeed belt")
    heavier(client, machine)
    page = client.get(f"{machine}?revision=a").text

    assert row(page, "Infeed belt") == re.sub(r"^Mark all ", "", before)
    assert row(client.get(machine).text, "Infeed belt") != before
    assert "Revision A · read-only" in text_of(page)
    for absent in ('name="axis"', "edit=common", "/rename", "/delete", "data-load"):
        assert absent not in page
    assert f'href="{machine}?revision=A&amp;show=todo' in page or f"{machine}?show=todo&amp;revision=A" in page
    assert client.get(f"{machine}?revision=Z").status_code == 404


def test_a_selection_compares_its_revisions(client: TestClient) -> None:
    body = {"application": worked_example(), "title": "Turret", "revision": "A"}
    place = str(client.post("/api/v1/selections", json=body).json()["url"])
    lighter = worked_example()
    lighter["emergency_stop"]["torque_Nm"] = 100
    assert client.post(f"/api/v1{place}/revisions", json={"application": lighter, "label": "B"}).status_code == 201

    page = client.get(f"{place}/revisions").text
    text = text_of(page)

    assert "A → B" in text and re.search(r"Emergency-stop torque 200 Nm 100 Nm", text)
    assert "Result that differs" in text and f'href="{place}?revision=A"' in page
    assert "Geänderte Eingabe" in client.get(f"{place}/revisions", headers={"Accept-Language": "de"}).text
    assert client.get(f"{place}/revisions?from=today&to=today").status_code == 422
    assert client.get(f"{place}/revisions?from=Z").status_code == 404


def test_a_machine_without_a_revision_offers_the_first(client: TestClient) -> None:
    place = str(client.post("/api/v1/machines", json=MACHINE).json()["url"])
    text = text_of(client.get(f"{place}/revisions").text)
    assert "No revision is saved yet." in text and "Save revision A" in text


def test_the_largest_axis_of_the_title_block_leads_to_the_axis_in_its_machine(client: TestClient, machine: str) -> None:
    block = re.search(r'class="cell largest".*?</div>', client.get(machine).text, re.DOTALL)
    assert block is not None and re.search(rf'href="{machine}/axes/[12]"', block[0])
