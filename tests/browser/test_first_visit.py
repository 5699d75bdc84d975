"""First visit: the page's purpose, two ways to begin, and below them the worked example, labelled as such."""

import re

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Visitor, button, in_german, torque, violations


@pytest.mark.parametrize("script", [True, False])
@pytest.mark.parametrize("width", [390, 1440])
def test_a_newcomer_finds_sentence_ways_to_begin_and_independence_without_scrolling(
    visitor: Visitor, width: int, script: bool
) -> None:
    page = visitor.open("/", width, script=script)
    told = page.get_by_role("region", name="About this page")
    expect(told).to_contain_text("Finds the HPN planetary gear for your duty cycle")
    expect(told).to_contain_text("Independent of the manufacturer.")
    begins = [told.get_by_role("link", name=name) for name in ("Start your own", "Start with a motion")]
    height = page.viewport_size["height"] if page.viewport_size else 0
    for part in (told, *begins):
        box = part.bounding_box()
        assert box and box["y"] >= 0 and box["y"] + box["height"] <= height
    expect(page.locator("main .primary:visible, header .primary:visible")).to_have_count(1)
    expect(page.locator("#verdict")).to_contain_text("Worked example of the handbook")


def test_the_line_leaves_with_the_first_own_value_and_save_becomes_the_primary(visitor: Visitor) -> None:
    page = visitor.open("/")
    told = page.get_by_role("region", name="About this page")
    expect(told).to_be_visible()
    expect(button(page, "Save")).to_have_class(re.compile("quiet"))
    torque(page, 1).fill("41")
    expect(told).to_be_hidden()
    expect(button(page, "Save")).to_have_class(re.compile("primary"))
    expect(torque(page, 1)).to_be_focused()
    expect(page.get_by_text("Worked example of the handbook")).to_have_count(0)


@pytest.mark.parametrize("script", [True, False])
def test_the_line_is_hidden_for_good_by_its_cross_and_begins_where_it_says(visitor: Visitor, script: bool) -> None:
    page = visitor.open("/", script=script)
    told = page.get_by_role("region", name="About this page")
    told.get_by_role("link", name="Hide this line").click()
    expect(page).to_have_url(re.compile(r"\?T=40&n=250.*&i=5$"))
    expect(told).to_have_count(0)
    expect(torque(page, 1)).to_have_value("40")

    page.goto(page.url.split("?")[0])
    told.get_by_role("link", name="Start your own").click()
    expect(torque(page, 1)).to_have_value("")
    expect(page.get_by_role("heading", name="Type the phases")).to_be_visible()
    page.go_back()
    told.get_by_role("link", name="Start with a motion").click()
    expect(page.get_by_label("Moment of inertia").first).to_have_value("")


@pytest.mark.parametrize("width", [390, 1024])
def test_accessibility_check_of_a_first_visit_finds_nothing(visitor: Visitor, width: int) -> None:
    page = visitor.open("/", width)
    if width == 1024:  # test_states.py checks it on a phone
        assert violations(page) == []
    in_german(page)
    expect(page.get_by_role("region", name="Über diese Seite")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") == width


def test_what_is_refused_before_there_is_any_answer_is_said_in_the_result_and_beside_its_field(
    visitor: Visitor,
) -> None:
    page = visitor.open("/?T=&n=&t=")
    page.get_by_role("radio", name="Belt").check()
    page.get_by_label("Torque, phase 1").fill("30")
    page.get_by_label("Speed, phase 1").fill("150")
    page.get_by_label("Duration, phase 1").fill("2")
    expect(page.locator("#problems")).to_contain_text("Pitch diameter")
    expect(page.get_by_label("Pitch diameter")).to_have_attribute("aria-invalid", "true")
    page.get_by_label("Pitch diameter").fill("80")
    expect(page.get_by_role("region", name="Result")).to_contain_text("suitable")


def test_on_a_phone_a_mechanism_leads_to_its_fields(visitor: Visitor) -> None:
    page = visitor.open("/?T=&n=&t=", 390)
    page.get_by_role("link", name="Ball screw").click()
    expect(page.get_by_label("Lead")).to_be_in_viewport()
