"""Fixtures of all tests: the catalogue as shipped, copies of it to spoil, and supplements over it."""

import gc
import os
import shutil
from collections.abc import Callable, Generator, Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from hpn.catalogue import HANDBOOK_FOLDER, Catalogue, load_catalogue
from tests import last_bits

# Two shared cores: no deadline per example, and as many examples as fit a test run of every commit. The long form draws
# more and others each time, so that it finds what no run before has met.
settings.register_profile(
    "hpn", deadline=None, max_examples=20, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile("soak", parent=settings.get_profile("hpn"), max_examples=600, derandomize=False)

Supplement = Callable[..., Catalogue]

BULK = ("test_fuzz.py",)
"""Files of which `make test` draws a part (`tests/web/conftest.py`) and `make soak` everything."""

LONGEST_FIRST = (
    *("image", "every_version", "stateful", "ties", "fuzz", "package", "hostile_files", "pages", "callers", "costly"),
    *("loop", "run", "contract", "pdf", "serving", "kill", "workers", "submodel", "files", "spool", "load", "lines"),
    *("invariances", "examples", "remedy", "selections_api", "year_later", "outage"),
    *("tools", "reader", "page", "plots"),
)
"""Files that take longest, so that none of them is left alone at the end."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--soak`: the long form of every test that has one, and nothing else (`make soak`)."""
    parser.addoption("--soak", action="store_true", help="the long form of every test that has one, and nothing else")


def pytest_configure(config: pytest.Config) -> None:
    """Draw as many examples as the form of the run asks for; before any test module is imported."""
    settings.load_profile("soak" if config.getoption("--soak") else "hpn")
    _forget_the_settings_of_the_machine()


def _forget_the_settings_of_the_machine() -> None:
    """For this process and whatever it starts; `HPN_TEST_…` are settings of the tests themselves."""
    for name in list(os.environ):
        if name.upper().startswith("HPN_") and not name.startswith("HPN_TEST_"):
            del os.environ[name]


@pytest.fixture(scope="session", autouse=True)
def other_processor() -> Iterator[None]:
    """numpy's functions with other last bits, where `HPN_TEST_LAST_BITS` asks for them."""
    way = os.environ.get("HPN_TEST_LAST_BITS")
    with pytest.MonkeyPatch.context() as patch:
        if way:
            last_bits.moved(patch, last_bits.way_of(way))
        yield


def pytest_report_header(config: pytest.Config) -> str:
    """Form of the tests that runs."""
    return "form: long (--soak)" if config.getoption("--soak") else "form: short; `make soak` runs the long one"


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect without looking for garbage: what is made here stays, and no later look has to go through it."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Keep what belongs to the form of the run, and order it.

    Browser tests come last: Playwright's event loop stays in this thread, and no other could run there after it.
    """
    belongs = _has_long_form if config.getoption("--soak") else _has_short_form
    if others := [item for item in items if not belongs(item)]:
        config.hook.pytest_deselected(items=others)
    items[:] = sorted(filter(belongs, items), key=lambda item: (_needs_browser(item), _place(item)))


def _has_short_form(item: pytest.Item) -> bool:
    return item.get_closest_marker("soak") is None


def _has_long_form(item: pytest.Item) -> bool:
    """True for a test with a long form: it is marked, takes the fixture `soak`, or draws examples."""
    asks = "soak" in getattr(item, "fixturenames", ())
    draws = getattr(getattr(item, "function", None), "is_hypothesis_test", False)
    return asks or draws or not _has_short_form(item) or item.path.name in BULK


def _needs_browser(item: pytest.Item) -> bool:
    return "playwright_driver" in getattr(item, "fixturenames", ())


def _place(item: pytest.Item) -> int:
    name = item.path.stem.removeprefix("test_")
    return LONGEST_FIRST.index(name) if name in LONGEST_FIRST else len(LONGEST_FIRST)


@pytest.fixture(scope="session")
def soak(pytestconfig: pytest.Config) -> bool:
    """True for the long form: a test that is long by nature takes its numbers from this."""
    return bool(pytestconfig.getoption("--soak"))


@pytest.fixture(scope="session")
def catalogue() -> Catalogue:
    """The catalogue as shipped, without a supplement."""
    return load_catalogue()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A copy of the shipped catalogue folder, to be changed by the test."""
    return Path(shutil.copytree(HANDBOOK_FOLDER, tmp_path / "catalogue"))


@pytest.fixture
def supplemented(tmp_path: Path) -> Supplement:
    """Loads the shipped catalogue under supplement files, given as file stem = content."""

    def load(**files: str) -> Catalogue:
        place = tmp_path / "supplement"
        place.mkdir(exist_ok=True)
        for stem, content in files.items():
            (place / f"{stem}.csv").write_text(content, encoding="utf-8")
        return load_catalogue(supplement=place)

    return load
