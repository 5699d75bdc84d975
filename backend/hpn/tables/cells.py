"""Cells of a table: blanks, numbers under either decimal mark, perhaps with a unit, and times.

A mark between thousands stands before groups of exactly three digits, is the same throughout a number, and never
follows a leading zero: `0,250` is a quarter under every reading. `0:00:30` and `PT30S` are durations, and
`2026-03-01T08:00:30` is a moment.
"""

from collections.abc import Sequence
from datetime import UTC, datetime
from decimal import Decimal as Exact
from fractions import Fraction
from functools import lru_cache
from typing import Literal, NamedTuple

from hpn.words.patterns import Pattern
from hpn.words.spellings import codes_for
from hpn.words.units import QUANTITY_OF

Decimal = Literal[".", ","]
DECIMALS: tuple[Decimal, ...] = (".", ",")

DASHES = str.maketrans(dict.fromkeys("\N{MINUS SIGN}\N{EN DASH}\N{NON-BREAKING HYPHEN}", "-"))
"""Signs used as a minus in documents."""

BLANKS = " \u00a0\u2007\u2008\u2009\u202f"
"""Blank, no-break, figure, punctuation, thin and narrow no-break space: any of them may separate thousands."""

UNSEEN = "\u00ad\u200b\u200c\u200d\u200e\u200f\u2060\ufeff"
"""Characters without width, which come with cells copied from documents."""

LONGEST_CELL = 400
"""Characters of the longest number: written out, the largest float has some 310 digits."""

_EXPONENT = r"(?:[eE][+-]?[0-9]{1,3})?"
_NUMBER = {
    decimal: Pattern(
        rf"[+-]?(?:(?P<plain>(?:[0-9]+(?:[{decimal}][0-9]+)?{trailing}|[{decimal}][0-9]+){_EXPONENT})"
        rf"|(?P<grouped>[1-9][0-9]{{0,2}}(?P<mark>[{group}'’{BLANKS}])[0-9]{{3}}(?:(?P=mark)[0-9]{{3}})*"
        rf"(?:[{decimal}][0-9]+)?))",
        LONGEST_CELL,
    )
    for decimal, group, trailing in ((".", ",", r"\.?"), (",", ".", ""))
}
_WITH_UNIT = Pattern(
    r"(?P<number>.*?[0-9][.,]?(?:[eE][+-]?[0-9]{1,3})?)"
    r"(?:\s+(?P<per>1\s?/[^0-9]+)|\s*(?P<unit>(?![eE][+-]?[0-9])(?:[^\W\d_]|[°'′″\"/])[^0-9]*(?:\^?\(?(?:[-−–]1|[23])\)?)?))",
    LONGEST_CELL,
)
"""A number and its unit: letters, or one divided by something."""

THOUSANDS = "÷"
"""Prefix of a number format's divisor where the format names no unit."""

PERCENT = "%"
_OF_PHASES = ("torque", "speed", "time", "force")
_NOTHING = ("", "-", "–", "—", "\N{MINUS SIGN}", "\N{NON-BREAKING HYPHEN}")
_HELD_AS_TEXT = Pattern(r"=\"(?P<formula>[^\"]*)\"|'(?P<text>[-+\N{MINUS SIGN}]?(?!0[0-9])[0-9].*)", LONGEST_CELL)
"""A number that spreadsheet programs hold as a text: `="40"` and `'40`, but not `'040`."""

_QUOTED = Pattern(
    r"\"(?P<a>[^\"]+)\"|'(?P<b>[^']+)'|[“„](?P<c>[^“”„]+)[”“]|[‘‚](?P<d>[^‘’‚]+)[’‘]|«(?P<e>[^«»]+)»", LONGEST_CELL
)
"""A cell in quotes, from programs whose separator needs no quotes."""

_FULL_WIDTH = str.maketrans({chr(ord(sign) + 0xFEE0): sign for sign in "0123456789.,+-"})


class Figure(str):
    """A number that a workbook holds as a number: in plain notation, with the unit of its format behind a blank."""

    __slots__ = ()


class Merged(str):
    """A cell covered by a merged number, with the name of the merged cells, `D2:D4`: the number may belong to each."""

    __slots__ = ()


class Spanning(str):
    """A text of a merged cell over several columns of one row."""

    columns: int


def spanned(cell: str) -> int:
    """Columns that a merged text covers; 0 for any other cell, whose extent is unknown."""
    return cell.columns if isinstance(cell, Spanning) else 0


class CellNumber(NamedTuple):
    """A number in plain notation, and the unit written behind it."""

    number: str
    unit: str


def tidy(cell: str) -> str:
    """A cell without invisible characters at its ends; a number held as a text or in full width becomes a plain one."""
    cell = cell.strip().strip(UNSEEN).strip()
    if match := _QUOTED.fullmatch(cell):
        cell = match[match.lastgroup or 0].strip()
    if match := _HELD_AS_TEXT.fullmatch(cell):
        cell = (match["formula"] or match["text"] or "").strip()
    plain = cell if cell.isascii() else cell.translate(_FULL_WIDTH)
    return plain if plain != cell and is_number(plain) else cell


def is_blank(cell: str) -> bool:
    """True for an empty cell or a dash."""
    return cell in _NOTHING


def held_of(cell: str) -> tuple[str, str] | None:
    """Shown and held number of a cell shown in thousands without a unit: 40 and 40000 of `40000 ÷1000`."""
    number, _, thousands = cell.partition(f" {THOUSANDS}") if isinstance(cell, Figure) else ("", "", "")
    if not thousands:
        return None
    decimal = Exact(number).scaleb(1 - len(thousands)).normalize()
    return f"{decimal:f}", number


def split_unit(text: str) -> tuple[str, str]:
    """Number and unit of a text such as `40 Nm`; the unit is blank if there is none."""
    match = _WITH_UNIT.fullmatch(text)
    return (match["number"], (match["per"] or match["unit"]).strip()) if match else (text, "")


def entry(cell: str, decimal: Decimal, *, any_unit: bool = False) -> CellNumber | None:
    """A cell as a number under a decimal mark; None for any other cell.

    Its unit must be a unit of phases; with `any_unit` it may be any known unit, or a percentage.
    """
    if isinstance(cell, Figure):
        number, _, unit = cell.partition(" ")
        return None if unit == PERCENT and not any_unit else CellNumber(number, unit)
    return _entry(cell, decimal, any_unit) if len(cell) <= LONGEST_CELL else None


@lru_cache(maxsize=20_000)
def _entry(cell: str, decimal: Decimal, any_unit: bool) -> CellNumber | None:
    if not any(map(str.isdigit, cell)):
        return None
    if (number := plain_number(cell, decimal)) is not None:
        return CellNumber(number, "")
    if (seconds := seconds_of(cell)) is not None:
        return CellNumber(seconds, "s")
    written, unit = (cell[:-1].rstrip(), PERCENT) if cell.endswith(PERCENT) else split_unit(cell)
    codes = codes_for(unit)
    known = unit == PERCENT or bool(codes) if any_unit else any(QUANTITY_OF[code] in _OF_PHASES for code in codes)
    # `1/min` is a unit without a number; `1'` is no unit of a phase.
    number = plain_number(written, decimal) if known and not codes_for(cell) else None
    return None if number is None else CellNumber(number, unit)


def plain_number(text: str, decimal: Decimal) -> str | None:
    """A number with a decimal point and without marks between thousands; None for any other text."""
    text = text.translate(DASHES)
    match = _NUMBER[decimal].fullmatch(text)
    if match is None:
        return None
    if match["mark"]:
        text = text.replace(match["mark"], "")
    return text.replace(decimal, ".").removesuffix(".")


def written(number: float) -> str:
    """A number in plain notation, with all its digits."""
    return repr(float(number)).removesuffix(".0")


def is_meant_as_number(cell: str) -> bool:
    """True for a number or a stand-in for one: a formula, or a cell below a merged number."""
    return cell.startswith("=") or isinstance(cell, Merged) or is_number(cell)


def is_number(cell: str) -> bool:
    """True for a number, or a number with a unit of phases, under either decimal mark."""
    return any(entry(cell, decimal) is not None for decimal in DECIMALS)


# --- Times ------------------------------------------------------------------------------------------------------------

LONGEST_TIME = 40

_CLOCK = Pattern(r"([0-9]{1,4}):([0-5][0-9]):([0-5][0-9])(?:[.,]([0-9]{1,9}))?", LONGEST_TIME)
_MINUTES = Pattern(r"()([0-9]{1,3}):([0-5][0-9])[.,]([0-9]{1,9})", LONGEST_TIME)
"""Minutes, seconds and a fraction: nobody writes fractions of minutes."""

_ISO = Pattern(r"PT(?=[0-9])(?:([0-9]{1,6})H)?(?:([0-9]{1,6})M)?(?:([0-9]{1,6})(?:[.,]([0-9]{1,9}))?S)?", LONGEST_TIME)
_MOMENT = Pattern(
    r"([0-9]{4}-[0-9]{2}-[0-9]{2})[T ]([0-9]{2}:[0-9]{2}(?::[0-9]{2})?)(?:[.,]([0-9]{1,9}))?"
    r"\s?(Z|[+-][0-9]{2}:?[0-9]{2})?",
    LONGEST_TIME,
)
TIME_FORMAT = Pattern(r"\[?[hH]{1,2}\]?:[mM]{2}:[sS]{2}(?:[.,](?:[0fsS]{1,6}|ms|xxx))?", LONGEST_TIME)
"""Format in a heading for times written as on a clock."""

TIME_PARTED = Pattern(r"[0-5]?[0-9]:[0-5][0-9]", LONGEST_TIME)
"""A time of two parts, hours and minutes or minutes and seconds."""


def seconds_of(cell: str) -> str | None:
    """Seconds of a time on a clock or of a duration, in plain notation; None for anything else."""
    return _seconds_of(cell) if len(cell) <= LONGEST_TIME else None


@lru_cache(maxsize=5000)
def _seconds_of(cell: str) -> str | None:
    match = _CLOCK.fullmatch(cell) or _MINUTES.fullmatch(cell) or _ISO.fullmatch(cell)
    if match is None:
        return None
    hours, minutes, seconds = (int(part or 0) for part in match.groups()[:3])
    return _with_fraction(3600 * hours + 60 * minutes + seconds, match[4])


def _with_fraction(whole: int, fraction: str | None) -> str:
    return f"{whole}.{fraction}" if fraction and fraction.strip("0") else str(whole)


def moment_of(cell: str) -> Fraction | None:
    """Seconds from 1970 to a date with a time of day, with all digits of the fraction; None for any other cell."""
    return _moment_of(cell) if len(cell) <= LONGEST_TIME else None


@lru_cache(maxsize=5000)
def _moment_of(cell: str) -> Fraction | None:
    match = _MOMENT.fullmatch(cell)
    if match is None or (match[3] and match[2].count(":") < 2):
        return None
    try:
        moment = datetime.fromisoformat(f"{match[1]}T{match[2]}{match[4] or 'Z'}").astimezone(UTC)
    except (ValueError, OverflowError):
        return None
    return Fraction(int(moment.timestamp())) + Fraction(f"0.{match[3] or 0}")


def seconds_between(moments: Sequence[Fraction | None], moment: Fraction) -> str:
    """Seconds from the first known moment of a column to another one, in plain notation."""
    first = next(each for each in moments if each is not None)
    nanoseconds = round((moment - first) * 10**9)
    sign, (whole, rest) = "-" if nanoseconds < 0 else "", divmod(abs(nanoseconds), 10**9)
    return sign + _with_fraction(whole, f"{rest:09d}".rstrip("0"))


BEGINS_A_FORMULA = ("=", "+", "-", "@", "\t", "\r")
_PLAIN_NUMBER = Pattern(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?", LONGEST_CELL)


def harmless(cell: str | None) -> str | None:
    """A text with an apostrophe before it where it would be a formula; a number stays as it is."""
    if cell is None or not cell.startswith(BEGINS_A_FORMULA) or _PLAIN_NUMBER.fullmatch(cell):
        return cell
    return f"'{cell}"
