"""Cut the typeface of page and PDF from IBM Plex Sans: the width and weights they use, and for the page only the
characters it writes.

The licence (SIL OFL 1.1) keeps the name Plex for the original, so that the result is called HPN Sans; its text goes
along with the files.
"""

import io
import unicodedata
from collections.abc import Iterable
from pathlib import Path

from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.subset import Options, Subsetter
from fontTools.ttLib import TTFont
from fontTools.varLib.instancer import instantiateVariableFont

NAME = "HPN Sans"
WIDTH = 94.0
WEIGHTS = (400.0, 650.0)
BOLD = 620.0
"""Weight of headings, as `--strong` of the page."""

THIN = {0x2009: 0.2, 0x202F: 0.2}
"""Widths of thin spaces in em: as drawn they are too narrow for groups of digits to be told apart."""

UPRIGHT = ["kern", "mark", "mkmk", "ccmp", "locl", "subs", "sups"]
ITALIC = ["ccmp", "locl"]
"""Features of the layout; symbols of one or two letters need no kerning, which is half of the file."""

LETTERS = {*range(0x20, 0x7F), *range(0xA0, 0x100)}
"""Western European text."""

SYMBOLS = {*map(ord, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789 ,.()/αβγδηθμπρφωΔ·−′")}
"""Characters of quantities' symbols and their indices, which stand in italics."""


ON_PAPER = {*range(0x20, 0x590), *range(0x1E00, 0x2C00)}
"""Latin, Greek and Cyrillic text, and signs: other scripts of a title have fonts of their own."""

ROMAN, SLANTED = "IBM Plex Sans Var-Roman.ttf", "IBM Plex Sans Var-Italic.ttf"


def faces(package: Path, texts: Iterable[Path]) -> dict[str, bytes]:
    """Upright and italic face, and their licence, by the names that the style sheets ask for."""
    originals = package / "fonts/complete/ttf"
    upright = cut(originals / ROMAN, LETTERS | written(texts), UPRIGHT, "Regular")
    italic = cut(originals / SLANTED, SYMBOLS, ITALIC, "Italic")
    return {
        "hpn-sans.woff2": saved(upright, "woff2"),
        "hpn-sans-italic.woff2": saved(italic, "woff2"),
        "hpn-sans.txt": (package / "LICENSE.txt").read_bytes(),
    }


def paper_faces(package: Path) -> dict[str, bytes]:
    """Faces of one weight each, as typst takes them, each with its licence."""
    originals = package / "fonts/complete/ttf"
    cuts = {
        "HPNSans.ttf": cut(originals / ROMAN, ON_PAPER, UPRIGHT, "Regular", WEIGHTS[0]),
        "HPNSans-Bold.ttf": cut(originals / ROMAN, ON_PAPER, UPRIGHT, "Bold", BOLD),
        "HPNSans-Italic.ttf": cut(originals / SLANTED, ON_PAPER, ITALIC, "Italic", WEIGHTS[0]),
    }
    for font in cuts.values():
        _raise_minus(font)
    licence = (package / "LICENSE.txt").read_bytes()
    return {name: saved(font) for name, font in cuts.items()} | {f"{name}.OFL.txt": licence for name in cuts}


def beyond(source: Path, first: Path) -> TTFont:
    """Face with the characters alone that a face lacks which is asked before it."""
    font, options = TTFont(source, recalcTimestamp=False), Options()
    options.layout_features, options.hinting, options.notdef_outline, options.name_IDs = ["*"], False, True, ["*"]
    subsetter = Subsetter(options)
    subsetter.populate(unicodes=font.getBestCmap().keys() - TTFont(first).getBestCmap().keys())
    subsetter.subset(font)
    return font


def written(sources: Iterable[Path]) -> set[int]:
    """Characters in texts, without line breaks and private ones."""
    found = {character for path in sources for character in path.read_text(encoding="utf-8")}
    return {ord(character) for character in found if unicodedata.category(character)[0] != "C"}


def cut(source: Path, wanted: set[int], features: list[str], style: str, weight: float | None = None) -> TTFont:
    """Face with the wanted characters alone, at one width and one weight, else a range of weights."""
    font = TTFont(source, recalcTimestamp=False)
    options = Options()
    options.layout_features, options.hinting, options.notdef_outline = features, False, True
    options.name_IDs = [0, 1, 2, 3, 4, 5, 6, 13, 14]
    subsetter = Subsetter(options)
    subsetter.populate(unicodes=wanted)
    subsetter.subset(font)
    instantiateVariableFont(font, {"wdth": WIDTH, "wght": weight or WEIGHTS}, inplace=True)
    _rename(font, style)
    units, mapping = font["head"].unitsPerEm, font.getBestCmap()
    for code, em in THIN.items():
        if code in mapping:
            font["hmtx"][mapping[code]] = (round(em * units), 0)
    return font


def _raise_minus(font: TTFont) -> None:
    """Add the minus of min⁻¹, at the height of the raised 1: without it a whole text would be set in another face."""
    shapes, widths, name = font["glyf"], font["hmtx"], "uni207B"
    minus, one = shapes["minus"], shapes["onesuperior"]
    share = (one.yMax - one.yMin) / (shapes["one"].yMax - shapes["one"].yMin)
    middle = (one.yMax + one.yMin - share * (minus.yMax + minus.yMin)) / 2
    pen = TTGlyphPen(shapes)
    pen.addComponent("minus", (share, 0, 0, share, 0, middle))
    font.setGlyphOrder([*font.getGlyphOrder(), name])
    shapes[name], widths[name] = pen.glyph(), tuple(round(share * measure) for measure in widths["minus"])
    for table in font["cmap"].tables:
        table.cmap[0x207B] = name


def _rename(font: TTFont, style: str) -> None:
    """Give a face its own name; copyright and licence stay."""
    names = {1: NAME, 2: style, 3: f"{NAME} {style}", 4: f"{NAME} {style}", 6: f"{NAME}-{style}".replace(" ", "")}
    for record in list(font["name"].names):
        if record.nameID in names:
            record.string = names[record.nameID]
        elif record.nameID not in (0, 13, 14):
            font["name"].removeNames(record.nameID)


def saved(font: TTFont, flavor: str | None = None) -> bytes:
    """Face as a file: plain, or compressed as browsers load it."""
    font.flavor = flavor
    content = io.BytesIO()
    font.save(content, reorderTables=False)
    return content.getvalue()
