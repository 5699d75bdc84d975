"""One version, wherever it is said."""

import re
import shlex
import tomllib
from pathlib import Path

from hpn import ENGINE_VERSION
from tests.operations.dockerfile import instructions

ROOT = Path(__file__).parents[2]


def test_package_image_engine_and_changelog_have_the_same_version() -> None:
    package = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    (labels,) = [rest for name, rest in instructions(ROOT / "backend/Dockerfile") if name == "LABEL"]
    image = dict(label.split("=", 1) for label in shlex.split(labels))["org.opencontainers.image.version"]
    newest = re.search(r"^## (\d\S*)$", (ROOT / "CHANGELOG.md").read_text(), re.M)

    assert newest is not None
    assert {package, image, newest[1]} == {ENGINE_VERSION}
