"""Pages of machines: what the list and a working copy show of axes with common values, and how axes are chosen."""

import re
from html import unescape
from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn.application import Application
from hpn.engine.selection import select
from tests.fleet.page import HEAVY, HUB
from tests.state import state_of

BELT = {"duty_cycle": {"phases": [{"torque_Nm": 21, "speed_rpm": 150, "duration_s": 0.3}], "pause_s": 0.4}}
COMMON = {"requirements": {"utilisation": 0.9}, "output_load": {"load_coefficient": 1.2}}
MACHINE: dict[str, Any] = {
    "title": "Packing line",
    "reference": "4711",
    "common": COMMON,
    "axes": [
        {"name": "Infeed belt", "quantity": 3, "ordering_code": None, "application": BELT},
        {"name": "Press ram", "application": {**HUB, "requirements": {"utilisation": 0.8}}},
        {"name": "Pallet lift", "application": HEAVY},
        {"name": "Carton erector", "application": {"duty_cycle": {"phases": [{"torque_Nm": 5}]}}},
    ],
}


@pytest.fixture(scope="module")
def machine(client: TestClient) -> str:
    """Address of a machine with common values."""
    saved = client.post("/api/v1/machines", json=MACHINE)
    assert saved.status_code == 201, saved.text
    return str(saved.json()["url"])


def text_of(html: str) -> str:
    """Text of a part of a page, its white space single."""
    return re.sub(r"\s+", " ", unescape(re.sub(r"<[^>]*>", " ", html)).replace("\u202f", " ")).strip()


def row(page: str, name: str) -> str:
    """Text of the row of an axis."""
    found = next(part for part in re.findall(r"<tr[^>]*id=.axis-.*?</tr>", page, re.DOTALL) if name in part)
    return text_of(found)


def test_the_working_copy_leads_to_its_files(client: TestClient, machine: str) -> None:
    page = client.get(machine).text

    for file in ("report.pdf", "gears.xlsx"):
        assert f'href="/api/v1{machine}/{file}"' in page
        assert client.get(f"/api/v1{machine}/{file}").status_code == 200


def test_common_tolerances_stand_among_the_values_of_every_axis(client: TestClient) -> None:
    tolerances = {
        "torque_Nm": {"percent": 5},
        "output_load.radial_N": {"minus": {"absolute": 0}, "plus": {"absolute": 9}},
    }
    place = client.post("/api/v1/machines", json={**MACHINE, "common": {"tolerances": tolerances}}).json()["url"]

    shown = text_of(client.get(place).text.partition('id="every-axis"')[2].partition("</div>")[0])

    assert "±5 %" in shown and "+9 N −0 N" in shown and "Radial" in shown
    assert "nothing in common" not in shown


def test_rows_show_own_values_quantity_and_gear_and_the_head_counts_gears(client: TestClient, machine: str) -> None:
    """Quantities times the weights of the catalogue: the page and the engine asked axis by axis agree."""
    page = client.get(machine).text
    catalogue = state_of(client).catalogue
    asked = (({**BELT, "requirements": COMMON["requirements"]}, 3), ({**HUB, "requirements": {"utilisation": 0.8}}, 1))
    gears = [(select(Application.model_validate(each), catalogue).selected, count) for each, count in asked]
    weight = sum(catalogue.by_designation[str(gear)].weight_kg or 0.0 for gear, count in gears for _ in range(count))

    assert f"3 {gears[0][0]}" in row(page, "Infeed belt") and "u 90" not in row(page, "Infeed belt")
    assert "u 80 %" in row(page, "Press ram")
    shown = re.search(r'Weight, all gears</p>\s*<p class="value">\s*<data class="quantity" value="([^"]*)"', page)
    assert shown is not None and float(shown[1]) == pytest.approx(weight, rel=1e-12)  # a sum in another order
    written = f"{weight:.2f}"  # in the head and under the list of gears alike
    assert (
        re.search(rf"Weight, all gears</p>.*?>{written}", page, re.S) and f'<td class="figure">{written}</td>' in page
    )
    assert "For every axis Maximum utilisation u 90 %" in text_of(page)
    assert "% u = 90 %" in text_of(
        page[page.index('class="cell largest"') :]
    )  # beside the bar, as the page of an axis has it
    assert "1 axis without a gear" in text_of(page) and "4 gears" in text_of(page)


def test_an_axis_that_does_not_hold_over_its_tolerance_says_so_and_is_counted(client: TestClient) -> None:
    stop = {"emergency_stop": {"torque_Nm": 200}, "requirements": {"ratios": [5]}}
    wide = {**BELT, **stop, "tolerances": {"emergency_stop.torque_Nm": {"percent": 40}}}
    axes = [{"name": "Wide", "application": wide}, {"name": "Exact", "application": {**BELT, **stop}}]
    page = client.get(client.post("/api/v1/machines", json={"axes": axes}).json()["url"]).text

    assert "not over the whole tolerance" in row(page, "Wide")
    assert "not over the whole tolerance" not in row(page, "Exact")
    assert "1 not over the whole tolerance" in text_of(page) and "2 suitable" in text_of(page)
    assert re.search(r"Over the tolerance \d+ hold 1 don’t", text_of(page))
    assert re.search(r"decides; worst case [\d.]+ %", text_of(page))
    (address,) = set(re.findall(r'href="([^"]*show=inside[^"]*)"', page))
    chosen = client.get(address.partition("#")[0]).text
    assert "Don’t hold 1" in text_of(chosen) and len(re.findall(r'id="axis-\d+"', chosen)) == 1


def test_an_axis_without_a_gear_says_what_would_mend_it_and_an_open_one_what_is_missing(
    client: TestClient, machine: str
) -> None:
    page = client.get(machine).text

    assert "No gear; nearest HPN-" in row(page, "Pallet lift") and "Fits if torques drop to" in text_of(page)
    assert "Speed of phase 1 is required" in row(page, "Carton erector")
    german = text_of(client.get(machine, headers={"Accept-Language": "de"}).text)
    assert "Drehzahl der Phase 1 fehlt" in german
    assert "Passt, wenn" in german and "Für alle Achsen" in german


def test_what_would_make_a_gear_fit_is_tried_on_the_axis(client: TestClient, machine: str) -> None:
    """The gear that the row calls nearest then fits, and nothing is changed until the axis is saved."""
    page = client.get(machine).text
    nearest = re.search(r"nearest (HPN-[0-9]+A-[0-9]+)", row(page, "Pallet lift"))
    links = re.findall(r'href="([^"]*)"[^>]*aria-label="Try it: Pallet lift, ', page)
    assert nearest and links

    for link in links:
        tried = text_of(client.get(unescape(link)).text)
        assert nearest[1] in tried and "passes every check" in tried
    assert client.get(f"/api/v1{machine}/axes/3").json()["application"] == HEAVY


def test_an_axis_changed_after_a_revision_is_marked_and_found(client: TestClient, machine: str) -> None:
    api = f"/api/v1{machine}"
    tag = client.get(api).headers["etag"]
    frozen = client.post(f"{api}/revisions", json={"label": "A"}, headers={"If-Match": tag})
    assert frozen.status_code == 201, frozen.text
    assert 'class="changed"' not in client.get(machine).text

    client.patch(f"{api}/axes/2", json={"quantity": 2})

    page = client.get(f"{machine}?show=changed").text
    assert re.findall(r'id="axis-(\d+)"', page) == ["2"] and 'class="changed"' in page
    assert "Working copy on revision A" in text_of(page)


@pytest.mark.parametrize(
    "own",
    [
        {"requirements": 5, "output_load": ["x"], "rank_by": {"a": 1}},
        {"requirements": {"utilisation": 10**400, "ratios": "all", "sizes": [1, {"a": None}], "life_h": True}},
        {"requirements": {"utilisation": -1e300, "efficiency": "<b>" * 1000}, "application_area": []},
    ],
)
def test_an_axis_with_whatever_was_sent_is_shown(client: TestClient, own: dict[str, Any]) -> None:
    saved = client.post("/api/v1/machines", json={"axes": [{"name": "A", "application": own}]})
    assert saved.status_code == 201, saved.text

    page = client.get(saved.json()["url"])

    assert page.status_code == 200 and "<b><b>" not in page.text


def test_the_list_has_verdicts_and_is_searched_and_filtered(client: TestClient, machine: str) -> None:
    sound = client.post("/api/v1/machines", json={"title": "Loader", "axes": MACHINE["axes"][:1]}).json()["url"]

    assert [url for url in (machine, sound) if f'href="{url}"' in client.get("/machines").text] == [machine, sound]
    todo = client.get("/machines?show=todo").text
    assert f'href="{machine}"' in todo and f'href="{sound}"' not in todo
    assert f'href="{sound}"' in client.get("/machines?search=LOAD").text
    assert "No machine matches." in client.get("/machines?search=nothing+of+it").text
    assert client.get("/machines/saved?cursor=x").headers["location"] == "/machines?cursor=x"
    for wrong in ("cursor=x", "search=%07", "show=nothing"):
        assert client.get(f"/machines?{wrong}").status_code == 422
