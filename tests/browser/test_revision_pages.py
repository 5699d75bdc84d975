"""Revisions in a browser: two states chosen by keys and compared, on a desk and on a phone."""

import httpx
import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Visitor, violations
from tests.fleet.test_machine_page import MACHINE


@pytest.fixture
def machine(server: str) -> str:
    """Address of a machine with two revisions."""
    place = str(httpx.post(f"{server}/api/v1/machines", json=MACHINE, trust_env=False).json()["url"])
    api = f"{server}/api/v1{place}"
    httpx.post(f"{api}/revisions", json={"label": "A"}, trust_env=False).raise_for_status()
    headers = {"Content-Type": "application/merge-patch+json"}
    httpx.patch(f"{api}/axes/1", json={"quantity": 5}, headers=headers, trust_env=False).raise_for_status()
    httpx.post(f"{api}/revisions", json={"label": "B"}, trust_env=False).raise_for_status()
    return place


@pytest.mark.parametrize(("width", "dark"), [(1440, False), (1440, True), (390, False)])
def test_two_revisions_are_chosen_by_keys_and_compared(visitor: Visitor, machine: str, width: int, dark: bool) -> None:
    page = visitor.open(f"{machine}/revisions?from=B&to=now", width, dark=dark, touch=width < 600)
    page.get_by_role("radio", name="compare from revision A").focus()
    page.keyboard.press("Space")
    page.get_by_role("radio", name="compare to revision B").check()
    page.keyboard.press("Enter")

    expect(page.get_by_role("heading", name="A → B")).to_be_visible()
    expect(page.get_by_role("row", name="Infeed belt")).to_contain_text("5")
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert violations(page) == []


@pytest.mark.parametrize("width", [1440, 390])
def test_a_revision_is_opened_read_only(visitor: Visitor, machine: str, width: int) -> None:
    page = visitor.open(f"{machine}?revision=A", width, touch=width < 600)

    expect(page.get_by_text("read-only")).to_be_visible()
    expect(page.get_by_role("checkbox")).to_have_count(0)
    assert violations(page) == []
