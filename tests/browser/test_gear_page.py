"""Page of a gear: permitted load of its shaft, its neighbours, and the handbook's statements, folded."""

import re

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Visitor, in_german, violations

GEAR = "/catalogue/HPN-20A-5"


@pytest.mark.parametrize("script", [True, False])
def test_the_envelope_follows_a_typed_speed_and_life_without_any_load(visitor: Visitor, script: bool) -> None:
    page = visitor.open(GEAR, script=script)
    expect(page.locator("#condition .tick.own").locator("visible=true").last).to_have_text("1\u202f800")
    page.get_by_role("textbox", name="Speed").fill("150")
    page.get_by_role("textbox", name="Life").fill("30 000")
    if not script:
        page.get_by_role("button", name="Show").click()
    expect(page.locator("#condition .tick.own").locator("visible=true").last).to_have_text("1\u202f374")
    expect(page.get_by_role("textbox", name="Life")).to_have_value("30 000")
    expect(page.get_by_text("150 rpm for a life of 30\u202f000 h")).to_be_visible()


def test_a_condition_that_can_not_be_is_said_at_its_field_while_the_other_stays(visitor: Visitor) -> None:
    page = visitor.open(GEAR)
    page.get_by_role("textbox", name="Speed").fill("-1")
    expect(page.get_by_role("textbox", name="Speed")).to_have_accessible_description("must be above 0")
    assert violations(page) == []
    page.get_by_role("textbox", name="Speed").fill("120")
    expect(page.get_by_text("must be above")).to_have_count(0)
    expect(page.get_by_role("textbox", name="Speed")).to_be_focused()


@pytest.mark.parametrize(
    ("path", "width"), [(GEAR, 1920), (GEAR, 1440), (GEAR, 1024), (GEAR, 390), ("/catalogue/HPN-40A-5", 390)]
)
def test_the_page_of_a_gear_holds_at_each_width_in_both_languages(visitor: Visitor, path: str, width: int) -> None:
    page = visitor.open(path, width)
    page.get_by_text("Enter them").click()
    page.get_by_text(re.compile("^Lubrication")).click()
    expect(page.get_by_text("PYRONOC")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert violations(page) == []
    in_german(page)
    expect(page.get_by_role("heading", name="Nachbarn")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") == width
