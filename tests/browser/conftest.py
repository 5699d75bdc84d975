"""A real server and a real Chromium, started once for all browser tests."""

import os
import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from urllib.request import urlopen

import pytest
from playwright.sync_api import Browser, BrowserContext, Locator, Page, Playwright, expect, sync_playwright

AXE = Path(__file__).parents[2] / "frontend/node_modules/axe-core/axe.min.js"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
SHELL = "chromium-headless-shell"
"""Chromium's engine without windows, at half the processor time; the long form and Lighthouse use full Chromium."""
# The browser resolves no host outside this machine.
OFFLINE = "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1 , EXCLUDE localhost"
PATIENCE_S = int(os.environ.get("HPN_TEST_PATIENCE_S", "60"))
"""Time limit of a wait, ample for a busy machine; only a failure takes that long."""
expect.set_options(timeout=1000 * PATIENCE_S)


SERVE = """import socket, sys, uvicorn
uvicorn.Server(uvicorn.Config("hpn.web.app:create_app", factory=True)).run([socket.socket(fileno=int(sys.argv[1]))])"""


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a running service."""
    folder = tmp_path_factory.mktemp("server")
    log = folder / "log"
    with socket.create_server(("127.0.0.1", 0)) as listener, log.open("w") as output:
        port, descriptor = listener.getsockname()[1], listener.fileno()
        environment = {
            "HPN_DATABASE_URL": f"sqlite:///{folder}/selections.sqlite3",
            "HPN_CORS_ORIGINS": f"http://localhost:{port}",  # another origin than 127.0.0.1
        }
        process = subprocess.Popen(
            # uvicorn's own --fd delays each answer by 40 ms: it takes a TCP socket for a Unix one
            [sys.executable, "-c", SERVE, str(descriptor)],
            pass_fds=[descriptor],
            stdout=output,
            stderr=subprocess.STDOUT,
            env=os.environ | environment,
        )
    try:
        _wait_for(f"http://127.0.0.1:{port}/healthz", process, log)
        yield f"http://127.0.0.1:{port}"
    finally:
        process.terminate()
        process.wait(PATIENCE_S)


def _wait_for(address: str, process: subprocess.Popen[bytes], log: Path) -> None:
    for _ in range(5 * PATIENCE_S):
        if process.poll() is not None:
            break
        try:
            with urlopen(address):
                return
        except OSError:
            time.sleep(0.2)
    raise RuntimeError(f"the server did not start:\n{log.read_text()}")


@pytest.fixture(scope="session")
def playwright_driver() -> Iterator[Playwright]:
    """Playwright's driver process."""
    with sync_playwright() as driver:
        yield driver


@pytest.fixture(scope="session")
def chromium(playwright_driver: Playwright, soak: bool) -> Iterator[Browser]:
    """Chromium of the machine, else Playwright's own."""
    names = BROWSERS if soak else (SHELL, *BROWSERS)
    path = next(filter(None, map(shutil.which, names)), None)
    browser = playwright_driver.chromium.launch(executable_path=path, args=[OFFLINE])
    yield browser
    browser.close()


class Watch:
    """Errors and warnings that a page logged, and its requests to other hosts."""

    def __init__(self, page: Page, server: str) -> None:
        self.console: list[str] = []
        self.strangers: list[str] = []
        home = urlsplit(server).netloc
        page.on("console", lambda m: self.console.append(m.text) if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: self.console.append(str(error)))
        page.on("request", lambda r: self.strangers.append(r.url) if urlsplit(r.url).netloc not in (home, "") else None)


class Visitor:
    """Opens pages of the service, each in its own context, and watches them."""

    def __init__(self, browser: Browser, server: str) -> None:
        self.browser, self.server = browser, server
        self.contexts: list[BrowserContext] = []
        self.watches: list[Watch] = []

    def open(
        self, path: str = "/", width: int = 1440, *, script: bool = True, dark: bool = False, touch: bool = False
    ) -> Page:
        """Page at a path, in a viewport of a width."""
        context = self.browser.new_context(
            viewport={"width": width, "height": 844 if width < 600 else 900},
            java_script_enabled=script,
            color_scheme="dark" if dark else "light",
            has_touch=touch,
            is_mobile=touch,
        )
        context.set_default_timeout(1000 * PATIENCE_S)
        self.contexts.append(context)
        page = context.new_page()
        self.watches.append(Watch(page, self.server))
        page.goto(self.server + path)
        return page

    def close(self) -> None:
        """End all contexts."""
        for context in self.contexts:
            context.close()


@pytest.fixture
def visitor(chromium: Browser, server: str) -> Iterator[Visitor]:
    """Visitor whose pages must neither log errors or warnings nor send requests to other hosts.

    Messages on status 422 are allowed: Chromium reports every 422, and tests on errors expect them.
    """
    visitor = Visitor(chromium, server)
    yield visitor
    complaints = [text for watch in visitor.watches for text in watch.console if "status of 422" not in text]
    strangers = [url for watch in visitor.watches for url in watch.strangers]
    visitor.close()
    assert complaints == []
    assert strangers == []


def open_section(page: Page, name: str) -> None:
    """Show a section of the result."""
    page.get_by_role("navigation", name="Sections of the result").get_by_role("link", name=name).click()


def show_all_sections(page: Page) -> None:
    """Show all sections of the result with their content, one below the other, as without script."""
    page.evaluate("delete document.querySelector('main').dataset.section")
    page.wait_for_function(
        "[...document.querySelectorAll('section[data-part]')].every(part => part.childElementCount > 1)"
    )


def torque(page: Page, phase: int) -> Locator:
    """Field of the torque of a phase, counted from 1."""
    return page.get_by_label(f"Torque, phase {phase}")


def pause(page: Page) -> Locator:
    """Field of the pause."""
    return page.get_by_role("textbox", name="Pause")


def edit_row(page: Page, number: int, does: str, row: str = "Phase") -> None:
    """Press a button in the menu of a row, counted from 1: Move up, Move down or Remove."""
    menu = page.get_by_role("button", name=f"{row} {number}:")
    menu.click()
    page.get_by_role("group", name=f"{row} {number}:").get_by_role("button", name=does).click()


def button(page: Page, name: str) -> Locator:
    """Button of exactly this name."""
    return page.get_by_role("button", name=name, exact=True)


ASKED_FOR = {rule: {"enabled": True} for rule in ("target-size", "label-content-name-mismatch")}
"""Rules for WCAG 2.5.8 and 2.5.3, which axe runs only on request."""


def reader_menu(page: Page) -> Locator:
    """Button of the menu of language and units."""
    return page.get_by_role("button", name=re.compile("^(Language and units|Sprache und Einheiten)"))


def in_german(page: Page) -> None:
    """Turn a page into German."""
    reader_menu(page).click()
    page.get_by_role("button", name="Deutsch").click()
    expect(page.locator("html")).to_have_attribute("lang", "de")
    page.wait_for_load_state()


Violations = list[tuple[str, list[str]]]
"""Rule and elements of each violation that axe finds."""


def violations(page: Page) -> Violations:
    """Violations in both themes; only contrast depends on the theme."""
    page.evaluate(AXE.read_text())
    # The bar at the foot covers content that is scrolled under it, possibly part of a field.
    page.evaluate("document.querySelectorAll('.jump').forEach(bar => { bar.style.position = 'static' })")
    found = _axe(page, {"rules": ASKED_FOR})
    page.emulate_media(color_scheme="dark")
    return found + _axe(page, {"runOnly": ["color-contrast"]})


def violations_in_forced_colours(page: Page) -> Violations:
    """Violations on a page that `violations` has seen; its contrast is then the system's."""
    page.emulate_media(forced_colors="active")
    return _axe(page, {"rules": ASKED_FOR | {"color-contrast": {"enabled": False}}})


def _axe(page: Page, options: dict[str, Any]) -> Violations:
    found = page.evaluate("options => axe.run({ ...options, resultTypes: ['violations'] })", options)["violations"]
    return [(entry["id"], [node["html"] for node in entry["nodes"]]) for entry in found]


# Chromium begins to intercept requests with a delay, so a test holds them back in the page.
HOLD = """() => {
  const send = window.fetch;
  const released = new Promise((release) => {
    window.release = () => { window.fetch = send; release(); };
  });
  window.fetch = (...asked) => Promise.all([send(...asked), released]).then(([answer]) => answer);
}"""


@contextmanager
def answer_held_back(page: Page, after: Callable[[], None], address: str = "**/?*") -> Iterator[None]:
    """Hold the answer to the request that `after` leads to until the block ends."""
    page.evaluate(HOLD)
    with page.expect_request(address):
        after()
    yield
    page.evaluate("release()")
