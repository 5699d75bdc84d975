"""Sentences with numbers in them: an English template, and values that each reader sees in their own units."""

from collections.abc import Callable
from dataclasses import dataclass, field

from hpn.units import SYMBOLS


def N_(text: str) -> str:
    """Mark a text for the translators; it is translated where it is shown."""
    return text


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with the suffix of its unit, rounded for reading where it is shown."""

    value: float
    unit: str
    digits: int = 3

    def __str__(self) -> str:
        """English, in the unit of the wire."""
        return f"{self.value:.{self.digits}g} {SYMBOLS[self.unit]}"


Value = Quantity | str | int


@dataclass(frozen=True, slots=True)
class Sentence:
    """An English template (msgid for translation) and the values in it; `translated` names values that are msgids."""

    template: str
    values: dict[str, Value] = field(default_factory=dict)
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
            else translate(str(value))
            if name in self.translated
            else str(value)
            for name, value in self.values.items()
        }
        return translate(self.template).format(**values)
