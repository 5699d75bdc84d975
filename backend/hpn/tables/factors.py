"""Powers of ten beside a unit, such as `10⁻⁴ kg·m²`, or in a row of their own below the headings."""

from collections.abc import Sequence
from re import IGNORECASE

from hpn.tables.cells import is_blank, is_number
from hpn.tables.headings import LONGEST_WRITTEN, UNIT, heading_of, parts_of
from hpn.words import spellings
from hpn.words.patterns import Pattern

_MINUS = "[-\u2212\u2013+]"
_POWER = rf"10 ?[⁻⁺]?[⁰¹²³⁴-⁹]+|10 ?(?:\^|\*\*|e) ?\(?{_MINUS}?[0-9]{{1,2}}|10{_MINUS}[0-9](?![0-9])"
_PLAIN = rf"1(?:[.,]0*)?e{_MINUS}?[0-9]{{1,2}}|100{{2,6}}(?![0-9.,])"
_TIMES = "[x×*·/:]"
_BESIDE = Pattern(
    rf"(?<![A-Za-z0-9.,])(?:{_POWER}|{_PLAIN}|{_TIMES} ?10{{1,6}}(?![0-9.,])|{_TIMES} ?0[.,]0*1"
    "|(?:10{1,6}|0[.,]0*1)$)",
    LONGEST_WRITTEN,
    IGNORECASE,
)
_ALONE = Pattern(rf"{_TIMES}? ?(?:{_POWER}|{_PLAIN}|10{{1,6}}|0[.,]0*1)\)?", LONGEST_WRITTEN, IGNORECASE)


def has_factor(text: str) -> bool:
    """True for a heading with a power of ten beside its unit that belongs to no known unit."""
    heading = heading_of(text)
    is_unit = heading.kind == UNIT and spellings.codes_for(heading.unit)
    return not is_unit and _BESIDE.search(parts_of(text)[0]) is not None


def has_factors(row: Sequence[str]) -> bool:
    """True for a row of powers of ten, one per column and not all plain numbers; a name may stand first."""
    cells = [cell for cell in row if not is_blank(cell)]
    factors = [cell for cell in cells if is_factor(cell)]
    others = [cell for cell in cells if cell not in factors]
    return not all(map(is_number, factors)) and (not others or others == cells[:1]) and not any(map(is_number, others))


def is_factor(cell: str) -> bool:
    """True for a cell that is only a power of ten, such as `×10⁻⁴` or `0.001`."""
    return _ALONE.fullmatch(cell.strip("[]() ")) is not None
