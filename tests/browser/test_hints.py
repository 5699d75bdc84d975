"""Hints of the form: shown over the next row while a field has the focus, so that nothing moves."""

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor, violations
from tests.browser.test_page import EXAMPLE


def tops(page: Page) -> list[float]:
    """Vertical positions of the form's visible fields in px."""
    fields = page.locator("#application .field")
    result: list[float] = fields.evaluate_all(
        "all => all.filter(each => each.checkVisibility()).map(each => each.getBoundingClientRect().top)"
    )
    return result


@pytest.mark.parametrize("width", [390, 1440])
def test_a_hint_covers_the_next_row_moves_nothing_and_lets_clicks_through(visitor: Visitor, width: int) -> None:
    page = visitor.open(EXAMPLE, width)
    field, hint = page.get_by_role("combobox", name="Load coefficient"), page.locator("#h-fw")
    expect(page.locator("#application .field > .hint:visible")).to_have_count(0)
    expect(field).to_have_accessible_description("1–1.2 smooth, 1.2–1.5 normal, 1.5–3 with impact")
    field.scroll_into_view_if_needed()
    before = tops(page)
    field.focus()
    expect(hint).to_be_visible()
    assert tops(page) == before

    frame, row = hint.bounding_box(), page.locator("#f-Tk").locator("xpath=..").bounding_box()
    assert frame and row
    assert abs(frame["y"] - row["y"]) <= 1
    assert abs(frame["height"] - row["height"]) <= 1
    assert violations(page) == []
    page.mouse.click(row["x"] + row["width"] / 2, row["y"] + row["height"] / 2)
    expect(page.get_by_label("Emergency-stop torque")).to_be_focused()
    expect(hint).to_be_hidden()


def test_a_hint_is_told_without_script(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE, script=False)
    expect(page.locator("#h-u")).to_be_hidden()
    page.get_by_label("Maximum utilisation").focus()
    expect(page.locator("#h-u")).to_be_visible()


@pytest.mark.parametrize("mechanism", ["rotary", "ball_screw"])
def test_each_hint_of_the_form_takes_one_line(visitor: Visitor, mechanism: str) -> None:
    page = visitor.open(f"/?mech={mechanism}&mv=trapezoidal&ms=&mt=")
    page.evaluate("for (const part of document.querySelectorAll('#application details')) part.open = true")
    lines = """all => all.map(hint => {
        hint.style.display = "block"; const range = document.createRange(); range.selectNodeContents(hint);
        const { height } = range.getBoundingClientRect(); hint.style.display = "";
        return [hint.textContent, height > 20];
    }).filter(([, wraps]) => wraps)"""
    assert page.locator("#application .field > .hint").evaluate_all(lines) == []
