"""Every state of the pages in one browser: axe in both themes and in forced colours, and no inner scroll bars."""

import re
from collections.abc import Callable

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import (
    Visitor,
    button,
    in_german,
    open_section,
    torque,
    violations,
    violations_in_forced_colours,
)
from tests.browser.test_motion import RAMPS
from tests.browser.test_page import EXAMPLE
from tests.build import worked_example

LOADED = EXAMPLE + "&FR=500&FA=200&fw=1.2"
LACKS_CENTRE = EXAMPLE + "&FR=900&FA=200&xR=24"
TABLE = "Nr.\tStep\tM [Nm]\tn [rpm]\tt [ms]\n1\trise\t12\t1,250\t350\n2\trun\t5\t2,500\t1,200\n"

WIDER = """() => [...document.querySelectorAll('body *')].filter((each) => {
  const { overflowX, overflowY } = getComputedStyle(each);
  const scrolls = (overflow, inner, outer) => ['auto', 'scroll'].includes(overflow) && inner > outer + 1;
  return each.checkVisibility() && !each.matches('.tabs, .landscape, textarea')
    && (scrolls(overflowX, each.scrollWidth, each.clientWidth)
      || (scrolls(overflowY, each.scrollHeight, each.clientHeight) && !each.matches('#application')));
}).map((each) => `${each.localName}.${each.className}#${each.id}`)"""
"""Elements with their own scroll bar, except the column of inputs, the tabs, the map on a phone and text fields."""


def _section(name: str) -> Callable[[Page], None]:
    return lambda page: open_section(page, name)


def _refused(page: Page) -> None:
    torque(page, 2).fill("3x2")
    expect(torque(page, 2)).to_have_attribute("aria-invalid", "true")


def _read(page: Page) -> None:
    page.get_by_label("Cells copied from a spreadsheet").fill(TABLE)
    button(page, "Preview").click()
    expect(page.get_by_text("Which is the decimal mark?").first).to_be_visible()


STATES: dict[str, tuple[str, Callable[[Page], None] | None]] = {
    "first visit": ("/", None),
    "example": (LOADED, None),
    "bearing": (LOADED, _section("Bearing")),
    "bearing without a load": (EXAMPLE, _section("Bearing")),
    "bearing without the shaft's centre": (LACKS_CENTRE, _section("Bearing")),
    "drive": (RAMPS, _section("Drive")),
    "drive with a motor": (RAMPS + "&nm=6000&Tm=7.2&Tmn=2.2&nmr=3000&Jm=0.0006&Jr=5#drive", None),
    "candidates": (LOADED, _section("Candidates")),
    "compare": (LOADED + "&pin=HPN-14A-5&pin=HPN-32A-5", _section("Compare")),
    "calculation": (LOADED, _section("Calculation")),
    "notes": (LOADED, _section("Notes")),
    "tolerance": (LOADED + "&tol=T:8p&tol=n:2p&tol=Tk:10p", _section("Tolerance")),
    "correcting": (LOADED, _refused),
    "nothing fits": (EXAMPLE.replace("T=40", "T=4000"), None),
    "motion with ramps": (RAMPS, None),
    "motion with tolerances": ("/?mech=rotary&J=0.8&Tf=3&mv=trapezoidal&ms=110&mt=0.4&tp=1&tol=J:10p", None),
    "gear": ("/catalogue/HPN-20A-5", None),
    "catalogue": ("/catalogue", None),
    "import": ("/paste", None),
    "table read": ("/paste", _read),
    "saved": ("SAVED", None),
}
SCROLLS = ("table read",)
"""States that may scroll: a pasted table can have any number of columns."""


@pytest.fixture(scope="module")
def saved(server: str) -> str:
    """Path of a saved selection."""
    body = {"application": worked_example(), "title": "Axis 7"}
    return str(httpx.post(f"{server}/api/v1/selections", json=body, trust_env=False).json()["url"])


@pytest.mark.parametrize("width", [390, pytest.param(1440, marks=pytest.mark.soak)])
def test_axe_finds_nothing_in_any_state_in_either_theme_and_in_forced_colours(
    visitor: Visitor, saved: str, width: int
) -> None:
    page = visitor.open("/", width)
    found = {}
    for name, (path, does) in STATES.items():
        page.emulate_media(color_scheme="light", forced_colors="none")
        page.goto(visitor.server + path.replace("SAVED", saved))
        if does:
            does(page)
        if faults := violations(page) + violations_in_forced_colours(page):
            found[name] = faults
    assert found == {}


@pytest.mark.parametrize("german", [False, True])
@pytest.mark.parametrize("width", [390, 1024, pytest.param(1440, marks=pytest.mark.soak)])
def test_nothing_scrolls_sideways_or_within_the_page(visitor: Visitor, saved: str, width: int, german: bool) -> None:
    page = visitor.open("/", width)
    if german:
        in_german(page)
    found = {}
    for name, (path, does) in STATES.items():
        if does and (german or name in SCROLLS):
            continue
        page.goto(visitor.server + path.replace("SAVED", saved))
        if does:
            does(page)
        within = [] if name in SCROLLS else page.evaluate(WIDER)
        if within or page.evaluate("document.documentElement.scrollWidth") > width:
            found[name] = within
    assert found == {}


def test_a_section_that_is_one_element_is_requested_once(visitor: Visitor) -> None:
    page = visitor.open(f"{LACKS_CENTRE}#bearing", 1440)
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    expect(page.get_by_role("region", name="Output bearing").get_by_label("x_c of 20A")).to_be_visible()
    page.wait_for_load_state("networkidle")
    assert len(asked) <= 2, asked


def test_a_phone_switches_what_ramps_are_given_as(visitor: Visitor) -> None:
    page = visitor.open(RAMPS, 390)
    page.get_by_role("group", name="Ramps given as").get_by_role("button", name="mm/s²").click()
    expect(page.get_by_label(re.compile("^Acceleration, move 1")).first).to_be_visible()


@pytest.mark.parametrize("width", [390, 768])
def test_a_narrow_catalogue_shows_a_group_of_columns_at_a_time(visitor: Visitor, width: int) -> None:
    page = visitor.open("/catalogue", width)
    table = page.get_by_role("table")
    expect(table.get_by_role("columnheader")).to_have_count(4)
    page.get_by_role("radio", name="Bearing").check(force=True)
    expect(table.get_by_role("columnheader", name=re.compile("^Radial load"))).to_be_visible()
    expect(table.get_by_role("columnheader", name=re.compile("^Rated torque"))).to_be_hidden()
