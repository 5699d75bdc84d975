"""A machine is worked on from its page: by keys, with the effect said before, on a desk and on a phone."""

import httpx
import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Visitor, violations
from tests.fleet.test_machine_page import MACHINE


@pytest.fixture
def machine(server: str) -> str:
    """Address of a machine."""
    return str(httpx.post(f"{server}/api/v1/machines", json=MACHINE, trust_env=False).json()["url"])


def test_marked_axes_are_changed_by_keys_and_undone(visitor: Visitor, machine: str) -> None:
    page = visitor.open(machine)
    page.keyboard.press("/")
    expect(page.get_by_role("searchbox")).to_be_focused()
    page.get_by_role("searchbox").press("Escape")
    page.get_by_role("checkbox", name="Mark Infeed belt").focus()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Space")
    expect(page.get_by_role("checkbox", name="Mark Infeed belt")).to_be_checked()
    page.get_by_label("Maximum utilisation").last.fill("0.4")
    expect(page.locator(".bulk .effect")).to_contain_text("gear")
    assert violations(page) == []
    page.get_by_role("button", name="Set for the marked axes").click()
    expect(page.get_by_role("row", name="Infeed belt")).to_contain_text("u 40")

    page.keyboard.press("Control+z")

    expect(page.get_by_text("Undone.")).to_be_visible()
    expect(page.get_by_role("row", name="Infeed belt")).not_to_contain_text("u 40")


def test_common_values_open_in_place_and_say_their_effect_while_they_are_typed(visitor: Visitor, machine: str) -> None:
    page = visitor.open(machine)
    page.keyboard.press("e")
    expect(page.get_by_role("button", name="Apply to 4 axes")).to_be_hidden()
    page.get_by_label("Maximum utilisation").fill("0.5")
    expect(page.locator("#every-axis .effect")).to_contain_text("take")
    assert violations(page) == []
    page.get_by_role("button", name="Apply to 4 axes").click()
    expect(page.locator("#every-axis")).to_contain_text("50")
    page.go_back()


@pytest.mark.parametrize("place", ["machine", "revisions", "list"])
def test_a_phone_has_room_for_a_utilisation_far_beyond_every_gear(visitor: Visitor, server: str, place: str) -> None:
    phases = [{"torque_Nm": 9000, "speed_rpm": 100, "duration_s": 1}]
    application = {"duty_cycle": {"phases": phases}, "requirements": {"life_h": 20000}}
    draft = {"title": "Press of a far utilisation", "application": application}
    httpx.post(f"{server}/api/v1/selections", json=draft, trust_env=False).raise_for_status()
    saved = httpx.post(
        f"{server}/api/v1/machines", json={"axes": [{"application": application}]}, trust_env=False
    ).json()
    httpx.post(f"{server}/api/v1{saved['url']}/revisions", json={"label": "A"}, trust_env=False).raise_for_status()
    addresses = {"machine": saved["url"], "revisions": f"{saved['url']}/revisions?from=A&to=now&show=all"}
    page = visitor.open(str(addresses.get(place, "/selections?search=far")), 390, touch=True)

    share = page.locator(".axes .percent, .saved-list .percent").first
    assert len(share.inner_text()) >= len("1 000 000 %")
    cell = share.locator("xpath=ancestor::td")
    assert cell.evaluate("cell => cell.scrollWidth <= cell.clientWidth")
    assert page.evaluate("document.documentElement.scrollWidth") == 390


@pytest.mark.parametrize("dark", [False, True])
def test_a_phone_shows_every_axis_and_its_marks(visitor: Visitor, machine: str, dark: bool) -> None:
    page = visitor.open(machine, 390, dark=dark, touch=True)

    assert page.evaluate("document.documentElement.scrollWidth") == 390
    for name in ("Infeed belt", "Press ram", "Pallet lift", "Carton erector"):
        expect(page.get_by_role("checkbox", name=f"Mark {name}")).to_be_visible()
    page.get_by_role("checkbox", name="Mark Press ram").check()
    expect(page.get_by_role("button", name="Remove")).to_be_visible()
    expect(page.get_by_role("heading", name="Fewest kinds")).to_be_visible()
    assert violations(page) == []
