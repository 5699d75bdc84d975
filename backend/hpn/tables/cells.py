"""Cells of a table: what is blank, and what is a number, perhaps with a unit, under either decimal mark.

A mark between thousands stands before groups of exactly three digits, is the same throughout a number, and never
follows a leading zero: `0,250` is a quarter under every reading.
"""

import re
from decimal import Decimal as Exact
from functools import lru_cache
from typing import Literal, NamedTuple

from hpn.tables.clocks import seconds_of
from hpn.tables.numbers import DASHES, split_unit
from hpn.words.units import QUANTITY_OF, codes_for

Decimal = Literal[".", ","]
DECIMALS: tuple[Decimal, ...] = (".", ",")

BLANKS = " \u00a0\u2007\u2008\u2009\u202f"
"""Blank, no-break, figure, punctuation, thin and narrow no-break space: each may stand between thousands."""

UNSEEN = "\u00ad\u200b\u200c\u200d\u200e\u200f\u2060\ufeff"
"""Characters without width, which come with cells copied from documents."""

LONGEST_CELL = 400
"""Characters of a cell that could still be a number: written out, the largest has some 310 digits."""

_EXPONENT = r"(?:[eE][+-]?[0-9]{1,3})?"
_NUMBER = {
    decimal: re.compile(
        rf"[+-]?(?:(?P<plain>(?:[0-9]+(?:[{decimal}][0-9]+)?{trailing}|[{decimal}][0-9]+){_EXPONENT})"
        rf"|(?P<grouped>[1-9][0-9]{{0,2}}(?P<mark>[{group}'’{BLANKS}])[0-9]{{3}}(?:(?P=mark)[0-9]{{3}})*"
        rf"(?:[{decimal}][0-9]+)?))"
    )
    for decimal, group, trailing in ((".", ",", r"\.?"), (",", ".", ""))
}
THOUSANDS = "÷"
"""Stands before what a format divides a number by, where nothing says the unit of what it shows."""

_OF_PHASES = ("torque", "speed", "time", "force")
_NOTHING = ("", "-", "–", "—", "\N{MINUS SIGN}", "\N{NON-BREAKING HYPHEN}")
_HELD_AS_TEXT = re.compile(r"=\"(?P<formula>[^\"]*)\"|'(?P<text>[-+\N{MINUS SIGN}]?(?!0[0-9])[0-9].*)")
"""How spreadsheet programs write a number that they hold as a text: `="40"`, and `'40` but no `'040`."""

_FULL_WIDTH = str.maketrans({chr(ord(sign) + 0xFEE0): sign for sign in "0123456789.,+-"})


class Figure(str):
    """A number that a workbook holds as such: in plain notation, with the unit of its format behind a blank."""

    __slots__ = ()


class Merged(str):
    """A cell that a merged one with a number covers, by the name of both, `D2:D4`: whose the number is, is not said."""

    __slots__ = ()


class Entry(NamedTuple):
    """A number in plain notation, and the unit written behind it."""

    number: str
    unit: str


def tidy(cell: str) -> str:
    """A cell without what can't be seen at its ends; a number that is held as a text, or in full width, as a number."""
    cell = cell.strip().strip(UNSEEN).strip()
    if match := _HELD_AS_TEXT.fullmatch(cell):
        cell = (match["formula"] or match["text"] or "").strip()
    plain = cell if cell.isascii() else cell.translate(_FULL_WIDTH)
    return plain if plain != cell and is_number(plain) else cell


def is_blank(cell: str) -> bool:
    """Whether a cell says nothing: empty, or a dash."""
    return cell in _NOTHING


def held_of(cell: str) -> tuple[str, str] | None:
    """What a workbook shows of a number in thousands without saying so, and what it holds: 40 of `40000 ÷1000`."""
    number, _, thousands = cell.partition(f" {THOUSANDS}") if isinstance(cell, Figure) else ("", "", "")
    if not thousands:
        return None
    shown = Exact(number).scaleb(1 - len(thousands)).normalize()
    return f"{shown:f}", number


def entry(cell: str, decimal: Decimal) -> Entry | None:
    """A cell as a number under a decimal mark; None where it is none, as a percentage is none of a phase."""
    if isinstance(cell, Figure):
        number, _, unit = cell.partition(" ")
        return None if unit == "%" else Entry(number, unit)
    return _entry(cell, decimal) if len(cell) <= LONGEST_CELL else None


@lru_cache(maxsize=20_000)
def _entry(cell: str, decimal: Decimal) -> Entry | None:
    if not any(map(str.isdigit, cell)):
        return None
    if (number := plain(cell, decimal)) is not None:
        return Entry(number, "")
    if (seconds := seconds_of(cell)) is not None:
        return Entry(seconds, "s")
    written, unit = split_unit(cell)
    # `1/min` is a unit, and no number of its own; `1'` is no phase's.
    known = any(QUANTITY_OF[code] in _OF_PHASES for code in codes_for(unit))
    number = plain(written, decimal) if known and not codes_for(cell) else None
    return None if number is None else Entry(number, unit)


def plain(text: str, decimal: Decimal) -> str | None:
    """A number with a point as decimal mark and nothing between thousands; None where it is no number."""
    text = text.translate(DASHES)
    match = _NUMBER[decimal].fullmatch(text)
    if match is None:
        return None
    if match["mark"]:
        text = text.replace(match["mark"], "")
    return text.replace(decimal, ".").removesuffix(".")


def is_meant_as_number(cell: str) -> bool:
    """Whether a cell is a number, or stands where one does: a formula, or a part of merged cells with a number."""
    return cell.startswith("=") or isinstance(cell, Merged) or is_number(cell)


def is_number(cell: str) -> bool:
    """Whether a cell is a number under any decimal mark."""
    return any(entry(cell, decimal) is not None for decimal in DECIMALS)
