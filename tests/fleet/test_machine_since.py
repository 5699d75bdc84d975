"""Changes of a machine since its latest revision beside its table, as the comparison of its revisions has them."""

import re
from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn.web.pages import machine_since
from tests.fleet.page import HEAVY, HUB
from tests.fleet.test_machine_changes import kept, past_of, send
from tests.fleet.test_machine_page import BELT, COMMON, row, text_of

STRONGER: dict[str, Any] = {"duty_cycle": {"phases": [{"torque_Nm": 63, "speed_rpm": 150, "duration_s": 0.3}]}}


@pytest.fixture
def machine(client: TestClient) -> str:
    """Address of a machine of three axes with a revision A."""
    axes = [{"name": name, "application": each} for name, each in zip("ABC", (BELT, HUB, HUB), strict=True)]
    place = str(client.post("/api/v1/machines", json={"title": "Line", "common": COMMON, "axes": axes}).json()["url"])
    assert client.post(f"/api/v1{place}/revisions", json={"label": "A"}).status_code == 201
    return place


def panel(page: str) -> str:
    """Text of the changes beside the table."""
    return text_of(page[page.index('<section id="since"') :].partition("</section>")[0])


def changed(client: TestClient, machine: str) -> None:
    """One axis stronger, one removed, one new."""
    client.patch(f"/api/v1{machine}/axes/1", json={"application": STRONGER})
    client.delete(f"/api/v1{machine}/axes/2")
    client.post(f"/api/v1{machine}/axes", json={"axes": [{"name": "D", "application": BELT}]})


def test_a_changed_axis_says_what_changed_and_what_it_did_to_its_gear(client: TestClient, machine: str) -> None:
    """The page and REST, which both have it from the comparison of two documents."""
    assert "No axis differs." in panel(client.get(machine).text)
    changed(client, machine)

    page = client.get(f"{machine}?show=changed").text
    by_number = {
        axis["number"]: axis for axis in client.get(f"/api/v1{machine}/differences?from=A&to=now").json()["axes"]
    }

    gears = [by_number[1][side]["gear"] for side in ("from", "to")]
    assert gears[0] != gears[1]
    message = panel(page)
    assert "1 changed · 1 new · 1 removed · 1 with another gear" in message
    assert f"A : Torque, phase 1 21 Nm 63 Nm {gears[0]} → {gears[1]}, " in message
    assert "D (new) " in message and "Removed: B" in message
    assert sorted(re.findall(r'id="axis-(\d+)"', page)) == ["1", "4"]
    assert "Changed since A 2" in text_of(page)
    below = text_of(page[page.index('id="axis-1"') :].partition("since-row")[2].partition("</tr>")[0])
    assert "21 Nm 63 Nm" in below and f"{gears[0]} → {gears[1]}" in below
    assert 'aria-label="new since revision A"' in page and 'aria-label="changed since revision A"' in page


def test_a_common_value_marks_the_axes_whose_answers_it_changes(client: TestClient, machine: str) -> None:
    client.patch(f"/api/v1{machine}", json={"common": {"requirements": {"utilisation": 0.2}}})

    page = client.get(f"{machine}?show=changed").text

    differ = client.get(f"/api/v1{machine}/differences?from=A&to=now").json()["axes"]
    assert len(re.findall(r'id="axis-(\d+)"', page)) == len(differ) > 0
    assert re.search("For every axis : Maximum utilisation 90 % 20 %", panel(page)), panel(page)


def marks(page: str) -> dict[int, tuple[str, bool]]:
    """Marks of axes by their numbers: the revision, and whether it is saved."""
    result = dict[int, tuple[str, bool]]()
    for number, cells in re.findall(r'id="axis-(\d+)"(.*?)</tr>', page, re.DOTALL):
        if mark := re.search(r'class="changed"( data-saved)?.*?</svg>(\w*)</span>', cells, re.DOTALL):
            result[int(number)] = mark[2], bool(mark[1])
    return result


def test_changes_are_shown_since_whichever_revision_is_chosen(client: TestClient, machine: str) -> None:
    client.patch(f"/api/v1{machine}/axes/1", json={"application": STRONGER})
    client.post(f"/api/v1{machine}/revisions", json={"label": "B"})
    client.patch(f"/api/v1{machine}/axes/2", json={"quantity": 2})

    latest, since_a = client.get(machine).text, client.get(f"{machine}?since=a&show=changed").text

    assert marks(latest) == {1: ("B", True), 2: ("C", False)}
    assert "Changed since revision B" in text_of(latest) and '<option value="B" selected>' in latest
    assert marks(since_a) == {1: ("B", True), 2: ("C", False)}
    assert "Changed since revision A" in panel(since_a) and "2 changed" in panel(since_a)
    assert "show=todo&amp;since=a" in since_a and 'name="since" value="a"' in since_a
    assert marks(client.get(f"{machine}?show=changed").text) == {2: ("C", False)}
    assert "2 changed" in panel(client.get(f"{machine}/since?since=A").text)
    assert panel(client.get(f"{machine}?since=nothing").text) == panel(latest)
    assert 'aria-label="changed in revision B"' in latest and 'aria-label="changed since revision B"' in latest


def test_an_axis_changed_back_is_not_marked(client: TestClient, machine: str) -> None:
    for quantity in (2, 1):
        client.patch(f"/api/v1{machine}/axes/3", json={"quantity": quantity})

    assert 'class="changed" title' not in client.get(machine).text


def test_a_large_machine_is_compared_by_itself(
    client: TestClient, machine: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same section, which the page does not wait for."""
    changed(client, machine)
    at_once = panel(client.get(machine).text)
    monkeypatch.setattr(machine_since, "FEW_AXES", 2)

    page = client.get(machine).text

    assert f'data-load="{machine}/since?since=A"' in page and '<section id="since"' not in page
    assert 'aria-label="changed since revision A"' in page
    assert panel(client.get(f"{machine}/since").text) == at_once
    fresh = client.post("/api/v1/machines", json={"axes": [{"application": BELT}]}).json()["url"]
    assert client.get(f"{fresh}/since").headers["location"] == f"{fresh}/revisions"


def test_an_axis_is_added_from_the_table_and_undone(client: TestClient, machine: str) -> None:
    before = kept(client, machine)

    page = send(client, machine, ("do", "add"), ("name", " Lift "), ("like", "")).text
    axis = kept(client, machine)["axes"][-1]
    assert (axis["name"], axis["application"], axis["answer"]["status"]) == ("Lift", {}, "open")
    assert f'href="{machine}/axes/{axis["number"]}">Open Lift' in page

    page = send(client, machine, ("do", "add"), ("name", ""), ("like", "2"), past=past_of(page)).text
    copy = kept(client, machine)["axes"][-1]
    assert (copy["name"], copy["application"]) == ("B", before["axes"][1]["application"])
    page = send(client, machine, ("do", "add"), ("name", "E"), ("like", "2"), past=past_of(page)).text
    assert kept(client, machine)["axes"][-1]["name"] == "E" and "Open E" in text_of(page)

    for _ in range(3):
        page = send(client, machine, ("do", "undo"), past=past_of(page)).text
    assert kept(client, machine) == before


@pytest.mark.parametrize(
    "fields",
    [
        {"name": "x" * 41, "like": ""},
        {"name": "a\x00b", "like": ""},
        {"name": "", "like": "99"},
        {"name": "x" * 41, "like": "1"},
    ],
)
def test_an_axis_that_can_t_be_is_not_added(client: TestClient, machine: str, fields: dict[str, str]) -> None:
    before = kept(client, machine)

    answer = send(client, machine, ("do", "add"), *fields.items())

    assert answer.status_code == 422 and kept(client, machine) == before


def test_a_machine_without_axes_takes_its_first_from_the_page(client: TestClient) -> None:
    place = client.post("/api/v1/machines", json={"axes": []}).json()["url"]
    assert "This machine has no axes yet." in client.get(place).text

    send(client, place, ("do", "add"), ("name", "First"), ("like", "none"))

    assert row(client.get(place).text, "First")


def test_the_worst_case_has_a_column_where_an_axis_has_tolerances(client: TestClient, machine: str) -> None:
    assert "sort=worst" not in client.get(machine).text
    client.patch(f"/api/v1{machine}", json={"common": {"tolerances": {"torque_Nm": {"percent": 10}}}})
    client.post(f"/api/v1{machine}/axes", json={"axes": [{"name": "heavy", "application": HEAVY}]})

    page = client.get(f"{machine}?sort=-worst").text

    answers = {axis["number"]: axis["answer"] for axis in kept(client, machine)["axes"]}
    rows = {int(number): text_of(part) for number, part in re.findall(r'id="axis-(\d+)">(.*?)</tr>', page, re.DOTALL)}
    for number, answer in answers.items():
        assert answer["worst_utilisation"] > answer["utilisation"]
        whole = "holds over" if answer["holds"] else "not over"
        assert f"{whole} the whole tolerance" in rows[number]
        figure = re.search(r"([\d ]+) % \S " + whole, rows[number])
        # Whole percent, rounded away from the bound.
        assert figure and abs(float(figure[1].replace(" ", "")) / (100 * answer["worst_utilisation"]) - 1) < 0.02
    values = [answers[number]["worst_utilisation"] for number in rows]
    assert 'aria-sort="descending"' in page and values == sorted(values, reverse=True)
