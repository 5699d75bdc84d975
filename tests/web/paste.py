"""Tables to paste, and readers of the parts of a preview."""

import re
from urllib.parse import parse_qs, urlsplit

LINK = "T=40&n=250&t=0.3&T=32&n=500&t=3&tp=4&Tk=200&i=5"
GERMAN = "Drehmoment [Nm]\tDrehzahl [1/min]\tDauer [s]\r\n9,3\t1.250\t0,3\r\n-12,5\t500\t1,25\r\n"
LONG = "".join(f"40.{k % 10};{250 + k % 90};0.25\n" for k in range(4000))
HTMX = {"HX-Request": "true"}

ASKED = re.compile(r'class="question asked">\s*<legend>(.*?)</legend>|<li>(.*?)</li>|<p class="error">(.*?)</p>')
"""Open questions of a preview, on choices and columns, or its problem."""


def query_of(location: str) -> dict[str, list[str]]:
    return parse_qs(urlsplit(location).query)


def cells(page: str) -> list[str]:
    """Cells of a preview's rows as they are read; the written text, if it differs, precedes them in grey."""
    return re.findall(r"<td>(?:\s*<small[^>]*>[^<]*</small>)?\s*(?:<mark>)?([^<]+?)\s*(?:</mark>)?</td>", page)


def chosen(page: str) -> dict[str, str]:
    """Value of each select of a preview; blank for an open question."""
    selects = re.findall(r'<select name="(\w+)".*?</select>', page, re.DOTALL)
    matches = re.findall(r'<select name="(\w+)"[^>]*>.*?<option(?: value="([^"]*)")? selected', page, re.DOTALL)
    assert len(matches) == len(selects)
    return dict(matches)


def of(page: str) -> str:
    """Digest of the table that the choices of a preview belong to."""
    match = re.search(r'name="of" value="(\w+)"', page)
    assert match
    return match[1]
