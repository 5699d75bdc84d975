"""Every page checked by axe, with rules that it omits by default, and targets for a finger."""

import httpx
import pytest
from playwright.sync_api import Page

from tests.browser.conftest import Visitor, show_all_sections, violations
from tests.build import worked_example

FULL = (
    "/?T=40&n=250&t=0.3&FRi=500&T=32&n=500&t=3&FRi=&T=20&n=250&t=0.4&FRi=700&tp=4&Tk=200&i=5&FR=500&fw=1.2&Lh=20000"
    "&nm=4000&Tm=20&gear=HPN-14A-5&pin=HPN-20A-5"
)
PAGES = (
    "/",
    FULL,
    "/?mech=rotary&J=0.8&mv=trapezoidal&ms=90&mt=0.8&Jm=0.0002&Tm=8&i=5&i=15#drive",
    "/?T=9,3&n=&t=1",
    "/?T=&n=&t=",
    "/?T=" + "1" * 61_000,
    "/paste",
    "/catalogue",
    "/catalogue?size=20A",
    "/catalogue/HPN-20A-5",
    "/catalogue/HPN-40A-5",
    "/catalogue/HPN-99A-5",
    "/selections",
    "/selections?reference=none",
    "/selections?reference=%07",
    "/selections/nothing",
    "/nowhere",
    "SAVED",
    "SAVED/delete",
    "/selections/compare?a=ID&b=ID",
    "/checks/average_torque",
    "/machines",
    "/machines?show=todo",
    "/motor-lists",
    "/motor-lists/nothing",
    "/pairs",
    "/pairs?T=40&n=250&t=0.3",
)
SHORT = (FULL, "/paste", "/catalogue?size=20A", "/catalogue/HPN-20A-5", "/selections", "/nowhere")

MAIN = ".masthead nav *, .reader > .link, .field :is(input, select), .duty input, .quiet, .primary, summary, .filter a"
LEAST_PX, TOUCH_PX = 24, 44
TOO_SMALL = """([main, least, touch]) => [...document.querySelectorAll(main + ', .icon')].map(
  element => [element.innerText || element.id, element.getBoundingClientRect(), element.matches('.icon')]
).filter(([name, box, icon]) => box.width && (box.height < touch - 0.5 || box.width < least)).map(([name]) => name)"""


@pytest.fixture(scope="module")
def saved(server: str) -> str:
    """Path of a saved selection."""
    body = {"application": worked_example(), "title": "Axis 7", "reference": "4711"}
    return str(httpx.post(f"{server}/api/v1/selections", json=body, trust_env=False).json()["url"])


def unfolded(visitor: Visitor, path: str, width: int, *, touch: bool = False) -> Page:
    """Page with everything unfolded."""
    page = visitor.open(path, width, touch=touch)
    if width < 600:
        show_all_sections(page)
    page.evaluate("document.querySelectorAll('details').forEach(part => { part.open = true })")
    page.wait_for_load_state("networkidle")
    for watch in visitor.watches:  # the browser reports pages that are refused or not found
        watch.console = [text for text in watch.console if "responded with a status of 4" not in text]
    return page


@pytest.mark.parametrize("path", SHORT)
def test_every_target_of_a_finger_is_big_enough_and_called_what_it_shows(
    visitor: Visitor, saved: str, path: str
) -> None:
    page = unfolded(visitor, path, 390, touch=True)

    assert violations(page) == []
    assert page.evaluate(TOO_SMALL, [MAIN, LEAST_PX, TOUCH_PX]) == []


@pytest.mark.soak
@pytest.mark.parametrize("width", [390, 1440])
@pytest.mark.parametrize("path", PAGES, ids=lambda path: path[:40])
def test_axe_finds_nothing_on_any_page_with_these_rules_too(
    visitor: Visitor, saved: str, path: str, width: int
) -> None:
    page = unfolded(
        visitor, path.replace("SAVED", saved).replace("ID", saved.rpartition("/")[2]), width, touch=width == 390
    )

    assert violations(page) == []
    assert width == 1440 or page.evaluate(TOO_SMALL, [MAIN, LEAST_PX, TOUCH_PX]) == []
