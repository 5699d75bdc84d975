"""Page of the OpenAPI document: needs no other host, and has the headers of every page."""

import json

from playwright.sync_api import expect

from tests.browser.conftest import Visitor
from tests.build import worked_example


def test_the_document_is_a_page_with_every_operation_that_sends_requests(visitor: Visitor) -> None:
    page = visitor.open("/docs")
    expect(page.locator(".opblock").first).to_be_visible()
    paths = page.evaluate("fetch('/openapi.json').then(reply => reply.json()).then(it => it.paths)")
    assert page.locator(".opblock").count() == sum(len(operations) for operations in paths.values())

    operation = page.locator("#operations-Selection-select")

    operation.get_by_role("button").first.click()
    operation.get_by_role("button", name="Try it out").click()
    operation.locator("textarea").fill(json.dumps(worked_example()))
    operation.get_by_role("button", name="Execute").click()

    answer = operation.locator(".live-responses-table")
    expect(answer.get_by_role("cell", name="200").first).to_be_visible()
    expect(answer).to_contain_text("HPN-20A-5")
    expect(page.get_by_role("heading", name="HPN Select")).to_be_visible()
