"""docs/licences.md fits the locks, and what it says is known and can be kept."""

import re
from importlib.metadata import PackageNotFoundError, version

import pytest

from tools.supply.licences import WRITTEN, sections
from tools.supply.locks import Package

Sections = dict[str, dict[Package, str]]
TEXT = WRITTEN.read_text()
PERMISSIVE = {
    "0BSD",
    "Apache-2.0",
    "BlueOak-1.0.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "MIT-CMU",
    "OFL-1.1",
    "PSF-2.0",
    "Python-2.0",
    "Zlib",
}
BINDING_ITSELF = {"LGPL-3.0-only", "MPL-2.0"}
"""Licences with duties for the package itself, none for what uses it."""
DEVELOPMENT = {
    "Artistic-1.0-Perl",
    "Classpath-exception-2.0",
    "CNRI-Python",
    "GPL-2.0-only",
    "GPL-2.0-or-later",
    "GPL-3.0-or-later",
}
"""Further licences of what is never handed on."""


@pytest.fixture(scope="module")
def found() -> Sections:
    """Licences by the locks and the packages themselves."""
    return sections()


def listed(title: str) -> dict[Package, str]:
    """Packages of a table with their licences."""
    section = TEXT.partition(f"## {title}\n")[2].partition("\n## ")[0]
    return {
        Package(name, of): licence
        for name, of, licence in re.findall(r"^\| (\S+) \| (\d\S*) \| (.+) \|$", section, re.M)
    }


def names(licence: str) -> set[str]:
    """Licences of an SPDX expression."""
    return set(re.findall(r"[\w.-]+", licence)) - {"AND", "OR", "WITH"}


def test_the_file_fits_the_locks(found: Sections) -> None:
    assert {title: set(listed(title)) for title in found} == {title: set(packages) for title, packages in found.items()}


def test_every_licence_is_known_and_can_be_kept(found: Sections) -> None:
    for title in found:
        allowed = PERMISSIVE | BINDING_ITSELF | (DEVELOPMENT if title.startswith("Development") else set())
        assert {name for licence in listed(title).values() for name in names(licence)} <= allowed


def test_the_licence_is_that_of_the_installed_package(found: Sections) -> None:
    installed = {
        package: licence
        for title in ("The service", "Development only, Python")
        for package, licence in listed(title).items()
        if _is_installed(package)
    }

    assert len(installed) > 100
    assert installed.items() <= (found["The service"] | found["Development only, Python"]).items()


def test_whatever_asks_for_more_than_a_notice_says_how_it_is_met(found: Sections) -> None:
    asking = {
        package.name
        for title in found
        for package, licence in listed(title).items()
        if not names(licence) <= PERMISSIVE
    }
    section = TEXT.partition("## Licences that ask for more than a notice\n")[2].partition("\n## ")[0]

    assert "psycopg" in asking
    assert asking == set(re.findall(r"^\| (\S+) \| .+ \| .+\. \|$", section, re.M))


def _is_installed(package: Package) -> bool:
    try:
        return version(package.name) == package.version
    except PackageNotFoundError:
        return False
