"""Edits on the page in real Chromium: time from the key press to the settled result, and the server's share of it.

A result is settled two frames after the last swap due to the key press; so the page's wait for a next key counts.
"""

import shutil
import statistics
from collections.abc import Callable, Mapping
from typing import Any

from playwright.sync_api import Browser, Page, sync_playwright

from tools.benchmarks.turns import in_turns, p95, ratios
from tools.benchmarks.variants import Server

EDITS = 8
TURNS = 7
QUIET_MS = 60
"""Milliseconds without an open request and without another swap before an edit counts as settled."""

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
OFFLINE = "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1 , EXCLUDE localhost"
ALL = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200"
PAGES = {"5_gears": "/", "64_gears": ALL, "64_gears_loaded": f"{ALL}&FR=500&FA=200"}

WATCH = """quiet => {
  performance.setResourceTimingBufferSize(10000);
  const edit = window.edit = {under_way: 0, pressed: 0, settled: 0};
  const fetched = window.fetch;
  window.fetch = (...given) => {
    edit.under_way += 1;
    return fetched(...given).finally(() => (edit.under_way -= 1));
  };
  document.addEventListener("keydown", (event) => {
    const requests = performance.getEntriesByType("resource").length;
    Object.assign(edit, {pressed: event.timeStamp, settled: 0, requests});
  }, true);
  document.addEventListener("htmx:after:swap", () => {
    requestAnimationFrame(() => requestAnimationFrame(() => (edit.settled = performance.now())));
  });
  edit.isSettled = () => edit.settled && !edit.under_way && performance.now() - edit.settled > quiet;
}"""
OUTCOME = """() => {
  const requests = performance.getEntriesByType("resource").slice(edit.requests);
  const fetched = requests.filter((entry) => entry.initiatorType === "fetch");
  return [edit.settled - edit.pressed,
          fetched.reduce((sum, entry) => sum + entry.responseStart - entry.requestStart, 0)];
}"""

Edits = list[tuple[float, float]]


def measure(servers: Mapping[str, Server]) -> dict[str, Any]:
    """Milliseconds by number of gears: from key press to settled, and the part until the server begins to answer."""
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=[OFFLINE])
        try:
            return {name: _compare(browser, servers, query) for name, query in PAGES.items()}
        finally:
            browser.close()


def _compare(browser: Browser, servers: Mapping[str, Server], query: str) -> dict[str, Any]:
    def turn_of(page: Page) -> Callable[[int], Edits]:
        return lambda turn: [_edit(page, turn * EDITS + number) for number in range(EDITS)]

    pages = {name: _open(browser, server.address + query) for name, server in servers.items()}
    found = in_turns({name: turn_of(page) for name, page in pages.items()}, TURNS)
    for page in pages.values():
        page.close()
    settled = {name: [[total for total, _ in turn] for turn in turns] for name, turns in found.items()}
    return {
        **{name: _summary([edit for turn in turns for edit in turn]) for name, turns in found.items()},
        "median_ratios": ratios({name: list(map(statistics.median, turns)) for name, turns in settled.items()}),
        "p95_ratios": ratios({name: list(map(p95, turns)) for name, turns in settled.items()}),
    }


def _open(browser: Browser, address: str) -> Page:
    page = browser.new_page(viewport={"width": 1440, "height": 900})
    page.goto(address, wait_until="networkidle")
    page.evaluate(WATCH, QUIET_MS)
    return page


def _edit(page: Page, number: int) -> tuple[float, float]:
    """Times of one key press, which overwrites the last digit of a torque with another one each time."""
    page.bring_to_front()
    field = page.locator('[name="T"]').nth(1)
    field.focus()
    field.evaluate("field => field.setSelectionRange(field.value.length - 1, field.value.length)")
    page.keyboard.press(str(number % 9 + 1))
    page.wait_for_function("() => edit.isSettled()", polling=20, timeout=20_000)
    total, server = page.evaluate(OUTCOME)
    return total, server


def _summary(edits: Edits) -> dict[str, Any]:
    totals, servers = [total for total, _ in edits], [server for _, server in edits]
    return {
        "edits": len(edits),
        "settled_ms": {"median": round(statistics.median(totals), 1), "p95": round(p95(totals), 1)},
        "server_ms": {"median": round(statistics.median(servers), 1), "p95": round(p95(servers), 1)},
        "server_share": round(statistics.median(server / total for total, server in edits), 3),
    }
