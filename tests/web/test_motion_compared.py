"""Two saved motions side by side, and what a link to one unfolds into."""

from starlette.testclient import TestClient

from hpn.web.api.samples import TURNING
from hpn.web.pages.saved import NAMES, phase_of
from tests.build import Json


def saved(api: TestClient, motion: Json) -> str:
    reply = api.post("/api/v1/selections", json={"application": {"duty_cycle": {"motion": motion}}})
    return str(reply.json()["id"])


def test_mechanism_and_moves_that_differ_stand_side_by_side(api: TestClient) -> None:
    heavier = TURNING | {"mechanism": TURNING["mechanism"] | {"inertia_kgm2": 1.2}}
    slower = heavier | {"moves": [TURNING["moves"][0] | {"time_s": 0.9}, *TURNING["moves"][1:]]}
    a, b = saved(api, TURNING), saved(api, slower)
    page = api.get(f"/selections/compare?a={a}&b={b}", headers={"Accept-Language": "en"}).text
    assert "Moment of inertia" in page
    assert "Move 1" in page
    assert "Move 2" not in page
    assert "Inertia of the load" in page


def test_a_link_to_a_motion_says_so(api: TestClient) -> None:
    place = f"/selections/{saved(api, TURNING)}"
    told = api.get("/oembed", params={"url": place}).json()["description"]
    assert "motion of 8 load phases, load inertia 0.8 kg·m²" in told


def test_a_difference_in_a_phase_of_a_motion_says_which_and_what() -> None:
    assert phase_of("/duty/phases/3/peak_torque_Nm") == 4
    assert phase_of("/candidates/0/life_L10_h") is None
    assert NAMES["peak_torque_Nm"] == "Peak torque"
    assert NAMES["load_inertia_kgm2"] == "Inertia of the load"
