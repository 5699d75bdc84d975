"""Type of the pages: five sizes and one for subscripts, in drawings, too, at any width."""

from collections.abc import Iterator, Sequence

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor, show_all_sections
from tests.browser.test_page import EXAMPLE

SIZES = (38, 20, 16, 14, 12.5, 10)
LOADED = EXAMPLE + "&FR=500&FA=200&fw=1.2"

USED = """() => {
  const found = {};
  for (const element of document.querySelectorAll("body *")) {
    const said = [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
    const aside = element.closest(".visually-hidden, .skip, option, math, script, style");
    if (!said || aside || !element.checkVisibility()) continue;
    const drawing = element.closest("svg");
    const scale = drawing?.hasAttribute("viewBox") ? drawing.getScreenCTM().a : 1;
    const size = Math.round(parseFloat(getComputedStyle(element).fontSize) * scale * 20) / 20;
    found[size] ??= `${element.localName}.${element.getAttribute("class")}: ${element.textContent.trim().slice(0, 30)}`;
  }
  return found;
}"""
"""Sizes of all letters on the screen, to a twentieth of a pixel, each with one of its elements."""


def others(page: Page, sizes: Sequence[float] = SIZES) -> dict[str, str]:
    """Sizes that are not permitted, each with an element."""
    return {
        size: where for size, where in page.evaluate(USED).items() if min(abs(float(size) - one) for one in sizes) > 0.1
    }


def at_each_width(visitor: Visitor, path: str) -> Iterator[Page]:
    """A page on a phone, on a desk and on a wide screen, as one that is resized."""
    page = visitor.open(path, 390)
    for width in (390, 1440, 1920):
        page.set_viewport_size({"width": width, "height": 900})
        yield page


@pytest.mark.parametrize(
    "path", ["/", LOADED, "/?T=&n=&t=", "/catalogue/HPN-20A-5", "/catalogue", "/selections", "/machines", "/paste"]
)
def test_a_page_has_five_sizes_of_letters_and_one_for_indices(visitor: Visitor, path: str) -> None:
    for page in at_each_width(visitor, path):
        if path == LOADED:
            show_all_sections(page)
        assert others(page) == {}, page.viewport_size


def test_discs_of_all_drawings_have_one_size(visitor: Visitor) -> None:
    for page in at_each_width(visitor, LOADED):
        discs = page.locator("#cycle .disc:visible, #envelope .mark .disc:visible")
        expect(discs.first).to_be_visible()
        heights = discs.evaluate_all("all => all.map(disc => disc.getBoundingClientRect().height)")
        assert max(heights) - min(heights) <= 1.5, (page.viewport_size, heights)


def test_a_menu_opens_under_its_caret_and_dims_nothing(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    for name, menu in (("Other files", "#other-files"), ("Language and units", "#units")):
        caret = page.get_by_role("button", name=name)
        caret.click()
        opened, under = page.locator(menu).bounding_box(), caret.bounding_box()
        assert opened and under
        assert 0 <= opened["y"] - under["y"] - under["height"] <= 12
        assert abs(opened["x"] + opened["width"] - under["x"] - under["width"]) <= 2
        shade = page.locator(menu).evaluate("each => getComputedStyle(each, '::backdrop').backgroundColor")
        assert shade in ("rgba(0, 0, 0, 0)", "transparent")
        page.keyboard.press("Escape")


def test_rows_of_a_menu_say_the_format_at_the_right(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.get_by_role("button", name="Other files").click()
    rows = page.locator("#other-files button")
    ends = rows.evaluate_all("all => all.map(row => row.lastElementChild.getBoundingClientRect().right)")
    assert len(ends) == 4
    assert max(ends) - min(ends) < 1


def test_what_is_chosen_is_readable_in_forced_colours(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.emulate_media(forced_colors="active")
    chosen = page.get_by_role("group", name="Only these ratios").locator("input:checked + span")
    expect(chosen).to_have_count(1)
    ink, ground = chosen.evaluate("chip => [getComputedStyle(chip).color, getComputedStyle(chip).backgroundColor]")
    system = "rgb(255, 255, 255)"  # HighlightText of Chromium's emulation in light colours
    assert (ink, ground != system) == (system, True)
