"""Journey from a rejected gear by its "Try it" to the same gear, which then passes."""

import random

from playwright.sync_api import expect

from hpn.catalogue import Catalogue
from hpn.links.writer import to_link
from tests.browser.conftest import Visitor
from tests.browser.test_page import selected
from tests.property.test_tried import rejected


def test_try_it_ends_on_the_same_gear_that_passes(visitor: Visitor, catalogue: Catalogue, soak: bool) -> None:
    result = rejected(random.Random(19), catalogue)
    page = visitor.open("/")
    for application, candidate in (next(result) for _ in range(300 if soak else 3)):
        page.goto(f"{visitor.server}{to_link(application)}&gear={candidate.designation}")
        ways = page.locator(".fix").get_by_role("link", name="Try it")
        for way in range(ways.count()):
            ways.nth(way).click()
            expect(selected(page)).to_contain_text(candidate.designation)
            expect(selected(page)).to_contain_text("✓ suitable")
            page.get_by_role("button", name="Undo").click()
            expect(selected(page)).to_contain_text("not suitable")
