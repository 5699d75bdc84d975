"""Units: the suffix of a field's name such as `_Nm`, the units for display, and the units that people type.

Units are converted exactly, by pint.
"""

import re
import unicodedata
from dataclasses import dataclass
from decimal import ROUND_HALF_EVEN, Context, Decimal
from fractions import Fraction
from functools import cache, lru_cache
from math import inf
from typing import Any


def N_(text: str) -> str:
    """Mark a text for the translators; it is translated where it is shown."""
    return text


SYMBOLS = {
    "Nm_per_rad": "Nm/rad",
    "Nm": "Nm",
    "rpm": "rpm",
    "s": "s",
    "h": "h",
    "N": "N",
    "kg": "kg",
    "mm": "mm",
    "arcmin": "arcmin",
    "degC": "°C",
    "percent": "%",
    "deg": "°",
    "deg_per_s2": "°/s²",
    "rad_per_s2": "rad/s²",
    "mm_per_s": "mm/s",
    "mm_per_s2": "mm/s²",
    "kgm2": "kg·m²",
    "Nm_per_rpm": N_("Nm/rpm"),
    "g_per_cm3": "g/cm³",
    "Hz": "Hz",
    "rad_per_s": "rad/s",
    "J": "J",
    "W": "W",
    "m_per_s": "m/s",
}
"""Unit suffix of a field name -> the symbol a reader sees."""

_LONGEST_FIRST = sorted(SYMBOLS, key=len, reverse=True)


@lru_cache(maxsize=1024)  # names may be a stranger's: what they fill has a limit
def suffix_of(field_name: str) -> str | None:
    """Unit suffix that ends a field name (`torque_Nm` -> `Nm`), or None for a field without a unit."""
    return next((unit for unit in _LONGEST_FIRST if field_name.endswith("_" + unit)), None)


def symbol_of(field_name: str) -> str:
    """Symbol of a field's unit (`life_L10_h` -> `h`), or an empty text for a field without one."""
    unit = suffix_of(field_name)
    return SYMBOLS[unit] if unit else ""


# --- Units for display ------------------------------------------------------------------------------------------------

CHOICES = {
    "torque": {"Nm": "Nm", "lb_in": "lb·in", "lb_ft": "lb·ft"},
    "speed": {"rpm": N_("rpm"), "rad_per_s": "rad/s", "deg_per_s": "°/s"},
    "force": {"N": "N", "lbf": "lbf"},
    "weight": {"kg": "kg", "lb": "lb"},
    "length": {"mm": "mm", "in": "in"},
    "angle": {"arcmin": "arcmin", "mrad": "mrad"},
    "temperature": {"degC": "°C", "degF": "°F"},
}
"""Kind of quantity -> codes of its units for display, with their symbols; the first is the wire's."""

NAMES = {
    "torque": N_("Torque"),
    "speed": N_("Speed"),
    "force": N_("Force"),
    "weight": N_("Weight"),
    "length": N_("Length"),
    "angle": N_("Angle"),
    "temperature": N_("Temperature"),
}

PRESETS = {"SI": (), "US": ("lb_in", "lbf", "lb", "in", "degF")}
"""Presets of all units."""

CODES = tuple(code for units in CHOICES.values() for code in list(units)[1:])
"""Codes of the units that differ from the wire's, in the order in which a cookie gives them."""

_PINT = {
    "Nm": "newton * meter",
    "lb_in": "force_pound * inch",
    "lb_ft": "force_pound * foot",
    "rpm": "rpm",
    "rad_per_s": "radian / second",
    "deg_per_s": "degree / second",
    "N": "newton",
    "lbf": "force_pound",
    "kg": "kilogram",
    "lb": "pound",
    "mm": "millimeter",
    "in": "inch",
    "arcmin": "arcminute",
    "mrad": "milliradian",
    "degC": "degC",
    "degF": "degF",
    "kNm": "kilonewton * meter",
    "daNm": "decanewton * meter",
    "Nmm": "newton * millimeter",
    "Ncm": "newton * centimeter",
    "mNm": "millinewton * meter",
    "oz_in": "force_ounce * inch",
    "kgf_m": "kilogram_force * meter",
    "kgf_cm": "kilogram_force * centimeter",
    "rev_per_s": "revolution / second",
    "krpm": "kilorpm",
    "deg_per_min": "degree / minute",
    "kN": "kilonewton",
    "daN": "decanewton",
    "g": "gram",
    "cm": "centimeter",
    "m": "meter",
    "arcsec": "arcsecond",
    "deg": "degree",
    "s": "second",
    "ms": "millisecond",
    "us": "microsecond",
    "min": "minute",
    "h": "hour",
    "day": "day",
    "kgm2": "kilogram * meter ** 2",
    "kg_cm2": "kilogram * centimeter ** 2",
    "kg_mm2": "kilogram * millimeter ** 2",
    "g_cm2": "gram * centimeter ** 2",
    "lb_in2": "pound * inch ** 2",
    "lb_ft2": "pound * foot ** 2",
    "oz_in2": "ounce * inch ** 2",
    "lb_in_s2": "force_pound * inch * second ** 2",
    "oz_in_s2": "force_ounce * inch * second ** 2",
}
FURTHER = {
    "torque": {
        **{"kNm": "kNm", "daNm": "daNm", "Ncm": "Ncm", "Nmm": "Nmm", "mNm": "mNm"},
        **{"oz_in": "oz·in", "kgf_m": "kgf·m", "kgf_cm": "kgf·cm"},
    },
    "speed": {"krpm": "krpm", "rev_per_s": N_("rev/s"), "deg_per_min": "°/min"},
    "force": {"kN": "kN", "daN": "daN"},
    "weight": {"g": "g"},
    "length": {"cm": "cm", "m": "m"},
    "angle": {"deg": "°", "arcsec": "arcsec"},
    "time": {"s": "s", "ms": "ms", "us": "µs", "min": "min", "h": "h", "day": "d"},
    "inertia": {
        **{"kgm2": "kg·m²", "kg_cm2": "kg·cm²", "kg_mm2": "kg·mm²", "g_cm2": "g·cm²"},
        **{"lb_in2": "lb·in²", "lb_ft2": "lb·ft²", "oz_in2": "oz·in²", "lb_in_s2": "lb·in·s²", "oz_in_s2": "oz·in·s²"},
    },
}
"""Further units that are only read: kind of quantity -> codes with their symbols."""

_SUFFIXES = {symbol: suffix for suffix, symbol in SYMBOLS.items()}
_OF_CODE = {code: next(iter(units)) for units in CHOICES.values() for code in units}
_SYMBOL = {code: symbol for table in (FURTHER, CHOICES) for units in table.values() for code, symbol in units.items()}
NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]{1,3})?")


@dataclass(frozen=True, slots=True)
class Measure:
    """A unit for display: shown = wire · factor + offset, exactly."""

    symbol: str
    factor: Fraction = Fraction(1)
    offset: Fraction = Fraction(0)

    @property
    def same(self) -> bool:
        """True for the wire's own unit."""
        return self.factor == 1 and self.offset == 0

    def shown(self, value: float) -> float:
        """A number of the wire in this unit."""
        return value if self.same else value * float(self.factor) + float(self.offset)

    def wire(self, text: str) -> float:
        """Number typed in this unit, converted to the wire's.

        Twelve digits are kept, or all of them where more than thirteen are given, so that every float can be written.
        """
        try:
            value = float((Fraction(text) - self.offset) / self.factor)
        except OverflowError:
            return inf
        return value if _digits(text) > 13 else float(f"{value:.12g}")

    def written(self, value: float, digits: int) -> str:
        """A number of the wire in this unit, correctly rounded to so many digits, as plain as it can be."""
        exact = Fraction(repr(value)) * self.factor + self.offset
        rounded = Context(prec=digits, rounding=ROUND_HALF_EVEN).divide(
            Decimal(exact.numerator), Decimal(exact.denominator)
        )
        if not rounded or -6 <= rounded.adjusted() < 15:
            text = f"{rounded:f}"
            return text.rstrip("0").rstrip(".") if "." in text else text
        return f"{rounded.normalize():e}".replace("e+", "e")

    def shortest(self, value: float) -> str:
        """The shortest text that `wire` reads as exactly this number."""
        for text in (self.written(value, digits) for digits in range(1, 50)):
            if self.wire(text) == value:
                return text
        # Few digits that stand for many: zeros say that all of them count.
        mantissa, e, exponent = text.partition("e")
        return mantissa + ("" if "." in text else ".") + "0" * (14 - _digits(text)) + e + exponent


def _digits(text: str) -> int:
    """Number of significant digits."""
    return len(re.sub(r"[eE].*|\D", "", text).lstrip("0"))


def measure(unit: str, chosen: tuple[str, ...]) -> Measure:
    """Unit that a unit of the wire (suffix `Nm_per_rad` or symbol `Nm/rad`) is shown in, for the codes chosen."""
    suffix = unit if unit in SYMBOLS else _SUFFIXES.get(unit, unit)
    return _measure(suffix, chosen)


@cache
def _measure(suffix: str, chosen: tuple[str, ...]) -> Measure:
    whole = _dividend(suffix)
    return entered(suffix, next((code for code in chosen if _OF_CODE[code] == whole), whole))


@cache
def entered(suffix: str, code: str) -> Measure:
    """Measure of a number that is given in the unit of a code, for a unit of the wire with the same dimension."""
    whole = _dividend(suffix)
    per = SYMBOLS[suffix].removeprefix(SYMBOLS[whole]) if whole != suffix else ""
    symbol = _SYMBOL.get(code, SYMBOLS.get(suffix, suffix)) + per
    if code == whole:
        return Measure(symbol)
    zero, one = (_registry().Quantity(Fraction(n), _PINT[whole]).to(_PINT[code]).magnitude for n in (0, 1))
    return Measure(symbol, Fraction(one - zero), Fraction(zero))


def _dividend(suffix: str) -> str:
    """The part of a unit that a reader may choose: of `Nm_per_rad` and `mm_per_s2` what stands before `_per_`."""
    whole = suffix.partition("_per_")[0]
    return whole if whole in _OF_CODE.values() else suffix


@cache
def _registry() -> Any:
    import pint  # takes a second, which readers in the units of the wire never need

    return pint.UnitRegistry(non_int_type=Fraction)


def codes_of(text: str) -> tuple[str, ...]:
    """Unit codes in a text such as `lb_in.lbf`, at most one per quantity, in the order of CODES; others are ignored."""
    given = text[:200].split(".")
    first = {_OF_CODE[code]: code for code in reversed(given) if code in CODES}
    return tuple(code for code in CODES if code in first.values())


# --- Units that people type -------------------------------------------------------------------------------------------

READ = {name: {**CHOICES.get(name, {}), **FURTHER.get(name, {})} for name in (*CHOICES, "time", "inertia")}
"""Kind of quantity -> codes of the units in which it may be given, with their symbols."""

_SPELLED = {
    "rpm": "rpm r.p.m. 1/min /min U/min Umdr/min r/min rev/min revs/min Upm tr/min giri/min varv/min omw/min ot/min "
    "turn/min turns/min min-1 U·min-1 r·min-1 rev·min-1 tr·min-1",
    "krpm": "krpm kU/min",
    "rev_per_s": "rev/s rev/sec revs/s revs/sec U/s r/s rps tr/s giri/s varv/s turn/s turns/s turns/sec 1/s /s s-1 Hz "
    "U·s-1 r·s-1 rev·s-1 tr·s-1",
    "rad_per_s": "rad/s rad/sec rads-1 1/s /s s-1 Hz",
    "deg_per_s": "°/s °/sec deg/s deg/sec degree/s degrees/s Grad/s degs-1 °s-1",
    "deg_per_min": "°/min deg/min degree/min degrees/min Grad/min",
    "N": "N Newton newtons",
    "kN": "kN",
    "daN": "daN",
    "lbf": "lbf lb lbs",
    "kg": "kg",
    "g": "g",
    "lb": "lb lbs",
    "mm": "mm",
    "cm": "cm",
    "m": "m",
    "in": "in inch",
    "arcmin": "arcmin '",
    "arcsec": "arcsec",
    "deg": "° deg Grad",
    "mrad": "mrad",
    "degC": "°C C degC",
    "degF": "°F F degF",
    "s": "s sec sec. secs Sek Sek. second seconds Sekunde Sekunden secondes secondi segundos sekunder",
    "ms": "ms msec msecs Millisekunden milliseconds millisecondes",
    "us": "µs us usec",
    "min": "min min. mins minute minutes Minuten",
    "h": "h hr hrs hour hours Std Std. Stunde Stunden heures",
    "day": "d day days Tag Tage jour jours",
}
_ARMS = {
    "Nm": "N·m kN·mm",
    "kNm": "kN·m",
    "daNm": "daN·m",
    "Ncm": "N·cm cN·m",
    "Nmm": "N·mm",
    "mNm": "mN·m",
    "oz_in": "ozf·in oz·in",
    "lb_in": "lbf·in lb·in lbs·in",
    "lb_ft": "lbf·ft lb·ft lbs·ft",
    "kgf_m": "kgf·m kp·m",
    "kgf_cm": "kgf·cm kp·cm kg·cm",
}
"""Units of torque as force and arm; inch and foot may stand first. `kg·cm` is how servos are sold."""

_INERTIAS = {
    "kgm2": "kg·m2",
    "kg_cm2": "kg·cm2",
    "kg_mm2": "kg·mm2",
    "g_cm2": "g·cm2",
    "lb_in2": "lb·in2 lbm·in2 lbs·in2",
    "lb_ft2": "lb·ft2 lbm·ft2 lbs·ft2",
    "oz_in2": "oz·in2",
    "lb_in_s2": "lb·in·s2 lbf·in·s2 lb·in·sec2 lbf·in·sec2",
    "oz_in_s2": "oz·in·s2 ozf·in·s2 oz·in·sec2 ozf·in·sec2",
}
"""Units of inertia: with a square of time as torque for each angular acceleration, else as mass and arm squared."""

FREQUENCY = "Hz"
"""May count turns, or be the electrical frequency of a motor: so many times the turns as it has pairs of poles."""

_SIGNS = " .·⋅∙•‧・*×"
"""Signs of a product, besides a hyphen."""

_PRODUCT = re.compile(rf"(?<=[A-Za-z])[{_SIGNS}_-]+(?=[A-Za-z])")
_AS_TYPED = str.maketrans({**dict.fromkeys("\N{MINUS SIGN}\N{EN DASH}\N{HYPHEN}", "-"), "μ": "µ"})
_SUPERSCRIPT = re.compile(r"\^?\(?-1\)?$")
_SQUARE = re.compile(r"(?:\^|\*\*)\(?2\)?$")


def _spelling(text: str) -> str:
    """A unit with one sign for a product and one way of writing `per`: `N.m`, `N-m` and `N·m` are `N·m`."""
    tight = unicodedata.normalize("NFKC", text).strip().translate(_AS_TYPED)
    inverse = _SUPERSCRIPT.sub("-1", tight)
    if inverse != tight or inverse.endswith("-1"):
        return re.sub(rf"[{_SIGNS}^()]", "", inverse)
    product = _PRODUCT.sub("·", _SQUARE.sub("2", tight))
    return re.sub(r"\.? */ *", "/", product.removesuffix(".") if "·" in product else product)


def _spellings() -> dict[str, tuple[str, ...]]:
    found: dict[str, list[str]] = {}
    for code, words in _SPELLED.items():
        for word in words.split():
            found.setdefault(_spelling(word), []).append(code)
    for code, products in _ARMS.items():
        for product in products.split():
            force, arm = product.split("·")
            for first, second in ((force, arm), (arm, force))[: 2 if arm in ("in", "ft") else 1]:
                found[f"{first}·{second}"] = found[f"{first}{second}"] = [code]
                found[f"{first}·{second}s"] = [code]
    for code, products in _INERTIAS.items():
        for product in products.split():
            found[product] = found[product.replace("·", "")] = [code]
    found["Newtonmeter"] = found["Newton·meter"] = found["newton·metres"] = ["Nm"]
    return {spelling: tuple(codes) for spelling, codes in found.items()}


SPELLINGS = _spellings()
"""A unit as people write it -> the codes that it may stand for: `1/s` may count revolutions or radians."""

_FOLDED = {
    spelling.casefold(): codes
    for spelling, codes in SPELLINGS.items()
    if len({other for each, other in SPELLINGS.items() if each.casefold() == spelling.casefold()}) == 1
    and not spelling.startswith(("mN", "Ms"))  # M and m are a factor of a thousand million
    and spelling != "d"
}
QUANTITY_OF = {code: name for name, codes in READ.items() for code in codes}
"""Code of a unit -> kind of quantity."""


def codes_for(text: str, quantity: str = "") -> tuple[str, ...]:
    """Codes that a unit as somebody writes it may stand for, of one quantity or any; several where it is ambiguous."""
    if len(text) > 40:
        return ()
    spelling = _spelling(text)
    codes = SPELLINGS.get(spelling) or _FOLDED.get(spelling.casefold(), ())
    return tuple(code for code in codes if quantity in ("", QUANTITY_OF[code]))


def quantity_of(suffix: str) -> str:
    """Kind of quantity of a unit of the wire; blank for a pure number."""
    whole = suffix.removesuffix("_per_rad")
    return QUANTITY_OF.get(whole, "")


def symbol_of_code(code: str) -> str:
    """Symbol of a unit by its code."""
    return _SYMBOL[code]
