"""Three journeys: a gear that is too soft, a pulley beside the shaft's centre, a brake that is too hard."""

import json
import re
from urllib.request import Request, urlopen

from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Visitor
from tests.browser.test_page import selected

AXIS = "/?T=40&n=60&t=0.5&T=-40&n=60&t=0.5&tp=1&i=5"


def verdict(page: Page) -> Locator:
    return page.locator(".verdict")


def test_an_axis_that_is_too_soft_is_asked_for_25_hz_and_gets_the_next_gear_with_the_reason(visitor: Visitor) -> None:
    page = visitor.open(f"{AXIS}&JL=1.2")
    expect(selected(page)).to_contain_text("HPN-20A-5")
    page.get_by_role("link", name="Drive").click()
    expect(page.get_by_role("table", name="Stiffness and resonance")).to_contain_text("23.4")

    page.locator("#group-stiffness > summary").click()
    page.get_by_label("Minimum natural frequency").fill("25")
    expect(selected(page)).to_contain_text("HPN-32A-5")

    page.get_by_role("link", name="Overview").click()
    expect(page.locator("#check-natural_frequency th")).to_contain_text("your limit · table 15.2")
    page.get_by_role("button", name="HPN-20A-5: not suitable").click()
    expect(verdict(page)).to_contain_text("natural frequency")
    expect(page.get_by_text("the load’s inertia drops to").first).to_be_visible()

    # The same over REST, as from a PLM system.
    question = {"load_inertia_kgm2": 1.2, "natural_frequency_Hz": 25, "ratios": [5]}
    phases = [{"torque_Nm": T, "speed_rpm": 60, "duration_s": 0.5} for T in (40, -40)]
    body = json.dumps({"duty_cycle": {"phases": phases, "pause_s": 1}, "requirements": question}).encode()
    request = Request(f"{visitor.server}/api/v1/select", body, {"Content-Type": "application/json"})
    with urlopen(request) as reply:
        assert json.load(reply)["selected"] == "HPN-32A-5"


def test_a_pulley_at_45_mm_is_judged_with_its_lever(visitor: Visitor) -> None:
    page = visitor.open(f"{AXIS}&size=20A&FR=600&FA=200")
    expect(selected(page)).to_contain_text("✓ suitable")

    page.locator("#group-lever > summary").click()
    expect(page.get_by_role("img", name="Shaft from the side")).to_be_visible()
    page.get_by_label("Radial load acts at").fill("45")
    expect(selected(page)).to_contain_text("one input is missing · one gear passes every other check")
    page.get_by_label("Axial load acts at").fill("40")
    page.get_by_label("x_c of 20A").fill("21")
    expect(page).to_have_url(re.compile("xc=20A:21"))
    expect(selected(page)).to_contain_text("No gear is suitable")
    expect(verdict(page)).to_contain_text("largest load on the output bearing (102")


def test_a_pulley_on_the_shaft_is_counted_from_the_torques(visitor: Visitor) -> None:
    page = visitor.open(f"{AXIS}&size=20A")
    expect(page.get_by_label("Pitch diameter")).to_be_hidden()
    page.get_by_role("group", name="On the gear’s shaft").get_by_role("radio", name="Belt").check()
    expect(page.get_by_label("Helix angle of the rack")).to_be_hidden()
    page.get_by_label("Pitch diameter").fill("200")
    page.get_by_label("Tension factor of the belt").fill("1.5")
    expect(page).to_have_url(re.compile("kb=1.5&dt=belt&dd=200"))
    expect(page.locator("#counted")).to_contain_text("up to 600 N")
    page.get_by_role("link", name="Bearing").click()
    expect(page.get_by_text("from a tangential force of 400").first).to_be_visible()
    page.get_by_role("button", name="Undo", exact=True).first.click()
    page.get_by_role("button", name="Undo", exact=True).first.click()
    page.get_by_role("button", name="Undo", exact=True).first.click()
    expect(page.get_by_role("radio", name="Typed")).to_be_checked()


def test_a_brake_that_is_too_hard_says_how_hard_it_may_be(visitor: Visitor) -> None:
    page = visitor.open(f"{AXIS}&size=20A&JL=0.8&Jm=0.0015")
    page.locator("#group-brake > summary").click()
    page.get_by_label("Brake torque").fill("30")
    expect(selected(page)).to_contain_text("No gear is suitable")
    expect(verdict(page)).to_contain_text("momentary peak torque")
    expect(page.get_by_text("the brake’s torque drops to").first).to_be_visible()

    page.get_by_label("Brake torque").fill("8")
    expect(selected(page)).to_contain_text("✓ suitable")
    page.get_by_role("link", name="Drive").click()
    expect(page.get_by_role("table", name="Stop by the brake")).to_contain_text("Stopping angle")
