"""From a keystroke to the settled result in real Chromium, beyond the debounce, and the server's share of it."""

import shutil
import statistics
from typing import Any

from playwright.sync_api import Page, sync_playwright

from tests.benchmarks.server import SERVICE, serving

EDITS = 200
DEBOUNCE_MS = 120
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
OFFLINE = "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1 , EXCLUDE localhost"
EVERY_GEAR = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200"

WATCH = """() => {
  window.settled = [];
  document.addEventListener("input", () => (window.started = performance.now()), true);
  document.addEventListener("htmx:after:swap", () => {
    requestAnimationFrame(() => requestAnimationFrame(() => window.settled.push(performance.now() - window.started)));
  });
}"""
SERVER = """() => performance.getEntriesByType("resource").filter((entry) => entry.initiatorType === "fetch")
  .map((entry) => entry.responseEnd - entry.requestStart)"""


def measure() -> dict[str, Any]:
    """Milliseconds over 200 edits, with five candidates and with every gear."""
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    with serving(SERVICE) as server, sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=[OFFLINE])
        address = f"http://127.0.0.1:{server.port}"
        try:
            return {
                name: _edits(browser.new_page(viewport={"width": 1440, "height": 900}), address + query)
                for name, query in {"worked_example_5_gears": "/", "every_gear_64": EVERY_GEAR}.items()
            }
        finally:
            browser.close()


def _edits(page: Page, address: str) -> dict[str, Any]:
    page.goto(address)
    page.evaluate("() => performance.setResourceTimingBufferSize(5000)")
    page.evaluate(WATCH)
    field = page.locator('[name="T"]').nth(1)
    field.focus()
    for edit in range(EDITS):
        # One keystroke at a time: the last digit is written over, each time with another.
        field.evaluate("field => field.setSelectionRange(field.value.length - 1, field.value.length)")
        page.keyboard.press(str((edit + 1) % 9 + 1))
        page.wait_for_function("count => window.settled.length >= count", arg=edit + 1, polling=5, timeout=20_000)
    total = [value - DEBOUNCE_MS for value in page.evaluate("() => window.settled")]
    server = page.evaluate(SERVER)
    return {
        "edits": len(total),
        "settled_ms": {"median": round(statistics.median(total), 1), "p95": _p95(total)},
        "server_ms": {"median": round(statistics.median(server), 1), "p95": _p95(server)},
    }


def _p95(values: list[float]) -> float:
    return round(statistics.quantiles(values, n=20)[-1], 1)
