"""Edits before or during an answer: no input is lost or mixed up."""

import re
from functools import partial
from typing import Any, Literal
from urllib.parse import parse_qs

import pytest
from playwright.sync_api import Download, Page, Request, Route, expect

from tests.browser.conftest import Visitor, answer_held_back, button, edit_row, in_german, open_section

EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"


FAINT = """() => {
  const luminance = (rgb) => {
    const part = (value) => ((value /= 255) <= 0.03928 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
    return 0.2126 * part(rgb[0]) + 0.7152 * part(rgb[1]) + 0.0722 * part(rgb[2]);
  };
  const canvas = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  const painted = (...colours) => {
    for (const colour of colours) { canvas.fillStyle = colour; canvas.fillRect(0, 0, 1, 1); }
    return canvas.getImageData(0, 0, 1, 1).data;
  };
  const ground = (each) => getComputedStyle(each).backgroundColor;
  const grounds = (each) => (each ? [...grounds(each.parentElement), ground(each)] : ["#fff"]);
  const found = [];
  const walker = document.createTreeWalker(document.querySelector(".result"), NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const each = walker.currentNode.parentElement;
    const isSeen = each.checkVisibility({ visibilityProperty: true, opacityProperty: true });
    if (!walker.currentNode.data.trim() || !isSeen) continue;
    if (each.closest(".visually-hidden, [aria-disabled], script, title, desc, .filled")) continue;
    const style = getComputedStyle(each), drawn = each.closest("svg");
    const below = grounds(drawn?.parentElement ?? each);
    if (drawn && each.matches(".number")) below.push(getComputedStyle(each.previousElementSibling).fill);
    const ink = drawn ? style.fill : style.color;
    const [one, other] = [painted(...below), painted(...below, ink)].map(luminance).sort((a, b) => b - a);
    const contrast = (one + 0.05) / (other + 0.05);
    if (contrast < 4.5) found.push(`${each.outerHTML.slice(0, 120)} ${contrast.toFixed(2)}`);
  }
  return found;
}"""
"""Texts of the result, drawings included, with a contrast below the 4.5 of WCAG 1.4.3."""


def torque(page: Page, phase: int) -> Any:
    return page.get_by_label(f"Torque, phase {phase}")


def pause(page: Page) -> Any:
    return page.get_by_label("Pause")


def average_torque(first: float) -> str:
    """T_av of the example with another torque in its first phase, by equation 17.2, formatted as in the calculation."""
    phases = ((first, 250 * 0.3), (32, 500 * 3), (20, 250 * 0.4))
    return f"{(sum(T ** (10 / 3) * turns for T, turns in phases) / sum(turns for _, turns in phases)) ** 0.3:.9g}"


def test_calculation_that_is_opened_meanwhile_is_that_of_the_answer(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    element = page.locator("#calculation")
    for first in (80, 96):  # first without an earlier calculation, then with one
        with answer_held_back(page, partial(torque(page, 1).fill, str(first))):
            open_section(page, "Calculation")
        expect(element).to_contain_text(f"={average_torque(first)}\u202fNm≤")
        expect(element).not_to_contain_text("32.0210136\u202fNm≤")
        open_section(page, "Overview")


def test_going_back_meanwhile_takes_back_the_edit_that_is_under_way(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    pause(page).fill("5")
    expect(page).to_have_url(re.compile("tp=5"))
    with answer_held_back(page, partial(torque(page, 1).fill, "77")), page.expect_request("**/?*"):
        page.evaluate("history.back()")
    expect(torque(page, 1)).to_have_value("40")
    expect(pause(page)).to_have_value("5")
    expect(page).to_have_url(re.compile("T=40&.*tp=5"))
    torque(page, 1).fill("41")
    expect(page).to_have_url(re.compile("T=41&.*tp=5"))


def test_result_is_said_to_be_of_other_inputs_while_its_answer_is_late(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    outdated = page.get_by_role("status").get_by_text("Out of date", exact=True)
    with answer_held_back(page, partial(torque(page, 1).fill, "500")):
        expect(outdated).to_be_visible()
    expect(page.get_by_role("region", name="Result")).not_to_have_attribute("aria-busy", "true")
    expect(outdated).to_be_hidden()


def test_a_save_takes_what_the_form_says(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.evaluate(
        "() => { const field = document.getElementById('T-0'); field.value = '90';"
        " field.dispatchEvent(new Event('input', { bubbles: true }));"
        " document.querySelector('form.save').requestSubmit(); }"
    )
    expect(page).to_have_url(re.compile("/selections/"))
    expect(page.get_by_role("table", name="Load phases").get_by_role("row").nth(1)).to_contain_text("90")


def test_a_save_takes_what_the_form_says_in_german_and_inches(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    in_german(page)
    expect(page.get_by_role("button", name="Speichern", exact=True)).to_be_visible()
    page.locator("#T-0").fill("90,5")
    page.locator("form.save").evaluate("form => form.requestSubmit()")
    expect(page).to_have_url(re.compile("/selections/"))
    expect(page.locator("table.phases tbody tr").first).to_contain_text("90,5")


def test_wrong_inputs_are_not_saved(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    torque(page, 1).fill("abc")
    expect(torque(page, 1)).to_have_attribute("aria-invalid", "true")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_text("Not saved: first correct the marked inputs.")).to_be_visible()
    page.get_by_role("button", name="Go to it").click()
    expect(torque(page, 1)).to_be_focused()
    expect(torque(page, 1)).to_have_value("abc")


def test_verdict_says_that_it_is_not_of_a_phase_with_a_blank_cell(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    verdict = page.locator(".verdict")
    torque(page, 1).fill("")
    expect(verdict.get_by_role("status").get_by_text("Out of date")).to_be_visible()
    expect(verdict.get_by_text("✓ suitable")).to_be_hidden()
    torque(page, 1).fill("41")
    expect(verdict.get_by_text("Out of date")).to_be_hidden()
    expect(verdict.get_by_text("✓ suitable")).to_be_visible()


def test_verdict_says_in_full_strength_and_in_any_section_that_an_input_is_wrong(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    open_section(page, "Calculation")
    torque(page, 1).fill("abc")
    message = page.locator(".verdict").get_by_role("link", name="Torque, phase 1")
    expect(message).to_be_visible()
    page.mouse.move(800, 500)
    page.mouse.wheel(0, 1500)
    expect(message).to_be_in_viewport()
    in_full = """message => {
      const { x, y, width, height } = message.getBoundingClientRect();
      if (document.elementFromPoint(x + width / 2, y + height / 2) !== message) return false;
      let strength = 1;
      for (let each = message; each; each = each.parentElement) strength *= getComputedStyle(each).opacity;
      return strength === 1;
    }"""
    page.wait_for_function(in_full, arg=message.element_handle())


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_while_an_input_is_refused_every_section_keeps_the_last_answer_readable(
    visitor: Visitor, scheme: Literal["light", "dark"]
) -> None:
    page = visitor.open(f"{EXAMPLE}&FR=500&FA=200&JL=0.5&Jm=0.001&nm=3000&Tm=30")
    page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
    torque(page, 1).fill("abc")
    expect(page.locator(".verdict .outdated")).to_be_visible()
    for name in ("Overview", "Bearing", "Drive", "Candidates", "Compare", "Calculation", "Notes"):
        open_section(page, name)  # only the first was there before
        section = page.locator(f"#{name.lower()}")
        expect(section).to_have_text(re.compile(r"\w.{80}", re.DOTALL), use_inner_text=True)
        ink = section.evaluate("section => getComputedStyle(section).color")
        assert ink == {"light": "rgb(95, 101, 111)", "dark": "rgb(154, 160, 170)"}[scheme], name
        assert page.evaluate(FAINT) == [], name
    torque(page, 1).fill("41")
    expect(page.locator(".verdict .outdated")).to_be_hidden()


def test_foot_of_a_phone_says_that_its_gear_is_not_of_these_inputs(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE, width=390)
    foot = page.locator("#jump")
    expect(foot).to_have_text(re.compile("HPN-20A-5.*78.%.*momentary peak torque", re.DOTALL), use_inner_text=True)
    height = foot.bounding_box()
    torque(page, 1).fill("")
    expect(foot).to_have_text(re.compile("HPN-20A-5.*Out of date$", re.DOTALL), use_inner_text=True)
    assert foot.bounding_box() == height


@pytest.mark.parametrize("typed", ["abc", ""])
def test_no_link_and_no_file_is_of_the_inputs_before(visitor: Visitor, typed: str) -> None:
    page = visitor.open(EXAMPLE)
    page.evaluate("navigator.clipboard.writeText = (text) => { window.copied = text }")
    downloads: list[Download] = []
    page.on("download", lambda download: downloads.append(download))
    torque(page, 1).fill(typed)
    expect(page.locator(".verdict .outdated")).to_be_visible()
    reason = page.get_by_text("No link and no file: the result is out of date.")
    button(page, "Other files").click()
    for name in ("Copy link", "PDF", "Workbook XLSX", "Duty cycle CSV"):
        page.locator("#commands").get_by_text(name, exact=True).dispatch_event("click")
        expect(reason).to_be_visible()
    assert page.evaluate("window.copied") is None
    torque(page, 1).fill("41")
    expect(reason).to_be_hidden()
    with page.expect_download(), page.expect_request("**/report.pdf") as request:
        page.get_by_role("button", name="PDF").click()
    assert torque_asked(request.value) == "41"
    assert len(downloads) == 1


def test_file_that_is_asked_for_while_an_answer_is_under_way_is_of_that_answer(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    with (
        page.expect_download(),
        page.expect_request("**/report.pdf") as request,
        answer_held_back(page, partial(torque(page, 1).fill, "42")),
    ):
        page.get_by_role("button", name="PDF").click()
    assert torque_asked(request.value) == "42"


def torque_asked(request: Request) -> str:
    """First torque in the link of a request for a file."""
    (link,) = parse_qs(request.post_data or "")["link"]
    return parse_qs(link.removeprefix("/?"))["T"][0]


def test_undo_takes_back_the_row_edit_that_is_under_way_and_no_more(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    torque(page, 1).fill("50")
    expect(page).to_have_url(re.compile("T=50&"))
    with answer_held_back(page, lambda: edit_row(page, 2, "Remove")):
        page.get_by_role("button", name="Undo").click()
    expect(torque(page, 3)).to_have_value("20")
    expect(page.get_by_role("button", name="Redo")).to_have_attribute("aria-disabled", "false")
    expect(torque(page, 1)).to_have_value("50")
    page.get_by_role("button", name="Redo").click()
    expect(torque(page, 3)).to_have_count(0)
    expect(torque(page, 1)).to_have_value("50")


def test_undo_takes_back_the_gear_that_was_chosen_just_now_and_no_more(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    torque(page, 1).fill("50")
    expect(page).to_have_url(re.compile("T=50&"))
    open_section(page, "Candidates")
    row = page.get_by_role("table", name="Suitable").get_by_role("link", name="HPN-32A-5", exact=True)
    expect(row).to_be_visible()
    with answer_held_back(page, row.click):
        page.get_by_role("button", name="Undo").click()
    expect(page.get_by_role("button", name="Redo")).to_have_attribute("aria-disabled", "false")
    expect(torque(page, 1)).to_have_value("50")
    page.get_by_role("button", name="Redo").click()
    expect(page).to_have_url(re.compile("T=50&.*gear=HPN-32A-5"))


AT_ONCE = """() => {
  window.here = true;
  const form = document.getElementById("application");
  new MutationObserver((_, observer) => {
    if (document.getElementById("application") === form) return;
    observer.disconnect();
    document.getElementById("application").requestSubmit();
  }).observe(document.body, { childList: true, subtree: true });
}"""
"""Submits the next form as soon as it is in the page, as Back pressed twice did; the page was then reloaded."""


def test_a_form_that_has_just_been_put_in_place_is_answered_in_the_page(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.evaluate(AT_ONCE)
    with page.expect_request(lambda request: "T=20" in request.url and "T=32" not in request.url) as sent:
        edit_row(page, 2, "Remove")
    assert "hx-request" in sent.value.headers  # otherwise the browser would load the page
    sent.value.response()
    expect(torque(page, 3)).to_have_count(0)
    assert page.evaluate("window.here") is True
    expect(page).to_have_url(re.compile(r"T=40&n=250&t=0\.3&T=20&n=250&t=0\.4"))


def test_gears_pinned_in_quick_succession_are_all_compared(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    open_section(page, "Candidates")
    page.get_by_text("14A: one gear").click()
    pins = page.get_by_role("region", name="Candidates")
    with answer_held_back(page, pins.get_by_role("button", name="Compare HPN-14A-5").click):
        pins.get_by_role("button", name="Compare HPN-32A-5").click()
    expect(page).to_have_url(re.compile("pin=HPN-14A-5&pin=HPN-32A-5"))
    open_section(page, "Compare")
    expect(page.get_by_role("table", name="Comparison of HPN-20A-5, HPN-14A-5, HPN-32A-5")).to_be_visible()


def test_a_name_that_no_gear_has_is_said_where_it_was_typed_and_changes_nothing(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    open_section(page, "Candidates")
    field = page.get_by_role("combobox", name="Find a gear")
    with page.expect_response("**/api/v1/catalogue/foo"):
        field.fill("foo")
        page.keyboard.press("Enter")
    page.wait_for_function("() => document.getElementById('find-gear').validationMessage !== ''")
    assert field.evaluate("field => field.validationMessage") == "No gear of the catalogue has this name."
    pause(page).fill("5")
    expect(page).to_have_url(re.compile("tp=5"))
    field.fill("HPN-32-05")
    page.keyboard.press("Enter")
    expect(page).to_have_url(re.compile("gear=HPN-32A-5"))
    for watch in visitor.watches:
        watch.console = [text for text in watch.console if "status of 404" not in text]


def test_without_a_phase_the_address_keeps_all_else(visitor: Visitor) -> None:
    page = visitor.open("/?T=&n=&t=")
    page.get_by_label("Torque Tk").fill("300")
    expect(page).to_have_url(re.compile("Tk=300"))
    page.reload()
    expect(page.get_by_label("Torque Tk")).to_have_value("300")
    expect(page.get_by_role("link", name="Type the first phase")).to_be_visible()


def test_an_input_that_an_undo_brings_back_is_not_folded_away(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    section = page.locator("#group-motor")
    section.locator("> summary").click()
    page.locator("#f-nm").fill("900")
    expect(page).to_have_url(re.compile("nm=900"))
    page.get_by_role("button", name="Undo").click()
    expect(page).not_to_have_url(re.compile("nm=900"))
    section.locator("> summary").click()
    page.get_by_role("button", name="Redo").click()
    expect(page).to_have_url(re.compile("nm=900"))
    expect(page.locator("#f-nm")).to_be_visible()


@pytest.mark.parametrize("late", ["htmx", "script"])
def test_inputs_given_before_the_scripts_are_ready_are_answered(visitor: Visitor, late: str) -> None:
    """Input before htmx takes the form, which it does in a timer after its script has run, or before the script."""
    page = visitor.open("/catalogue")
    value_held: list[Route] = []
    if late == "htmx":
        page.add_init_script(
            "{ const start = setTimeout; setTimeout = (call, ms, ...rest) => start(call, (ms ?? 0) + 1000, ...rest) }"
        )
    else:
        page.route(re.compile(r"/page\..*\.js$"), lambda route: value_held.append(route))
    for give, case in (
        (lambda: torque(page, 1).fill("77"), "T=77&"),
        (lambda: page.locator("#f-rank").select_option(index=1), "rank="),
    ):
        with page.expect_request(re.compile(r"/page\..*\.js$")):
            page.goto(visitor.server + EXAMPLE, wait_until="domcontentloaded" if late == "htmx" else "commit")
        give()
        while value_held:
            value_held.pop().continue_()
        expect(page).to_have_url(re.compile(case))


def test_page_that_nobody_has_touched_asks_for_nothing(visitor: Visitor) -> None:
    page = visitor.open("/catalogue")
    question: list[str] = []
    page.on(
        "request", lambda request: question.append(request.url) if "HX-Request".lower() in request.headers else None
    )
    page.goto(visitor.server + EXAMPLE + "&Lreq=20000&c=iso&curve=std")
    page.wait_for_load_state("networkidle")
    assert question == []


@pytest.mark.parametrize("count", [100, 300])
def test_sections_of_a_long_cycle_come_when_they_come_into_sight_and_are_of_the_answer(
    visitor: Visitor, count: int
) -> None:
    page = visitor.open("/?" + "&".join(f"T={20 + k % 20}&n=250&t=0.3" for k in range(count)))
    open_section(page, "Candidates")
    table = page.get_by_role("table", name="Suitable")
    expect(table.get_by_role("row").nth(1)).to_be_visible()
    pause(page).fill("4")
    expect(page).to_have_url(re.compile("tp=4"))
    open_section(page, "Calculation")
    expect(page.locator("#calculation math").first).to_be_visible()
    open_section(page, "Candidates")
    expect(table.get_by_role("row").nth(1)).to_be_visible()


def test_a_page_of_something_between_takes_no_place_of_the_result(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.route("**/?*", lambda route: route.fulfill(content_type="text/html", body="<body>Please log in</body>"))

    torque(page, 1).fill("41")

    expect(page.locator("#connection")).to_contain_text("Not calculated: HTTP 200. Your input is kept.")
    expect(page.locator("#result .verdict")).to_be_visible()
    page.unroute("**/?*")
    page.get_by_role("button", name="Try now").click()
    expect(page).to_have_url(re.compile("T=41&"))
    expect(page.get_by_text("Not calculated")).to_be_hidden()
