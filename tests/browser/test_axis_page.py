"""Daily work on a machine: an axis is opened, changed and saved, then the next one; two people on one axis."""

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor, torque, violations
from tests.build import cycle, phase
from tests.web.test_axis_page import AXES, COMMON


@pytest.fixture
def machine(server: str) -> str:
    """Address of a machine."""
    sent = {"title": "Packing line", "common": COMMON, "axes": AXES}
    return str(httpx.post(f"{server}/api/v1/machines", json=sent, trust_env=False).json()["url"])


def changed(page: Page, field: str, text: str) -> None:
    """Type into a cell of the first phase, and wait until the address contains the text."""
    page.locator(f"#{field}-0").fill(text)
    page.wait_for_url(f"**{field}={text}&**")


def test_an_axis_is_opened_from_its_machine_changed_and_saved_back_and_then_the_next(
    visitor: Visitor, machine: str
) -> None:
    page = visitor.open(machine)
    page.get_by_role("table").get_by_role("link", name="X1").click()
    expect(page.get_by_role("link", name="Packing line")).to_be_visible()
    assert violations(page) == []

    changed(page, "T", "24")
    page.keyboard.press("Control+s")

    page.wait_for_url(f"**{machine}/axes/1")
    expect(torque(page, 1)).to_have_value("24")
    page.locator("#result").focus()
    page.keyboard.press("]")
    page.wait_for_url(f"**{machine}/axes/2")
    expect(page.get_by_label("Name of axis 2")).to_have_value("Y bridge")
    expect(page.get_by_label("Maximum utilisation")).to_have_value("1")


def test_what_is_typed_and_left_is_there_again_on_the_way_back(visitor: Visitor, machine: str) -> None:
    page = visitor.open(f"{machine}/axes/1")
    changed(page, "T", "25")
    page.locator("#result").focus()
    page.keyboard.press("]")
    page.wait_for_url(f"**{machine}/axes/2")

    page.go_back()

    expect(torque(page, 1)).to_have_value("25")


def test_the_second_of_two_on_one_axis_sees_all_three_and_goes_on_with_both(visitor: Visitor, machine: str) -> None:
    page = visitor.open(f"{machine}/axes/1")
    second = page.context.new_page()
    second.goto(page.url)
    changed(page, "T", "24")
    page.get_by_role("button", name="Save to machine").click()
    page.wait_for_url(f"**{machine}/axes/1")

    changed(second, "n", "350")
    second.get_by_role("button", name="Save to machine").click()

    expect(second.get_by_role("row", name="Torque, row 1")).to_contain_text("24")
    expect(second.get_by_role("row", name="Speed, row 1")).to_contain_text("350")
    assert violations(second) == []
    second.get_by_role("link", name="Theirs with my changes").click()
    expect(torque(second, 1)).to_have_value("24")
    expect(second.locator("#n-0")).to_have_value("350")
    second.get_by_role("button", name="Save to machine").click()
    second.wait_for_url(f"**{machine}/axes/1")
    expect(second.locator("#n-0")).to_have_value("350")


@pytest.mark.parametrize("width", [1440, 390])
def test_what_stands_beside_the_checks_of_an_axis_does_not_lie_on_itself(
    visitor: Visitor, server: str, width: int
) -> None:
    """Loads of each phase widen the input, so that the result of a wide page is narrow."""
    loaded = cycle(phase(80, 60, 0.8, radial_N=900.0))
    sent = {"axes": [{"name": "Table", "application": loaded}, {"name": "Lift", "application": loaded}]}
    place = httpx.post(f"{server}/api/v1/machines", json=sent, trust_env=False).json()["url"]
    page = visitor.open(f"{place}/axes/1", width, touch=width < 600)

    parts = [page.locator("section.nearest", has_text=text) for text in ("Nearest lighter gear", "In this machine")]
    above, below = (part.evaluate("part => part.getBoundingClientRect().toJSON()") for part in parts)
    assert above["height"] > 20 and above["bottom"] <= below["top"]


def test_the_strap_of_a_refused_save_is_as_wide_as_a_phone(visitor: Visitor, machine: str) -> None:
    page = visitor.open(f"{machine}/axes/1", 390, touch=True)
    torque(page, 1).fill("x")
    expect(torque(page, 1)).to_have_attribute("aria-invalid", "true")
    page.get_by_role("button", name="Save to machine").click()

    expect(page.get_by_text("Not saved: first correct")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") == 390
