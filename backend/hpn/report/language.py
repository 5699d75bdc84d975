"""Texts and numbers of a file in the reader's language."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache, cached_property
from string import Formatter

from babel.dates import format_date
from babel.numbers import get_decimal_symbol

from hpn.checks import telling_decimals
from hpn.translation import LANGUAGES, texts

__all__ = ["LANGUAGES", "Language", "language"]

_DATES = {"en": "en_GB", "de": "de_DE"}
GROUP = "\N{NARROW NO-BREAK SPACE}"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_QUANTITY = re.compile(r"-?[0-9]+(\.[0-9]+)?(e[+-]?[0-9]+)? \S{1,8}")


@dataclass(frozen=True)
class Language:
    """A language: its texts by their English ones, and how it writes numbers."""

    code: str
    messages: Mapping[str, str] = field(default_factory=dict, repr=False, hash=False)

    def text(self, english: str) -> str:
        """A text in this language; an unknown one stays English."""
        return self.messages.get(english, english)

    def unit(self, symbol: str) -> str:
        """Symbol of a unit as it is written in this language: `rpm` is `min⁻¹` in German."""
        return self.messages.get(symbol, symbol)

    def filled(self, english: str) -> str:
        """A text whose template was filled in English already: the template is recognised by its fixed parts."""
        if english in self.messages or not self.messages:
            return self.text(english)
        for pattern, template in self._templates:
            if match := pattern.fullmatch(english):
                return template.format(**{name: self._value(value) for name, value in match.groupdict().items()})
        return english

    def _value(self, value: str) -> str:
        if not _QUANTITY.fullmatch(value):
            return self.filled(value)
        number, _, unit = value.partition(" ")
        return f"{number.replace('.', self.decimal)} {self.unit(unit)}"

    @cached_property
    def _templates(self) -> list[tuple[re.Pattern[str], str]]:
        """Templates with the most fixed text first, so that a loose one takes nothing from a strict one."""
        templates = sorted((m for m in self.messages if "{" in m and _telling(m)), key=len, reverse=True)
        return [(_pattern(template), _plain(self.messages[template])) for template in templates]

    @cached_property
    def decimal(self) -> str:
        """Decimal mark."""
        return get_decimal_symbol(self.code)

    def exact(self, value: float) -> str:
        """An input as it was given, up to twelve digits."""
        if not _extreme(value):
            return self._written(f"{value:.12g}")
        mantissa, exponent = f"{value:.11e}".split("e")
        return f"{self._written(f'{float(mantissa):.12g}')}·10{exponent_of(exponent)}"

    def figure(self, value: float | None) -> str:
        """A computed number to four digits, never fewer than its integer; None is a dash."""
        if value is None:
            return "–"
        if _extreme(value):
            return self._scientific(value)
        if abs(value) >= 1000:
            return self._written(f"{value:.0f}")
        short = f"{value:.12g}"
        return self._written(short if len(short.lstrip("-0.").replace(".", "")) <= 4 else f"{value:#.4g}".rstrip("."))

    def percent(self, share: float | None, allowed: float = 1.0) -> str:
        """A share as a percentage, with as many digits as it takes to tell it from what is allowed."""
        if share is None:
            return "–"
        value = share * 100
        digits = telling_decimals(value, 100 * allowed, 0 if value >= 1000 else 1)
        if value >= 1e7 or 0 < value < 1e-3:
            number = self._scientific(value)
        else:
            number = self._written(f"{value:.{digits}f}" if value == 0 or value >= 0.1 else f"{value:.2g}")
        return f"{number}\N{NO-BREAK SPACE}%"

    def tick(self, value: float) -> str:
        """A round number on an axis."""
        if value == 0 or 1e-3 <= abs(value) < 1e6:
            return self.exact(float(f"{value:.6g}"))
        mantissa, exponent = f"{value:.3e}".split("e")
        return f"{self._written(f'{float(mantissa):g}')}·10{exponent_of(exponent)}"

    def date(self, moment: datetime) -> str:
        """Day and time in UTC."""
        utc = moment.astimezone(UTC)
        return f"{format_date(utc.date(), 'long', locale=_DATES[self.code])}, {utc:%H:%M} UTC"

    def _written(self, number: str) -> str:
        whole, _, fraction = number.partition(".")
        grouped = f"{int(whole):,}".replace(",", GROUP)
        sign = "\N{MINUS SIGN}" if number.startswith("-") else ""
        return sign + grouped.removeprefix("-") + (self.decimal + fraction if fraction else "")

    def _scientific(self, value: float) -> str:
        mantissa, exponent = f"{value:.3e}".split("e")
        return f"{self._written(mantissa)}·10{exponent_of(exponent)}"


def exponent_of(digits: str) -> str:
    """An exponent as superscript."""
    return str(int(digits)).translate(_SUPERSCRIPT)


def _extreme(value: float) -> bool:
    return abs(value) >= 1e10 or 0 < abs(value) < 1e-4


def _telling(template: str) -> bool:
    """Whether the fixed parts are enough to know the template by."""
    return sum(letter.isalpha() for literal, *_ in Formatter().parse(template) for letter in literal) >= 9


def _pattern(template: str) -> re.Pattern[str]:
    parts = []
    for literal, name, _, _ in Formatter().parse(template):
        parts.append(re.escape(literal) + (f"(?P<{name}>.+?)" if name else ""))
    return re.compile("".join(parts), re.DOTALL)


def _plain(template: str) -> str:
    """The template without format specifications: its values are texts already."""
    return "".join(
        literal.replace("{", "{{").replace("}", "}}") + (f"{{{name}}}" if name else "")
        for literal, name, _, _ in Formatter().parse(template)
    )


@cache
def language(code: str) -> Language:
    """One of LANGUAGES. Raises KeyError for another code."""
    return Language(code, texts(code))
