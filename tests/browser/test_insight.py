"""Journeys of an engineer in search of reasons: the remedy followed, gears compared, the calculation read."""

import re

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Visitor, open_section, pause, show_all_sections, violations
from tests.browser.test_page import EXAMPLE, selected, torque


def comparison(page: Page) -> Locator:
    return page.get_by_role("table", name=re.compile("^Comparison of"))


def size_unfolded(page: Page, size: str) -> None:
    """Show the rejected gears of a size in the list of candidates."""
    open_section(page, "Candidates")
    page.get_by_text(re.compile(rf"{size}:\s+one gear")).click()


def test_finding_why_HPN_14A_5_fails_and_making_it_fit_by_its_remedy(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    size_unfolded(page, "14A")
    page.get_by_role("link", name="HPN-14A-5", exact=True).click()
    expect(selected(page)).to_contain_text("not suitable")
    open_section(page, "Overview")
    words = page.locator(".verdict").get_by_text(re.compile("Fits if torques drop to 90.5.% and"))
    expect(words).to_contain_text(re.compile(r"Tk to 107.Nm"))

    for phase, value in enumerate((40, 32, 20), start=1):
        torque(page, phase).fill(f"{value * 0.905:g}")
    page.get_by_label("Torque Tk").fill("107")

    expect(selected(page)).to_contain_text("HPN-14A-5")
    expect(selected(page)).to_contain_text("✓ suitable")
    peak = page.get_by_role("table", name="Load limits").get_by_role("row", name=re.compile("^Average torque"))
    expect(peak.get_by_role("cell").last).to_have_text(re.compile(r"100.%\s*All duty torques"))


def test_a_life_that_fails_offers_torque_or_speed(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE + "&Lh=2000000&gear=HPN-20A-5")
    remedies = page.locator(".verdict").get_by_role("listitem")
    expect(remedies).to_contain_text([re.compile("torques drop to 85.%"), re.compile("speeds drop to 58.3.%")])


def test_trying_the_remedy_by_its_link_without_script(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE + "&gear=HPN-14A-5", script=False)
    page.get_by_role("link", name="Try it").click()
    expect(selected(page)).to_contain_text("HPN-14A-5")
    expect(selected(page)).to_contain_text("✓ suitable")
    expect(torque(page, 1)).to_have_value("36.2")


def test_trying_the_remedy_is_an_edit_that_undo_takes_back(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE + "&gear=HPN-14A-5")
    page.evaluate("window.same = true")
    torque(page, 2).fill("31")
    page.get_by_role("link", name="Try it").click()
    expect(selected(page)).to_contain_text("✓ suitable")
    expect(torque(page, 1)).to_have_value("37.24")
    expect(page.locator("#result")).to_be_focused()
    expect(page).to_have_url(re.compile("T=37.24.*gear=HPN-14A-5"))
    expect(torque(page, 1)).to_have_class("changed")
    expect(torque(page, 1)).to_have_attribute("title", re.compile("was 40"))
    page.get_by_role("button", name="Undo").click()
    expect(torque(page, 1)).to_have_value("40")
    expect(torque(page, 2)).to_have_value("31")
    expect(selected(page)).to_contain_text("not suitable")
    page.get_by_role("button", name="Redo").click()
    expect(torque(page, 1)).to_have_value("37.24")
    expect(selected(page)).to_contain_text("✓ suitable")
    assert page.evaluate("window.same"), "the page was not loaded anew"
    expect(page.locator(".changed")).to_have_count(0)


def test_marks_of_a_remedy_go_with_the_next_edit(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE + "&gear=HPN-14A-5")
    page.get_by_role("link", name="Try it").click()
    expect(page.locator(".changed")).to_have_count(4)
    pause(page).fill("5")
    expect(page.locator(".changed")).to_have_count(0)


def test_comparing_gears_by_pinning_them_from_the_list(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    open_section(page, "Candidates")
    page.get_by_role("button", name="Compare HPN-32A-5").click()
    expect(page).to_have_url(re.compile("pin=HPN-32A-5"))
    open_section(page, "Compare")
    expect(comparison(page)).to_have_accessible_name("Comparison of HPN-20A-5, HPN-32A-5")
    expect(page).to_have_url(re.compile(re.escape(EXAMPLE + "&pin=HPN-32A-5") + "#compare$"))

    wind_up = comparison(page).get_by_role("row", name=re.compile("^Wind-up at"))
    expect(wind_up.get_by_role("cell").nth(0)).to_have_text("5.29")  # 40 Nm / 26000 Nm/rad
    expect(wind_up.get_by_role("cell").nth(1)).to_contain_text("better")
    expect(comparison(page).get_by_role("row", name=re.compile("^Backlash"))).not_to_contain_text("better")

    torque(page, 1).fill("41")
    expect(page).to_have_url(re.compile("T=41&.*&pin=HPN-32A-5#compare$"))
    expect(comparison(page)).to_have_accessible_name("Comparison of HPN-20A-5, HPN-32A-5")
    page.get_by_role("button", name="Remove HPN-32A-5 from the comparison").first.click()
    expect(comparison(page)).to_have_accessible_name("Comparison of HPN-20A-5, HPN-14A-5")


def test_pinning_by_key_keeps_the_focus_on_the_toggle(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    open_section(page, "Candidates")
    candidates = page.get_by_role("region", name="Candidates")
    candidates.get_by_role("button", name="Compare HPN-32A-5").press("Enter")
    out = candidates.get_by_role("button", name="Remove HPN-32A-5 from the comparison")
    expect(out).to_be_focused()
    page.keyboard.press("Enter")
    expect(candidates.get_by_role("button", name="Compare HPN-32A-5")).to_be_focused()
    page.keyboard.press("Enter")
    expect(out).to_be_focused()
    open_section(page, "Compare")
    comparison(page).get_by_role("button", name="Remove HPN-32A-5 from the comparison").press("Enter")
    expect(comparison(page)).to_have_accessible_name("Comparison of HPN-20A-5, HPN-14A-5")


def test_pinning_while_an_input_is_wrong_says_why_it_can_not_be(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    torque(page, 1).fill("9,3")
    expect(page.get_by_text("Not recalculated")).to_be_visible()
    open_section(page, "Candidates")
    toggle = page.get_by_role("button", name="Compare HPN-32A-5")
    toggle.press("Enter")
    reason = page.get_by_text("Not compared: first correct the marked inputs.")
    expect(reason).to_be_visible()
    expect(toggle).to_be_focused()
    torque(page, 1).fill("41")
    expect(reason).to_be_hidden()
    expect(page).to_have_url(re.compile("T=41&"))
    open_section(page, "Compare")
    expect(comparison(page)).to_have_accessible_name("Comparison of HPN-20A-5, HPN-14A-5")


def test_comparing_gears_without_script(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE, script=False)
    page.get_by_role("button", name="Compare HPN-32A-5").click()
    page.get_by_text(re.compile(r"11A:\s+one gear")).click()
    page.get_by_role("button", name="Compare HPN-11A-5").click()
    expect(comparison(page)).to_have_accessible_name("Comparison of HPN-20A-5, HPN-32A-5, HPN-11A-5")
    page.get_by_role("button", name="Calculate").click()
    expect(page).to_have_url(re.compile("&i=5&pin=HPN-32A-5&pin=HPN-11A-5$"))
    expect(comparison(page)).to_have_accessible_name("Comparison of HPN-20A-5, HPN-32A-5, HPN-11A-5")
    page.get_by_role("button", name="Remove HPN-32A-5 from the comparison").first.click()
    expect(comparison(page)).to_have_accessible_name("Comparison of HPN-20A-5, HPN-11A-5")


def test_reading_the_calculation(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    open_section(page, "Calculation")
    life = page.get_by_role("group", name="Formulas: Life")
    expect(life.get_by_role("math").nth(1)).to_contain_text("32.0210136")
    expect(life.get_by_role("math").nth(2)).to_contain_text("1\u202f167\u202f275.94")
    expect(page.get_by_text("as the handbook does in equation 18.9")).to_be_visible()
    expect(page.get_by_text("Equation 17.10, page 17 of the handbook.")).to_be_visible()


def test_calculation_opened_after_an_edit_is_that_of_the_edit(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    torque(page, 1).fill("41")
    expect(page.get_by_role("row", name="Average torque").first).to_contain_text("32.1")
    expect(page.get_by_role("math", include_hidden=True)).to_have_count(0)
    open_section(page, "Calculation")
    peak = page.get_by_role("group", name="Formulas: Load limit 2: repeated peak torque")
    expect(peak).to_contain_text("41")
    open_section(page, "Overview")
    torque(page, 1).fill("42")
    open_section(page, "Calculation")
    expect(peak).to_contain_text("42")


def test_calculation_stands_there_without_script(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE, script=False)
    formulas = page.get_by_role("group", name="Formulas: Maximum input speed")
    expect(formulas).to_contain_text("2\u202f500")


INSIDE = """() => [...document.querySelectorAll(".result *")].filter((box) => {
  const { overflowX, overflowY } = getComputedStyle(box);
  const scrolls = [overflowX, overflowY].some((way) => ["auto", "scroll"].includes(way));
  return box.checkVisibility() && box.closest("#candidates, #compare, #calculation")
    && (scrolls || (!box.closest(".visually-hidden, svg") && box.getBoundingClientRect().right > innerWidth + 1));
}).map((box) => `${box.closest(".section").id} ${box.className || box.localName}`)"""
"""Boxes of the three sections that have their own scroll bar, or are wider than the page."""


@pytest.mark.parametrize("width", [390, 1440])
def test_candidates_comparison_and_calculation_scroll_with_the_page_alone(visitor: Visitor, width: int) -> None:
    pins = "&pin=HPN-14A-5&pin=HPN-32A-5&pin=HPN-11A-5&FR=300&FA=100"
    page = visitor.open(EXAMPLE + pins, width=width, touch=width < 1000)
    if width < 1000:
        show_all_sections(page)
    for name in ("Candidates", "Compare", "Calculation"):
        if width > 1000:
            open_section(page, name)
        assert page.evaluate(INSIDE) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_a_phone_shows_one_gear_beside_the_reference_without_script_too(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE + "&pin=HPN-14A-5&pin=HPN-32A-5", width=390, script=False)
    heads = comparison(page).locator("thead th:visible")
    expect(heads).to_contain_text([re.compile("HPN-20A-5"), re.compile("HPN-14A-5")])
    page.get_by_role("radio", name="HPN-32A-5").check(force=True)
    expect(heads).to_contain_text([re.compile("HPN-20A-5"), re.compile("HPN-32A-5")])


def test_the_head_of_the_candidates_sticks_below_the_title_block(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE.replace("&i=5", ""))
    open_section(page, "Candidates")
    for summary in page.locator("#candidates summary").all()[:2]:
        summary.click()
    page.locator("#rejected-14A tbody tr").last.scroll_into_view_if_needed()
    page.mouse.wheel(0, 200)
    foot = "head => Math.round(head.getBoundingClientRect().bottom)"
    head = page.locator("#rejected-14A thead th").nth(1)
    top = head.evaluate("head => Math.round(head.getBoundingClientRect().top)")
    assert top >= page.locator(".head").evaluate(foot) - 1


@pytest.mark.soak  # test_page.py checks all sections on a phone
def test_remedy_calculation_and_comparison_are_accessible_in_both_themes(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE + "&gear=HPN-14A-5&pin=HPN-20A-5&FR=300", width=1000)
    assert violations(page) == []


def test_name_of_a_check_shows_its_explanation_and_gets_the_focus_back(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    name = page.get_by_role("table", name="Load limits").get_by_role("button", name="Average torque", exact=True)
    name.press("Enter")
    explanation = page.get_by_role("dialog", name="Load limit 1: average torque")
    expect(explanation).to_be_focused()
    expect(explanation.get_by_role("term")).to_contain_text(["What is checked", "If exceeded", "What to change"])
    assert violations(page) == []
    page.keyboard.press("Escape")
    expect(explanation).to_be_hidden()
    expect(name).to_be_focused()
    expect(page).to_have_url(re.compile(re.escape(EXAMPLE) + "$"))
