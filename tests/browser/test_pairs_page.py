"""Pairs in the browser, for a new user: a data sheet is pasted, its list named, a pair taken."""

import re

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Visitor, violations
from tests.browser.test_standards import LEAST_PX, MAIN, TOO_SMALL, TOUCH_PX

LINK = (
    "mech=rotary&J=0.5&etam=0.95&mv=trapezoidal&ms=110&mt=0.25&mv=dwell&ms=&mt=0.4&mv=trapezoidal&ms=-110&mt=0.3"
    "&tp=0.3&Jr=20&eta=0.95"
)
HEAD = (
    "Motor\tRated torque\tPeak torque\tRated speed\tMax. speed\tRotor inertia\tWeight\n\tNm\tNm\trpm\trpm\tkg·cm²\tkg\n"
)


def sheet(count: int) -> str:
    """Rows of a data sheet as copied from a spreadsheet, inertias in kg·cm²."""
    rows = []
    for number in range(count):
        torque = 0.3 * 1.045**number
        inertia, weight = 0.34 * torque**1.4, 0.7 + torque**0.8
        rows.append(f"S{40 + number}\t{torque:.2f}\t{3 * torque:.2f}\t3000\t6000\t{inertia:.3f}\t{weight:.1f}")
    return HEAD + "\n".join(rows)


@pytest.mark.parametrize(("width", "dark"), [(1440, False), (390, True)])
def test_a_sheet_of_112_motors_becomes_ranked_pairs_of_which_one_is_taken(
    visitor: Visitor, width: int, dark: bool
) -> None:
    page = visitor.open(f"/pairs?{LINK}", width, dark=dark, touch=width == 390)
    page.locator(".pairs-input details").evaluate_all("all => all.forEach(one => { one.open = true })")

    page.get_by_label("or cells copied from a spreadsheet").fill(sheet(112))
    page.get_by_role("button", name="Read table").click()
    expect(page.get_by_text("112 motors")).to_be_visible()
    assert violations(page) == []
    page.get_by_label("Name of the list").fill(f"Servo {width}")
    page.get_by_role("button", name="Save list").click()

    expect(page.get_by_role("table", name="Suitable pairs")).to_be_visible()
    assert violations(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert width == 1440 or page.evaluate(TOO_SMALL, [MAIN, LEAST_PX, TOUCH_PX]) == []
    heading = page.locator("#pair-heading").inner_text()
    page.get_by_role("link", name="Take this pair").click()
    gear = re.search(r"HPN-\d+A-\d+", heading)
    assert gear
    expect(page.locator("#verdict")).to_contain_text(gear[0])


@pytest.mark.parametrize(("width", "dark"), [(1440, True), (390, False)])
def test_the_lists_of_motors_have_a_page(visitor: Visitor, width: int, dark: bool) -> None:
    page = visitor.open("/motor-lists", width, dark=dark, touch=width == 390)

    expect(page.get_by_role("heading", name="Motor lists")).to_be_visible()
    assert violations(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert width == 1440 or page.evaluate(TOO_SMALL, [MAIN, LEAST_PX, TOUCH_PX]) == []


def test_a_curve_typed_into_the_form_is_judged_at_once_and_a_part_of_a_point_is_said(visitor: Visitor) -> None:
    """By hand: M_c at 1,000 rpm is 2.8 - 0.4 / 3 Nm, the RMS torque √((4² · 0.3 + 1² · 0.5) / 1.8) Nm."""
    page = visitor.open("/?T=40&n=100&t=0.3&T=10&n=300&t=0.5&tp=1&i=10&size=20A")
    page.locator("#group-motor summary").click()
    points = page.get_by_label("Motor torque over speed")

    points.press_sequentially("0 : 2.8 : 7.2\n3000 : 2.4 : 7.2\n6000 : 1.5")
    points.press("Tab")
    expect(page.locator("#e-mcv")).to_contain_text("point 3: give speed, continuous and peak torque")
    points.press_sequentially(" : 3")
    points.press("Tab")

    row = page.get_by_role("row").filter(has_text="Motor rated torque").first
    expect(row).to_contain_text("1.72")
    expect(row).to_contain_text("2.67")
    expect(page).to_have_url(re.compile(r"mcv=3000:2\.4:7\.2"))  # after the answer is on the page
    assert violations(page) == []
