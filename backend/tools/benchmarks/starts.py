"""Starts: the first start after the install, the commands, and the size of an installed environment on the disk."""

import shutil
import statistics
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from tools.benchmarks.applications import FIVE, select_body
from tools.benchmarks.turns import in_turns, ratios
from tools.benchmarks.variants import Checkout, clean_environment, product

STARTS = 2
COMMANDS = 3


def commands(checkouts: Mapping[str, Checkout], folder: Path) -> dict[str, Any]:
    """Seconds of `hpn --help` and of `hpn select` with a file."""
    file = folder / "application.json"
    file.write_bytes(select_body(0, FIVE))
    given = {"help": ["--help"], "select": ["select", str(file)]}
    return {name: _timed(checkouts, words, folder) for name, words in given.items()}


def _timed(checkouts: Mapping[str, Checkout], words: Sequence[str], folder: Path) -> dict[str, Any]:
    def turn_of(checkout: Checkout) -> Callable[[int], float]:
        return lambda turn: _seconds([checkout.hpn, *words], folder)

    return _summary(in_turns({name: turn_of(checkout) for name, checkout in checkouts.items()}, COMMANDS))


def _seconds(command: Sequence[str], folder: Path) -> float:
    start = time.perf_counter()
    subprocess.run(command, cwd=folder, env=clean_environment(), check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start


def first_starts(checkouts: Mapping[str, Checkout], folder: Path) -> dict[str, Any]:
    """Seconds of `hpn serve` in a fresh clone until its page answers, and megabytes of the clone's packages.

    The clone is of the last commit. Files that an earlier start left beside its code are deleted; packages stay as they
    were installed.
    """
    clones = {name: _installed_clone(checkout, folder / name) for name, checkout in checkouts.items()}

    def turn_of(clone: Checkout) -> Callable[[int], float]:
        return lambda turn: _first_start(clone, folder)

    found = in_turns({name: turn_of(clone) for name, clone in clones.items()}, STARTS, warm_up=False)
    megabytes = {name: [_packages_MB(clone)] for name, clone in clones.items()}
    return {"first_start": _summary(found), "packages_MB": _of_packages(megabytes)}


def _installed_clone(checkout: Checkout, place: Path) -> Checkout:
    """Clone with the run-time packages only."""
    subprocess.run(["git", "clone", "--quiet", checkout.folder, place], check=True)
    subprocess.run(["make", "--silent", "install"], cwd=place, env=clean_environment(), check=True, capture_output=True)
    return Checkout(checkout.name, place)


def _first_start(clone: Checkout, folder: Path) -> float:
    for cache in list((clone.folder / "backend").rglob("__pycache__")):
        shutil.rmtree(cache)
    start = time.perf_counter()
    with product(clone, folder):
        return time.perf_counter() - start


def _packages_MB(clone: Checkout) -> float:
    (packages,) = clone.folder.glob(".venv/lib/python*/site-packages")
    files = (path for path in packages.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return sum(path.stat().st_size for path in files) / 1e6


def _of_packages(megabytes: Mapping[str, Sequence[float]]) -> dict[str, Any]:
    return {**{name: round(values[0]) for name, values in megabytes.items()}, "ratios": ratios(megabytes)}


def _summary(seconds: Mapping[str, Sequence[float]]) -> dict[str, Any]:
    medians = {f"{name}_s": round(statistics.median(values), 3) for name, values in seconds.items()}
    return {**medians, "ratios": ratios(seconds)}
