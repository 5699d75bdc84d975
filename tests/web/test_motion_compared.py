"""Two saved motions side by side, and the preview of a link to one."""

import re

from starlette.testclient import TestClient

from hpn.files.export import DIGITS
from tests.build import TURNING, Json, cycle, phase


def saved(api: TestClient, motion: Json, **parts: Json) -> str:
    reply = api.post("/api/v1/selections", json={"application": {"duty_cycle": {"motion": motion}, **parts}})
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


def test_motor_torques_with_the_motors_own_inertia_are_no_quotient_of_the_loads(api: TestClient) -> None:
    turned = {"motor": {"inertia_kgm2": 1e-4, "peak_torque_Nm": 10, "rated_torque_Nm": 5}}
    a, b, plain = (
        saved(api, TURNING, requirements=turned),
        saved(api, TURNING, requirements=turned),
        saved(api, TURNING),
    )
    with_inertia, without = (
        api.get(f"/selections/compare?a={one}&b={other}", headers={"Accept-Language": "en"}).text
        for one, other in ((a, b), (plain, plain))
    )
    assert "T<sub>in,max</sub>" in with_inertia and "T<sub>in,rms</sub>" in with_inertia
    quotients = ["/(i·η)" in re.sub("<[^>]+>", "", page) for page in (with_inertia, without)]
    assert quotients == [False, True]


def test_a_link_to_a_motion_says_so(api: TestClient) -> None:
    page = api.get(f"/selections/{saved(api, TURNING)}").text
    described = re.search(r'<meta property="og:description" content="([^"]*)"', page)
    assert described and "motion of 8 load phases, load inertia 0.8 kg·m²" in described[1]


def test_a_saved_motion_is_shown_as_it_was_given_and_its_phases_with_the_digits_of_the_report(api: TestClient) -> None:
    page = api.get(f"/selections/{saved(api, TURNING)}", headers={"Accept-Language": "en"}).text
    inputs = page[page.index("Input as saved") : page.index('id="cycle"')]
    assert re.search(r"<dt>Mechanism\s*</dt><dd>Rotary</dd>", inputs)
    assert "0.8\N{NARROW NO-BREAK SPACE}kg·m²" in inputs
    assert inputs.count("<li>") == len(TURNING["moves"])
    assert "Load phases of the motion" in inputs
    numbers = re.findall(r"<td[^>]*>−?([\d.\N{NARROW NO-BREAK SPACE}]+)</td>", inputs)
    assert numbers and max(len(re.sub(r"^[0.]+|\D", "", number)) for number in numbers) == DIGITS


def test_typed_phases_stay_as_typed_on_the_page_of_a_saved_selection(api: TestClient) -> None:
    reply = api.post("/api/v1/selections", json={"application": cycle(phase(40.123456, 250, 1))})
    page = api.get(f"/selections/{reply.json()['id']}", headers={"Accept-Language": "en"}).text
    assert ">40.123456</td>" in page
    assert "Load phases of the motion" not in page
