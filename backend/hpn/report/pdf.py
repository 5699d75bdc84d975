"""The PDF report: two tagged pages (PDF/UA-1), the same bytes for the same selection."""

import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import typst

from hpn.reader import Reader
from hpn.report.content import content
from hpn.report.export import Export

TEMPLATE = Path(__file__).parent / "report.typ"
USER_TEXTS = ("title", "reference")
REPLACEMENT = "□"
PAGES = 2
SCALES = ((1.0, 1.0), (1.0, 0.9), (0.9, 0.9), (0.9, 0.8), (0.8, 0.7), (0.7, 0.6), (0.5, 0.5))
"""Scale of each page, the largest first."""

_PAGE_COUNT = re.compile(rb"/Type/Pages/Count (\d+)")
Ranges = Sequence[tuple[int, int]]

_WESTERN = ((0x20, 0x7E), (0xA0, 0x24F), (0x370, 0x3FF), (0x400, 0x45F), (0x200B, 0x2026), (0x20AC, 0x20AC))
_WIDER = (*_WESTERN, (0x5D0, 0x5EA), (0x621, 0x64A), (0x2030, 0x22FF))
"""Characters that the fonts of the report surely have, and those that they most likely have."""


def pdf(export: Export, reader: Reader) -> bytes:
    """The report on an export.

    PDF/UA refuses a text that no font can show. Only the user's texts can hold one; it is replaced, and a note says so.
    """
    data = content(export, reader)
    seconds = int(export.created.timestamp()) if export.created else 0
    for printable in (None, _WIDER, _WESTERN):
        try:
            return _fitted(_limited(data, printable) if printable else data, seconds)
        except typst.TypstError as error:
            if "could not be displayed" not in error.message or printable is _WESTERN:
                raise
    raise AssertionError("the last attempt returns or raises")


def _fitted(data: Mapping[str, Any], seconds: int) -> bytes:
    """As large as two pages allow."""
    for scales in SCALES:
        document = _compiled({**data, "scales": scales}, seconds)
        if int(_PAGE_COUNT.findall(document)[0]) <= PAGES:
            return document
    return document


def _compiled(data: Mapping[str, Any], seconds: int) -> bytes:
    compiler = typst.Compiler(
        TEMPLATE.read_bytes(),
        font_paths=_fonts(),
        ignore_system_fonts=True,
        sys_inputs={"data": json.dumps(data)},
    )
    result = compiler.compile(format="pdf", pdf_standards=["ua-1"], timestamp=seconds)
    assert isinstance(result, bytes)
    return result


@cache
def _fonts() -> typst.Fonts:
    """The fonts that typst brings: the report looks the same on every machine."""
    return typst.Fonts(include_system_fonts=False)


def _limited(data: Mapping[str, Any], printable: Ranges) -> dict[str, Any]:
    def shown(character: str) -> str:
        return character if any(low <= ord(character) <= high for low, high in printable) else REPLACEMENT

    replaced = {name: "".join(map(shown, data[name])) for name in USER_TEXTS}
    return {**data, **replaced, "notices": [*data["notices"], [data["labels"]["unprintable"]]]}
