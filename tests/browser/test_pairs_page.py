"""Pairs in the browser, for a new user: a data sheet is pasted, its list named, a pair taken."""

import re
from collections.abc import Iterator

import httpx2
import pytest
from playwright.sync_api import expect

from tests.browser.conftest import PATIENCE_S, Visitor, violations
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


@pytest.fixture
def place(visitor: Visitor) -> Iterator[str]:
    """Address of a stored list of three motors, which is deleted afterwards."""
    lists, content = f"{visitor.server}/api/v1/motor-lists", sheet(3).replace("\t", ";").encode()
    with httpx2.Client(timeout=PATIENCE_S, headers={"content-type": "text/csv"}) as client:
        answer = client.post(lists, params={"name": "Sheet"}, content=content)
        assert answer.status_code == 201, answer.text
        yield f"/motor-lists/{answer.json()['id']}"
        client.delete(f"{lists}/{answer.json()['id']}")


@pytest.mark.parametrize(("width", "dark", "script"), [(1440, False, True), (390, True, True), (1440, False, False)])
def test_a_motor_is_typed_into_the_sheet_of_a_list_by_keyboard(
    visitor: Visitor, place: str, width: int, dark: bool, script: bool
) -> None:
    page = visitor.open(place, width, dark=dark, touch=width == 390, script=script)
    page.get_by_label("Motor, row 4", exact=True).fill("New 1")
    page.keyboard.press("Tab")
    page.keyboard.type("1,27 Nm")
    expect(page.get_by_label("Rated motor torque, row 4, in Nm")).to_have_value("1,27 Nm")
    page.get_by_label("Inertia of the motor, row 4, in kg·cm²").fill("nonsense")

    page.keyboard.press("Enter")  # a further row, and nothing is saved
    expect(page.get_by_label("Motor, row 5", exact=True)).to_be_focused()
    page.get_by_role("button", name="Save list").click()
    alert = page.get_by_role("alert")
    expect(alert).to_contain_text("Not saved: correct these rows, or remove them: 4.")
    expect(page.get_by_label("Motor, row 4", exact=True)).to_be_focused()
    assert not script or violations(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth") if script else True
    assert width == 1440 or page.evaluate(TOO_SMALL, [MAIN, LEAST_PX, TOUCH_PX]) == []

    page.get_by_label("Inertia of the motor, row 4, in kg·cm²").fill("0,41")
    page.get_by_label("Rated motor torque, row 4, in Nm").fill("1.27 Nm")
    page.get_by_role("button", name="Save list").click()
    expect(alert).to_contain_text("row 4")
    page.get_by_label("Inertia of the motor, row 4, in kg·cm²").fill("0.41")
    page.get_by_role("button", name="Save list").click()

    expect(page.get_by_text("4 motors")).to_be_visible()
    expect(page.get_by_label("Rated motor torque, row 4, in Nm")).to_have_value("1.27")
    page.get_by_role("button", name="Remove row 4").click()
    expect(page.get_by_label("Motor, row 4", exact=True)).to_have_value("")


def test_two_tabs_with_one_list_overwrite_each_other_only_on_request(visitor: Visitor, place: str) -> None:
    first, second = visitor.open(place), visitor.open(place)
    first.get_by_label("Rated motor torque, row 1, in Nm").fill("0.31")
    first.get_by_role("button", name="Save list").click()
    expect(first.get_by_role("alert")).to_have_count(0)
    second.get_by_label("Weight, row 2, in kg").fill("9")

    second.get_by_role("button", name="Save list").click()

    expect(second.get_by_role("alert")).to_contain_text("Somebody else has saved this list")
    expect(second.get_by_role("alert")).to_contain_text("S40, S41")
    expect(second.get_by_label("Weight, row 2, in kg")).to_have_value("9")
    assert violations(second) == []
    second.get_by_role("button", name="Save in place of theirs").click()
    expect(second.get_by_text("3 motors")).to_be_visible()
    visitor.watches[1].console.clear()  # Chromium reports every 412


@pytest.mark.parametrize(("width", "dark"), [(1920, False), (390, True)])
def test_the_list_and_the_axis_stand_beside_the_pairs(visitor: Visitor, place: str, width: int, dark: bool) -> None:
    page = visitor.open(f"/pairs?{LINK}&list={place.rpartition('/')[2]}", width, dark=dark, touch=width == 390)

    expect(page.get_by_role("table", name="Motors").get_by_role("row")).to_have_count(4)
    expect(page.get_by_role("region", name="Axis")).to_contain_text("110 ° · 0.25 s")
    assert violations(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.get_by_role("link", name="Edit list").click()
    expect(page.get_by_label("Motor, row 1", exact=True)).to_have_value("S40")


def test_pairs_without_an_application_begin_with_one(visitor: Visitor) -> None:
    page = visitor.open("/pairs")

    expect(page.get_by_role("alert")).to_have_count(0)
    assert violations(page) == []
    page.get_by_role("link", name="on the selection page").click()
    expect(page).to_have_url(f"{visitor.server}/")


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
