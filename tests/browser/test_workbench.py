"""Workbench: positions at each width, parts that stay in sight, and sections that an edit updates."""

import re
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor, in_german, open_section, show_all_sections
from tests.browser.test_page import EXAMPLE, selected, torque

SEVEN = (
    "/?" + "&".join(f"T={10 * k}&n={60 * k}&t=0.{k}&FRi={150 * k}&FAi={50 * k}" for k in range(1, 8)) + "&tp=1&Tk=120"
)
STATES = {
    "nothing": "/?T=&n=&t=",
    "example": EXAMPLE,
    "seven": SEVEN,
    "slow": "/?T=4&n=-250&t=3&T=-3&n=2&t=5&tp=4&Tk=19.5&gear=HPN-20A-4",
    "none fits": "/?T=5000&n=250&t=0.3&T=32&n=500&t=3&tp=4&Tk=9000&FR=9000&u=0.8",
    "turn": "/?mech=rotary&J=0.8&mg=12&rg=250&Tf=1.5&mv=trapezoidal&ms=90&mt=0.8&mv=dwell&ms=&mt=0.4&tp=1",
    "all gears": EXAMPLE.replace("&i=5", "&FR=500&FA=200"),
}
ZOOMED = 720
"""Width of a window of 1440 px at 200 % zoom."""
SHORT = {
    *(("seven", 1440, "de"), ("seven", 1920, "en"), ("none fits", 1024, "de")),
    *(("example", ZOOMED, "de"), ("all gears", 390, "de"), ("none fits", 1280, "de"), ("slow", 1440, "de")),
}

CLASHES = """() => {
  const texts = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = walker.currentNode, owner = node.parentElement;
    const turned = 'text[transform*="rotate"]'; // is larger than its letters, which the tests of plots compare
    const drawn = '.mark.pass, .mark.fail'; // whose letters are out of sight, for copying
    const never = '.subject, .visually-hidden, .skip, option, dialog, [popover], .jump, math, sub, script';
    const aside = `${never}, ${drawn}, ${turned}`;
    if (!node.textContent.trim() || owner.closest(aside)) continue;
    if (!owner.checkVisibility({ opacityProperty: true, visibilityProperty: true })) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    const boxes = [...range.getClientRects()].filter((box) => box.width > 1 && box.height > 1);
    texts.push(...boxes.map((box) => [node.textContent.trim(), box, owner]));
  }
  const clipped = (owner) => owner.closest(".application, .scroller, .head, .masthead");
  const found = [];
  for (let a = 0; a < texts.length; a++) for (let b = a + 1; b < texts.length; b++) {
    const [one, p, left] = texts[a], [two, q, right] = texts[b];
    if (left === right || left.contains(right) || right.contains(left) || clipped(left) !== clipped(right)) continue;
    const wide = Math.min(p.right, q.right) - Math.max(p.left, q.left);
    const high = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
    if (wide > 2 && high > Math.min(p.height, q.height) / 2) found.push(`${one} / ${two}`);
  }
  return found;
}"""
"""Pairs of overlapping texts within the same scrolling box."""

CUT = """() => [...document.querySelectorAll("main svg text")].filter(text => {
  const box = text.getBoundingClientRect(), room = text.ownerSVGElement.getBoundingClientRect();
  const beyond = box.left < room.left - 1 || box.right > room.right + 1;
  return box.width > 0 && (beyond || box.top < room.top - 2 || box.bottom > room.bottom + 2);
}).map(text => text.textContent)"""
"""Texts that reach beyond their drawing."""

SMALL = """() => [...document.querySelectorAll("main *, header *")].filter(element =>
  [...element.childNodes].some(node => node.nodeType === 3 && node.textContent.trim())
  && element.checkVisibility() && !element.closest(".visually-hidden, option, math, svg")
  && parseFloat(getComputedStyle(element).fontSize) < (element.closest("sub") ? 10 : 12.5))
  .map(element => element.textContent.trim())"""
"""Texts smaller than the smallest of the five sizes; indices have 10 px at every size, as in the PDF."""


def read_german(page: Page) -> None:
    """Turn a page into German."""
    in_german(page)
    expect(page.locator("html")).to_have_attribute("lang", "de")


def in_sight(page: Page, *locators: Any) -> list[bool]:
    """True for each element that is completely within the window's height."""
    height = page.viewport_size["height"] if page.viewport_size else 0
    boxes = [locator.bounding_box() for locator in locators]
    return [bool(box) and box["y"] >= 0 and box["y"] + box["height"] <= height for box in boxes]


@pytest.mark.parametrize(
    ("state", "language"),
    [
        *(("example", "en"), ("none fits", "de")),
        *(pytest.param(state, "en", marks=pytest.mark.soak) for state in ("seven", "none fits", "all gears")),
        *(pytest.param(state, "de", marks=pytest.mark.soak) for state in ("example", "seven", "all gears")),
    ],
)
def test_verdict_checks_envelope_and_map_need_no_scrolling_at_1440_by_900(
    visitor: Visitor, state: str, language: str
) -> None:
    page = visitor.open(STATES[state])
    if language == "de":
        read_german(page)
    parts = [page.locator(part) for part in (".verdict", "#limits", "#envelope", ".landscape table")]

    assert in_sight(page, *parts) == [True] * 4
    assert page.evaluate("document.documentElement.scrollWidth") == 1440


@pytest.mark.parametrize(
    ("state", "width", "language"),
    [
        pytest.param(state, width, language, marks=() if (state, width, language) in SHORT else pytest.mark.soak)
        for state in STATES
        for width in (390, ZOOMED, 1024, 1280, 1366, 1440, 1920)
        for language in ("en", "de")
    ],
)
def test_no_text_lies_over_another_or_beyond_the_page(visitor: Visitor, state: str, width: int, language: str) -> None:
    page = visitor.open(STATES[state], width)
    if language == "de":
        read_german(page)
    if width < 1024 and state != "nothing":
        show_all_sections(page)

    assert page.evaluate(CLASHES) == []
    assert page.evaluate(CUT) == []
    assert page.evaluate(SMALL) == []
    assert page.evaluate("document.documentElement.scrollWidth") == width


@pytest.mark.parametrize("state", ["all gears", "seven"])
def test_page_of_a_phone_is_at_most_5000_px_long(visitor: Visitor, state: str) -> None:
    page = visitor.open(STATES[state], 390, touch=True)
    assert page.evaluate("document.documentElement.scrollHeight") <= 5000
    assert page.evaluate("document.documentElement.scrollWidth") == page.evaluate("innerWidth") == 390


@pytest.mark.parametrize("width", [390, ZOOMED])
def test_narrow_screen_shows_one_section_at_a_time_and_its_tabs_stay_in_sight(visitor: Visitor, width: int) -> None:
    page = visitor.open(STATES["all gears"], width, touch=True)
    tabs = page.get_by_role("navigation", name="Sections of the result")
    expect(page.get_by_role("table", name="Load limits")).to_be_visible()

    open_section(page, "Candidates")
    expect(page.get_by_role("table", name="Suitable").first).to_be_visible()
    expect(page.get_by_role("table", name="Load limits")).to_be_hidden()
    page.get_by_text("Independent of the manufacturer.").scroll_into_view_if_needed()
    expect(tabs).to_be_in_viewport()

    open_section(page, "Bearing")
    expect(page.get_by_role("heading", name="Output bearing")).to_be_in_viewport()


def test_sections_follow_one_another_on_a_phone_without_script(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE, 390, script=False)
    for name in ("Load limits", "Suitable"):
        expect(page.get_by_role("table", name=name).first).to_be_visible()


def test_verdict_stays_in_sight_wherever_somebody_types_or_reads(visitor: Visitor) -> None:
    page = visitor.open(SEVEN)
    open_section(page, "Calculation")
    page.mouse.move(900, 600)
    page.mouse.wheel(0, 2000)
    page.wait_for_function("() => scrollY > 300")
    page.locator("#f-Nk").fill("100")
    expect(page).to_have_url(re.compile("Nk=100"))

    assert in_sight(page, selected(page)) == [True]
    expect(page.locator("#f-Nk")).to_be_in_viewport()


def test_an_edit_brings_what_is_in_sight_and_a_section_that_is_opened_follows_from_then_on(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    with page.expect_request("**/?*") as first:
        torque(page, 1).fill("41")
    assert first.value.headers["hpn-parts"] == ""
    expect(page.get_by_role("row", name="Average torque").first).to_contain_text("32.1")

    open_section(page, "Compare")
    comparison = page.get_by_role("table", name=re.compile("^Comparison of"))
    expect(comparison).to_be_visible()
    with page.expect_request("**/?*") as second:
        torque(page, 1).fill("45")
    assert second.value.headers["hpn-parts"] == "compare"
    expect(comparison.get_by_role("row", name=re.compile("Average torque"))).to_contain_text("41")

    page.reload()
    expect(comparison).to_be_visible()
    expect(page.get_by_role("table", name="Load limits")).to_be_hidden()


def test_a_cell_that_is_blanked_leaves_no_result_as_if_it_were_valid(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.get_by_label("Speed, phase 2").fill("")
    for place in ("form", ".verdict"):
        expect(page.locator(f"{place} .waiting")).to_be_visible()
        expect(page.locator(f"{place} .waiting")).to_have_text("Still to enter: Speed, phase 2, in rpm")
    element = [
        page.locator(name) for name in (".tabs", "#jump strong", "#cycle svg", "#overview")
    ]  # the second is a phone's verdict
    muted = page.evaluate("getComputedStyle(document.querySelector('.hint')).color")
    for part in (*element, selected(page), page.locator(".largest .percent")):
        expect(part).to_have_css("color", muted)
    page.get_by_label("Speed, phase 2").fill("500")
    for part in element:
        expect(part).not_to_have_css("color", muted)
    expect(selected(page)).not_to_have_css("color", muted)


@pytest.mark.parametrize("length", [20_000, 100_000, 1_000_000])
def test_a_text_too_long_for_an_address_gets_the_message_of_its_field(visitor: Visitor, length: int) -> None:
    page = visitor.open(EXAMPLE)

    page.get_by_label("Speed, phase 2").fill("9" * length)
    expect(page.locator("#duty-errors")).to_have_text("Speed, phase 2: is too long for a number")
    expect(page.locator("#connection").get_by_text("Not calculated")).to_be_hidden()

    page.get_by_label("Speed, phase 2").fill("400")
    expect(page).to_have_url(re.compile("n=400&"))


def test_the_link_is_copied_from_the_bar(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.context.grant_permissions(["clipboard-write"])
    torque(page, 1).fill("41")
    expect(page).to_have_url(re.compile("T=41&"))
    page.get_by_role("button", name="Copy link").click()
    expect(page.get_by_role("button", name="Copied")).to_be_visible()
    address = page.url
    page.get_by_role("link", name="untitled selection").click()
    page.keyboard.press("Control+v")
    expect(page.get_by_role("textbox", name="Title")).to_have_value(address[:200])


def test_ratios_that_tie_are_said_to_and_rejected_sizes_are_folded(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE.replace("&i=5", ""))
    open_section(page, "Candidates")
    expect(page.get_by_text("20A: ratios 4, 5, 7 are equal in weight and utilisation for this input")).to_be_visible()
    table = page.get_by_role("table", name="Not suitable, nearest miss first").first
    expect(table).to_be_hidden()
    page.get_by_text(re.compile("14A: 13 gears, nearest HPN-14A-4 at 182")).click()
    expect(page.locator("#rejected-14A").get_by_role("row", name=re.compile("HPN-14A-50"))).to_be_visible()


def test_seven_named_phases_with_loads_take_at_most_5000_px_of_a_phone(visitor: Visitor) -> None:
    page = visitor.open(SEVEN.replace("&FRi", "&pn=Rapid&FRi") + "&fw=1.2", 390, touch=True)
    expect(page.locator("#limits tbody tr")).to_have_count(7)
    assert page.evaluate("document.documentElement.scrollHeight") <= 5000


@pytest.mark.parametrize("path", ["/?T=&n=&t=", EXAMPLE])
def test_a_column_that_is_added_on_a_phone_leaves_the_table_in_its_place(visitor: Visitor, path: str) -> None:
    page = visitor.open(path, 390, touch=True)
    torque(page, 1).evaluate("field => scrollBy(0, field.getBoundingClientRect().top - 150)")
    before = page.evaluate("scrollY")
    page.get_by_role("button", name="load", exact=True).tap()
    expect(page.get_by_role("textbox", name=re.compile("^Radial load.* 1"))).to_be_in_viewport()
    assert page.evaluate("scrollY") == before > 0


def test_the_menu_of_a_phone_has_one_edge_and_no_command_touches_the_edge_of_the_screen(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE, 390, touch=True)
    save = page.get_by_role("button", name="Save").bounding_box()
    assert save and save["y"] > 0
    page.get_by_role("button", name="More").tap()
    entries = page.locator("#more :is(a, button):visible")
    expect(entries).to_have_count(8)
    edge = """nodes => nodes.map(node => {
        const range = document.createRange(); range.selectNodeContents(node);
        return Math.round(range.getBoundingClientRect().left);
    })"""
    assert len(set(entries.evaluate_all(edge))) == 1


def test_the_cells_of_a_row_of_the_map_stand_in_one_line_apart_from_each_other(visitor: Visitor) -> None:
    page = visitor.open(
        "/?mech=rotary&J=0.8&mv=trapezoidal&ms=90&mt=0.3&ma=&TB=40&tb=0.03&nm=3000&Tm=9&Tmn=3.2&Jm=0.0008"
    )
    buttons = page.locator("#map tr:first-child td button")
    tops = buttons.evaluate_all("nodes => nodes.map(node => Math.round(node.getBoundingClientRect().top))")
    assert len(set(tops)) == 1
    room = """nodes => nodes.map(node => {
        const range = document.createRange(); range.selectNodeContents(node);
        return node.closest("td").clientWidth - range.getBoundingClientRect().width;
    })"""
    assert min(page.locator("#map td button").evaluate_all(room)) >= 4


def test_the_unit_of_a_field_gives_way_to_one_that_is_typed(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    unit = page.locator("#f-Tk + .unit")
    page.locator("#f-Tk").fill("200000 Nmm")
    expect(unit).to_be_hidden()
    page.locator("#f-Tk").fill("200")
    expect(unit).to_be_visible()


def test_a_touched_screen_of_390_px_keeps_undo_in_reach_figures_in_their_cells_and_keys_out(visitor: Visitor) -> None:
    page = visitor.open("/?T=38&n=300&t=0.5&T=15&n=600&t=4&gear=HPN-11A-15", 390, touch=True)
    page.get_by_role("link", name="Try it").first.click()
    undo = page.get_by_role("button", name="Undo")
    expect(undo).to_be_in_viewport()
    undo.click()
    expect(torque(page, 1)).to_have_value("38")
    expect(undo).to_have_count(0)
    buttons = page.locator(".landscape td button")
    text, cell = "range.getBoundingClientRect().width", "node.clientWidth"
    inside = f"""nodes => nodes.map(node => {{
        const range = document.createRange(); range.selectNodeContents(node); return {cell} - {text};
    }})"""
    assert min(buttons.evaluate_all(inside)) >= 4
    assert page.locator(".tabs").evaluate("tabs => getComputedStyle(tabs).maskImage") == "none"
    page.goto(page.url.split("?")[0] + "?T=&n=&t=")
    expect(page.get_by_text("Alt+Enter").locator("visible=true")).to_have_count(0)


def test_the_field_whose_value_governs_has_the_colour_of_its_row(visitor: Visitor) -> None:
    page = visitor.open(STATES["all gears"])
    edge = "field => getComputedStyle(field.parentElement).boxShadow"
    colour = page.locator("#limits .governing .percent").evaluate("percent => getComputedStyle(percent).color")
    assert colour in page.locator("#f-Tk").evaluate(edge) and colour not in page.locator("#f-Nk").evaluate(edge)


def test_a_name_for_each_phase_moves_no_column(visitor: Visitor) -> None:
    page = visitor.open(STATES["all gears"])
    before = page.locator("#result").bounding_box()
    page.get_by_role("button", name="name", exact=True).click()
    expect(page.get_by_role("textbox", name="Name, phase 1")).to_be_visible()
    assert page.locator("#result").bounding_box() == before
    box = page.get_by_role("textbox", name="Torque, phase 1").bounding_box()
    assert box and box["width"] >= 64  # room for nine characters


def test_another_section_in_the_address_of_an_open_page_is_shown(visitor: Visitor) -> None:
    page = visitor.open("/")
    page.evaluate("location.hash = '#bearing'")
    expect(page.get_by_role("link", name="Bearing", exact=True)).to_have_attribute("aria-current", "true")
    assert page.evaluate("scrollY") == 0


FEET = """(cells) => cells.map((cell) => {
  const range = document.createRange();
  range.selectNodeContents(cell);
  const lines = [...range.getClientRects()].filter(({ height }) => height > 0);
  return Math.min(...lines.map(({ bottom }) => Math.round(bottom)));
})"""
"""Lower edge of the first line of text in each cell in px."""


def test_figures_of_a_check_stand_beside_the_first_line_of_its_name(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    for row in page.locator("#limits tbody tr").all():
        name, demand = row.locator(".explain, .figure:nth-child(2) .quantity").evaluate_all(FEET)[:2]
        assert abs(name - demand) <= 1


EDGES = "parts => parts.map(part => Math.round(part.getBoundingClientRect().left))"


@pytest.mark.parametrize("language", ["en", "de"])
def test_sign_and_unit_of_the_checks_stand_in_columns_and_each_name_in_one_line(
    visitor: Visitor, language: str
) -> None:
    page = visitor.open(STATES["all gears"])
    if language == "de":
        read_german(page)
    limits = page.locator("#limits tbody td:nth-child(3)")
    page.evaluate("document.fonts.ready.then(() => 0)")
    names = page.locator("#limits .explain").evaluate_all("names => names.map(name => name.offsetHeight)")

    for part in (".sign", ".quantity .unit"):
        assert len(set(limits.locator(part).evaluate_all(EDGES))) == 1, part
    expect(page.locator("#limits tbody td:nth-child(2) .unit")).to_have_count(0)
    assert max(names) <= 24, names
