"""Sentences and figures of the page that used to mislead, in both languages."""

import re

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Visitor, in_german

EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
OWN_LOADS = "/?T=10&n=500&t=1&FRi=620&T=5&n=100&t=1&FRi=310"


def life(page: Page) -> Locator:
    return page.locator("#f-Lb")


# --- The address follows accepted values ------------------------------------------------------------------------------


def test_address_of_a_refused_field_is_the_one_from_before_it_was_typed_in(visitor: Visitor) -> None:
    """Typing 40.000 passes 40, 40.0 and 40.00: none of them is the intended value."""
    page = visitor.open(f"{EXAMPLE}&FR=500")
    expect(page).to_have_url(re.compile("FR=500"))
    before = page.url
    life(page).click()
    for text in ("4", "40", "40.0", "40.00"):
        life(page).fill(text)
        expect(page).to_have_url(re.compile(rf"&Lb={float(text):g}(&|$)"))
    life(page).fill("40.000")
    expect(life(page)).to_have_attribute("aria-invalid", "true")
    expect(page).to_have_url(before)
    page.reload()
    expect(life(page)).to_have_value("")
    expect(page.get_by_text("asked 20 000 h")).to_be_visible()


def test_offer_that_is_next_by_keyboard_is_the_one_on_the_safe_side(visitor: Visitor) -> None:
    page = visitor.open(f"{EXAMPLE}&FR=500")
    life(page).fill("40.000")
    expect(life(page)).to_have_accessible_description(re.compile("write 40000 or 40"))
    page.keyboard.press("Tab")
    expect(page.get_by_role("button", name="40000", exact=True)).to_be_focused()
    page.keyboard.press("Enter")
    expect(page).to_have_url(re.compile("&Lb=40000(&|$)"))

    page = visitor.open(f"{EXAMPLE}&FR=500&Tm=20")
    in_german(page)
    peak = page.locator("#f-Tm")
    peak.fill("1.250")
    expect(peak).to_have_accessible_description(re.compile("1,250 oder 1250 schreiben"))
    page.keyboard.press("Tab")
    expect(page.get_by_role("button", name="1,250", exact=True)).to_be_focused()


def test_undo_to_a_refused_field_leaves_its_address_alone(visitor: Visitor) -> None:
    page = visitor.open(f"{EXAMPLE}&FR=500")
    before = page.url
    life(page).fill("40.000")
    expect(life(page)).to_have_attribute("aria-invalid", "true")
    page.locator("#f-FR").fill("600")
    expect(page).to_have_url(before)
    life(page).fill("30000")
    expect(page).to_have_url(re.compile("FR=600.*&Lb=30000"))


# --- Loads of the whole cycle -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("german", [False, True])
def test_load_of_the_cycle_beside_loads_of_every_phase_says_at_its_field_that_it_does_not_count(
    visitor: Visitor, german: bool
) -> None:
    page = visitor.open(OWN_LOADS)
    if german:
        in_german(page)
    radial = page.get_by_label("Radiallast des Zyklus" if german else "Radial load of the cycle")
    expect(radial).not_to_have_accessible_description(re.compile("Phase|phase"))
    radial.fill("900")
    message = (
        "Die Radiallast des ganzen Zyklus, 900 N, zählt nicht: Jede Phase hat eine eigene."
        if german
        else "The radial load of the whole cycle, 900 N, is not used: every phase has its own."
    )
    expect(radial).to_have_accessible_description(message)
    expect(page.locator("#n-FR")).to_be_visible()
    second = page.locator("#FRi-1")
    second.fill("")
    expect(radial).to_have_accessible_description("")
    second.fill("310")
    expect(radial).to_have_accessible_description(message)
    page.reload()
    expect(radial).to_have_accessible_description(message)


# --- The saved page ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("width", [1440, 390])
def test_saved_page_cuts_no_figure_of_a_phase(visitor: Visitor, width: int) -> None:
    phases = "&".join(
        f"T=-12345.678&n=250.25&t=1234.5&FRi=620&FAi=1250.75&Tpk=13000&npk=300.5&Trms=12500.5&pn=Arm+swings+out+{k}"
        for k in range(3)
    )
    page = visitor.open(f"/?{phases}", width)
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page).to_have_url(re.compile("/selections/"))
    for language in ("English", "German"):
        if language == "German":
            in_german(page)
        table = page.locator("table.phases")
        expect(table.get_by_text("620").first).to_be_visible()
        page.wait_for_load_state()  # its style sheets decide the widths
        box = table.locator("xpath=..")
        assert box.evaluate("box => box.scrollWidth - box.clientWidth") == 0
        cut = table.evaluate(
            "(table) => [...table.querySelectorAll('th, td')].filter((cell) => cell.scrollWidth > cell.clientWidth + 1 "
            "&& cell.closest('tbody')).map((cell) => cell.textContent)"
        )
        assert cut == []


# --- The drive, reserves and the verdict ------------------------------------------------------------------------------


@pytest.mark.parametrize("german", [False, True])
def test_each_row_of_the_drive_says_whether_it_is_a_magnitude_and_inertia_is_in_no_quotient(
    visitor: Visitor, german: bool
) -> None:
    motion = "/?mech=rotary&J=0.8&Tf=2&mv=trapezoidal&ms=90&mt=0.5&mv=dwell&ms=&mt=0.5&Jm=0.0002&Tm=20&Tmn=8&nm=4000"
    page = visitor.open(motion)
    if german:
        in_german(page)
    page.locator('.tabs a[href="#drive"]').click()
    drive = page.locator("section.drive")
    motor = drive.get_by_role("table", name=re.compile("am Motor" if german else "at the motor"))
    magnitude, without = (
        ("dem Betrag nach", "ohne den Not-Halt") if german else ("by magnitude", "without the emergency stop")
    )
    expect(motor.get_by_role("row").nth(1)).to_contain_text(magnitude)
    expect(motor.locator("caption")).to_contain_text(without)
    expect(motor).to_contain_text("Tin,max ≤ Tmot")
    expect(motor).not_to_contain_text("(i·η)")
    stiff = drive.get_by_role("table", name="Positionsfehler" if german else "Position error")
    expect(stiff).to_contain_text("mit ihren Vorzeichen" if german else "with their signs")
    expect(stiff).not_to_contain_text(without)


@pytest.mark.parametrize(("german", "width"), [(False, 1440), (True, 390)])
def test_verdict_says_for_which_life_the_bearing_is_judged_and_offers_the_same(
    visitor: Visitor, german: bool, width: int
) -> None:
    page = visitor.open("/?T=25&n=150&t=2&tp=1&FR=1500&Lh=40000", width)
    if german:
        in_german(page)
    verdict = page.locator(".verdict")
    message = "für die Vorgabe von 20.000 h (L50)" if german else "for the default of 20 000 h (L50)"
    expect(verdict).to_contain_text(message)
    verdict.get_by_role(
        "link", name="Dieselbe Lebensdauer vom Lager fordern" if german else "Require the same of the bearing"
    ).click()
    expect(page).to_have_url(re.compile("&Lb=40000&Lbb=L10"))
    expect(verdict).not_to_contain_text(message)
