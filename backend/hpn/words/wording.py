"""Sentences with numbers: an English template, and values that each reader sees in their own units."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Union

from msgspec import Struct, field
from msgspec.structs import replace

from hpn.words.units import N_ as N_
from hpn.words.units import SYMBOLS

Rounding = Literal["nearest", "down", "up"]


class MendableError(Exception):
    """An error that the caller or the operator can mend; its text names the fault and the remedy."""


class Quantity(Struct, frozen=True, tag=True):
    """A number with the suffix of its unit, rounded where it is shown; a blank unit means a pure number.

    A bound is rounded to the safe side, in any unit.
    """

    value: float
    unit: str
    digits: int = 3
    rounding: Rounding = "nearest"

    def __str__(self) -> str:
        """English text in the unit of the wire; a large number in full, `5830` instead of `5.83e+03`."""
        number = rounded(self.value, self.digits, self.rounding)
        if "e+" in number and abs(self.value) < 1e12:
            number = f"{float(number):.0f}"
        return f"{number} {SYMBOLS.get(self.unit, '')}".rstrip()


def rounded(value: float, digits: int, rounding: Rounding = "nearest") -> str:
    """A number to `digits` significant digits; rounding never moves a bound to the wrong side."""
    text = f"{value:.{digits}g}"
    if rounding == "nearest" or not math.isfinite(value):
        return text
    # Floating-point errors don't count: 107 stays 107, up and down.
    beyond = float(text) > value * (1 + 1e-14) if rounding == "down" else float(text) < value * (1 - 1e-14)
    if not beyond:
        return text
    step = 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1)
    return f"{float(text) + (step if rounding == 'up' else -step):.{digits}g}"


MOST_DECIMALS = 10


def telling_decimals(value: float, bound: float, least: int) -> int:
    """Decimals, at least `least`, at which a rounded percentage stays on its own side of a bound and of 100.

    Within a relative 1e-12 a value is on neither side, as in the checks.
    """
    marks = [mark for mark in (bound, 100.0) if abs(value - mark) <= 1 + _ROOM * abs(mark)]
    decimals = least
    while decimals < MOST_DECIMALS and any(_side(round(value, decimals), mark) != _side(value, mark) for mark in marks):
        decimals += 1  # more than 1 away from a mark: rounding moves a value by half at most
    return decimals


def _side(value: float, bound: float) -> int:
    if abs(value / bound - 1) <= _ROOM:
        return 0
    return 1 if value > bound else -1


_ROOM = 1e-12


class Typed(Struct, frozen=True, tag=True):
    """A number to type instead of another text, with the unit behind it; a form offers it if it is `whole`.

    It is in plain notation until a page writes it with the reader's decimal mark. A number that is not whole replaces
    only a part of the text, such as a number in a sum.
    """

    number: str
    unit: str = ""
    whole: bool = True

    def __str__(self) -> str:
        return f"{self.number} {self.unit}".rstrip()


Value = Union[Quantity, Typed, str, int, "Sentence"]


class Sentence(Struct, frozen=True, tag=True):
    """An English template (msgid for translation) and its values, which may be other sentences.

    `translated` names values that are msgids.
    """

    template: str
    values: Mapping[str, "Value"] = field(default_factory=dict)
    translated: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The sentence in English and in the units of the wire."""
        return self.render(str, str)

    def render(self, translate: Callable[[str], str], show: Callable[[Quantity], str]) -> str:
        """The sentence in the reader's language and units."""
        values = {
            name: show(value)
            if isinstance(value, Quantity)
            else value.render(translate, show)
            if isinstance(value, Sentence)
            else translate(str(value))
            if name in self.translated
            else str(value)
            for name, value in self.values.items()
        }
        return translate(self.template).format(**values)

    @property
    def offers(self) -> tuple[str, ...]:
        """Texts that may replace the content of a field."""
        of_parts = (value.offers for value in self.values.values() if isinstance(value, Sentence))
        own = (str(value) for value in self.values.values() if isinstance(value, Typed) and value.whole)
        return (*own, *(offer for offers in of_parts for offer in offers))

    def marked(self, decimal: str) -> "Sentence":
        """The sentence with a decimal mark in the numbers to type."""
        return replace(self, values={name: _marked(value, decimal) for name, value in self.values.items()})


def _marked(value: Value, decimal: str) -> Value:
    if isinstance(value, Typed):
        return replace(value, number=value.number.replace(".", decimal))
    return value.marked(decimal) if isinstance(value, Sentence) else value


def first_of(names: Iterable[object], most: int) -> str:
    """Names in a row, with `…` in place of those beyond `most`."""
    texts = list(map(str, names))
    return ", ".join([*texts[:most], "…"] if len(texts) > most else texts)


def shortened(lines: Sequence[str], most: int) -> list[str]:
    """The first lines, and a line with the count of the rest."""
    return [*lines[:most], *([f"and {len(lines) - most} more"] if len(lines) > most else [])]


def listed(parts: Sequence[Sentence], template: str = "{first}, {rest}") -> Sentence:
    """Sentences in a row, joined by a template with `first` and `rest`."""
    *early, joined = parts
    for part in reversed(early):
        joined = Sentence(template, {"first": part, "rest": joined})
    return joined


@dataclass(frozen=True, slots=True)
class Named:
    """Name of a quantity (an English msgid), its symbol, a sentence on it, and the handbook's equation for it.

    `caveat` (a msgid too) is a warning that always goes with it.

    An index stands behind an underscore: `T_av`. The sentence of an input is in the application model.
    """

    name: str
    symbol: str = ""
    sentence: str = ""
    equation: str = ""
    caveat: str = ""
