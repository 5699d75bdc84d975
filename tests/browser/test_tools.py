"""Journeys with the tools around the form: paste, files, a lost server, and the catalogue."""

import re
from functools import partial
from pathlib import Path

import pytest
from playwright.sync_api import Dialog, Page, expect

from tests.browser.conftest import (
    Visitor,
    answer_held_back,
    button,
    open_section,
    pause,
    reader_menu,
    torque,
    violations,
)

EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
GERMAN = "Drehmoment [Nm]\tDrehzahl [1/min]\tDauer [s]\r\n9,3\t1.250\t0,3\r\n12,5\t500\t1,25\r\n"
PASTE = """([id, text]) => {
  const data = new DataTransfer();
  data.setData("text/plain", text);
  const event = new ClipboardEvent("paste", {clipboardData: data, bubbles: true, cancelable: true});
  return document.getElementById(id).dispatchEvent(event);
}"""
"""Pastes as a browser does; true if the page leaves the pasting to the browser."""


def paste(page: Page, text: str, into: str = "T-0") -> bool:
    page.locator(f"#{into}").focus()
    return bool(page.evaluate(PASTE, [into, text]))


def test_german_table_is_shown_and_taken_and_undone(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    assert not paste(page, GERMAN)
    dialog = page.get_by_role("dialog", name="Paste a table or open a file")
    expect(dialog.get_by_text("Column separator: tab.")).to_be_visible()
    expect(dialog.get_by_role("row", name="2 9.3 1 250 0.3")).to_be_visible()
    expect(torque(page, 1)).to_have_value("40")  # nothing is taken yet
    button(page, "Replace phases").click()
    expect(dialog).to_be_hidden()
    expect(page).to_have_url(re.compile(r"\?T=9\.3&n=1250&t=0\.3&T=12\.5&n=500&t=1\.25$"))
    expect(torque(page, 1)).to_have_value("9.3")
    expect(torque(page, 1)).to_be_focused()
    button(page, "Undo").click()
    expect(torque(page, 3)).to_have_value("20")
    expect(page).to_have_url(re.compile(re.escape(EXAMPLE) + "$"))


def test_ambiguous_table_is_asked_about_by_keyboard(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    paste(page, "1.234\t250\t3")
    expect(page.get_by_text("Which is the decimal mark?")).to_be_visible()
    mark = page.get_by_role("group", name="Which is the decimal mark?")
    point, comma = mark.get_by_role("radio", name="a point"), mark.get_by_role("radio", name="a comma")
    expect(point).to_be_focused()
    expect(point).not_to_be_checked()
    expect(button(page, "Replace phases")).to_be_disabled()
    page.keyboard.press("Space")
    expect(page.get_by_role("cell", name="1.234", exact=True)).to_be_visible()
    expect(point).to_be_focused()  # the answer does not move the focus
    page.keyboard.press("ArrowDown")
    expect(page.get_by_role("cell", name="1\u202f234", exact=True)).to_be_visible()
    expect(comma).to_be_focused()
    expect(comma).to_be_checked()
    for _ in range(12):
        if button(page, "Replace phases").evaluate("b => b === document.activeElement"):
            break
        page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(torque(page, 1)).to_have_value("1234")


def test_choice_made_while_the_answer_to_the_one_before_is_under_way_counts(visitor: Visitor) -> None:
    """The table is requested 150 ms after a choice: an answer in between showed the previous choice."""
    page = visitor.open(EXAMPLE)
    paste(page, "1.234\t250\t3")
    mark = page.get_by_role("group", name="Which is the decimal mark?")
    expect(mark.get_by_role("radio", name="a point")).to_be_focused()
    with answer_held_back(page, partial(page.keyboard.press, "Space"), "**/paste"):
        page.keyboard.press("ArrowDown")
    expect(page.get_by_role("cell", name="1\u202f234", exact=True)).to_be_visible()
    expect(mark.get_by_role("radio", name="a comma")).to_be_checked()


def test_column_is_corrected_and_taken(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    paste(page, "9.3\t1250\t300\n12.5\t500\t200\n")
    page.get_by_label("Unit of column 3").select_option("ms")
    expect(page.get_by_text("All phases take 0.5 s.")).to_be_visible()
    page.get_by_label("Quantity of column 1").select_option("Speed")
    expect(page.get_by_text("Columns 1 and 2 are read as the same quantity.")).to_be_visible()
    page.get_by_label("Quantity of column 2").select_option("Torque")
    button(page, "Replace phases").click()
    expect(page).to_have_url(re.compile(r"\?T=1250&n=9\.3&t=0\.3&T=500&n=12\.5&t=0\.2$"))


def test_columns_that_nobody_knows_are_skipped_by_one_button(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    paste(page, "T;n;Dauer;Temp A;Temp B;Lage\n9;1250;0,3;20;21;1,5\n12;500;0,2;20;22;2,5\n")
    expect(page.get_by_text("What is column “Temp A”?")).to_be_visible()
    button(page, "Skip 3 columns that were not recognised").click()
    expect(page.get_by_text("All phases take 0.5 s.")).to_be_visible()
    expect(page.get_by_label("Quantity of Temp B")).to_have_value("skip")
    page.get_by_label("Unit of Dauer").select_option("ms")  # the button's choice stays
    expect(page.get_by_text("All phases take 0.0005 s.")).to_be_visible()
    button(page, "Replace phases").click()
    expect(page).to_have_url(re.compile(r"\?T=9&n=1250&t=0\.0003&T=12&n=500&t=0\.0002$"))


def test_a_table_that_can_not_be_read_says_so_and_nothing_is_taken(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    paste(page, "40\tabc\t3")
    expect(page.get_by_role("alert")).to_contain_text("row 1: abc is not a number")
    expect(button(page, "Replace phases")).to_have_count(0)
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)
    expect(torque(page, 1)).to_have_value("40")


def test_single_cell_pastes_as_ever(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    for text in ("41", " 41 ", "9,3", "1.234,5", "41\n"):
        assert paste(page, text)
    expect(page.get_by_role("dialog")).to_have_count(0)


def test_long_table_is_edited_as_text_and_kept_as_a_file(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.open(EXAMPLE)
    paste(page, "".join(f"40,{k % 10};{250 + k % 90};0,25\n" for k in range(3500)))
    button(page, "Replace phases").click()
    text = page.get_by_role("textbox", name="Load phases")
    expect(text).to_be_visible()
    expect(page.get_by_text("This cycle is too long for a link: keep it as a file.")).to_be_visible()
    expect(page).to_have_url(re.compile("/paste$"))
    button(page, "Other files").click()
    with page.expect_download() as download:
        button(page, "Duty cycle CSV").click()
    assert Path(download.value.path()).read_text().count("\n") == 3501
    button(page, "Undo").click()
    expect(torque(page, 3)).to_have_value("20")
    expect(page).to_have_url(re.compile(re.escape(EXAMPLE) + "$"))


def test_application_leaves_as_a_file_and_comes_back(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.open(EXAMPLE)
    button(page, "Other files").click()
    with page.expect_download() as download:
        page.get_by_role("button", name="Application JSON").click()
    file = tmp_path / "application.json"
    download.value.save_as(file)
    page.goto(visitor.server + "/?T=&n=&t=")
    button(page, "Paste table").click()
    page.get_by_label("or a file").set_input_files(file)
    expect(page.get_by_text("An application with 3 load phases.")).to_be_visible()
    button(page, "Open it").click()
    expect(page).to_have_url(re.compile(re.escape(EXAMPLE) + "$"))


def test_table_and_file_are_taken_without_script(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.open(EXAMPLE, script=False)
    pause(page).fill("5")  # typed, not calculated yet: it must be kept
    button(page, "Paste table").click()
    page.get_by_label("Cells copied from a spreadsheet").fill("1.234;250;3\n2.345;100;1")
    button(page, "Preview").click()
    page.get_by_role("radio", name="a point: 1.234").check()
    button(page, "Preview").click()
    button(page, "Replace phases").click()
    expect(torque(page, 2)).to_have_value("2.345")
    expect(pause(page)).to_have_value("5")
    file = tmp_path / "cycle.csv"
    file.write_text("9,3;250;0,5\n", "cp1252")
    page.get_by_role("link", name="Import").click()
    page.get_by_label("or a file").set_input_files(file)
    button(page, "Preview").click()
    button(page, "Append").click()
    expect(torque(page, 3)).to_have_value("9.3")


def test_long_wait_is_shown_and_a_short_one_is_not(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.clock.install(time=0)
    page.clock.pause_at(60)  # from here only run_for advances the clock, even on a slow machine
    result = page.get_by_role("region", name="Result")
    before = page.get_by_role("table", name="Load limits").bounding_box()
    with answer_held_back(page, lambda: pause(page).fill("5")):
        page.clock.run_for(250)
        expect(result).not_to_have_attribute("aria-busy", "true")
        page.clock.run_for(100)
        expect(result).to_have_attribute("aria-busy", "true")
        assert page.get_by_role("table", name="Load limits").bounding_box() == before
    expect(page).to_have_url(re.compile("tp=5"))
    expect(result).not_to_have_attribute("aria-busy", "true")


OVERLOADED = """() => {
  const send = window.fetch;
  window.release = () => { window.fetch = send; };
  const headers = { "content-type": "application/problem+json" };
  window.fetch = () => Promise.resolve(new Response('{"detail": "too many at once"}', { status: 503, headers }));
}"""


class TestWithoutServer:
    """Tests without a server; not watched, as the browser reports failed requests in its console."""

    @pytest.fixture
    def page(self, visitor: Visitor) -> Page:
        page = visitor.open(EXAMPLE)
        visitor.watches.clear()
        return page

    def test_lost_server_is_said_and_tried_again_and_nothing_typed_is_lost(self, page: Page) -> None:
        page.context.set_offline(True)
        pause(page).fill("7")
        message = page.get_by_text("The server can’t be reached.")
        expect(message).to_be_visible()
        expect(pause(page)).to_have_value("7")
        expect(page.get_by_role("region", name="Result")).to_have_attribute("data-stale", "")
        page.context.set_offline(False)
        expect(page).to_have_url(re.compile("tp=7"))
        expect(message).to_be_hidden()

    def test_inputs_that_nobody_has_answered_are_not_left_behind(self, page: Page) -> None:
        asked = list[str]()

        def stay(dialog: Dialog) -> None:
            asked.append(dialog.type)
            dialog.dismiss()

        page.on("dialog", stay)
        page.context.set_offline(True)
        pause(page).fill("7")
        expect(page.get_by_text("The server can’t be reached.")).to_be_visible()
        button(page, "Save").click()
        expect(page.get_by_text("Not saved: the server does not answer.")).to_be_visible()
        page.get_by_role("link", name="Catalogue", exact=True).click()
        page.wait_for_timeout(100)
        assert asked == ["beforeunload"]
        expect(pause(page)).to_have_value("7")
        page.context.set_offline(False)
        expect(page).to_have_url(re.compile("tp=7"))
        button(page, "Save").click()
        expect(page).to_have_url(re.compile("/selections/"))

    def test_table_that_nobody_reads_leaves_the_result_as_it_is(self, page: Page) -> None:
        page.context.set_offline(True)
        paste(page, "40\t250\t3\n32\t500\t3")
        expect(page.get_by_text("The server can’t be reached.")).to_be_visible()
        expect(page.get_by_role("region", name="Result", include_hidden=True)).not_to_have_attribute("data-stale", "")
        page.context.set_offline(False)

    def test_reply_that_is_no_page_never_takes_the_forms_place(self, page: Page) -> None:
        page.evaluate(OVERLOADED)
        pause(page).fill("8")
        expect(page.get_by_text("too many at once")).to_be_visible()
        expect(pause(page)).to_have_value("8")
        page.evaluate("release()")
        button(page, "Try now").click()
        expect(page).to_have_url(re.compile("tp=8"))


def test_ordering_code_follows_what_is_chosen_and_survives_the_next_answer(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.get_by_role("radio", name="J8").check(force=True)
    page.get_by_label("Motor adapter").fill("bh-af1")
    code = page.get_by_role("region", name="Ordering code").get_by_role("status")
    expect(code).to_have_text("HPN-20A-5-J8-BH-AF1")
    page.get_by_role("checkbox", name="7", exact=True).check(force=True)
    page.get_by_role("checkbox", name="5", exact=True).uncheck(force=True)
    expect(code).to_have_text("HPN-20A-7-J8-BH-AF1")
    page.get_by_label("Motor adapter").fill("bh af1!")
    expect(code).to_have_text("HPN-20A-7-J8")
    expect(page.get_by_text("letters and digits")).to_be_visible()


@pytest.mark.parametrize("script", [True, False])
def test_gear_is_found_by_any_spelling(visitor: Visitor, script: bool) -> None:
    page = visitor.open(EXAMPLE, script=script)
    open_section(page, "Candidates")
    page.get_by_role("combobox", name="Find a gear").fill("HPN-14-05-J6-BH-AF1")
    page.get_by_role("search").get_by_role("button", name="Show").click()
    expect(page).to_have_url(re.compile("gear=HPN-14A-5"))
    expect(page.get_by_role("region", name="Result").get_by_role("heading", level=2)).to_contain_text("HPN-14A-5")


def test_from_the_selection_to_a_gears_page_and_back_with_another_gear(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.locator("#verdict").get_by_role("link", name="HPN-20A-5").click()
    expect(page.get_by_role("heading", level=2)).to_have_text("HPN-20A-5")
    page.get_by_role("navigation", name="Neighbours").get_by_role("link", name="HPN-32A-5", exact=True).click()
    expect(page.get_by_role("row", name="Rated torque TN")).to_contain_text("200 Nm")
    page.get_by_role("link", name="Use in selection").click()
    expect(page).to_have_url(re.compile(re.escape(EXAMPLE) + "&gear=HPN-32A-5$"))


def test_envelope_of_a_gear_has_its_axes_as_the_plots_of_a_selection(visitor: Visitor) -> None:
    page = visitor.open("/catalogue/HPN-20A-5")
    drawing = page.get_by_role("figure", name="Permissible axial load against radial load of HPN-20A")
    radial, axial = (drawing.get_by_text(f"{name} load in N").bounding_box() for name in ("radial", "axial"))
    assert radial and axial
    assert radial["width"] > radial["height"] and axial["width"] > axial["height"]  # each name at the end of its axis
    assert axial["y"] < radial["y"] and axial["x"] < radial["x"]
    corners = page.get_by_role("table", name="Corner points")
    expect(corners.get_by_role("columnheader")).to_have_text(["fw", "Radial N", "Axial N"])


def test_table_is_pasted_by_touch_on_a_phone(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE, width=390, touch=True)
    button(page, "Paste table").tap()
    page.get_by_label("Cells copied from a spreadsheet").fill(GERMAN)
    button(page, "Replace phases").tap()
    expect(torque(page, 2)).to_have_value("12.5")
    assert page.evaluate("document.documentElement.scrollWidth") == 390


@pytest.mark.soak  # test_states.py checks these pages on a phone
@pytest.mark.parametrize("width", [390, 1440])
@pytest.mark.parametrize(
    "path",
    ["/catalogue", "/catalogue/HPN-20A-5", "/catalogue/HPN-40A-5", "/catalogue?size=11A&i=3", "/paste?T=1&n=2&t=3"],
)
def test_accessibility_check_finds_nothing_on_the_pages_beside(visitor: Visitor, path: str, width: int) -> None:
    page = visitor.open(path, width=width)
    if "i=3" in path:
        visitor.watches.clear()  # Chromium reports the 404 of a filter without gears
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert violations(page) == []


@pytest.mark.parametrize(
    "state", ["paste", *(pytest.param(state, marks=pytest.mark.soak) for state in ("shortcuts", "long"))]
)
def test_accessibility_check_finds_nothing_in_the_dialogs(visitor: Visitor, state: str) -> None:
    page = visitor.open(EXAMPLE if state != "long" else "/?" + "&".join(["T=40&n=250&t=1"] * 101))
    if state == "paste":
        paste(page, "1.234\t250\t3")
        expect(page.get_by_text("Which is the decimal mark?")).to_be_visible()
    if state == "shortcuts":
        reader_menu(page).click()
        button(page, "Shortcuts").click()
    assert violations(page) == []
