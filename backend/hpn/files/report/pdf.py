"""PDF report: tagged pages (PDF/UA-1) with every phase of a long cycle, the same bytes for the same selection."""

import json
import re
from collections.abc import Mapping, Set
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Any

import typst

from hpn.files.carried import parts_of
from hpn.files.export import Export
from hpn.files.report.content import content
from hpn.installed import data_folder
from hpn.words.reader import Reader

FOLDER = Path(__file__).parent
LOOK = ("look.typ", "selection.typ")
"""Look of every report, and the parts of a selection; the report's own template follows them."""

FONTS = data_folder("frontend/dist/paper")
FIRST_FONTS = ("HPN Sans", "Noto Sans Arabic", "DejaVu Sans Mono", "Noto Sans", "Noto Sans SC")
"""Fonts that typst tries first for a character; then it tries every other Noto font."""

REPLACEMENT = "□"
KEPT_COMPILATIONS = 10
"""Compilations for which typst keeps its layout: a quarter of a gigabyte for 10,000 phases."""

NO_PARTS: Mapping[str, bytes] = {}

_UNSHOWN = re.compile(r'the text `"(.+?)"` could not be displayed')
_ESCAPED = re.compile(r"\\u\{([0-9a-f]+)\}")


def pdf(export: Export, reader: Reader) -> bytes:
    """Report on an export."""
    title, parts = export.heading.title.strip(), parts_of(export, reader)
    return printed("report.typ", content(export, reader), title, export.created, parts)


def printed(
    template: str,
    data: Mapping[str, Any],
    title: str,
    created: datetime | None,
    attached: Mapping[str, bytes] = NO_PARTS,
) -> bytes:
    """Report of a template and its data, with parts attached as JSON.

    PDF/UA refuses a character that no font can show. Characters that typst names as such are replaced, and a note lists
    them.
    """
    seconds = int(created.timestamp()) if created else 0
    texts = {"attached": json.dumps({name: part.decode() for name, part in attached.items()})}
    unshown: set[str] = set()
    while True:
        try:
            return _compiled(template, _without(unshown, data), {"title": title, **texts}, seconds)
        except typst.TypstError as error:
            missing = _unshown(error)
            if missing <= unshown:
                raise
            unshown |= missing
        finally:
            _forget()


def _compiled(template: str, data: Mapping[str, Any], texts: Mapping[str, str], seconds: int) -> bytes:
    families = dict.fromkeys([*FIRST_FONTS, *(name for name in _fonts().families() if name.startswith("Noto"))])
    compiler = typst.Compiler(
        b"\n".join((FOLDER / name).read_bytes() for name in (*LOOK, template)),
        font_paths=_fonts(),
        ignore_system_fonts=True,
        sys_inputs={"data": json.dumps({**data, "fonts": [*families]}), **texts},
    )
    result = compiler.compile(format="pdf", pdf_standards=["ua-1"], timestamp=seconds)
    assert isinstance(result, bytes)
    return result


@cache
def _fonts() -> typst.Fonts:
    """Noto fonts of this installation and those of typst: the report looks the same on every machine."""
    return typst.Fonts(include_system_fonts=False, font_paths=[FONTS])


def _forget() -> None:
    """Let typst drop its layout of this report: the next report has nothing in common with it."""
    for _ in range(KEPT_COMPILATIONS + 1):
        typst.compile(b" ", font_paths=_fonts(), ignore_system_fonts=True)


def _unshown(error: typst.TypstError) -> set[str]:
    """Characters that typst names as missing in its fonts; empty for any other error."""
    texts = _UNSHOWN.findall(error.diagnostic)
    plain = "".join(_ESCAPED.sub(lambda code: chr(int(code[1], 16)), text) for text in texts)
    return {character for character in plain if not character.isascii()}


def _without(unshown: Set[str], data: Mapping[str, Any]) -> Mapping[str, Any]:
    if not unshown:
        return data
    text = json.dumps(data, ensure_ascii=False).translate({ord(character): REPLACEMENT for character in unshown})
    replaced: dict[str, Any] = json.loads(text)
    codes = ", ".join(f"U+{ord(character):04X}" for character in sorted(unshown))
    return {**replaced, "notices": [*replaced["notices"], [data["labels"]["unprintable"].format(codes=codes)]]}
