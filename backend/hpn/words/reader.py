"""The reader of a page or a file: language, units and number format of all content.

The only catalogue of translations for page and files is compiled in memory on first use. Babel comes with the extra
`serve` and takes a third of the time of `hpn select`: it is imported only where a reader sees the result.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from gettext import GNUTranslations, NullTranslations
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from hpn.words import units
from hpn.words.source import source_sentence
from hpn.words.units import Measure
from hpn.words.wording import Quantity, Sentence, rounded, telling_decimals

if TYPE_CHECKING:
    from babel.messages.catalog import Catalog

FOLDER = Path(__file__).parent / "locale"
LANGUAGES = ("en", "de")
"""English is the language of the texts themselves and needs no catalogue."""

LANGUAGE_NAMES = {"en": "English", "de": "Deutsch"}
"""Each language by its own name."""

GROUP = "\N{NARROW NO-BREAK SPACE}"
"""Separator of thousands in English, where a comma would be a decimal mark elsewhere; and before a unit."""

MINUS, NOTHING = "\N{MINUS SIGN}", "–"
_DATES = {"en": "en_GB", "de": "de_DE"}
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Reader:
    """A language, units for display, and significant digits of a computed number: 3 on pages, 4 in files.

    Everything else (API, links, `data-value`) uses the units of the wire and has every digit.
    """

    language: str = "en"
    units: tuple[str, ...] = ()
    digits: int = 3

    @classmethod
    def of_marker(cls, marker: str) -> "Reader":
        """Reader of a `marker`; its unknown parts count as English and the units of the wire."""
        code = marker.partition(".")[0]
        return cls(code if code in LANGUAGES else "en", units.codes_of(marker))

    @property
    def marker(self) -> str:
        """Language and units in one word, such as `de.lb_in`; blank for English in the units of the wire."""
        return ".".join((*((self.language,) if self.language != "en" else ()), *self.units))

    @property
    def preset(self) -> str:
        """Name of the preset with these units, or blank."""
        return next((name for name, codes in units.PRESETS.items() if set(codes) == set(self.units)), "")

    @property
    def decimal(self) -> str:
        """Decimal mark."""
        return _marks(self.language)[0]

    @property
    def group(self) -> str:
        """Mark between thousands."""
        return _marks(self.language)[1]

    # --- Texts --------------------------------------------------------------------------------------------------------

    def text(self, english: str) -> str:
        """A text in the reader's language; an unknown one stays English."""
        return translations(self.language).gettext(english) if english else ""

    def plural(self, one: str, many: str, number: int) -> str:
        """A text in the singular or plural of a number."""
        return translations(self.language).ngettext(one, many, number)

    def sentence(self, sentence: Sentence) -> str:
        """A sentence in the reader's language and units."""
        return sentence.render(self.text, self.quantity)

    def source(self, source: str) -> str:
        """Short source of a catalogue's figure or of a check's limit: `table 12.1, p. 12`."""
        return self.sentence(source_sentence(source))

    def translated(self, texts: Mapping[str, str]) -> list[tuple[str, str]]:
        """Options of a choice: codes with their texts."""
        return [(code, self.text(text)) for code, text in texts.items()]

    def date(self, moment: datetime) -> str:
        """Day and time in UTC."""
        return f"{self.day(moment)}, {moment.astimezone(UTC):%H:%M} UTC"

    def day(self, moment: datetime) -> str:
        """Day in UTC."""
        from babel.dates import format_date

        return format_date(moment.astimezone(UTC).date(), "long", locale=_DATES[self.language])

    # --- Units --------------------------------------------------------------------------------------------------------

    def measure(self, unit: str) -> Measure:
        """Measure of a unit of the wire, given as suffix or symbol, in the reader's units."""
        return units.measure(unit, self.units)

    def unit(self, unit: str) -> str:
        """Symbol of the reader's unit for a unit of the wire, given as suffix or symbol."""
        return self.text(self.measure(unit).symbol)

    def value(self, value: float | None, unit: str) -> float | None:
        """A number of the wire in the reader's unit."""
        return None if value is None else self.measure(unit).number(value)

    # --- Numbers ------------------------------------------------------------------------------------------------------

    def figure(self, value: float | None, unit: str = "", beside: float | None = None) -> str:
        """A number of the wire in the reader's unit; None is a dash.

        As printed if it is short, else to `digits`, but with all digits before the decimal mark: with three digits
        32.0210136 is `32.0`, 1167275.9 `1 167 276`. Hours are whole from 100 on, and above 100 million `> 100 000 000`
        unless the number `beside` it is that large, too. It has enough digits to differ from the number `beside` it.
        """
        if value is None:
            return NOTHING
        measure = self.measure(unit)
        number = measure.number(value)
        other = None if beside is None else measure.number(beside)
        if unit == HOURS and number > MOST_HOURS and (other is None or other <= MOST_HOURS):
            return f">{GROUP}{self.written(str(MOST_HOURS))}"
        if _is_extreme(number):
            return self._scientific(_told_apart(_exponential, number, other, self.digits))
        is_whole = unit == HOURS and abs(number) >= 100
        write, digits = (_decimals, 0) if is_whole else (_short, self.digits)
        return self.written(_told_apart(write, number, other, digits))

    def distinct(self, value: float, other: float | None, unit: str) -> str:
        """A number with enough digits to differ from another one."""
        return "∞" if math.isinf(value) else self.figure(value, unit, other)

    def exact(self, value: float | None, unit: str = "") -> str:
        """An input as given, or to six digits in another unit; None is a dash."""
        if value is None:
            return NOTHING
        measure = self.measure(unit)
        return self.written(f"{value:.12g}" if measure.same else measure.written(value, 6))

    def fixed(self, value: float, unit: str, places: int) -> str:
        """A number of the wire in the reader's unit with as many decimals as its neighbours in a column."""
        return self.written(f"{self.measure(unit).number(value):.{places}f}")

    def mass(self, value: float | None) -> str:
        """Mass of several gears: two decimals everywhere, with which lists add up."""
        return NOTHING if value is None else self.fixed(value, "kg", 2)

    def with_unit(self, number: str, unit: str) -> str:
        """A written number with the reader's unit; without it where the unit is blank."""
        return f"{number}{GROUP}{self.unit(unit)}" if unit and number != NOTHING else number

    def quantity(self, quantity: Quantity) -> str:
        """A quantity of a sentence, with its unit."""
        return self.with_unit(self.number(quantity), quantity.unit)

    def number(self, quantity: Quantity) -> str:
        """Number of a quantity in the reader's unit, without the unit, with every whole digit."""
        number, digits = self.measure(quantity.unit).number(quantity.value), quantity.digits
        if quantity.rounding == "nearest" and not _is_extreme(number):
            digits = max(digits, len(f"{abs(number):.0f}"))
        return self.written(rounded(number, digits, quantity.rounding))

    def bound(self, quantity: Quantity) -> str:
        """Number of a quantity as given, for a message beside a field that shows the unit."""
        return self.exact(quantity.value, quantity.unit)

    def percent(self, share: float | None, allowed: float = 1.0) -> str:
        """A share as a percentage, with enough digits to differ from the allowed one."""
        return NOTHING if share is None else f"{self._percent(100 * share, allowed)}{GROUP}%"

    def capped_percent(self, share: float | None, allowed: float = 1.0) -> str:
        """Percentage without its sign, for a narrow cell; beyond tenfold only `>999`."""
        if share is None:
            return NOTHING
        return ">999" if share >= 9.995 else self._percent(100 * share, allowed)

    def _percent(self, value: float, allowed: float) -> str:
        if value >= 1e7:
            return self._scientific(f"{value:.{self.digits - 1}e}")
        least = 1 if 0 < value < 9.95 else self.digits - 3 if value < 1000 else 0
        return self.written(f"{value:.{telling_decimals(value, 100 * allowed, least)}f}")

    def tick(self, value: float) -> str:
        """A round number on an axis."""
        if value == 0 or 1e-3 <= abs(value) < 1e6:
            return self.written(f"{value:.6g}")
        mantissa, exponent = f"{value:.3e}".split("e")
        return self._scientific(f"{float(mantissa):g}e{exponent}")

    def written(self, number: str) -> str:
        """A rounded number, such as `2e+04` or `-1234.50`, with the reader's marks."""
        exponent = number.partition("e")[2]
        if not exponent:
            return self._marked(number)
        if -5 <= int(exponent) < 10:
            return self._marked(f"{float(number):.15f}".rstrip("0").rstrip("."))
        return self._scientific(number)

    def _scientific(self, number: str) -> str:
        mantissa, exponent = number.split("e")
        return f"{self._marked(mantissa)}·{self.power_of_ten(int(exponent))}"

    @staticmethod
    def power_of_ten(exponent: int) -> str:
        """A power of ten with its exponent above the line."""
        return f"10{str(exponent).translate(_SUPERSCRIPT)}"

    def _marked(self, number: str) -> str:
        decimal, group = _marks(self.language)
        whole, _, fraction = number.lstrip("+-").partition(".")
        if not whole.isdigit():  # infinity
            return number
        sign = MINUS if number.startswith("-") else ""
        return sign + f"{int(whole):,}".replace(",", group) + (decimal + fraction if fraction else "")


DEFAULT = Reader()


HOURS = "h"
MOST_HOURS = 100_000_000
"""Longest life in h that is written out."""

MOST_DIGITS = 15


def _short(value: float, digits: int) -> str:
    """A number with all its digits if it has at most four, else to `digits`, with all digits before its point."""
    short = f"{value:.12g}"
    if "e" not in short and len(short.lstrip("-").replace(".", "").lstrip("0")) <= 4:
        return short
    return f"{value:.0f}" if abs(value) >= 10 ** (digits - 1) else f"{value:#.{digits}g}".rstrip(".")


def _decimals(value: float, decimals: int) -> str:
    return f"{value:.{decimals}f}"


def _exponential(value: float, digits: int) -> str:
    return f"{value:.{digits - 1}e}"


def _told_apart(write: Callable[[float, int], str], value: float, other: float | None, digits: int) -> str:
    """A number written with the fewest digits at which it differs from another one.

    Both get as many digits, so that the larger one never reads as the smaller; numbers equal within 1e-12 need no more.
    """
    if other is not None and math.isfinite(other) and not math.isclose(value, other, rel_tol=1e-12):
        while digits < MOST_DIGITS and float(write(value, digits)) == float(write(other, digits)):
            digits += 1
    return write(value, digits)


def _is_extreme(value: float) -> bool:
    return abs(value) >= 1e10 or 0 < abs(value) < 1e-4


@cache
def _marks(code: str) -> tuple[str, str]:
    """Decimal and group mark."""
    from babel import Locale

    marks = Locale.parse(code).number_symbols["latn"]
    return marks["decimal"], GROUP if code == "en" else marks["group"]


# --- Translations -----------------------------------------------------------------------------------------------------


def path_of(code: str) -> Path:
    """Path of a language's catalogue."""
    return FOLDER / code / "LC_MESSAGES/hpn.po"


def catalogue(code: str) -> "Catalog":
    """Catalogue of a language, read from its file."""
    from babel.messages.pofile import read_po

    with path_of(code).open("rb") as file:
        return read_po(file, locale=code, domain="hpn")


@cache
def translations(code: str) -> NullTranslations:
    """Translations of one of LANGUAGES for gettext; raises KeyError for any other."""
    if code not in LANGUAGES:
        raise KeyError(code)
    if code == "en":
        return NullTranslations()
    from babel.messages.mofile import write_mo

    compiled = BytesIO()
    write_mo(compiled, catalogue(code))
    compiled.seek(0)
    return GNUTranslations(compiled)
