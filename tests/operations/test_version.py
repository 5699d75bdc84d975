"""One version, wherever it is said."""

import re
import tomllib
from pathlib import Path

from hpn import ENGINE_VERSION

ROOT = Path(__file__).parents[2]


def test_package_engine_and_changelog_have_the_same_version() -> None:
    package = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    newest = re.search(r"^## (\d\S*)$", (ROOT / "CHANGELOG.md").read_text(), re.M)

    assert newest is not None
    assert (package, newest[1]) == (ENGINE_VERSION, ENGINE_VERSION)
