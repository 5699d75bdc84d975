"""What the tests share: the catalogue as shipped, copies of it to spoil, and supplements over it."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from hpn.catalogue import HANDBOOK_FOLDER, Catalogue, load_catalogue

# Two shared cores: no deadline per example, and as many examples as fit a test run of every commit.
settings.register_profile(
    "hpn", deadline=None, max_examples=60, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("hpn")

Supplement = Callable[..., Catalogue]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Browser tests come last: Playwright's event loop stays in this thread, and no other could run there after it."""
    items.sort(key=lambda item: "playwright_driver" in getattr(item, "fixturenames", ()))


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
