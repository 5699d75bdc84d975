"""Tolerances on the page: fields on request, which move with their rows, and the tab of worst cases."""

import re

from playwright.sync_api import expect

from tests.browser.conftest import Visitor, violations

LINK = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"


def test_the_tolerance_of_a_row_is_moved_and_removed_with_it(visitor: Visitor) -> None:
    page = visitor.open(LINK)
    expect(page.get_by_label("Tolerance: Torque, phase 2")).to_have_count(0)  # hidden until requested
    page.get_by_role("button", name="± tolerances").click()
    page.get_by_label("Tolerance: Torque, phase 2").fill("10")
    expect(page).to_have_url(re.compile(r"tol=T\.2:10p"))

    page.get_by_label("Torque, phase 2, in Nm", exact=True).focus()
    page.keyboard.press("Alt+ArrowUp")
    expect(page.get_by_label("Tolerance: Torque, phase 1")).to_have_value("10 %")
    expect(page).to_have_url(re.compile(r"T=32&.*tol=T\.1:10p"))
    page.keyboard.press("Alt+Enter")  # a blank row at the end
    page.get_by_label("Torque, phase 2, in Nm", exact=True).focus()
    page.keyboard.press("Alt+Delete")
    expect(page).to_have_url(re.compile(r"T=32&n=500&t=3&T=20&.*tol=T\.1:10p"))
    page.get_by_label("Torque, phase 1, in Nm", exact=True).focus()
    page.keyboard.press("Alt+Delete")
    expect(page).to_have_url(re.compile(r"/\?T=20&(?!.*tol=)"))


def test_a_wrong_tolerance_is_said_beside_its_field(visitor: Visitor) -> None:
    page = visitor.open(f"{LINK}&tol=Tk:10p")
    field = page.get_by_label("Tolerance of all rows: Speed")
    field.fill("110")

    expect(field).to_have_attribute("aria-invalid", "true")
    expect(field).to_have_accessible_description(re.compile("side of 0"))


def test_the_tab_has_the_worst_cases_and_each_opens(visitor: Visitor) -> None:
    page = visitor.open(f"{LINK}&tol=Tk:40p&tol=T:5p")
    page.get_by_role("link", name="Tolerance").click()
    region = page.get_by_role("region", name="Over the whole tolerance")
    expect(region).to_contain_text("holds if the tolerance of Tk is at most ±28")
    expect(region.get_by_role("row", name=re.compile("Average torque"))).to_contain_text("high T")
    assert violations(page) == []
    region.get_by_role("link", name=re.compile("open it.*momentary peak torque")).click()
    expect(page).to_have_url(re.compile("Tk=280"))
    expect(page.locator("#verdict")).to_contain_text(re.compile("HPN-20A-5.*not suitable", re.DOTALL))
