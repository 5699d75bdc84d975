"""List of saved selections, which are saved from the page, found, renamed, compared and continued."""

import re

import httpx
import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Visitor, in_german
from tests.build import worked_example


def saved(server: str, **labels: str) -> str:
    """Address of a newly saved selection."""
    body = {"application": worked_example(), **labels}
    answer = httpx.post(f"{server}/api/v1/selections", json=body, trust_env=False).raise_for_status()
    return str(answer.json()["url"])


def test_the_list_is_searched_and_a_selection_opened_by_keyboard_without_script(visitor: Visitor, server: str) -> None:
    for reference in ("keys-1", "keys-2"):
        saved(server, title=f"Axis {reference}", reference=reference)
    page = visitor.open("/selections", width=390, script=False)

    page.get_by_role("searchbox", name="Search").focus()
    page.keyboard.type("keys-2")
    page.keyboard.press("Enter")
    rows = page.get_by_role("region", name="Saved selections").get_by_role("rowheader")
    expect(rows.get_by_role("link")).to_have_text(["Axis keys-2"])
    for _ in range(20):
        if page.evaluate("document.activeElement.innerText") == "Axis keys-2":
            break
        page.keyboard.press("Tab")
    page.keyboard.press("Enter")

    expect(page.get_by_role("heading", level=1)).to_have_text("Axis keys-2")


def test_labels_of_a_selection_survive_reload_saving_and_a_copy(visitor: Visitor) -> None:
    written = "&title=Journey+1&ref=4711-J&author=M.+Muster&rev=B&order_output=J8&order_motor=BH-AF1"
    page = visitor.open("/?T=40&n=250&t=0.3&i=5" + written)
    page.reload()
    page.get_by_role("button", name="Save", exact=True).click()

    page.wait_for_url("**/selections/*")
    for text in ("4711-J", "M. Muster"):
        expect(page.get_by_text(text, exact=True)).to_be_visible()
    expect(page.get_by_text(re.compile("^HPN-[0-9]+A-5-J8-BH-AF1$"))).to_be_visible()
    page.get_by_role("link", name="Edit a copy").click()
    expect(page).to_have_url(re.compile(re.escape(written)))


def test_two_are_marked_renamed_and_compared(visitor: Visitor, server: str) -> None:
    for title in ("pair one", "pair two"):
        saved(server, title=title)
    page = visitor.open("/selections?search=pair")

    page.get_by_role("button", name="Rename pair one").click()
    page.get_by_role("form", name="Rename pair one").get_by_label("Title").fill("pair three")
    page.keyboard.press("Enter")
    rows = page.get_by_role("region", name="Saved selections").get_by_role("rowheader")
    expect(rows).to_have_text(["pair two", "pair three"])
    for name in ("pair two", "pair three"):
        page.get_by_role("checkbox", name=f"Mark {name}").check()
    page.get_by_role("button", name="Compare two").click()

    expect(page.get_by_role("heading", level=1)).to_have_text("Two selections side by side")
    expect(page.get_by_text("None: both have the same input.")).to_be_visible()


@pytest.mark.parametrize("width", [1440, 390])
def test_the_box_of_another_verdict_stands_beside_its_words(visitor: Visitor, width: int) -> None:
    page = visitor.open("/selections", width)

    box = page.get_by_role("checkbox", name="other verdict today").bounding_box()

    assert box is not None and box["width"] <= 24


SIGN_AND_LIMIT = """cells => cells.map(cell =>
  [...cell.querySelectorAll(".sign, .quantity")].map(part => part.getBoundingClientRect().bottom))"""
"""Lower edges of sign and limit in each cell in px."""


def test_limits_of_a_saved_selection_stand_beside_their_sign_and_names_of_figures_are_not_cut(
    visitor: Visitor, server: str
) -> None:
    page = visitor.open(saved(server, title="Drehtisch"))
    in_german(page)
    expect(page.locator("html")).to_have_attribute("lang", "de")
    feet = page.locator("#limits tbody td:nth-child(3)").evaluate_all(SIGN_AND_LIMIT)
    heights = page.locator(".figures dt").evaluate_all("names => names.map(name => name.offsetHeight)")

    assert feet
    assert all(abs(sign - limit) < 4 for sign, limit in feet)
    assert max(heights) < 40  # two lines
