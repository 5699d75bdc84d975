"""The table of saved selections from the keyboard, without script."""

import httpx
from playwright.sync_api import expect

from tests.browser.conftest import Visitor
from tests.build import worked_example


def test_the_list_is_filtered_and_a_selection_opened_by_keyboard_without_script(visitor: Visitor, server: str) -> None:
    for reference in ("keys-1", "keys-2"):
        body = {"application": worked_example(), "title": f"Axis {reference}", "reference": reference}
        httpx.post(f"{server}/api/v1/selections", json=body, trust_env=False).raise_for_status()
    page = visitor.open("/selections", width=390, script=False)

    page.get_by_role("textbox", name="Reference").focus()
    page.keyboard.type("keys-2")
    page.keyboard.press("Enter")
    rows = page.get_by_role("region", name="Saved selections").get_by_role("rowheader")
    expect(rows).to_have_text(["Axis keys-2"])
    for _ in range(20):
        if page.evaluate("document.activeElement.innerText") == "Axis keys-2":
            break
        page.keyboard.press("Tab")
    page.keyboard.press("Enter")

    expect(page.get_by_role("heading", level=1)).to_have_text("Saved selection")
    expect(page.get_by_text("Axis keys-2")).to_be_visible()
