"""Answers and saved selections on paper."""

import io
import re

import pypdfium2
import pytest
from playwright.sync_api import Page, expect
from pypdf import PdfReader

from tests.browser.conftest import (
    Visitor,
    reader_menu,
)

EXAMPLE = "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
PHASES = (("40", "250", "0.3"), ("32", "500", "3"), ("20", "250", "0.4"))


@pytest.mark.parametrize(("units", "size"), [("Metric (SI)", (595, 842)), ("US customary", (612, 792))])
def test_answer_prints_on_one_page_of_the_readers_paper(visitor: Visitor, units: str, size: tuple[int, int]) -> None:
    page = visitor.open(EXAMPLE)
    reader_menu(page).click()
    with page.expect_navigation():
        page.get_by_role("button", name=units).click()
    (sheet,) = PdfReader(io.BytesIO(page.pdf(prefer_css_page_size=True))).pages
    assert (round(sheet.mediabox.width), round(sheet.mediabox.height)) == size


def printed(page: Page) -> list[str]:
    """Texts of a page's printed sheets."""
    sheets = pypdfium2.PdfDocument(page.pdf(prefer_css_page_size=True))
    return [" ".join(sheet.get_textpage().get_text_range().split()) for sheet in sheets]


def test_saved_selection_prints_its_candidates(visitor: Visitor) -> None:
    page = visitor.open(EXAMPLE)
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page).to_have_url(re.compile("/selections/"))
    page.emulate_media(media="print")
    candidates = page.get_by_role("table", name="Suitable")
    expect(candidates.get_by_role("row", name=re.compile("HPN-20A-5"))).to_be_visible()
    text = "".join(printed(page)).replace(" ", "")  # Chromium prints single letters, some far apart
    listed = text[text.index("Candidates") :]
    assert listed.index("HPN-32A-5") < listed.index("HPN-14A-5")


@pytest.mark.parametrize("units", ["Metric (SI)", "US customary"])
@pytest.mark.parametrize("more", ["&i=5", "", "&FR=500&FA=200&fw=1.2"], ids=["one ratio", "every ratio", "loads"])
def test_the_worked_example_as_saved_takes_three_sheets_with_running_heads(
    visitor: Visitor, units: str, more: str
) -> None:
    page = visitor.open(EXAMPLE.replace("&i=5", more))
    page.get_by_text("Title block").click()
    page.get_by_label("Title", exact=True).fill('Infeed "turret" \\ C')
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page).to_have_url(re.compile("/selections/"))
    reader_menu(page).click()
    with page.expect_navigation():
        page.get_by_role("button", name=units).click()
    texts = [text.replace(" ", "") for text in printed(page)]  # kerned letters read as separate
    assert len(texts) <= 3, texts[-1][:600]
    for number, text in enumerate(texts, 1):
        assert text.startswith(f'Infeed"turret"\\C{number}/{len(texts)}')
    whole = "".join(texts)
    assert whole.count("axialloadin") == 1, "the envelope stands once"
    assert "Checked" in texts[0] and "Approved" in texts[0] and page.url in whole
    assert texts[0].index("Checked") < texts[0].index("Inputassaved"), "the title block comes first"
    assert "▾" not in whole and "2more" not in whole
    page.emulate_media(media="print")
    code = page.locator(".address svg").bounding_box()
    assert code and code["width"] == code["height"] > 50, "a code leads to the address"


@pytest.mark.parametrize(
    ("path", "first"), [("/catalogue", "HPN-11A-4"), ("/catalogue/HPN-20A-5", "Repeated peak torque")]
)
def test_a_table_begins_on_the_first_sheet_without_anything_to_press(visitor: Visitor, path: str, first: str) -> None:
    page = visitor.open(path)
    texts = printed(page)
    assert len(texts) <= 2 and first in texts[0]
    page.emulate_media(media="print")
    assert page.get_by_role("link", name="Use in selection").or_(page.get_by_role("button")).count() == 0
