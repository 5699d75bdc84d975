"""Journeys of people with dimensions and moves, but without inertias and phases."""

import json
import re
from functools import partial
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Visitor, answer_held_back, in_german, violations

SAVED = re.compile("/selections/[A-Za-z0-9_-]{22}$")
ON_DESK = pytest.mark.parametrize("width", [1440, pytest.param(390, marks=pytest.mark.soak)])
ON_PHONE = pytest.mark.parametrize("width", [390, pytest.param(1440, marks=pytest.mark.soak)])
START = "/?mech=rotary&mv=trapezoidal&ms=&mt="
RAMPS = (
    "/?mech=ball_screw&h=20&ml=180&mc=120&inc=90&mv=trapezoidal&ms=600&mt=&mn=400&mta=0.2&mtd=0.5"
    "&mv=dwell&ms=&mt=1.5&mn=&mta=&mtd="
)
LIFTED = "/?mech=ball_screw&h=20&ml=120&inc=90&mv=s_curve&ms=-400&mt=1.5&mv=modified_sine&ms=400&mt=2"


def result(page: Page) -> Locator:
    return page.get_by_role("region", name="Result")


def box(page: Page, name: str, *, exact: bool = False) -> Locator:
    return page.get_by_role("textbox", name=name, exact=exact)


def add_body(page: Page, k: int, shape: str, **figures: str) -> None:
    """Fill body k, and add it first if it is not the first."""
    if k > 1:
        page.get_by_role("button", name="Add body").click()
    choice = page.get_by_role("combobox", name=f"Shape, body {k}")
    expect(choice).to_be_visible()
    choice.select_option(shape)
    for name, value in figures.items():
        box(page, f"{name.replace('_', ' ')}, body {k}").fill(value)


def add_move(page: Page, k: int, profile: str, **figures: str) -> None:
    """Fill move k, and add it first if it is not the first."""
    if k > 1:
        page.get_by_role("button", name="Add move").click()
        expect(page.get_by_role("combobox", name=f"Profile, move {k}")).to_be_focused()
    page.get_by_role("combobox", name=f"Profile, move {k}").select_option(profile)
    for name, value in figures.items():
        box(page, f"{name}, move {k}").fill(value)


def use_the_sum(page: Page, figure: str) -> None:
    expect(page.locator("#bodies-sum")).to_contain_text(figure)
    page.get_by_role("button", name="Use this inertia").click()


def saved(page: Page, base: str) -> tuple[dict[str, Any], str]:
    """Save the page's selection; its application and link."""
    page.get_by_role("button", name="Save", exact=True).click()
    page.wait_for_url(SAVED)
    reply = page.request.get(page.url.replace("/selections/", "/api/v1/selections/")).text()
    kept = json.loads(reply)
    return kept["application"], base + kept["result"]["link"]


def has_no_sideways_scroll(page: Page) -> bool:
    return bool(page.evaluate("document.documentElement.scrollWidth <= innerWidth"))


@ON_DESK
def test_a_rotary_table_known_by_its_dimensions_becomes_a_saved_selection(visitor: Visitor, width: int) -> None:
    page = visitor.open("/?T=&n=&t=", width)
    page.get_by_role("button", name="Motion", exact=True).click()
    expect(page.get_by_role("button", name="Rotary", exact=True)).to_have_attribute("aria-pressed", "true")
    expect(result(page)).to_contain_text("Moves, each from rest to rest")
    page.get_by_text("Inertia from dimensions").click()
    add_body(page, 1, "Disc", Mass="60", Diameter="500")
    add_body(page, 2, "Point mass", Mass="5", Off_the_axis="180", Number="4")
    use_the_sum(page, "2.523")
    expect(box(page, "Moment of inertia")).to_have_value("2.523")
    add_move(page, 1, "Trapezoidal", Angle="90", Time="0.6")
    expect(box(page, "Peak speed, move 1")).to_have_attribute("placeholder", "37.5")
    add_move(page, 2, "Dwell", Time="1.2")
    expect(page).to_have_url(re.compile("mv=dwell&ms=&mt=1.2$"))
    expect(result(page)).to_contain_text("HPN-20A-4")
    assert has_no_sideways_scroll(page)
    typed = page.url

    application, link = saved(page, visitor.server)

    assert application["duty_cycle"]["motion"]["mechanism"]["inertia_kgm2"] == 2.523
    assert link == typed
    page.goto(link)
    expect(box(page, "Moment of inertia")).to_have_value("2.523")
    expect(page.get_by_role("combobox", name="Profile, move 2")).to_have_value("dwell")
    expect(result(page)).to_contain_text("HPN-20A-4")


@ON_PHONE
def test_a_ball_screw_known_by_its_dimensions_becomes_a_saved_selection(visitor: Visitor, width: int) -> None:
    page = visitor.open(START, width)
    page.get_by_role("button", name="Ball screw", exact=True).click()
    expect(box(page, "Lead")).to_be_visible()
    expect(box(page, "Mass off the shaft")).to_have_count(0)
    box(page, "Lead").fill("20")
    box(page, "Moved mass").fill("120")
    page.get_by_text("Inertia from dimensions").click()
    add_body(page, 1, "Disc", or_density="7.85", Diameter="40", Height="1000")
    use_the_sum(page, "0.00197")
    page.get_by_text("Incline, friction, efficiency, stage").click()
    box(page, "Incline").fill("90")
    add_move(page, 1, "S-curve", Distance="400", Time="1.5")
    add_move(page, 2, "S-curve", Distance="-400", Time="1.5")
    expect(result(page)).to_contain_text("suitable")
    expect(page).to_have_url(re.compile(r"mech=ball_screw&J=0\.00197\d*&h=20&ml=120&inc=90&.*&ms=-400&mt=1\.5$"))
    assert has_no_sideways_scroll(page)
    typed, gear = page.url, result(page).get_by_role("heading", level=2).inner_text().splitlines()[0]

    application, link = saved(page, visitor.server)

    assert application["duty_cycle"]["motion"]["mechanism"]["lead_mm"] == 20
    assert link == typed
    page.goto(link)
    expect(result(page).get_by_role("heading", level=2)).to_contain_text(gear)
    expect(box(page, "Distance, move 2")).to_have_value("-400")


def test_switching_taking_over_and_going_back(visitor: Visitor) -> None:
    page = visitor.open("/")
    page.get_by_role("button", name="Motion", exact=True).click()
    box(page, "Moment of inertia").fill("2.5")
    add_move(page, 1, "Trapezoidal", Angle="90", Time="0.6")
    expect(page).to_have_url(re.compile("mech=rotary&J=2.5&mv=trapezoidal&ms=90&mt=0.6"))
    motion = page.url
    page.get_by_text("Resulting phases").first.click()
    expect(page.locator(".out tbody tr")).to_have_count(3)
    box(page, "Time, move 1").fill("0.9")
    expect(page.locator(".out tbody tr").first).to_contain_text("0.3")
    box(page, "Time, move 1").fill("0.6")
    expect(page).to_have_url(motion)

    page.get_by_role("button", name="Copy into the table").click()
    expect(box(page, "Torque, phase 3, in Nm", exact=True)).to_be_visible()
    expect(page).to_have_url(re.compile("Tpk="))
    page.go_back()
    expect(box(page, "Angle, move 1")).to_have_value("90")
    expect(page).to_have_url(motion)
    page.get_by_role("button", name="Phases", exact=True).click()
    expect(box(page, "Torque, phase 1, in Nm", exact=True)).to_have_value("40")
    expect(page).to_have_url(re.compile("T=40&n=250&t=0.3"))


def test_a_cell_is_shown_where_the_profile_has_it_or_something_stands_in_it(visitor: Visitor) -> None:
    page = visitor.open(START)
    box(page, "Moment of inertia").fill("2.5")
    profile = page.get_by_role("combobox", name="Profile, move 1")
    expect(box(page, "Angle, move 1")).to_be_visible()  # a cell of the profile that a new move has
    profile.select_option("")
    expect(box(page, "Angle, move 1")).to_be_hidden()
    profile.focus()
    profile.select_option("S-curve")
    expect(box(page, "Jerk share, move 1")).to_be_visible()
    box(page, "Angle, move 1").fill("90")
    box(page, "Peak speed, move 1").fill("25")
    expect(page.locator("#duty-errors p")).to_have_count(0)  # an unfinished move is no error yet
    box(page, "Acceleration, move 1").fill("900")
    expect(page).to_have_url(re.compile("mv=s_curve&ms=90&mn=25&ma=900"))
    profile.select_option("Dwell")
    box(page, "Time, move 1").fill("1")
    expect(box(page, "Jerk share, move 1")).to_be_hidden()
    expect(box(page, "Angle, move 1")).to_be_visible()
    expect(page.locator("#duty-errors")).to_contain_text("has no Angle: leave it out")


def test_a_complete_move_is_answered_at_once_and_the_missing_cell_is_named_where_it_is_not(visitor: Visitor) -> None:
    page = visitor.open("/?mech=ball_screw&h=20&ml=180&mv=trapezoidal&ms=600&mt=2")
    expect(result(page)).to_contain_text("suitable")
    page.get_by_role("button", name="ramps up and down").click()
    page.get_by_role("button", name="Add move").click()
    page.get_by_role("combobox", name="Profile, move 2").select_option("Trapezoidal")
    awaited = page.get_by_text("Still to enter:").filter(visible=True)
    expect(awaited).to_have_count(2)  # below the table and in the result
    expect(awaited.first).to_contain_text("Distance, move 2, in mm")
    expect(page.locator("td:has(> [data-awaited]) > input")).to_have_attribute("id", "ms-1")
    box(page, "Distance, move 2").fill("-600")
    expect(awaited.last).to_contain_text("Time, move 2, in s")
    box(page, "Largest speed, move 2").fill("400")
    expect(awaited.last).to_contain_text("Acceleration time, move 2, in s")
    box(page, "Acceleration time, move 2").fill("0.2")
    expect(page).to_have_url(re.compile("mn=400&mta=0.2"))  # neither its time nor its acceleration is given
    expect(awaited).to_have_count(0)
    expect(page.locator("[data-awaited]")).to_have_count(0)


def test_the_result_of_an_earlier_request_names_the_cell_that_is_still_to_enter(visitor: Visitor) -> None:
    page = visitor.open("/?mech=ball_screw&h=20&ml=180&mv=trapezoidal&ms=600&mt=2&mv=trapezoidal&ms=-600&mt=2")
    awaited = page.get_by_text("Still to enter:").filter(visible=True)
    with answer_held_back(page, partial(box(page, "Time, move 1").fill, "1.5")):
        box(page, "Time, move 2").fill("")
        expect(awaited.last).to_contain_text("Time, move 2, in s")
    expect(page).to_have_url(re.compile("mt=1.5"))
    expect(awaited).to_have_count(2)
    expect(awaited.last).to_contain_text("Time, move 2, in s")


@pytest.mark.parametrize(("width", "panel"), [(1440, 700), (1920, 760), (1300, 580), (1024, 1024)])
def test_the_panel_widens_for_more_columns_and_a_move_stays_one_row(
    visitor: Visitor, soak: bool, width: int, panel: int
) -> None:
    page = visitor.open(f"{RAMPS}&pn=Raise&pn=Load&FRi=100&FRi=", width)
    form = page.locator("#application").bounding_box()
    cells = page.locator("#move-0 > :is(td, th)").evaluate_all(
        "all => all.filter(each => each.checkVisibility()).map(each => each.getBoundingClientRect().top)"
    )
    assert form and form["width"] == panel
    assert len(set(cells)) == 1
    assert has_no_sideways_scroll(page)
    assert (
        page.locator("#duty :is(input, select)").evaluate_all(
            "all => all.filter(each => each.scrollWidth > each.clientWidth + 1)"
        )
        == []
    )
    expect(page.get_by_role("columnheader", name="up", exact=True)).to_be_visible()
    if soak or width == 1024:  # the elements are the same at every width
        assert violations(page) == []


def test_ramps_turn_from_times_into_accelerations_and_back(visitor: Visitor) -> None:
    page = visitor.open(RAMPS)
    units = page.get_by_role("group", name="Ramps given as")
    expect(units.get_by_role("button", name="s", exact=True)).to_have_attribute("aria-pressed", "true")
    units.get_by_role("button", name="mm/s²").click()
    expect(box(page, "Acceleration, move 1")).to_have_value("2000")
    expect(box(page, "Deceleration, move 1")).to_have_value("800")
    expect(page).to_have_url(re.compile("mn=400&ma=2000&md2=800"))
    page.get_by_role("group", name="Ramps given as").get_by_role("button", name="s", exact=True).click()
    expect(box(page, "Deceleration time, move 1")).to_have_value("0.5")
    expect(page).to_have_url(re.compile("mn=400&mta=0.2&mtd=0.5"))


def test_moves_are_edited_by_the_keys_of_phases(visitor: Visitor) -> None:
    page = visitor.open("/?mech=rotary&J=2.5&mv=trapezoidal&ms=90&mt=0.6&mv=dwell&ms=&mt=1.2")
    box(page, "Time, move 1").focus()
    page.keyboard.press("Alt+ArrowDown")
    expect(page.get_by_role("combobox", name="Profile, move 2")).to_have_value("trapezoidal")
    expect(box(page, "Time, move 2")).to_be_focused()
    page.get_by_role("combobox", name="Profile, move 2").focus()
    page.keyboard.press("Alt+Enter")
    expect(page.get_by_role("combobox", name="Profile, move 3")).to_be_focused()
    page.keyboard.press("Alt+Delete")
    expect(page.get_by_role("combobox", name="Profile, move 3")).to_have_count(0)
    assert violations(page) == []


def test_a_motion_is_given_without_script(visitor: Visitor) -> None:
    page = visitor.open("/?T=&n=&t=", script=False)
    page.get_by_role("button", name="Motion", exact=True).click()
    page.get_by_text("Inertia from dimensions").click()
    add_body(page, 1, "Ring", Mass="20", Inner_diameter="300")
    box(page, "Diameter, body 1").first.fill("400")
    page.get_by_role("button", name="Calculate").click()
    use_the_sum(page, "0.625")
    page.get_by_role("combobox", name="Profile, move 1").select_option("Modified sine")
    expect(box(page, "Peak speed, move 1")).to_be_hidden()
    box(page, "Angle, move 1").fill("180")
    box(page, "Time, move 1").fill("0.5")
    page.get_by_role("button", name="Calculate").click()
    expect(result(page)).to_contain_text("suitable")


def test_the_phases_of_a_saved_motion_stay_within_its_input(visitor: Visitor) -> None:
    page = visitor.open(LIFTED)
    page.get_by_role("button", name="Save", exact=True).click()
    page.wait_for_url(SAVED)
    table = page.get_by_role("region", name="Load phases of the motion")
    cell, beside = table.bounding_box(), page.get_by_role("region", name="Result").bounding_box()
    assert cell and beside and cell["x"] + cell["width"] <= beside["x"]
    table.focus()
    assert table.evaluate("node => getComputedStyle(node).overflowX") == "auto"


def test_the_longest_profile_is_not_cut(visitor: Visitor) -> None:
    page = visitor.open("/?mech=rotary&J=2&mv=modified_sine&ms=60&mt=0.4")
    _expect_whole(page, "Modified sine")
    in_german(page)
    _expect_whole(page, "Modifizierter Sinus")


def _expect_whole(page: Page, profile: str) -> None:
    """The chosen profile has room beside the arrow of the browser, 20 px."""
    expect(page.locator("select[name=mv] option:checked")).to_have_text(profile)
    room, needed = page.locator("select[name=mv]").evaluate(
        """select => { const style = getComputedStyle(select), pen = document.createElement("canvas").getContext("2d");
        pen.font = style.font;
        return [select.clientWidth - parseFloat(style.paddingLeft) - 20,
                pen.measureText(select.selectedOptions[0].text).width] }"""
    )
    assert needed <= room
