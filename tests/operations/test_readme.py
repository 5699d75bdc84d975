"""README and docs leave out no address of the service, no folder and no page; their links lead somewhere."""

import re
from pathlib import Path

from hpn.web.app import create_app

ROOT = Path(__file__).parents[2]


def section(title: str) -> str:
    """Text of the README under a title."""
    return (ROOT / "README.md").read_text().partition(f"\n## {title}\n")[2].partition("\n## ")[0]


def test_every_address_of_the_api_is_listed() -> None:
    # one in full, or those that differ by their last name behind one in full
    listed = re.findall(r"`(?:[A-Z]+ )?([^` ]+)`", (ROOT / "docs/rest.md").read_text())
    missing = [path for path in create_app().openapi()["paths"] if not {path, path.rpartition("/")[2]} & set(listed)]

    assert missing == []


def test_every_folder_is_listed() -> None:
    listed = section("The folders")
    folders = [path for place in ("tests", "docs") for path in (ROOT / place).iterdir() if path.is_dir()]

    assert [path.name for path in folders if path.name[0] not in "._" and path.name not in listed] == []


def test_the_readme_is_short_and_leads_to_every_page() -> None:
    text = (ROOT / "README.md").read_text()
    pages = {f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md")}

    assert len(text.splitlines()) <= 120
    assert pages - set(re.findall(r"\]\(([^)#]+)\)", text)) == set()


def test_links_between_the_papers_lead_to_files() -> None:
    for paper in (ROOT / "README.md", *(ROOT / "docs").glob("*.md")):
        for link in re.findall(r"\]\(([^):#]+)\)", paper.read_text()):
            assert (paper.parent / link).exists(), (paper.name, link)
