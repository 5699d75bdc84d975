"""Units: the suffix of a field's name such as `_Nm`, and the units that users choose and type.

Units are converted exactly, by pint.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import ROUND_HALF_EVEN, Context, Decimal
from fractions import Fraction
from functools import cache, lru_cache
from math import inf
from typing import Any, NamedTuple

from hpn.words.patterns import Pattern


def N_(text: str) -> str:
    """Mark a text for the translators; it is translated where it appears."""
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
    "deg_per_s3": "°/s³",
    "mm_per_s3": "mm/s³",
    "kgm2": "kg·m²",
    "Nm_per_rpm": N_("Nm/rpm"),
    "g_per_cm3": "g/cm³",
    "Hz": "Hz",
    "rad_per_s": "rad/s",
    "J": "J",
    "kW_per_s": "kW/s",
    "kW": "kW",
}
"""Unit suffix of a field name -> symbol for a reader."""

_LONGEST_FIRST = sorted(SYMBOLS, key=len, reverse=True)


@lru_cache(maxsize=1024)  # names may come from a request: the cache has a limit
def suffix_of(field_name: str) -> str:
    """Unit suffix that ends a field name (`torque_Nm` -> `Nm`), blank for a field without a unit."""
    return next((unit for unit in _LONGEST_FIRST if field_name.endswith("_" + unit)), "")


def symbol_of(field_name: str) -> str:
    """Symbol of a field's unit (`life_L10_h` -> `h`), blank for a field without one."""
    return SYMBOLS.get(suffix_of(field_name), "")


# --- Units that users choose and type ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit: its symbol, its name in pint, and further spellings separated by blanks; pages offer it if `shown`.

    A torque is spelled as force and arm, an inertia as mass and arm squared: `spellings.py` derives the other forms.
    """

    symbol: str
    pint: str
    spelled: str = ""
    shown: bool = False


UNITS: Mapping[str, Mapping[str, Unit]] = {
    "torque": {
        "Nm": Unit("Nm", "newton * meter", "N·m kN·mm", shown=True),
        "kNm": Unit("kNm", "kilonewton * meter", "kN·m"),
        "daNm": Unit("daNm", "decanewton * meter", "daN·m"),
        "Ncm": Unit("Ncm", "newton * centimeter", "N·cm cN·m"),
        "Nmm": Unit("Nmm", "newton * millimeter", "N·mm"),
        "mNm": Unit("mNm", "millinewton * meter", "mN·m"),
        "oz_in": Unit("oz·in", "force_ounce * inch", "ozf·in oz·in"),
        "lb_in": Unit("lb·in", "force_pound * inch", "lbf·in lb·in lbs·in", shown=True),
        "lb_ft": Unit("lb·ft", "force_pound * foot", "lbf·ft lb·ft lbs·ft", shown=True),
        "kgf_m": Unit("kgf·m", "kilogram_force * meter", "kgf·m kp·m"),
        "kgf_cm": Unit("kgf·cm", "kilogram_force * centimeter", "kgf·cm kp·cm kg·cm"),  # kg·cm is how servos are sold
    },
    "speed": {
        "rpm": Unit(
            N_("rpm"),
            "rpm",
            "rpm r.p.m. 1/min /min U/min Umdr/min r/min rev/min revs/min Upm tr/min tr/mn giri/min varv/min "
            "omw/min ot/min turn/min turns/min min-1 U·min-1 r·min-1 rev·min-1 tr·min-1",
            shown=True,
        ),
        "krpm": Unit("krpm", "kilorpm", "krpm kU/min"),
        "rev_per_s": Unit(
            N_("rev/s"),
            "revolution / second",
            "rev/s rev/sec revs/s revs/sec U/s r/s rps tr/s giri/s varv/s turn/s turns/s turns/sec 1/s /s s-1 Hz "
            "U·s-1 r·s-1 rev·s-1 tr·s-1",
        ),
        "rad_per_s": Unit("rad/s", "radian / second", "rad/s rad/sec rads-1 1/s /s s-1 Hz", shown=True),
        "deg_per_s": Unit(
            "°/s",
            "degree / second",
            "°/s °/sec deg/s deg/sec degree/s degrees/s Grad/s degs-1 °s-1",
            shown=True,
        ),
        "deg_per_min": Unit("°/min", "degree / minute", "°/min deg/min degree/min degrees/min Grad/min"),
    },
    "force": {
        "N": Unit("N", "newton", "N Newton newtons", shown=True),
        "kN": Unit("kN", "kilonewton", "kN"),
        "daN": Unit("daN", "decanewton", "daN"),
        "lbf": Unit("lbf", "force_pound", "lbf lb lbs", shown=True),
        "kgf": Unit("kgf", "kilogram_force", "kgf kp"),
    },
    "weight": {
        "kg": Unit("kg", "kilogram", "kg", shown=True),
        "g": Unit("g", "gram", "g"),
        "lb": Unit("lb", "pound", "lb lbs", shown=True),
        "oz": Unit("oz", "ounce", "oz"),
    },
    "length": {
        "mm": Unit("mm", "millimeter", "mm", shown=True),
        "cm": Unit("cm", "centimeter", "cm"),
        "m": Unit("m", "meter", "m"),
        "in": Unit("in", "inch", "in inch", shown=True),
    },
    "angle": {
        "arcmin": Unit("arcmin", "arcminute", "arcmin ' ′", shown=True),
        "mrad": Unit("mrad", "milliradian", "mrad", shown=True),
        "deg": Unit("°", "degree", "° deg Grad"),
        "arcsec": Unit("arcsec", "arcsecond", 'arcsec " ″'),
        "rad": Unit("rad", "radian", "rad"),
        "rev": Unit("rev", "revolution", "rev revs turn turns Umdr"),
    },
    "temperature": {
        "degC": Unit("°C", "degC", "°C C degC", shown=True),
        "degF": Unit("°F", "degF", "°F F degF", shown=True),
    },
    "time": {
        "s": Unit(
            "s", "second", "s sec sec. secs Sek Sek. second seconds Sekunde Sekunden secondes secondi segundos sekunder"
        ),
        "ms": Unit("ms", "millisecond", "ms msec msecs Millisekunden milliseconds millisecondes"),
        "us": Unit("µs", "microsecond", "µs us usec"),
        "min": Unit("min", "minute", "min min. mins minute minutes Minuten"),
        "h": Unit("h", "hour", "h hr hrs hour hours Std Std. Stunde Stunden heures"),
        "day": Unit("d", "day", "d day days Tag Tage jour jours"),
        "year": Unit(
            "yr", "year", "yr yrs year years Jahr Jahre"
        ),  # 365.25 days, as the page says where a life is typed
    },
    "inertia": {
        "kgm2": Unit("kg·m²", "kilogram * meter ** 2", "kg·m2"),
        "kg_cm2": Unit("kg·cm²", "kilogram * centimeter ** 2", "kg·cm2"),
        "kg_mm2": Unit("kg·mm²", "kilogram * millimeter ** 2", "kg·mm2"),
        "g_cm2": Unit("g·cm²", "gram * centimeter ** 2", "g·cm2"),
        "lb_in2": Unit("lb·in²", "pound * inch ** 2", "lb·in2 lbm·in2 lbs·in2"),
        "lb_ft2": Unit("lb·ft²", "pound * foot ** 2", "lb·ft2 lbm·ft2 lbs·ft2"),
        "oz_in2": Unit("oz·in²", "ounce * inch ** 2", "oz·in2"),
        "lb_in_s2": Unit("lb·in·s²", "force_pound * inch * second ** 2", "lb·in·s2 lbf·in·s2 lb·in·sec2 lbf·in·sec2"),
        "oz_in_s2": Unit("oz·in·s²", "force_ounce * inch * second ** 2", "oz·in·s2 ozf·in·s2 oz·in·sec2 ozf·in·sec2"),
    },
    "power": {
        "kW": Unit("kW", "kilowatt", "kW"),
        "W": Unit("W", "watt", "W Watt"),
        "hp": Unit("hp", "horsepower", "hp HP"),
    },
    "frequency": {"Hz": Unit("Hz", "hertz", "Hz"), "kHz": Unit("kHz", "kilohertz", "kHz")},
}
"""Kind of quantity -> codes of its possible units."""

NAMES = {
    "torque": N_("Torque"),
    "speed": N_("Speed"),
    "force": N_("Force"),
    "weight": N_("Weight"),
    "length": N_("Length"),
    "angle": N_("Angle"),
    "temperature": N_("Temperature"),
}
"""Kinds of quantities with a unit that the reader may choose."""

CHOICES = {name: {code: unit.symbol for code, unit in UNITS[name].items() if unit.shown} for name in NAMES}
"""Kind of quantity -> codes of its units for display, with their symbols; the first is the wire's."""

READ = {
    name: CHOICES.get(name, {}) | {code: unit.symbol for code, unit in units.items()} for name, units in UNITS.items()
}
"""Kind of quantity -> codes of all its possible units, with their symbols, those for display first."""

QUANTITY_OF = {code: name for name, codes in READ.items() for code in codes}
"""Code of a unit -> kind of quantity."""

PRESETS = {"SI": (), "US": ("lb_in", "lbf", "lb", "in", "degF")}
"""Presets of all units."""

CODES = tuple(code for units in CHOICES.values() for code in list(units)[1:])
"""Codes of the units that differ from the wire's, in the order of a cookie."""

_SUFFIXES = {symbol: suffix for suffix, symbol in SYMBOLS.items()}
_OF_CODE = {code: next(iter(units)) for units in CHOICES.values() for code in units}
NUMBER = Pattern(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]{1,3})?", 400)
"""A number in plain notation: written out, the largest has some 310 digits."""


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

    def number(self, value: float) -> float:
        """A number of the wire in this unit."""
        return value if self.same else value * float(self.factor) + float(self.offset)

    def wire(self, text: str) -> float:
        """Number typed in this unit, converted to the wire's.

        Twelve digits are kept, or all of them if more than thirteen are given, so that every float can be written.
        """
        try:
            value = float((Fraction(text) - self.offset) / self.factor)
        except OverflowError:
            return inf
        return value if _digits(text) > 13 else float(f"{value:.12g}")

    def written(self, value: float, digits: int) -> str:
        """A number of the wire in this unit, correctly rounded to `digits`, in the plainest notation."""
        exact = Fraction(repr(value)) * self.factor + self.offset
        rounded = Context(prec=digits, rounding=ROUND_HALF_EVEN).divide(
            Decimal(exact.numerator), Decimal(exact.denominator)
        )
        if not rounded or -6 <= rounded.adjusted() < 15:
            text = f"{rounded:f}"
            return text.rstrip("0").rstrip(".") if "." in text else text
        return f"{rounded.normalize():e}".replace("e+", "e")

    def shortest(self, value: float) -> str:
        """Shortest text that `wire` reads as exactly this number."""
        for text in (self.written(value, digits) for digits in range(1, 50)):
            if self.wire(text) == value:
                return text
        # A short text for a number with more digits: added zeros make all digits count.
        mantissa, e, exponent = text.partition("e")
        return mantissa + ("" if "." in text else ".") + "0" * (14 - _digits(text)) + e + exponent


def _digits(text: str) -> int:
    """Number of significant digits."""
    mantissa = text.casefold().partition("e")[0]
    return len("".join(filter(str.isdigit, mantissa)).lstrip("0"))


def measure(unit: str, chosen: tuple[str, ...]) -> Measure:
    """Measure in which a unit of the wire (suffix `Nm_per_rad` or symbol `Nm/rad`) is shown, for the chosen codes."""
    suffix = unit if unit in SYMBOLS else _SUFFIXES.get(unit, unit)
    return _measure(suffix, chosen)


@cache
def _measure(suffix: str, chosen: tuple[str, ...]) -> Measure:
    whole = quotient_of(suffix).dividend
    return entered(suffix, next((code for code in chosen if _OF_CODE[code] == whole), whole))


@cache
def entered(suffix: str, code: str) -> Measure:
    """Measure of a number in the unit of a code, for a unit of the wire with the same dimension.

    For a quotient the code may be that of the dividend only, as in `lb_in` for `lb·in/rad`, or of both, `Nm/arcmin`.
    """
    wire = quotient_of(suffix)
    over, _, under = code.partition("/")
    own = wire._replace(dividend=over, divisor=under or wire.divisor)
    if own == wire:
        return Measure(own.symbol)
    zero, one = (_registry().Quantity(Fraction(n), wire.pint).to(own.pint).magnitude for n in (0, 1))
    return Measure(own.symbol, Fraction(one - zero), Fraction(zero))


class Quotient(NamedTuple):
    """Unit by the codes of its parts, `mm` and `s` with power 2 for `mm_per_s2`; the divisor is blank without one.

    A dividend without a code, such as a percentage, is its suffix.
    """

    dividend: str
    divisor: str = ""
    power: str = ""

    @property
    def symbol(self) -> str:
        """Its symbol: `mm/s²`."""
        over = symbol_of_code(self.dividend) if self.dividend in QUANTITY_OF else SYMBOLS.get(self.dividend, "")
        return f"{over}/{symbol_of_code(self.divisor)}{_RAISED[self.power]}" if self.divisor else over

    @property
    def pint(self) -> str:
        """Its name in pint."""
        over = UNITS[QUANTITY_OF[self.dividend]][self.dividend].pint
        if not self.divisor:
            return over
        return f"({over}) / ({UNITS[QUANTITY_OF[self.divisor]][self.divisor].pint}) ** {self.power or 1}"


_RAISED = {"": "", "2": "²", "3": "³"}
_PER = Pattern(r"(\w+)_per_([a-z]+)([23]?)", 60)


@lru_cache(maxsize=1024)
def quotient_of(suffix: str) -> Quotient:
    """Parts of a unit of the wire; a unit with its own code, such as `rad_per_s`, is no quotient."""
    parts = None if suffix in QUANTITY_OF else _PER.fullmatch(suffix)
    return Quotient(*parts.groups()) if parts else Quotient(suffix)


@cache
def _registry() -> Any:
    import pint  # takes a second; readers in the units of the wire never need it

    return pint.UnitRegistry(non_int_type=Fraction)


def codes_of(text: str) -> tuple[str, ...]:
    """Unit codes in a text such as `lb_in.lbf`, at most one per quantity, in the order of CODES; others are ignored."""
    codes = text[:200].split(".")
    first = {_OF_CODE[code]: code for code in reversed(codes) if code in CODES}
    return tuple(code for code in CODES if code in first.values())


def quantity_of(suffix: str) -> str:
    """Kind of quantity of a unit of the wire; blank for a pure number and for a quotient."""
    return QUANTITY_OF.get(suffix, "")


def symbol_of_code(code: str) -> str:
    """Symbol of a unit by its code."""
    return READ[QUANTITY_OF[code]][code]
