"""Files and tests that SECURITY.md and docs/resilience.md name exist."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAPERS = [ROOT / "SECURITY.md", ROOT / "docs" / "resilience.md"]


@pytest.mark.parametrize("paper", PAPERS, ids=lambda path: path.name)
def test_every_test_and_target_that_a_paper_names_exists(paper: Path) -> None:
    text = paper.read_text()
    named = set(re.findall(r"`(?:tests/)?([a-z]+/(?:test_\w+)?)(?:\.py)?`", text)) - {"tests/"}
    targets = set(re.findall(r"`make (\w+)", text))

    assert named and targets
    assert {name for name in named if not [*(ROOT / "tests").glob(f"{name.rstrip('/')}*")]} == set()
    assert targets <= set(re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(), re.M))


def test_the_readme_leads_to_the_papers() -> None:
    readme = (ROOT / "README.md").read_text()

    assert [paper.name for paper in PAPERS if paper.name not in readme] == []


@pytest.mark.parametrize("paper", [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")], ids=lambda path: path.name)
def test_no_paper_holds_two_versions_of_a_merge(paper: Path) -> None:
    assert not re.search(r"^(<{7}|={7}|>{7})( |$)", paper.read_text(), re.M)
