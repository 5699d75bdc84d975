"""Two saved selections side by side, without script."""

import html
import re
from collections.abc import Iterator

import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import Json, cycle, phase, worked_example

LOADED = worked_example(
    requirements={"ratios": [5], "life_h": 30000},
    output_load={"radial_N": 500, "axial_N": 100, "load_coefficient": 1.2},
)


UNEVEN = [phase(8.5, 76, 1.2), phase(7.3, 67, 1.3), phase(18.8, 250, 2.3), phase(8.3, 184, 0.9)]


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A client of a service that runs for all tests of this file."""
    folder = tmp_path_factory.mktemp("compared")
    with TestClient(create_app(Settings(database_url=f"sqlite:///{folder}/store.sqlite3"))) as client:
        yield client


def saved(client: TestClient, application: Json, **labels: str) -> str:
    """Id of a selection that is now saved."""
    response = client.post("/api/v1/selections", json={"application": application, **labels})
    assert response.status_code == 201, response.text
    return str(response.json()["id"])


def rows(page: str, part: str) -> dict[str, list[str]]:
    """Texts of a part of the table by the heads of its rows; `differs` is one more text of a row that is marked so."""
    body = re.search(rf'<tbody id="compared-{part}">(.*?)</tbody>', page, re.S)
    assert body, part
    result = {}
    for marked, row in re.findall(r'<tr class="(differs)?[^"]*">(.*?)</tr>', body[1], re.S):
        head, *cells = (text(cell) for cell in re.findall(r"<t[hd].*?</t[hd]>", row, re.S))
        result[head] = [*cells, *([marked] if marked else [])]
    return result


def text(markup: str) -> str:
    return " ".join(html.unescape(re.sub("<[^>]*>", "", markup)).replace("\u202f", " ").split())


def compared(client: TestClient, a: str, b: str, **headers: str) -> str:
    page = client.get(f"/selections/compare?a={a}&b={b}", headers=headers)
    assert page.status_code == 200
    return page.text


def test_differences_in_input_verdict_checks_and_figures_stand_side_by_side(client: TestClient) -> None:
    _, second, third = LOADED["duty_cycle"]["phases"]
    phases = [phase(44, 250, 0.3), second | {"name": "<lift>"}, third]
    heavier = LOADED | cycle(*phases, pause_s=LOADED["duty_cycle"]["pause_s"])
    a = saved(client, LOADED, title="Axis <1>", author="M. Muster")
    b = saved(client, heavier | {"requirements": {"ratios": [7]}}, title="Axis 2", revision="B")

    page = compared(client, a, b)

    assert f'<a href="/selections/{a}">Axis &lt;1&gt;</a>' in page
    inputs = rows(page, "inputs")
    assert inputs["Phase 1"] == ["40 Nm · 250 rpm · 0.3 s", "44 Nm · 250 rpm · 0.3 s", "differs"]
    assert inputs["Phase 2"] == ["32 Nm · 500 rpm · 3 s", "<lift> · 32 Nm · 500 rpm · 3 s", "differs"]
    assert not {"Phase 3", "Pause"} & {head.partition(" t")[0] for head in inputs}
    assert ["5", "7", "differs"] in inputs.values()
    assert ["30 000 h", "–", "differs"] in inputs.values()
    assert rows(page, "verdicts")["Gear"] == ["HPN-20A-5", "HPN-20A-7", "differs"]
    checks = rows(page, "checks")
    assert checks["Average torque"] == ["40 % ✓passes 32.0 Nm ≤ 80 Nm", "40 % ✓passes 32.4 Nm ≤ 80 Nm", "differs"]
    assert len(checks["Momentary peak torque"]) == 2
    assert [texts[1:] for texts in checks.values() if "not required" in texts] == [["not required", "differs"]]
    figures = rows(page, "figures")
    assert figures["Maximum torque Tmax"] == ["40 Nm", "44 Nm", "differs"]
    assert len(figures["Maximum output speed nout,max"]) == 2
    assert list(rows(page, "published").values())[1:] == [["149 Nm", "113 Nm", "differs"]]


def test_a_demand_above_its_limit_is_not_said_to_be_below_it(client: TestClient) -> None:
    a, b = saved(client, cycle(phase(400, 250, 3))), saved(client, cycle(phase(40, 250, 3)))
    checks = rows(compared(client, a, b), "checks")

    assert [cell.split("Nm", 1)[1] for cell in checks["Average torque"][:2]] == [" > 200 Nm", " ≤ 80 Nm"]


def test_two_of_the_same_differ_in_nothing(client: TestClient) -> None:
    page = compared(client, *(saved(client, LOADED) for _ in range(2)))

    assert "None: both have the same input." in page
    assert 'class="differs"' not in page


def test_last_bits_are_no_difference(client: TestClient) -> None:
    """Phases in another order add up to another last bit, as another processor does."""
    one, other = (saved(client, cycle(*phases, requirements={"ratios": [5]})) for phases in (UNEVEN, UNEVEN[::-1]))
    a, b = (client.get(f"/api/v1/selections/{id}").json()["result"] for id in (one, other))
    page = compared(client, one, other)

    assert a["duty"]["average_torque_Nm"] != b["duty"]["average_torque_Nm"]
    for part in ("verdicts", "checks", "figures"):
        assert [head for head, cells in rows(page, part).items() if "differs" in cells] == []


def test_figures_are_in_the_units_of_the_reader(client: TestClient) -> None:
    a, b = saved(client, cycle(phase(40, 100))), saved(client, cycle(phase(50, 100)))

    page = compared(client, a, b, Cookie="hpn_units=lb_in.lbf")

    assert rows(page, "figures")["Maximum torque Tmax"] == ["354 lb·in", "443 lb·in", "differs"]


def test_a_cycle_may_be_longer_than_the_other_and_very_long(client: TestClient) -> None:
    a, b = (saved(client, cycle(*[phase(torque, 100)] * count)) for torque, count in ((30, 1), (40, 70)))

    inputs = compared(client, a, b)

    assert rows(inputs, "inputs")["Phase 2"] == ["–", "40 Nm · 100 rpm · 1 s", "differs"]
    assert "Phase 51" not in rows(inputs, "inputs")
    assert "and more phases that differ" in inputs


def test_boxes_marked_in_the_list_lead_to_the_comparison(client: TestClient) -> None:
    a, b = saved(client, LOADED), saved(client, LOADED)
    page = client.get("/selections").text

    assert len(re.findall(rf'form="comparing" name="id" value="(?:{a}|{b})"', page)) == 2
    answer = client.get(f"/selections/compare?id={a}&id={b}", follow_redirects=False)
    assert (answer.status_code, answer.headers["location"]) == (303, f"/selections/compare?a={a}&b={b}")


@pytest.mark.parametrize("query", ["", "id=x", "a=x", "b=x", "id=x&id=y&id=z"])
def test_not_two_is_asked_for_two(client: TestClient, query: str) -> None:
    page = client.get(f"/selections/compare?{query}")

    assert page.status_code == 422
    assert "Mark two saved selections in the list" in page.text


def test_one_that_is_deleted_says_so_and_the_other_stays_in_reach(client: TestClient) -> None:
    record, gone = saved(client, LOADED, title="kept"), saved(client, LOADED)
    client.delete(f"/api/v1/selections/{gone}")

    one = client.get(f"/selections/compare?a={gone}&b={record}")
    none = client.get(f"/selections/compare?a={gone}&b=x")

    assert (one.status_code, none.status_code) == (404, 404)
    assert "One of the two is not there" in one.text
    assert f'<a href="/selections/{record}">kept</a>' in one.text
    assert "Neither of the two is there" in none.text


def test_a_store_out_of_reach_says_so(tmp_path_factory: pytest.TempPathFactory) -> None:
    settings = Settings(database_url="postgresql://nobody@127.0.0.1:9/none", database_seconds=1)
    with TestClient(create_app(settings)) as client:
        page = client.get(f"/selections/compare?a={'A' * 22}&b={'B' * 22}")

    assert page.status_code == 503
    assert "temporarily unavailable" in page.text
