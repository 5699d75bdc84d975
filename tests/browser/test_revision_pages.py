"""Revisions in a browser: two states chosen by keyboard and compared, on a desktop and on a phone."""

import httpx
import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Visitor, in_german, violations
from tests.build import worked_example
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


@pytest.mark.parametrize("width", [1440, 390])
def test_two_revisions_are_chosen_by_keys_and_compared(visitor: Visitor, machine: str, width: int) -> None:
    page = visitor.open(f"{machine}/revisions?from=B&to=now", width, touch=width < 600)
    page.get_by_role("radio", name="compare from revision A").focus()
    page.keyboard.press("Space")
    page.get_by_role("radio", name="compare to revision B").check()
    page.keyboard.press("Enter")

    expect(page.get_by_role("heading", name="A → B")).to_be_visible()
    expect(page.get_by_role("row", name="Infeed belt")).to_contain_text("5")
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert violations(page) == []


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("width", [1440, 1280, 1024])
def test_the_states_that_are_compared_stand_in_one_line(
    visitor: Visitor, machine: str, language: str, width: int
) -> None:
    page = visitor.open(f"{machine}/revisions?from=A&to=now", width)
    if language == "de":
        in_german(page)

    heading = page.locator("#compared-heading")
    line = heading.evaluate("heading => parseFloat(getComputedStyle(heading).lineHeight)")
    assert heading.evaluate("heading => heading.clientHeight") < 1.9 * line
    fields = page.locator(".comparison .states :is(select, button)").all()
    assert len({round(field.evaluate("field => field.getBoundingClientRect().bottom")) for field in fields}) == 1
    for cell in page.locator(".comparison .machine-block :is(.name, .value), .compared-axes td").all():
        assert cell.evaluate("cell => cell.scrollWidth <= cell.clientWidth + 1")  # rounded up
    assert page.evaluate("document.documentElement.scrollWidth") == width


@pytest.mark.parametrize("width", [1440, 390])
def test_a_revision_is_opened_read_only(visitor: Visitor, machine: str, width: int) -> None:
    page = visitor.open(f"{machine}?revision=A", width, touch=width < 600)

    expect(page.get_by_text("read-only")).to_be_visible()
    expect(page.get_by_role("checkbox")).to_have_count(0)
    assert violations(page) == []


@pytest.fixture
def selection(server: str) -> str:
    """Address of a selection with the revisions A and B."""
    loaded = worked_example(output_load={"radial_N": 500.0, "axial_N": 200.0, "load_coefficient": 1.2})
    sent = {"application": worked_example(), "title": "Infeed turret", "reference": "HB-2417", "revision": "A"}
    place = str(httpx.post(f"{server}/api/v1/selections", json=sent, trust_env=False).json()["url"])
    body = {"application": loaded, "label": "B", "author": "MA", "note": "loads of the turret"}
    httpx.post(f"{server}/api/v1{place}/revisions", json=body, trust_env=False).raise_for_status()
    return place


@pytest.mark.parametrize(("width", "dark"), [(1440, False), (390, True)])
@pytest.mark.parametrize("language", ["en", "de"])
def test_a_saved_selection_is_the_workbench_read_only(
    visitor: Visitor, selection: str, width: int, dark: bool, language: str
) -> None:
    page = visitor.open(selection, width, dark=dark, touch=width < 600)
    if language == "de":
        in_german(page)

    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert violations(page) == []
    bearing = page.get_by_role("link", name={"en": "Bearing", "de": "Lager"}[language], exact=True)
    bearing.click()
    expect(page.locator("#bearing")).to_be_visible()
    expect(page.locator("#overview")).to_be_hidden()
    assert violations(page) == []
    expect(page.locator("main").get_by_role("textbox")).to_have_count(0)


def test_on_a_phone_the_gear_its_utilisation_and_life_stand_on_the_first_screen(
    visitor: Visitor, selection: str
) -> None:
    page = visitor.open(selection, 390, touch=True)

    for part in (".designation", ".largest", ".facts > div"):
        box = page.locator(part).first.bounding_box()
        assert box is not None and box["y"] + box["height"] < 844 / 2, part


def test_without_script_the_sections_of_a_saved_selection_follow_each_other(visitor: Visitor, selection: str) -> None:
    page = visitor.open(selection, 390, script=False)

    for part in ("overview", "bearing", "candidates", "calculation", "notes", "today"):
        expect(page.locator(f"#{part}")).to_be_visible()
    expect(page.get_by_role("heading", name="Input as saved")).to_be_visible()


def test_the_next_revision_begins_with_the_latest_and_is_saved_from_the_head(visitor: Visitor, selection: str) -> None:
    page = visitor.open(selection)
    page.get_by_role("link", name="New revision").click()
    page.wait_for_url("**/axes/1")
    page.locator("#T-0").fill("44")
    page.wait_for_url("**T=44&**")
    page.get_by_role("button", name="Save", exact=True).click()
    page.wait_for_url("**/axes/1")
    page.get_by_role("link", name="Infeed turret").click()
    expect(page.get_by_text("The working copy has changed since revision B.")).to_be_visible()
    page.locator(".newer").get_by_role("link", name="Compare").click()
    expect(page.get_by_role("row", name="Torque, phase 1")).to_contain_text("44")

    page.get_by_text("Save revision C").click()
    assert violations(page) == []
    page.get_by_role("form", name="Save a revision").get_by_label("Note").fill("heavier")
    page.get_by_role("form", name="Save a revision").get_by_role("button", name="Save").click()

    expect(page.get_by_role("heading", name="B → C")).to_be_visible()
    page.get_by_role("link", name="Open revision C").click()
    expect(page.get_by_text("C of 3")).to_be_visible()


@pytest.mark.parametrize("width", [1440, 390])
@pytest.mark.parametrize("place", ["/machines", "/selections", "/selections/revisions"])
def test_lists_and_revisions_of_a_selection_fit_in_german(
    visitor: Visitor, machine: str, selection: str, place: str, width: int
) -> None:
    address = f"{selection}/revisions" if place == "/selections/revisions" else place
    page = visitor.open(address, width, touch=width < 600)
    in_german(page)

    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert violations(page) == []
