"""Who reads a page: the language, the units and the number format that everything is shown in."""

import re
import secrets
from collections.abc import Callable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

from babel import Locale
from jinja2 import pass_context
from jinja2.runtime import Context

from hpn.checks import allowed, telling_decimals
from hpn.explanations import EXPLANATIONS
from hpn.notices import Notice
from hpn.reply import REASONS
from hpn.report.language import language
from hpn.translation import LANGUAGES, translations
from hpn.web import display, measures
from hpn.web.form.messages import Message
from hpn.web.measures import Measure
from hpn.wording import N_, Quantity, Sentence, rounded

LANGUAGE_NAMES = {"en": "English", "de": "Deutsch"}
"""Each language by its own name."""


@cache
def _marks(code: str) -> tuple[str, str]:
    """Decimal and group mark. English groups with a space, because a comma there is a decimal mark elsewhere."""
    marks = Locale.parse(code).number_symbols["latn"]
    return marks["decimal"], display.GROUP if code == "en" else marks["group"]


@dataclass(frozen=True)
class Reader:
    """A language, and units for display. Everything else (API, links, `data-value`) speaks the units of the wire."""

    language: str = "en"
    units: tuple[str, ...] = ()

    @classmethod
    def of_marker(cls, marker: str) -> "Reader":
        """Reader of a `marker`; what is unknown in it counts as English and the units of the wire."""
        code = marker.partition(".")[0]
        return cls(code if code in LANGUAGES else "en", measures.codes_of(marker))

    @property
    def marker(self) -> str:
        """Language and units in one word, such as `de.lb_in`; blank for English in the units of the wire."""
        return ".".join((*((self.language,) if self.language != "en" else ()), *self.units))

    @property
    def decimal(self) -> str:
        """Decimal mark."""
        return _marks(self.language)[0]

    @property
    def group(self) -> str:
        """Mark between thousands."""
        return _marks(self.language)[1]

    @property
    def preset(self) -> str:
        """Name of the preset that these units are, or blank."""
        return next((name for name, codes in measures.PRESETS.items() if set(codes) == set(self.units)), "")

    def text(self, english: str) -> str:
        """A text of the domain in the reader's language."""
        return translations(self.language).gettext(english) if english else ""

    def plural(self, one: str, many: str, number: int) -> str:
        """A text that depends on a number."""
        return translations(self.language).ngettext(one, many, number)

    def source(self, source: str) -> str:
        """Where a figure of the catalogue comes from, in short: `table 12.1, p. 12`."""
        match = re.fullmatch(r"(table|section) ([0-9.]+)(?:, page ([0-9]+))?", source)
        if match is None:
            return self.filled(source)
        template = N_("table {number}") if match[1] == "table" else N_("section {number}")
        place = self.told(Sentence(template, {"number": match[2]}))
        page = Sentence(N_("{place}, p.\u202f{page}"), {"place": place, "page": match[3] or ""})
        return self.told(page) if match[3] else place

    def filled(self, english: str) -> str:
        """A text whose template was filled in English already, such as a notice that was saved."""
        return language(self.language).filled(english)

    def measure(self, unit: str) -> Measure:
        """How a quantity in a unit of the wire, given as suffix or symbol, is shown."""
        return measures.measure(unit, self.units)

    def value(self, value: float | None, unit: str) -> float | None:
        """A number of the wire in the unit that the reader sees."""
        return None if value is None else self.measure(unit).shown(value)

    def figure(self, value: float | None, unit: str = "") -> str:
        """A number of the wire as the reader sees it, in their unit; `unit` is a suffix or symbol of the wire."""
        return self.localised(display.figure(self.value(value, unit)))

    def exact(self, value: float | None, unit: str = "") -> str:
        """An input as it was given, or to six digits in another unit."""
        if value is None:
            return "–"
        measure = self.measure(unit)
        return self.localised(display.plain(f"{value:.12g}" if measure.same else measure.written(value, 6)))

    def percent(self, utilisation: float | None, allowed: float = 1.0) -> str:
        """Utilisation as a percentage that can be told from what is allowed."""
        return self.localised(display.percent(utilisation, allowed))

    def capped_percent(self, utilisation: float | None, allowed: float = 1.0) -> str:
        """Percentage without its sign, for a narrow cell."""
        return self.localised(display.capped_percent(utilisation, allowed))

    def localised(self, number: str) -> str:
        """A number as `display` writes it, with the reader's marks."""
        if self.language == "en":
            return number
        decimal, group = _marks(self.language)
        marks = {".": decimal, display.GROUP: group}
        return re.sub(r"(?<=\d)[.\u202f](?=\d)", lambda mark: marks[mark[0]], number)

    def unit(self, unit: str) -> str:
        """Symbol of the unit that the reader sees in place of a unit of the wire, given as suffix or symbol."""
        return self.text(self.measure(unit).symbol)

    def quantity(self, quantity: Quantity) -> str:
        """A quantity of a sentence, with its unit."""
        shown = self.measure(quantity.unit).shown(quantity.value)
        number = self.localised(display.plain(rounded(shown, quantity.digits, quantity.rounding)))
        return f"{number}{display.GROUP}{self.unit(quantity.unit)}" if quantity.unit else number

    def bound(self, quantity: Quantity) -> str:
        """The number of a quantity alone, for a message beside a field that shows the unit."""
        return self.exact(quantity.value, quantity.unit)

    def told(self, sentence: Sentence | Notice) -> str:
        """A sentence in the reader's language and units."""
        sentence = sentence.sentence if isinstance(sentence, Notice) else sentence
        return sentence.render(self.text, self.quantity)

    def say(self, message: Message | Sentence) -> str:
        """What is wrong with an input."""
        return self.told(message) if isinstance(message, Sentence) else message.text(self.text, self.bound)

    def reason(self, candidate: Mapping[str, Any], utilisation: float) -> str:
        """Why a candidate of a reply stands where it does; `utilisation` is the user's u."""
        if self.language == "en":
            return str(candidate["reason"])
        return self.told(reason_of(candidate, utilisation))

    def translated(self, texts: Mapping[str, str]) -> list[tuple[str, str]]:
        """Options of a choice: codes with their texts."""
        return [(code, self.text(text)) for code, text in texts.items()]


DEFAULT = Reader()


class Visit(NamedTuple):
    """A reader, and the address of the page that they look at."""

    reader: Reader = DEFAULT
    address: str = "/"


# Per request, not per process: templates of every page find it without each route handing it on.
VISIT: ContextVar[Visit] = ContextVar("visit", default=Visit())  # noqa: B039


def current() -> Reader:
    """Reader of the request under way."""
    return VISIT.get().reader


def address() -> str:
    """Path and query of the request under way, or of the form's page where it was posted."""
    return VISIT.get().address


def reason_of(candidate: Mapping[str, Any], utilisation: float) -> Sentence:
    """The reason of a candidate as a sentence that can be translated; `utilisation` is the user's u."""
    status, used = candidate["status"], candidate["utilisation"]
    if status == "unrated":
        return Sentence(REASONS["unrated"], {"name": f"HPN-{candidate['size']}"})
    if used is None:
        return Sentence(REASONS["no_stop_allowed"])
    failed = sum(check["status"] == "fail" for check in candidate["checks"])
    key = "unsuitable_more" if failed > 1 else status
    title = EXPLANATIONS[candidate["governing_check"]].title
    bound = 100 * allowed(candidate["governing_check"], utilisation)
    percent = Quantity(round(100 * used, telling_decimals(100 * used, bound, 1)), "percent", 12)
    return Sentence(REASONS[key], {"check": title, "percent": percent, "failed": failed}, ("check",))


def _for_reader(method: str) -> Callable[..., Any]:
    # With the context, because Jinja works out filters of constants only once otherwise.
    def filtered(_: Context, *arguments: Any) -> Any:
        return getattr(current(), method)(*arguments)

    return pass_context(filtered)


FILTERS: dict[str, Callable[..., Any]] = {
    "capital": lambda text: text[:1].upper() + text[1:],
    "t": _for_reader("text"),
    **{
        name: _for_reader(name)
        for name in (
            *("figure", "exact", "percent", "capped_percent", "value", "unit"),
            *("told", "say", "reason", "source", "filled", "translated"),
        )
    },
}
"""`{{ 40 | figure("Nm") }}`, `{{ "Nm" | unit }}`, `{{ sentence | told }}`: for whoever reads the page."""


def reader_of(_: Context) -> Reader:
    """Reader of the page that is rendered."""
    return current()


def once() -> str:
    """A key that nobody can guess, for a form that is to count once however often it is sent."""
    return secrets.token_urlsafe(16)


GLOBALS = {
    "once": once,
    "here": address,
    "measures": measures,
    "reader": current,
    "LANGUAGE_NAMES": LANGUAGE_NAMES,
}
"""What the forms of settings and of saving need."""

GETTEXT = (_for_reader("text"), _for_reader("plural"))
"""`_()` and `ngettext()` of the templates."""
