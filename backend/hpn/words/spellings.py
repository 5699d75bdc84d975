"""Spellings of units: from a typed unit to its possible codes."""

import unicodedata

from hpn.words.patterns import Pattern
from hpn.words.units import QUANTITY_OF, UNITS, quantity_of, quotient_of

FREQUENCY = "Hz"
"""Unit of turns, or of a motor's electrical frequency, which is the turns times the number of pole pairs."""

_SIGNS = " .·⋅∙•‧・*×"
"""Signs of a product, besides a hyphen."""

LONGEST = 40
_COMPOSED = 18 * LONGEST
"""Characters of a typed unit, and after conversion to compatible characters, up to 18 for one."""

_PRODUCT = Pattern(rf"(?<=[A-Za-z])[{_SIGNS}_-]+(?=[A-Za-z])", _COMPOSED)
_AS_TYPED = str.maketrans({**dict.fromkeys("\N{MINUS SIGN}\N{EN DASH}\N{HYPHEN}", "-"), "μ": "µ"})
_SUPERSCRIPT = Pattern(r"\^?\(?-1\)?$", _COMPOSED)
_SQUARE = Pattern(r"(?:\^|\*\*)\(?2\)?$", _COMPOSED)
_PER = Pattern(r"\.? */ *", _COMPOSED)
_BESIDE_POWER = Pattern(rf"[{_SIGNS}^()]", _COMPOSED)
_OF_TEN = Pattern(r"[x×·]? *10\^?\(?-([0-9])\)?[ x×·*]*kg[ ·]*m2", _COMPOSED)
"""An inertia as in data sheets: `10⁻⁴ kg·m²` is kg·cm²."""

_POWER = Pattern(r"(.+?)(?:\^|\*\*)?\(?([23])?\)?", _COMPOSED)


def _spelling(text: str) -> str:
    """A unit with uniform signs for products and for `per`: `N.m`, `N-m` and `N·m` become `N·m`."""
    tight = unicodedata.normalize("NFKC", text).strip().translate(_AS_TYPED)
    inverse = _SUPERSCRIPT.sub("-1", tight)
    if inverse != tight or inverse.endswith("-1"):
        return _BESIDE_POWER.sub("", inverse)
    product = _PRODUCT.sub("·", _SQUARE.sub("2", tight))
    return _PER.sub("/", product.removesuffix(".") if "·" in product else product)


def _spellings() -> dict[str, tuple[str, ...]]:
    codes_by_spelling: dict[str, dict[str, None]] = {}
    for quantity, units in UNITS.items():
        for code, unit in units.items():
            for word in unit.spelled.split():
                for spelling in _FORMS.get(quantity, _plain)(word):
                    codes_by_spelling.setdefault(spelling, {})[code] = None
    codes_by_spelling |= {word: {"Nm": None} for word in ("Newtonmeter", "Newton·meter", "newton·metres")}
    return {spelling: tuple(codes) for spelling, codes in codes_by_spelling.items()}


def _plain(word: str) -> list[str]:
    return [_spelling(word)]


def _of_torque(word: str) -> list[str]:
    """Spellings of a product of force and arm; inch and foot may stand first."""
    force, arm = word.split("·")
    turned = [(arm, force)] if arm in ("in", "ft") else []
    return [spelling for a, b in ((force, arm), *turned) for spelling in (f"{a}·{b}", f"{a}{b}", f"{a}·{b}s")]


def _of_inertia(word: str) -> list[str]:
    """Spellings of a mass and its arm squared, or of a torque per angular acceleration (with a time squared)."""
    return [word, word.replace("·", "")]


_FORMS = {"torque": _of_torque, "inertia": _of_inertia}

SPELLINGS = _spellings()
"""Typed unit -> its possible codes: `1/s` may count revolutions or radians."""

_FOLDED = {
    spelling.casefold(): codes
    for spelling, codes in SPELLINGS.items()
    if len({other for each, other in SPELLINGS.items() if each.casefold() == spelling.casefold()}) == 1
    and not spelling.startswith(("mN", "Ms"))  # M and m are a factor of a thousand million
    and spelling != "d"
}


def codes_for(text: str, quantity: str = "") -> tuple[str, ...]:
    """Possible codes of a typed unit, of one quantity or any; several if ambiguous.

    Without a quantity, `Hz` is a unit of speed.
    """
    if len(text) > LONGEST:
        return ()
    spelling = _spelling(text)
    if (factor := _OF_TEN.fullmatch(spelling)) is not None:
        spelling = {"4": "kg·cm2", "6": "kg·mm2", "7": "g·cm2"}.get(factor[1], spelling)
    codes = SPELLINGS.get(spelling) or _FOLDED.get(spelling.casefold(), ())
    return tuple(code for code in codes if QUANTITY_OF[code] == quantity or not (quantity or code == FREQUENCY))


def codes_in(text: str, unit: str) -> tuple[str, ...]:
    """Possible codes of a typed unit in place of a unit of the wire, such as `mm_per_s2`.

    Empty for a pure number. For a quotient the code of the dividend, with a different divisor's code: `Nm/arcmin`.
    """
    wire = quotient_of(unit)
    if not wire.divisor:
        return codes_for(text, quantity_of(unit)) if quantity_of(unit) else ()
    if len(text) > LONGEST:
        return ()
    over, _, under = _spelling(text).rpartition("/")
    parts = _POWER.fullmatch(under)
    if parts is None or (parts[2] or "") != wire.power:
        return ()
    dividends, divisors = (
        codes_for(part, QUANTITY_OF[code]) for part, code in ((over, wire.dividend), (parts[1], wire.divisor))
    )
    return tuple(a if b == wire.divisor else f"{a}/{b}" for a in dividends for b in divisors)
