"""Packages of the locks."""

import json
import re
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[3]
RUN_LOCK = ROOT / "requirements.lock"
DEVELOPMENT_LOCKS = tuple(ROOT / f"requirements-{name}.lock" for name in ("dev", "build", "node"))
PAGE = ROOT / "frontend"
ENTRY = re.compile(r"^([\w.-]+)==(\S+)[^\\]*\\\n((?: +--hash=.*\n)+)", re.M)


class Package(NamedTuple):
    """Package of a lock; a name may occur twice, for older and newer versions of Python."""

    name: str
    version: str
    hashes: str = ""


def python(lock: Path) -> list[Package]:
    """Packages of a requirements lock, for all machines."""
    text = lock.read_text()
    packages = [Package(*entry) for entry in ENTRY.findall(text)]
    assert len(packages) == len(re.findall(r"^\w", text, re.M)), (
        f"{lock.name} is written in another way than this reads"
    )
    return packages


def page() -> dict[str, dict[str, Any]]:
    """Packages of the page's lock, by their folders."""
    packages: dict[str, dict[str, Any]] = json.loads((PAGE / "package-lock.json").read_text())["packages"]
    return {folder: package for folder, package in packages.items() if folder}
