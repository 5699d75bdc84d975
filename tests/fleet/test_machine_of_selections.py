"""A machine begins with saved selections: each that is marked in their list becomes an axis."""

import re
from html import unescape

import pytest
from starlette.testclient import TestClient

from tests.build import worked_example
from tests.fleet.test_machine_page import text_of

LONG = "Infeed turret of the packing line in hall 3, with the new drive"


@pytest.fixture
def saved(client: TestClient) -> list[str]:
    """Ids of two saved selections: one with revisions and an ordering code, one with a long title."""
    first = {"application": worked_example(), "title": "Infeed turret", "reference": "HB-2417", "revision": "A"}
    id = str(client.post("/api/v1/selections", json=first).json()["id"])
    later = worked_example(requirements={"ratios": [5]})
    body = {"application": later, "label": "B", "ordering_code": "HPN-20A-5-J6-BH-AF1"}
    assert client.post(f"/api/v1/selections/{id}/revisions", json=body).status_code == 201
    other = {"application": worked_example(emergency_stop={"torque_Nm": 150}), "title": LONG, "reference": "HB-2388"}
    return [id, str(client.post("/api/v1/selections", json=other).json()["id"])]


def begun(client: TestClient, ids: list[str]) -> str:
    """Address of the machine that the marked selections make."""
    answer = client.post("/machines", data={"new": "selections", "id": ids}, follow_redirects=False)
    assert answer.status_code == 303, answer.text
    return str(answer.headers["location"])


def test_each_marked_selection_becomes_an_axis_as_its_latest_revision_has_it(
    client: TestClient, saved: list[str]
) -> None:
    """Two ways that agree: the axes over REST, and the selections that they come of."""
    machine = begun(client, saved[::-1])
    axes = client.get(f"/api/v1{machine}").json()["axes"]

    assert [axis["name"] for axis in axes] == [f"{LONG[:39]}…", "Infeed turret"]
    assert [axis["note"] for axis in axes] == [f"{LONG}, HB-2388", "HB-2417"]
    assert [axis["ordering_code"] for axis in axes] == [None, "HPN-20A-5-J6-BH-AF1"]
    for axis, id in zip(axes, reversed(saved), strict=True):
        reply = client.get(f"/api/v1/selections/{id}").json()
        assert axis["application"] == reply["application"]
        candidates = {each["designation"]: each for each in reply["result"]["candidates"]}
        gear = axis["answer"]["designation"]
        assert axis["answer"]["utilisation"] == pytest.approx(candidates[gear]["utilisation"], rel=1e-12)
    assert "Infeed turret" in text_of(client.get(machine).text)


def test_the_list_of_selections_makes_the_machine_without_script(client: TestClient, saved: list[str]) -> None:
    page = unescape(client.get("/selections").text)
    form = re.search(r'<button[^>]*value="selections"[^>]*>', page)

    assert form and 'formaction="/machines"' in form[0] and 'formmethod="post"' in form[0]
    assert len(re.findall(rf'form="comparing" name="id" value="(?:{"|".join(saved)})"', page)) == 2


def test_a_selection_that_is_not_marked_or_gone_makes_no_machine(client: TestClient, saved: list[str]) -> None:
    nothing = client.post("/machines", data={"new": "selections"})
    assert nothing.status_code == 422 and "Mark the saved selections first" in nothing.text
    lost = client.post("/machines", data={"new": "selections", "id": [saved[0], "no-such-selection-1234"]})
    assert lost.status_code == 404 and "there is no saved selection" in text_of(lost.text)
    many = client.post("/machines", data={"new": "selections", "id": [f"s{n}" for n in range(300)]})
    assert many.status_code == 422 and "300 saved selections are marked" in many.text
