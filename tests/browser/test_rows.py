"""Journeys with the rows of the duty cycle: undo and redo, keys, and edits while an answer is under way."""

import re
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor, answer_held_back, button, edit_row, pause, torque

EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"


def test_every_edit_can_be_undone_and_done_again(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    undo, redo = button(page, "Undo"), button(page, "Redo")
    expect(undo).to_have_attribute("aria-disabled", "true")
    torque(page, 1).press_sequentially("5")
    expect(page).to_have_url(re.compile("T=540&"))
    edit_row(page, 2, "Remove")
    expect(torque(page, 3)).to_have_count(0)
    page.get_by_role("checkbox", name="7", exact=True).check(force=True)
    expect(page).to_have_url(re.compile("i=7"))
    page.keyboard.press("Control+z")
    expect(page.get_by_role("checkbox", name="7", exact=True)).not_to_be_checked()
    undo.click()
    expect(torque(page, 2)).to_have_value("32")
    undo.click()
    expect(torque(page, 1)).to_have_value("40")
    expect(undo).to_have_attribute("aria-disabled", "true")
    expect(undo).to_be_focused()
    redo.click()
    expect(torque(page, 1)).to_have_value("540")
    expect(torque(page, 3)).to_have_value("20")
    redo.click()
    expect(torque(page, 3)).to_have_count(0)
    expect(page.get_by_role("checkbox", name="7", exact=True)).not_to_be_checked()
    redo.click()
    expect(page.get_by_role("checkbox", name="7", exact=True)).to_be_checked()
    expect(torque(page, 1)).to_have_value("540")
    expect(torque(page, 3)).to_have_count(0)
    expect(redo).to_have_attribute("aria-disabled", "true")


@pytest.mark.parametrize("way", ["header", "address"])
def test_back_restores_the_form_behind_a_place_that_an_empty_page_does_not_have(visitor: Visitor, way: str) -> None:
    page = visitor.open("/?T=&n=&t=")
    if way == "header":
        page.get_by_role("link", name="Selection", exact=True).click()
    else:
        page.evaluate("location.hash = 'overview'")
    stop = page.get_by_label("Emergency-stop torque")
    stop.fill("90")
    stop.press("Tab")
    expect(page).to_have_url(re.compile("Tk=90"))
    page.go_back()
    expect(stop).to_have_value("")
    expect(page).not_to_have_url(re.compile("Tk=90"))
    expect(button(page, "Undo")).to_have_attribute("aria-disabled", "true")
    page.go_forward()
    expect(stop).to_have_value("90")


def test_undo_key_in_a_text_field_stays_the_browsers(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    edit_row(page, 3, "Remove")
    expect(torque(page, 3)).to_have_count(0)
    torque(page, 1).focus()
    page.keyboard.press("Control+z")
    pause(page).fill("5")  # a later edit is answered; the answer would include an effect of the key
    expect(page).to_have_url(re.compile(r"/\?T=40&n=250&t=0\.3&T=32&n=500&t=3&tp=5&"))
    expect(torque(page, 3)).to_have_count(0)


def test_keys_edit_rows_and_are_listed(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    torque(page, 1).focus()
    page.keyboard.press("Alt+ArrowDown")
    expect(torque(page, 2)).to_have_value("40")
    torque(page, 3).focus()
    page.keyboard.press("Alt+Delete")
    expect(torque(page, 3)).to_have_count(0)
    expect(torque(page, 2)).to_be_focused()  # the row that takes the place of the removed one
    page.keyboard.press("Alt+Enter")
    expect(torque(page, 3)).to_be_focused()
    page.keyboard.type("?")
    expect(torque(page, 3)).to_have_value("?")
    expect(page.get_by_role("dialog")).to_have_count(0)
    torque(page, 3).fill("")
    page.keyboard.press("Control+Enter")
    expect(page.get_by_role("region", name="Result")).to_be_focused()
    page.keyboard.press("?")
    expect(page.get_by_role("dialog", name="Shortcuts")).to_contain_text("Alt+Enter")
    page.keyboard.press("Escape")
    expect(page.get_by_role("region", name="Result")).to_be_focused()
    page.keyboard.press("Escape")
    expect(torque(page, 3)).to_be_focused()


def shown(page: Page) -> list[list[str]]:
    """Texts in the fields of the duty table, by row."""
    rows = page.locator("#duty tbody").get_by_role("row")
    return [
        [field.input_value() for field in fields] for row in rows.all() if (fields := row.get_by_role("textbox").all())
    ]


def addressed(page: Page) -> list[list[str]]:
    """Rows of the duty cycle in the address."""
    query = parse_qs(urlsplit(page.url).query)
    return [list(row) for row in zip(query["T"], query["n"], query["t"], strict=True)]


def in_rows(rows: list[list[str]]) -> re.Pattern[str]:
    """Address of a duty cycle."""
    return re.compile(re.escape("/?" + "&".join(f"T={T}&n={n}&t={t}" for T, n, t in rows) + "&tp="))


ROWS = [["40", "250", "0.3"], ["32", "500", "3"], ["20", "250", "0.4"]]


@pytest.mark.parametrize(
    ("key", "phase", "column", "order", "lands", "at_once"),
    [
        pytest.param("Alt+ArrowDown", 1, "T", [1, 0, 2], 2, False, marks=pytest.mark.soak),
        ("Alt+ArrowDown", 1, "n", [1, 0, 2], 2, True),
        pytest.param("Alt+ArrowUp", 2, "T", [1, 0, 2], 1, True, marks=pytest.mark.soak),
        ("Alt+ArrowUp", 1, "t", [0, 1, 2], 1, False),
        pytest.param("Alt+Delete", 1, "n", [1, 2], 1, False, marks=pytest.mark.soak),
        ("Alt+Delete", 3, "t", [0, 1], 2, True),
    ],
)
def test_row_edited_by_key_in_a_changed_cell_takes_the_figures_along(
    visitor: Visitor, key: str, phase: int, column: str, order: list[int], lands: int, *, at_once: bool
) -> None:
    page = visitor.open(EXAMPLE)
    name, typed = {"T": ("Torque", "36"), "n": ("Speed", "245"), "t": ("Duration", "0.7")}[column]
    values = [list(row) for row in ROWS]
    values[phase - 1]["Tnt".index(column)] = typed
    cell = page.get_by_label(f"{name}, phase {phase},")
    cell.select_text()
    page.keyboard.type(typed)
    if not at_once:
        expect(page).to_have_url(re.compile(f"{column}={typed}&"))
    rows = [values[row] for row in order]

    with page.expect_response("**/?*") as answer:
        page.keyboard.press(key)
    assert "&do=" not in answer.value.url

    expect(page.get_by_label(f"{name}, phase {lands},")).to_be_focused()
    expect(page).to_have_url(in_rows(rows))
    assert shown(page) == addressed(page) == rows
    expect(page.get_by_label(f"{name}, phase {lands},")).to_be_focused()
    with page.expect_response("**/?*"):
        page.get_by_label("Pause").fill("5")
    expect(page).to_have_url(re.compile("tp=5"))
    assert shown(page) == addressed(page) == rows


def test_row_moved_by_key_twice_in_quick_succession_goes_two_places(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    torque(page, 1).fill("36")
    with answer_held_back(page, lambda: page.keyboard.press("Alt+ArrowDown")):
        page.keyboard.press("Alt+ArrowDown")
    expect(torque(page, 3)).to_be_focused()
    expect(torque(page, 3)).to_have_value("36")
    expected = [ROWS[1], ROWS[2], ["36", "250", "0.3"]]
    expect(page).to_have_url(in_rows(expected))
    assert shown(page) == addressed(page) == expected


def test_typing_while_the_answer_to_a_row_edit_is_under_way_keeps_both_and_the_place(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    with answer_held_back(page, lambda: edit_row(page, 1, "Remove")):
        expect(torque(page, 3)).to_have_count(0)
        torque(page, 2).fill("205")
    expect(torque(page, 2)).to_have_value("205")
    expect(torque(page, 2)).to_be_focused()
    expect(page).to_have_url(re.compile(r"\?T=32&n=500&t=3&T=205&"))


def test_rows_added_in_quick_succession_all_come(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    with answer_held_back(page, button(page, "+ Add phase").click):
        button(page, "+ Add phase").click()
    expect(torque(page, 5)).to_be_visible()


MOTION = "/?mech=rotary&J=2.5&Tf=3&mv=trapezoidal&ms=90&mt=0.6&mn=&pn=a&mv=dwell&ms=&mt=1.2&mn=&pn=b"
TABLE = """() => {
  const table = document.getElementById("duty").cloneNode(true);
  const fields = [...document.querySelectorAll("#duty :is(input, select)")].map((field) => [field.id, field.value]);
  // marks of the answer, and what fields said first
  const marks = ["class", "value", "placeholder", "autofocus", "selected"];
  for (const part of table.querySelectorAll("tbody *")) {
    for (const name of marks) if (name !== "value" || part.localName === "input") part.removeAttribute(name);
  }
  return [table.tBodies[0].innerHTML.replace(/\\s+/g, " ").replaceAll("> <", "><").trim(), fields];
}"""


@pytest.mark.parametrize(
    ("path", "row"), [(EXAMPLE, "Phase"), (f"{EXAMPLE}&FRi=1&FRi=2&FRi=", "Phase"), (MOTION, "Move")]
)
def test_rows_edited_on_the_page_are_those_that_the_server_draws(visitor: Visitor, path: str, row: str) -> None:
    page = visitor.open(path)
    page.evaluate("document.getElementById('application').stays = true")
    button(page, f"+ Add {row.lower()}").click()
    edit_row(page, 2, "Move up", row)
    edit_row(page, 3, "Move up", row)
    edit_row(page, 1, "Remove", row)
    assert page.evaluate("document.getElementById('application').stays")
    here = page.evaluate(TABLE)
    button(page, "Undo").click()
    expect(page.locator("#duty tbody tr")).to_have_count(here[0].count("<tr") + 1)
    button(page, "Redo").click()  # gets the form from the server
    expect(page.locator("#duty tbody tr")).to_have_count(here[0].count("<tr"))
    assert page.evaluate(TABLE) == here


def test_a_row_beyond_those_of_a_table_makes_the_cycle_a_text(visitor: Visitor) -> None:
    page = visitor.open("/?" + "&".join(["T=40&n=250&t=0.3"] * 99))
    button(page, "+ Add phase").click()
    expect(torque(page, 100)).to_be_focused()
    torque(page, 100).fill("7")
    button(page, "+ Add phase").click()
    expect(page.get_by_role("textbox", name="Load phases")).to_have_value(re.compile(r"7\t\t\n"))


def test_a_number_that_is_offered_is_filled_in_on_the_page(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.evaluate("document.getElementById('application').stays = true")
    torque(page, 2).fill("1,234")
    page.locator("#duty-errors").get_by_role("button", name="1.234").click()
    expect(torque(page, 2)).to_have_value("1.234")
    expect(torque(page, 2)).to_be_focused()
    expect(page).to_have_url(re.compile("T=1.234&"))
    assert page.evaluate("document.getElementById('application').stays")
    button(page, "Undo").click()
    expect(torque(page, 2)).to_have_value("1,234")


def test_a_row_pressed_while_other_columns_are_under_way_waits_for_them(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    with answer_held_back(page, button(page, "load").click):
        torque(page, 1).focus()
        page.keyboard.press("Alt+ArrowDown")
        page.keyboard.press("Alt+ArrowDown")
        torque(page, 2).fill("33")
    expect(torque(page, 3)).to_be_focused()
    expected = [["33", *ROWS[1][1:]], ROWS[2], ROWS[0]]
    expect(page).to_have_url(in_rows(expected))
    assert [row[:3] for row in shown(page)] == expected
    expect(page.get_by_label("Radial load, phase 3,")).to_be_visible()


def test_enter_goes_down_a_column_and_adds_a_row_at_its_end(visitor: Visitor) -> None:
    page = visitor.open("/?T=&n=&t=")
    torque(page, 1).focus()
    for k, row in enumerate(ROWS, start=1):
        expect(torque(page, k)).to_be_focused()
        for value in row:
            page.keyboard.type(value)
            page.keyboard.press("Tab" if value != row[-1] else "Enter")
    expect(torque(page, 4)).to_be_focused()
    assert shown(page)[:3] == ROWS
    speed = page.get_by_label("Speed, phase 1,")
    speed.focus()
    page.keyboard.press("Enter")
    expect(page.get_by_label("Speed, phase 2,")).to_be_focused()
    expect(page).to_have_url(re.compile("T=20&n=250&t=0.4"))


def test_a_row_has_its_menu_by_key_and_tab_goes_through_values_alone(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    torque(page, 1).focus()
    for name in ("Speed, phase 1", "Duration, phase 1", "Torque, phase 2"):
        page.keyboard.press("Tab")
        expect(page.get_by_label(f"{name},")).to_be_focused()
    page.keyboard.press("Shift+F10")
    menu = page.get_by_role("group", name="Phase 2:")
    expect(menu.get_by_role("button", name="Move up")).to_be_focused()
    page.keyboard.press("Escape")
    expect(menu).to_be_hidden()
    expect(torque(page, 2)).to_be_focused()
    page.keyboard.press("ContextMenu")
    page.keyboard.press("Enter")
    expect(torque(page, 1)).to_have_value("32")
    expect(torque(page, 1)).to_be_focused()


def test_a_phase_is_named_in_its_row_and_where_an_input_is_wrong(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    button(page, "name").click()
    page.get_by_label("Name, phase 2").fill("lift")
    expect(page).to_have_url(re.compile("pn=lift"))
    torque(page, 2).fill("x")
    expect(page.locator("#duty-errors")).to_contain_text("phase 2 (lift)")
    button(page, "+ Add phase").click()
    page.get_by_label("Name, phase 4").fill("brake")
    expect(page.locator("form .waiting")).to_have_text("Still to enter: Torque, phase 4, in Nm")
