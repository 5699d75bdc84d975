"""Lighthouse on the served page, with the desktop and mobile presets."""

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.browser.conftest import BROWSERS, OFFLINE

LIGHTHOUSE = Path(__file__).parents[2] / "frontend/node_modules/lighthouse/cli/index.js"
NODE = Path(__file__).parents[2] / ".venv/node/bin"
PERFORMANCE = {"desktop": 100, "mobile": 95}
SHORT = {("/", "mobile")}
"""Audit of `make test`: the start page with the slower preset. `make soak` audits all pages with both."""

PAGES = ("/", "/catalogue", "/catalogue/HPN-20A-5")
"""Pages for search engines; the others forbid indexing, which Lighthouse counts as a fault."""

TRIES = 4
"""Number of tries, of which the best counts: other work on the machine can only lower the performance score."""


@pytest.mark.parametrize(
    ("path", "preset"),
    [
        pytest.param(path, preset, marks=() if (path, preset) in SHORT else pytest.mark.soak)
        for path in PAGES
        for preset in PERFORMANCE
    ],
)
def test_lighthouse_finds_the_page_fast_accessible_and_sound(
    server: str, tmp_path: Path, preset: str, path: str
) -> None:
    best = 0
    for _ in range(TRIES):
        scores = _audit(server + path, preset, tmp_path)
        if not scores:
            continue
        best = max(best, scores.pop("performance"))
        assert scores == {"accessibility": 100, "best-practices": 100, "seo": 100}
        if best >= PERFORMANCE[preset]:
            return
    assert best >= PERFORMANCE[preset]


def _audit(address: str, preset: str, folder: Path) -> dict[str, int]:
    """Scores by category; empty if the browser lost its trace, as happens on a busy machine: run it again."""
    report = folder / "report.json"
    command = [
        shutil.which("node", path=f"{NODE}{os.pathsep}{os.environ['PATH']}") or "node",
        str(LIGHTHOUSE),
        address,
        *(["--preset=desktop"] if preset == "desktop" else []),
        "--only-categories=performance,accessibility,best-practices,seo",
        "--output=json",
        f"--output-path={report}",
        "--quiet",
        f"--chrome-flags=--headless=new --no-sandbox '{OFFLINE}'",
    ]
    chrome = {"CHROME_PATH": path} if (path := next(filter(None, map(shutil.which, BROWSERS)), None)) else {}
    if subprocess.run(command, env={**os.environ, **chrome}, timeout=180).returncode:
        return {}
    categories: dict[str, Any] = json.loads(report.read_text())["categories"]
    return {name: round(100 * category["score"]) for name, category in categories.items()}
