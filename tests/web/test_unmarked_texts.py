"""Pages in a made-up language with different letters: a text with plain letters is not marked for translation."""

import re
from collections.abc import Iterator
from gettext import NullTranslations
from html.parser import HTMLParser

import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.words import reader

EVERYTHING = (
    "/?T=40&n=250&t=0.3&FRi=500&FAi=200&T=32&n=500&t=3&FRi=&FAi=&T=20&n=250&t=0.4&FRi=&FAi=&tp=4&Tk=200&Nk=1000&fw=1.2"
    "&Lh=20000&bl=7&K3=5000&m=5&L=200&ta=25&aa=vacuum&nm=9000&Tm=20&Tmn=15"
)
PAGES = (
    "/",
    EVERYTHING,
    f"{EVERYTHING}&gear=HPN-14A-5",
    f"{EVERYTHING}&gear=HPN-40A-5",
    "/?T=40&n=250&t=0.3&T=9,3&tp=x&i=99&strange=1&Nk=-1&fw=4&FR=",
    "/?T=1&n=1&t=1&i=99",
    "/?T=&n=&t=",
    "/?mech=rotary&J=0.8&mg=12&mv=trapezoidal&ms=90&mt=0.8&mv=dwell&ms=1&mt=0.4",
    "/?mech=rotary&J=0.8&mv=trapezoidal&ms=90&mt=0.8&Jm=0.0002&Jr=5&nmr=3000",
    "/?T=40&n=250&t=0.3&Tpk=55&npk=500&Trms=42",
    "/paste",
    "/catalogue",
    "/catalogue/HPN-20A-5",
    "/catalogue/HPN-40A-5",
    "/catalogue/HPN-99A-5",
    "/selections",
    "/selections?reference=%07",
    "/selections/nothing",
)
SHOWN = ("aria-label", "title", "placeholder", "alt", "content")
UNTRANSLATED = re.compile(
    r"\b[0-9a-f]{16}\b|"
    r"PYRONOC UNIVERSAL 00|"
    r"HPN Select|HPN(-\w+)*|Deutsch|English|\b\d+A\b|\bSI\b|\bUS\b|ISO 281|\bJ\d\b|[\w.-]+\.csv|HPN_\w+|\bM\d+\b"
    r"|strange|\b[A-Za-z]_\w+(,\w+)*|\bm[sj]\b|\brg\b|\bdwell\b|^\s*(av|in|out|rms|mot|k)(,(av|max|N))?(\(max\))?\s*$|JSON|CSV|PDF|PNG|SVG|XLSX|AASX|Ctrl|Alt|Enter|Esc|Strg|Shift|Tab|xx\.xx|AAS|BH-AF1|\bLb\d+\b|L10|L50|\bL\d+\b"
)
"""Versions of the catalogue; names of products, files, formats, keys and parameters; symbols and their indices."""

FULL_WIDTH = {ord(letter): ord(letter) + 0xFEE0 for letter in "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"}


class FullWidth(NullTranslations):
    """Translations into letters that the service's texts don't contain."""

    def gettext(self, message: str) -> str:
        """Text with every letter outside placeholders changed."""
        parts = re.split(r"(%\(\w+\)s|\{\w+\})", message)
        return "".join(part if k % 2 else part.translate(FULL_WIDTH) for k, part in enumerate(parts))

    def ngettext(self, one: str, many: str, number: int) -> str:
        """Text for a number, with every letter outside placeholders changed."""
        return self.gettext(one if number == 1 else many)


class Texts(HTMLParser):
    """Texts and spoken attributes of a page, without scripts, formulas, code and symbols."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """Note attributes, and skip the content of elements without prose."""
        inputs = dict(attributes)
        if tag in ("script", "style", "var", "math", "code", "pre", "kbd", "sub"):
            self.open.append(tag)
        if (
            tag != "link"
            and "property" not in inputs
            and inputs.get("name") not in ("viewport", "color-scheme", "theme-color", "robots", "htmx-config")
        ):
            self.found += [str(inputs[name]) for name in SHOWN if inputs.get(name)]

    def handle_endtag(self, tag: str) -> None:
        """End the skipping of an element's content."""
        if self.open and self.open[-1] == tag:
            self.open.pop()

    def handle_data(self, data: str) -> None:
        """Note a text."""
        if not self.open:
            self.found.append(data)


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    with TestClient(create_app(), headers={"Cookie": "hpn_language=de"}) as client:
        yield client


@pytest.mark.parametrize("path", PAGES)
def test_no_text_of_a_page_escapes_translation(path: str, client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reader, "translations", lambda code: FullWidth())
    page = Texts()
    answer = client.get(path)
    assert answer.status_code < 500
    page.feed(answer.text)
    left = [UNTRANSLATED.sub("", text).strip() for text in page.found]
    assert [text for text in left if re.search("[A-Za-z]{2}", text)] == []
