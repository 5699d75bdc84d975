"""Who reads a page: the language, the units and the number format that everything is shown in."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from jinja2 import pass_context
from jinja2.runtime import Context

from hpn.notices import Notice
from hpn.units import SYMBOLS
from hpn.web import display
from hpn.wording import Quantity, Sentence


@dataclass(frozen=True)
class Reader:
    """A language, and units for display. Everything else (API, links, `data-value`) speaks the units of the wire."""

    language: str = "en"

    def text(self, english: str) -> str:
        """A text of the domain in the reader's language."""
        return english

    def figure(self, value: float | None, unit: str = "") -> str:
        """A number in the wire's unit as the reader sees it; `unit` is a suffix (`Nm_per_rad`) or symbol (`Nm/rad`)."""
        return display.figure(value)

    def unit(self, unit: str) -> str:
        """Symbol of the unit that the reader sees in place of a unit of the wire, given as suffix or symbol."""
        return SYMBOLS.get(unit, unit)

    def quantity(self, quantity: Quantity) -> str:
        """A quantity of a sentence, with its unit."""
        return str(quantity)

    def told(self, sentence: Sentence | Notice) -> str:
        """A sentence in the reader's language and units."""
        sentence = sentence.sentence if isinstance(sentence, Notice) else sentence
        return sentence.render(self.text, self.quantity)


DEFAULT = Reader()


def reader_of(context: Context) -> Reader:
    """Reader of the page that is rendered: the variable `reader`."""
    reader: Reader = context.get("reader") or DEFAULT
    return reader


def _for_reader(method: str) -> Callable[..., Any]:
    def filtered(context: Context, *arguments: Any) -> Any:
        return getattr(reader_of(context), method)(*arguments)

    return pass_context(filtered)


FILTERS = {name: _for_reader(name) for name in ("figure", "unit", "told")}
"""`{{ 40 | figure("Nm") }}`, `{{ "Nm" | unit }}`, `{{ sentence | told }}`, for whoever reads the page."""
