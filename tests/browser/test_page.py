"""Journeys through the page in a real browser."""

import re
from typing import Any, Literal

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import (
    Visitor,
    answer_held_back,
    edit_row,
    open_section,
    show_all_sections,
    violations,
)

EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
PHASES = (("40", "250", "0.3"), ("32", "500", "3"), ("20", "250", "0.4"))


def selected(page: Page) -> Any:
    return page.get_by_role("region", name="Result").get_by_role("heading", level=2)


def torque(page: Page, phase: int) -> Any:
    return page.get_by_label(f"Torque, phase {phase}")


def tab_to(page: Page, role: Literal["textbox", "button", "checkbox"], name: str) -> None:
    """Press Tab until the control with this role and name has the focus."""
    wanted = page.get_by_role(role, name=name, exact=True)
    for _ in range(60):
        if wanted.evaluate("element => element === document.activeElement"):
            return
        page.keyboard.press("Tab")
    raise AssertionError(f"no way by keyboard to {role} {name}")


def scroll(page: Page) -> float:
    return float(page.evaluate("scrollY"))


def test_first_visit_shows_the_worked_example_and_its_answer(visitor: Visitor) -> None:
    page = visitor.open("/")
    expect(selected(page)).to_contain_text("HPN-20A-5")
    expect(selected(page)).to_contain_text("suitable")
    expect(torque(page, 1)).to_have_value("40")
    verdict = page.get_by_role("region", name="Result")
    expect(verdict.get_by_text("decides").first).to_be_in_viewport()
    expect(verdict.get_by_text("Worked example of the handbook")).to_be_in_viewport()
    expect(verdict.get_by_text("The lightest gear that passes every check.")).to_be_in_viewport()


def test_worked_example_typed_by_keyboard_alone_into_an_empty_cycle_selects_HPN_20A_5(visitor: Visitor) -> None:
    page = visitor.open("/?T=&n=&t=")
    expect(page.get_by_role("link", name="Type the first phase")).to_be_visible()
    tab_to(page, "textbox", "Torque, phase 1, in Nm")
    for k, phase in enumerate(PHASES, start=1):
        for value in phase:
            page.keyboard.type(value)
            page.keyboard.press("Tab")
        if k < len(PHASES):
            tab_to(page, "button", "+ Add phase")
            page.keyboard.press("Enter")
            expect(torque(page, k + 1)).to_be_focused()
    tab_to(page, "textbox", "Pause tp")
    page.keyboard.type("4")
    tab_to(page, "textbox", "Emergency-stop torque Tk")
    page.keyboard.type("200")
    tab_to(page, "checkbox", "5")
    page.keyboard.press("Space")
    expect(selected(page)).to_contain_text("HPN-20A-5")
    expect(page).to_have_url(re.compile(re.escape(EXAMPLE) + "$"))
    assert visitor.watches[0].console == []


def test_shared_link_reproduces_input_and_answer(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    expect(selected(page)).to_contain_text("HPN-20A-5")
    for k, phase in enumerate(PHASES, start=1):
        row = page.get_by_role("row", name=f"Torque, phase {k}").or_(page.locator(f"#phase-{k - 1}")).first
        assert [box.input_value() for box in row.get_by_role("textbox").all()] == list(phase)
    expect(page.get_by_role("checkbox", name="5", exact=True)).to_be_checked()


def test_typing_recalculates_and_keeps_focus_caret_and_scroll(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE, width=1000)
    box = torque(page, 2)
    box.focus()
    page.evaluate("scrollTo(0, 40)")
    before = scroll(page)
    box.evaluate("box => box.setSelectionRange(0, 0)")
    page.keyboard.type("1")
    expect(selected(page)).to_contain_text("HPN-32A-5")
    expect(box).to_be_focused()
    assert box.evaluate("box => [box.selectionStart, box.selectionEnd]") == [1, 1]
    assert box.input_value() == "132"
    assert scroll(page) == before
    expect(page).to_have_url(re.compile("T=132"))


def test_answer_that_arrives_late_never_overwrites_what_is_typed_meanwhile(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    with answer_held_back(page, lambda: torque(page, 1).fill("41")):
        torque(page, 1).fill("42")
        torque(page, 2).fill("33")
        page.get_by_label("Pause").focus()
    expect(page).to_have_url(re.compile("T=42&.*T=33&"))
    expect(torque(page, 1)).to_have_value("42")
    expect(torque(page, 2)).to_have_value("33")


def test_back_and_forward_walk_through_edits_not_keystrokes(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    torque(page, 1).fill("41")
    expect(page).to_have_url(re.compile("T=41&"))
    torque(page, 1).fill("410")
    expect(page).to_have_url(re.compile("T=410&"))
    expect(selected(page)).not_to_contain_text("HPN-20A-5")
    page.get_by_label("Pause").fill("5")
    expect(page).to_have_url(re.compile("tp=5"))

    page.go_back()
    expect(page.get_by_label("Pause")).to_have_value("4")
    expect(torque(page, 1)).to_have_value("410")
    page.go_back()
    expect(torque(page, 1)).to_have_value("40")
    expect(selected(page)).to_contain_text("HPN-20A-5")
    expect(page).to_have_url(re.compile(re.escape(EXAMPLE) + "$"))
    page.go_forward()
    expect(torque(page, 1)).to_have_value("410")
    expect(selected(page)).not_to_contain_text("HPN-20A-5")

    torque(page, 1).fill("40")
    expect(selected(page)).to_contain_text("HPN-20A-5")


def test_choosing_a_candidate_shows_its_limits_and_goes_back(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    open_section(page, "Candidates")
    page.get_by_text("14A: one gear").click()
    page.get_by_role("link", name="HPN-14A-5", exact=True).click()
    expect(selected(page)).to_contain_text("HPN-14A-5")
    expect(selected(page)).to_contain_text("not suitable")
    open_section(page, "Overview")
    limits = page.get_by_role("table", name="Load limits of HPN-14A-5")
    expect(limits.get_by_role("row", name="Average torque")).to_contain_text("fails")
    expect(page).to_have_url(re.compile("gear=HPN-14A-5$"))
    page.get_by_label("Pause").fill("5")
    expect(page).to_have_url(re.compile("tp=5.*gear=HPN-14A-5$"))
    page.go_back()
    page.go_back()
    expect(selected(page)).to_contain_text("HPN-20A-5")


def test_rows_are_added_moved_and_removed_in_place(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    edit_row(page, 2, "Move up")
    expect(torque(page, 1)).to_have_value("32")
    expect(torque(page, 2)).to_have_value("40")
    edit_row(page, 1, "Remove")
    expect(torque(page, 3)).to_have_count(0)
    expect(torque(page, 1)).to_have_value("40")
    expect(page).to_have_url(re.compile(r"/\?T=40&n=250&t=0.3&T=20&n=250&t=0.4&tp=4"))
    page.get_by_role("button", name="Add phase").click()
    expect(torque(page, 3)).to_be_focused()
    expect(torque(page, 3)).to_have_value("")


def test_row_edit_straight_after_typing_moves_what_was_typed(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    torque(page, 1).fill("44")
    edit_row(page, 1, "Move down")
    expect(torque(page, 2)).to_have_value("44")
    expect(torque(page, 1)).to_have_value("32")


def test_error_stands_beside_its_field_and_the_input_stays(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    torque(page, 2).fill("9,3")
    expect(torque(page, 2)).to_have_accessible_description("write 9.3")
    expect(torque(page, 2)).to_have_attribute("aria-invalid", "true")
    expect(torque(page, 2)).to_have_value("9,3")
    expect(page.get_by_text("Not recalculated: one input needs correction.")).to_be_visible()
    expect(selected(page)).to_contain_text("HPN-20A-5")
    torque(page, 2).fill("9.3")
    expect(torque(page, 2)).not_to_have_attribute("aria-invalid", "true")
    expect(page.get_by_text("Not recalculated")).to_have_count(0)
    expect(page).to_have_url(re.compile("T=9.3&"))


def test_phase_left_unfinished_is_reported_when_its_row_is_left(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.get_by_role("button", name="Add phase").click()
    expect(torque(page, 4)).to_be_focused()
    page.keyboard.type("50")
    expect(page.locator("form .waiting")).to_have_text("Still to enter: Speed, phase 4, in rpm")
    page.get_by_label("Pause").focus()
    expect(page.get_by_label("Speed, phase 4")).to_have_accessible_description("is missing")


def test_a_missing_diameter_is_asked_for_in_amber_and_a_wrong_one_is_refused_in_red(visitor: Visitor) -> None:
    page = visitor.open(f"{EXAMPLE}&dt=belt&dd=60")
    amber = page.locator("form .waiting").first.evaluate("waits => getComputedStyle(waits).color")
    diameter, said = page.get_by_label("Pitch diameter"), page.locator("form .error")
    diameter.fill("")
    expect(page.locator("#problems .named")).to_have_text("Still to enter: Pitch diameter")
    expect(said).to_have_css("color", amber)
    diameter.fill("x")
    expect(page.locator("#problems .named")).to_have_text("To correct: Pitch diameter")
    expect(said).not_to_have_css("color", amber)


def test_without_script_the_form_calculates_and_edits_rows(visitor: Visitor) -> None:
    page = visitor.open("/", script=False)
    expect(selected(page)).to_contain_text("HPN-20A-5")
    page.get_by_role("button", name="Add phase").click()
    torque(page, 4).fill("160")
    page.get_by_label("Speed, phase 4").fill("100")
    page.get_by_label("Duration, phase 4").fill("2")
    page.get_by_role("button", name="Calculate").click()
    expect(selected(page)).to_contain_text("HPN-32A-5")
    edit_row(page, 4, "Move up")
    expect(torque(page, 3)).to_have_value("160")
    edit_row(page, 3, "Remove")
    expect(selected(page)).to_contain_text("HPN-20A-5")
    page.get_by_role("button", name=re.compile("^HPN-32A-5: suitable")).click()
    expect(selected(page)).to_contain_text("HPN-32A-5")
    torque(page, 1).fill("9,3")
    torque(page, 1).press("Enter")
    expect(torque(page, 1)).to_have_accessible_description("write 9.3")
    expect(torque(page, 1)).to_have_value("9,3")


def test_without_script_what_is_typed_is_saved_although_it_was_not_calculated(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE, script=False)
    torque(page, 1).fill("41.5")
    page.get_by_text("Title block").click()
    page.get_by_label("Title", exact=True).fill("Axis 7")
    page.get_by_role("button", name="Save", exact=True).click()

    expect(page).to_have_url(re.compile("/selections/[A-Za-z0-9_-]{22}$"))
    expect(page).to_have_title(re.compile("Axis 7"))
    page.get_by_role("link", name="Edit a copy").click()
    expect(torque(page, 1)).to_have_value("41.5")
    expect(torque(page, 2)).to_have_value("32")


def test_explanation_of_a_check_opens_and_closes_by_keyboard(visitor: Visitor) -> None:
    page = visitor.open("/")
    opener = page.get_by_role("button", name="Repeated peak torque")
    opener.focus()
    page.keyboard.press("Enter")
    dialog = page.get_by_role("dialog", name="Load limit 2: repeated peak torque")
    expect(dialog).to_be_visible()
    expect(dialog).to_contain_text("What to change")
    page.keyboard.press("Escape")
    expect(dialog).to_be_hidden()
    expect(opener).to_be_focused()


def test_opened_sections_stay_open_while_typing(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.get_by_text("Properties and environment").click()
    page.get_by_label("Maximum utilisation").fill("0.7")
    expect(selected(page)).to_contain_text("HPN-32A-5")
    expect(page.get_by_label("Maximum utilisation")).to_be_visible()
    expect(page.get_by_label("Maximum utilisation")).to_be_focused()


def test_loads_can_be_given_for_each_phase(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.get_by_role("button", name="load", exact=True).click()
    expect(page.get_by_role("button", name="load", exact=True)).to_have_attribute("aria-pressed", "true")
    page.get_by_label("Radial load, phase 2").fill("500")
    expect(page).to_have_url(re.compile("FRi=&.*FRi=500"))
    expect(page.get_by_role("table", name="Load limits").get_by_text("Output bearing").first).to_be_visible()


@pytest.mark.parametrize("width", [390, 1024, 1440])
def test_every_figure_is_read_in_full_with_a_load_per_phase(visitor: Visitor, width: int) -> None:
    rows = (
        "T=40&n=250&t=0.3&FRi=1800.25&FAi=-486.786&pn=&T=1234.5&n=1500&t=13.25&FRi=12500.375&FAi=300&pn=Rapid+advance"
    )
    page = visitor.open(f"/?{rows}&i=5", width=width)
    for field in page.get_by_role("table", name="Load phases").get_by_role("textbox").all():
        assert field.evaluate("field => field.scrollWidth <= field.clientWidth")
    radial, axial = (
        page.get_by_label("Radial load, phase 2").bounding_box(),
        page.get_by_label("Axial load, phase 2").bounding_box(),
    )
    assert radial and axial and radial["x"] + radial["width"] <= axial["x"]
    assert min(radial["width"], axial["width"]) > 55


@pytest.mark.parametrize(
    ("path", "width"),
    [
        ("/?T=500000&n=250&t=0.3", 1440),
        pytest.param("/?T=500&n=100&t=1", 1440, marks=pytest.mark.soak),
        pytest.param(EXAMPLE, 1024, marks=pytest.mark.soak),
    ],
)
def test_no_figure_of_limits_and_map_runs_into_its_neighbour(visitor: Visitor, path: str, width: int) -> None:
    page = visitor.open(path, width=width)
    for table in ("Load limits", "Size × ratio"):
        for cell in page.get_by_role("table", name=table).get_by_role("cell").all():
            inside = (
                "cell => [cell, ...cell.querySelectorAll('a')].every(box => box.scrollWidth <= box.clientWidth + 1)"
            )
            assert cell.evaluate(inside), cell.inner_text()


def test_page_does_not_move_while_typing(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    heading, table = selected(page), page.get_by_role("table", name="Size × ratio")
    before = heading.bounding_box(), table.bounding_box()
    for value in ("41", "4", "45.25"):
        torque(page, 1).fill(value)
        expect(page).to_have_url(re.compile(f"T={re.escape(value)}&"))
        assert (heading.bounding_box(), table.bounding_box()) == before
    box = torque(page, 1).bounding_box()
    torque(page, 1).fill("9,3")
    expect(page.get_by_text("Not recalculated")).to_be_visible()
    assert (heading.bounding_box(), table.bounding_box()) == before
    assert torque(page, 1).bounding_box() == box


@pytest.mark.parametrize("width", [390, 768, 1024, 1440, 1920])
def test_nothing_makes_the_page_scroll_sideways(visitor: Visitor, width: int) -> None:
    page = visitor.open(EXAMPLE.replace("&i=5", "&FR=500&FRi=&FRi=&FRi=700"), width=width)
    show_all_sections(page)
    assert page.evaluate("document.documentElement.scrollWidth") == width


# All sections are checked on a phone, one below the other as without script; test_standards.py does so unfolded.
@pytest.mark.parametrize(
    ("path", "width"),
    [
        pytest.param(EXAMPLE, 390, marks=pytest.mark.soak),
        pytest.param(EXAMPLE, 1440, marks=pytest.mark.soak),
        pytest.param(EXAMPLE.replace("&i=5", "&FR=500&gear=14A-5"), 390, marks=pytest.mark.soak),
        pytest.param(EXAMPLE.replace("&i=5", "&FR=500&gear=14A-5"), 1440),
        pytest.param("/?T=9,3&n=&t=1", 390),
        pytest.param("/?T=9,3&n=&t=1", 1440, marks=pytest.mark.soak),
        pytest.param("/?T=&n=&t=", 390, marks=pytest.mark.soak),
        pytest.param("/?T=&n=&t=", 1440),
    ],
)
def test_accessibility_check_finds_nothing_in_either_theme(visitor: Visitor, path: str, width: int) -> None:
    page = visitor.open(path, width=width)
    if width < 600:
        show_all_sections(page)
    assert violations(page) == []


def test_page_works_by_touch_on_a_phone(visitor: Visitor) -> None:
    page = visitor.open("/", width=390, touch=True)
    page.get_by_role("checkbox", name="7", exact=True).tap()
    page.get_by_role("checkbox", name="5", exact=True).tap()
    expect(selected(page)).to_contain_text("HPN-20A-7")
    page.get_by_role("link", name=re.compile("78.% momentary peak torque")).tap()
    expect(selected(page)).to_be_in_viewport()
    page.get_by_role("link", name="Input", exact=True).tap()
    expect(page.get_by_role("heading", name="Duty cycle at")).to_be_in_viewport()


def test_message_on_a_result_of_before_names_the_field_and_leads_to_it(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.get_by_label("Speed, phase 2, in rpm").fill("x")
    named = page.locator("#result .verdict").get_by_role("link", name="Speed, phase 2")
    expect(named).to_be_visible()
    page.get_by_label("Pause").focus()
    named.click()
    expect(page.get_by_label("Speed, phase 2, in rpm")).to_be_focused()
