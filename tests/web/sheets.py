"""Sheet of a motor list as a browser would send it back."""

import re
from collections.abc import Mapping
from html.parser import HTMLParser
from urllib.parse import urlencode

from httpx2 import Response
from starlette.testclient import TestClient

Fields = list[tuple[str, str]]
ROLES = ("mot", "Tmn", "Tm", "Tst", "nmr", "nm", "Jm", "mmo", "mcv")


class _Fields(HTMLParser):
    """Fields of the sheet's form, in their order; none of its buttons."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.fields: Fields = []
        self._in_sheet, self._area = False, ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        own = dict(attrs)
        self._in_sheet |= tag == "form" and "motor-cells" in (own.get("class") or "")
        if self._in_sheet and (tag == "textarea" or (tag == "input" and own.get("type") != "radio")):
            self.fields.append((own.get("name") or "", own.get("value") or ""))
            self._area = self.fields[-1][0] if tag == "textarea" else ""

    def handle_data(self, data: str) -> None:
        if self._in_sheet and self._area:
            self.fields[-1] = (self._area, data.strip())

    def handle_endtag(self, tag: str) -> None:
        self._area = ""
        self._in_sheet &= tag != "form"


def cells(page: str, changes: Mapping[tuple[int, str], str] | None = None) -> Fields:
    """Fields of a page's sheet, with other texts in some cells by row and field."""
    counts = dict.fromkeys(ROLES, 0)
    fields = list[tuple[str, str]]()
    for name, text in _Fields(page).fields:
        counts[name] = counts.get(name, 0) + 1
        fields.append((name, (changes or {}).get((counts[name], name), text)))
    return fields


def rows(page: str) -> list[list[str]]:
    """Cells of a page's sheet, row by row."""
    fields = _Fields(page).fields
    columns = [[text for name, text in fields if name == role] for role in ROLES]
    return [list(row) for row in zip(*columns, strict=True)]


def typed(client: TestClient, fields: Fields, place: str, **button: str) -> Response:
    """Answer to a sheet that is sent, by default to be saved."""
    body = urlencode([*fields, *(button or {"keep": "1"}).items()])
    headers = {"content-type": "application/x-www-form-urlencoded"}
    return client.post(place, content=body, headers=headers, follow_redirects=False)


def problems(page: str) -> list[str]:
    """Sentences on what is wrong with a sheet."""
    return re.findall(r'<p class="error">(.*?)</p>', page)
