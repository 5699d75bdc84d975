"""Journeys of readers with other languages and units."""

import re

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor, in_german, reader_menu, violations

EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
ODD = "/?T=40.123456789&n=33.3333333333333&t=0.1&tp=0.07&Tk=199.99&FR=512.34&fw=1.2&ta=21.7&bl=7.5&m=3.3&L=150.5"


def set_units(page: Page, preset: str) -> None:
    reader_menu(page).click()
    with page.expect_navigation():
        page.get_by_role("button", name=preset).click()


def address(page: Page) -> str:
    return page.url.split("/", 3)[3]


@pytest.mark.parametrize(
    ("link", "script"),
    [
        pytest.param(EXAMPLE, True, marks=pytest.mark.soak),
        pytest.param(ODD, True),
        pytest.param(EXAMPLE, False),
        pytest.param(ODD, False, marks=pytest.mark.soak),
    ],
    ids=["example", "odd figures", "example without script", "odd figures without script"],
)
def test_switching_to_lb_in_and_german_and_back_loses_nothing(visitor: Visitor, link: str, script: bool) -> None:
    page = visitor.open(link, script=script)
    torque = page.locator("#T-0")
    before, first = address(page), torque.input_value()
    set_units(page, "US customary")
    expect(page.get_by_label("Torque, phase 1, in lb·in")).to_have_value(re.compile(r"^35[45]\.\d+$"))
    in_german(page)
    expect(page.get_by_label("Drehmoment, Phase 1, in lb·in")).to_have_value(re.compile(r"^35[45],\d+$"))
    if not script:
        page.get_by_role("button", name="Berechnen").click()
    expect(page.locator("html")).to_have_attribute("lang", "de")
    set_units(page, "Metrisch (SI)")
    reader_menu(page).click()
    page.get_by_role("button", name="English").click()
    expect(page.get_by_label("Torque, phase 1, in Nm")).to_have_value(first)
    assert address(page) == before


def test_typing_in_a_readers_units_makes_the_link_of_everybody(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    set_units(page, "US customary")
    box = page.get_by_label("Torque, phase 1, in lb·in")
    box.fill("300.0")
    expect(page).to_have_url(re.compile(r"/\?T=33\.8954487083&n=250&t=0\.3&T=32&"))
    expect(box).to_have_value("300.0")
    other = visitor.open(page.url.replace(visitor.server, ""))
    expect(other.get_by_label("Torque, phase 1, in Nm")).to_have_value("33.8954487083")


def test_a_decimal_comma_is_understood_in_a_german_form(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    in_german(page)
    box = page.get_by_label("Drehmoment, Phase 2")
    box.fill("9,3")
    expect(page).to_have_url(re.compile("T=9.3&"))
    expect(box).to_have_value("9,3")
    box.fill("1.234")
    expect(box).to_have_accessible_description("1234 oder 1,234 schreiben")


@pytest.mark.parametrize("script", [True, False])
def test_number_that_may_be_two_is_offered_in_plain_digits_and_taken_with_one_press(
    visitor: Visitor, script: bool
) -> None:
    page = visitor.open(f"{EXAMPLE}&FR=500", script=script)
    in_german(page)
    life = page.locator("#f-Lb")
    life.fill("20.000")
    if not script:
        page.get_by_role("button", name="Berechnen").click()
    expect(life).to_have_accessible_description(re.compile("20000 oder 20 schreiben"))
    life.locator("xpath=../..").get_by_role("button", name="20000").click()
    expect(life).to_have_value("20000")
    expect(life).not_to_have_attribute("aria-invalid", "true")
    expect(page.get_by_text("Nicht neu berechnet", exact=False).first).to_be_hidden()


@pytest.mark.parametrize("script", [True, False])
def test_number_is_typed_as_the_page_prints_it(visitor: Visitor, script: bool) -> None:
    page = visitor.open(f"{EXAMPLE}&FR=500", script=script)
    life = page.locator("#f-Lb")
    life.fill("30\u202f000")
    if not script:
        page.get_by_role("button", name="Calculate").click()
    expect(page).to_have_url(re.compile("&Lb=30000(&|$)"))
    expect(life).to_have_value("30\u202f000" if script else "30000")


def test_undo_goes_back_across_a_switch_to_the_same_torque(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.get_by_label("Torque, phase 1, in Nm").fill("60")
    expect(page).to_have_url(re.compile("T=60&"))
    set_units(page, "US customary")
    torque = page.get_by_label("Torque, phase 1, in lb·in")
    expect(torque).to_have_value("531.04")
    page.get_by_role("button", name="Undo").click()
    expect(torque).to_have_value("354.03")
    expect(page).to_have_url(re.compile("T=40&"))
    page.get_by_role("button", name="Redo").click()
    expect(torque).to_have_value("531.04")


def test_unfinished_input_survives_a_switch(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.get_by_role("button", name="Add phase").click()
    expect(page.get_by_label("Torque, phase 4")).to_be_focused()
    page.keyboard.type("50")
    in_german(page)
    expect(page.get_by_label("Drehmoment, Phase 4")).to_have_value("50")
    expect(page.get_by_label("Drehzahl, Phase 4")).to_have_accessible_description("fehlt")


def test_language_follows_the_browser_and_no_link_changes_it(visitor: Visitor) -> None:
    context = visitor.browser.new_context(locale="de-AT")
    page = context.new_page()
    page.goto(visitor.server + EXAMPLE + "&written=lb_in")
    expect(page.locator("html")).to_have_attribute("lang", "de")
    page.goto(visitor.server + EXAMPLE)
    expect(page.get_by_label("Drehmoment, Phase 1, in Nm")).to_have_value("40")
    context.close()


def test_units_are_chosen_by_keyboard_one_by_one(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    reader_menu(page).focus()
    page.keyboard.press("Enter")
    dialog = page.get_by_role("dialog", name="Units")
    expect(dialog).to_be_visible()
    dialog.get_by_label("Speed").select_option("rad/s")
    dialog.get_by_role("button", name="Apply").press("Enter")
    expect(page.get_by_label("Speed, phase 1, in rad/s")).to_have_value("26.18")
    expect(page.get_by_label("Torque, phase 1, in Nm")).to_have_value("40")


@pytest.mark.parametrize(
    "path",
    [
        ODD,
        *(pytest.param(path, marks=pytest.mark.soak) for path in ("/?T=9,3&n=&t=1", "/catalogue/HPN-20A-5", "/paste")),
    ],
)
def test_accessibility_check_finds_nothing_in_german_with_the_units_open(visitor: Visitor, path: str) -> None:
    page = visitor.open(path)
    with page.expect_navigation():
        in_german(page)
    set_units(page, "US-Einheiten")
    reader_menu(page).click()
    assert violations(page) == []


@pytest.mark.parametrize("width", [390, 1440, *(pytest.param(width, marks=pytest.mark.soak) for width in (768, 1024))])
def test_nothing_makes_the_german_page_scroll_sideways(visitor: Visitor, width: int) -> None:
    page = visitor.open(EXAMPLE.replace("&i=5", "&FR=500&FRi=&FRi=&FRi=700"), width=width)
    in_german(page)
    expect(page.locator("html")).to_have_attribute("lang", "de")
    assert page.evaluate("document.documentElement.scrollWidth") == width
