"""`make screenshots`: pictures of the page's main states for the docs, from the real service in real Chromium."""

import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Browser, sync_playwright

from tools.benchmarks.variants import HERE, Checkout, product

FOLDER = Path("docs/screenshots")
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
OFFLINE = "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1 , EXCLUDE localhost"
EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
LOADED = EXAMPLE + "&FR=500&FA=200&fw=1.2"


@dataclass(frozen=True)
class Screen:
    """State of the page, and the browser that shows it."""

    name: str
    path: str
    width: int = 1440
    dark: bool = False
    language: str = "en"


STATES = (
    Screen("answer-1440-light", "/"),
    Screen("rejected-1440-light", EXAMPLE + "&gear=HPN-14A-5"),
    Screen("bearing-1440-light", LOADED + "#bearing"),
    Screen("german-1440-dark", "/", dark=True, language="de"),
    Screen("answer-390-light", "/", width=390),
)


def main() -> None:
    """Take all pictures anew."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    with (
        tempfile.TemporaryDirectory() as folder,
        product(Checkout("here", HERE), Path(folder)) as server,
        sync_playwright() as driver,
    ):
        browser = driver.chromium.launch(executable_path=path, args=[OFFLINE])
        for state in STATES:
            _take(browser, server.address, state)
        browser.close()


def _take(browser: Browser, address: str, state: Screen) -> None:
    context = browser.new_context(
        viewport={"width": state.width, "height": 844 if state.width < 600 else 900},
        color_scheme="dark" if state.dark else "light",
        locale=state.language,
        reduced_motion="reduce",
    )
    page = context.new_page()
    page.goto(address + state.path, wait_until="networkidle")
    page.screenshot(path=FOLDER / f"{state.name}.png")
    context.close()


if __name__ == "__main__":
    main()
