"""Numbers as people type them: in their own units and with their decimal mark, turned into the wire's and back.

A form says in its field `written` whose language and units it is in. It takes numbers as pages print them: `20 000`,
`1.5·10⁻³`, and `1.167.276` in German. A link without that field takes plain numbers alone. Nothing is lost on the way:
a number that is shown shorter than it is stands in the field `was`, and counts as long as nobody edits it. A number may
carry a unit of its own, `40 Nm`, or be a sum, `=40*2`: the wire has the plain number.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from math import isfinite
from typing import Literal, NamedTuple

from hpn.tables.arithmetic import worked_out
from hpn.tables.cells import DASHES, DECIMALS, plain_number, split_unit
from hpn.words import spellings
from hpn.words import units as measures
from hpn.words.patterns import Pattern
from hpn.words.reader import Reader
from hpn.words.units import NUMBER, SYMBOLS
from hpn.words.wording import N_, Sentence, Typed

Kind = Literal["number", "whole", "text", "flag", "by_size"]

WRITTEN, WAS = "written", "was"
"""Fields that say how the others are written, and which exact numbers stand behind them."""

DIGITS = 5
"""Digits that a number from elsewhere is shown with in another unit."""

LONGEST_TEXT = 100
_LONGEST = 60
"""Characters of a text, such as the designation of a motor, and of a number."""

_ASKED = {
    decimal: Pattern(rf"[+-]?[1-9][0-9]{{0,2}}[{group}][0-9]{{3}}", _LONGEST)
    for decimal, group in ((".", ","), (",", "."))
}
"""Numbers whose mark may stand between thousands or be a decimal mark of another language."""

_POWER = Pattern(r"\s?[·×]\s?10([⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]{1,3})", _LONGEST)
_RAISED = str.maketrans("⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "+-0123456789")
FLAGS: Mapping[str, bool] = {"0": False, "1": True, "false": False, "true": True}
"""How no and yes are written."""


class Entry(str):
    """A number in the wire's notation, with what stands in its field, and why it can't be read if it can't."""

    shown: str
    refusal: Sentence | None

    def __new__(cls, wire: str, shown: str, refusal: Sentence | None = None) -> "Entry":
        """A text that behaves as `wire`."""
        entry = super().__new__(cls, wire)
        entry.shown, entry.refusal = shown, refusal
        return entry


class FieldTexts(NamedTuple):
    """Texts for the fields, by the texts of the wire that were asked for, and the field `was`."""

    texts: list[str]
    was: str


class Notation:
    """Notation of the numbers of a form or link: its language and units, and the numbers that a form was made from.

    `marker` is blank for a link. A form's numbers may be written as pages print them.
    """

    def __init__(self, fields: Mapping[str, str]) -> None:
        self.reader = Reader.of_marker(fields.get(WRITTEN, ""))
        self.marker = self.reader.marker if fields.get(WRITTEN) else None
        self.decimal = self.reader.decimal if fields.get(WRITTEN) else ""
        self.was: dict[tuple[str, str], float] = {}
        for token in fields.get(WAS, "").split():
            unit, _, text = token.partition(":")
            if unit in SYMBOLS and len(text) <= _LONGEST and NUMBER.fullmatch(text) and isfinite(float(text)):
                self.was[unit, self.reader.measure(unit).written(float(text), DIGITS)] = float(text)

    def entry(self, text: str, unit: str) -> str:
        """A text of a field in the wire's unit and notation; what is no number stays as it is."""
        if not self.reader.marker and NUMBER.fullmatch(text):
            return text
        plain, measure = self._number(text, unit)
        if isinstance(plain, Sentence):
            return Entry(f"{text}?", text, plain)
        if plain is None:
            return Entry(self._with_comma(text), text) if self._with_comma(text) != text else text
        if measure.same:
            return Entry(plain, text) if self.reader.marker or plain != text.strip() else text
        own = measure is self.reader.measure(unit)
        value = self.was.get((unit, plain), measure.wire(plain)) if own else measure.wire(plain)
        vanishes = not measure.offset and _is_too_small(plain, value)  # 32 °F are 0 °C
        return Entry(_plain(value) if isfinite(value) and not vanishes else plain, text)

    def _number(self, text: str, unit: str) -> tuple[str | Sentence | None, measures.Measure]:
        """Number in plain notation and the unit that it is in; None where it is none, a message for what is wrong."""
        own, decimal = self.reader.measure(unit), self.decimal
        if text.lstrip().startswith("="):
            return worked_out(text.strip(), self._in_sum), own
        plain = read_decimal(text, decimal)
        if plain is not None or len(text) > _LONGEST:
            return plain, own
        if not unit and text.rstrip().endswith("%"):
            return _without_percent(read_decimal(text.rstrip()[:-1], decimal)), own
        number, spelled = split_unit((_without_power(text) if decimal else text).strip())
        if not spelled:
            return None, own
        plain = read_decimal(number, decimal)
        if plain is None:
            return _advice(self._with_comma(number), spelled, mostly_whole=unit == "h"), own
        code = unit_code(spelled, unit)
        return (code, own) if isinstance(code, Sentence) else (plain, measures.entered(unit, code))

    def _in_sum(self, number: str) -> str | Sentence | None:
        """Number of a sum in plain notation, or advice in the reader's: it takes the place of a part of the text."""
        plain = read_decimal(number, self.decimal)
        advice = None if plain else _advice(self._with_comma(number), whole=False)
        return advice.marked(self.reader.decimal) if advice else plain

    def _with_comma(self, text: str) -> str:
        """A text as a link would have it, in which a comma is asked about and a point is not."""
        return text.replace(".", ",") if self.decimal == "," and _ASKED[","].fullmatch(_tidy(text)) else text


def _without_percent(number: str | None) -> Sentence | None:
    """Advice in place of a percentage."""
    return _to_write([f"{Decimal(number).scaleb(-2).normalize():f}"]) if number else None


def unit_code(spelled: str, unit: str) -> str | Sentence:
    """Code of a unit as somebody writes it, for a quantity in a unit of the wire, or what is wrong with it."""
    codes = spellings.codes_in(spelled, unit)
    if len(codes) == 1:
        return codes[0]
    if len(codes) > 1:
        template = N_("{unit} can be {first} or {second}; write one of them")
        return Sentence(template, {"unit": spelled, **either(codes, spelled)})
    wire = measures.quotient_of(unit)
    if not (quantity := measures.quantity_of(wire.dividend)):
        return Sentence(N_("must be a number without a unit"))
    possible = ", ".join(wire._replace(dividend=code).symbol for code in measures.READ[quantity])
    return Sentence(
        N_("{unit} is not a unit of this quantity; possible: {units}"), {"unit": spelled[:20], "units": possible}
    )


def known_units(quantity: str) -> str:
    """Symbols of all units that are read for a quantity."""
    return ", ".join(measures.READ[quantity].values())


def either(codes: Sequence[str], spelled: str) -> dict[str, Sentence]:
    """Meanings of a spelling, as values of a sentence: two units, or one and a frequency that counts no turns."""
    first, second = (Sentence(measures.symbol_of_code(code)) for code in codes[:2])
    return {"first": first, "second": Sentence(ELECTRICAL) if spelled.strip() == spellings.FREQUENCY else second}


def read_decimal(text: str, decimal: str) -> str | None:
    """A number as a page prints it, in plain notation; None where it is none or could be two.

    Without a decimal mark none but plain notation is read.
    """
    plain = _tidy(text)
    if len(plain) > _LONGEST or (decimal and _ASKED[decimal].fullmatch(plain)):
        return None
    if NUMBER.fullmatch(plain):
        return plain
    if not decimal:
        return None
    return plain_number(_without_power(plain), "," if decimal == "," else ".")


def _without_power(text: str) -> str:
    """A text with `e-3` in place of `·10⁻³`."""
    return _POWER.sub(lambda power: f"e{power[1].translate(_RAISED)}", text)


def _tidy(text: str) -> str:
    return text.strip().translate(DASHES)


def to_fields(entries: Iterable[tuple[str, str]], reader: Reader, written: str | None) -> FieldTexts:
    """Texts of the wire, with their units, as the reader's form shows them; `written` marks how they came in.

    The reader's own entries stay as typed. Numbers from elsewhere are shown to five digits in another unit, or to all
    digits where two numbers would look alike; the full number is remembered where the shown one is rounded.
    """
    listed = [_Field(text, unit, reader, own=reader.marker == (written or "")) for text, unit in entries]
    alike = Counter(short for short, _ in {(field.short, field.value) for field in listed if field.value is not None})
    texts, was = [], []
    for field in listed:
        texts.append(field.text if alike[field.short] < 2 else field.exact)
        if field.value is not None and field.read(texts[-1]) != field.value:
            was.append(f"{field.unit}:{_plain(field.value)}")
    return FieldTexts(texts, " ".join(dict.fromkeys(was)))


class _Field:
    """A text of the wire, and how its field shows it; `value` is None where it shows the wire's own unit."""

    def __init__(self, wire: str, unit: str, reader: Reader, *, own: bool) -> None:
        self.unit, self.reader, self.measure = unit, reader, reader.measure(unit)
        plain = _tidy(wire)
        number = bool(NUMBER.fullmatch(plain))
        self.value = float(plain) if number and not self.measure.same and isfinite(float(plain)) else None
        self.short = "" if self.value is None else self.measure.written(self.value, DIGITS), unit
        self.typed = wire.shown if isinstance(wire, Entry) and (own or wire.refusal) else None
        self.wire = self._marked(wire) if number else wire

    @property
    def text(self) -> str:
        """As typed, else short."""
        if self.typed is not None:
            return self.typed
        return self.wire if self.value is None else self._marked(self.short[0])

    @property
    def exact(self) -> str:
        """As typed, else with every digit."""
        if self.typed is not None:
            return self.typed
        return self.wire if self.value is None else self._marked(self.measure.shortest(self.value))

    def read(self, text: str) -> float | None:
        """Number of the wire that a text would be read as, without memory."""
        plain = read_decimal(text, self.reader.decimal)
        return None if plain is None else self.measure.wire(plain)

    def _marked(self, number: str) -> str:
        return number.replace(".", self.reader.decimal)


def _plain(value: float) -> str:
    return repr(value).removesuffix(".0").replace("e+", "e").replace("e-0", "e-")


# --- Values -----------------------------------------------------------------------------------------------------------

ELECTRICAL = N_("an electrical frequency")
NOT_WHOLE = N_("must be a whole number")
_ANY_NUMBER = Pattern(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?", _LONGEST)

_IN_GROUPS = Pattern(r"[+-]?[1-9][0-9]{0,2}\.[0-9]{2}0", _LONGEST)
"""A number as nobody writes a whole one, unless the point is meant to stand between thousands."""


def read_value(text: str, kind: Kind, *, mostly_whole: bool = False) -> float | int | str | Sentence:
    """Value that a text stands for, or what to write instead; `mostly_whole` where hardly anyone means decimals."""
    if isinstance(text, Entry) and text.refusal:
        return text.refusal
    original, text = text, text.strip()
    if kind == "text":
        return text if len(text) <= LONGEST_TEXT else Sentence(N_("is too long"))
    if kind == "flag":
        return FLAGS.get(text.lower(), Sentence(N_("must be 0 or 1")))
    plain = _tidy(text)
    if len(plain) > _LONGEST or not _ANY_NUMBER.fullmatch(plain):
        return _not_a_number(plain, kind, mostly_whole=mostly_whole)
    value = float(plain)
    if value in (float("inf"), float("-inf")):
        return Sentence(N_("is too large"))
    if _is_too_small(plain, value):
        return Sentence(N_("is too small"))
    with_comma = isinstance(original, Entry) and "," in original.shown
    if (mostly_whole or kind == "whole") and not with_comma and _IN_GROUPS.fullmatch(plain):
        decimal = _without_zeros(plain)
        return _to_write([decimal, plain.replace(".", "")][kind == "whole" and "." in decimal :])
    if kind == "number":
        return value
    return int(value) if value.is_integer() else Sentence(NOT_WHOLE)


def _without_zeros(number: str) -> str:
    """A number whose decimals can't be taken for a group of thousands."""
    return number.rstrip("0").rstrip(".") if _IN_GROUPS.fullmatch(number) else number


def _is_too_small(plain: str, value: float) -> bool:
    """True where a number in plain notation is another one than the zero that became of it."""
    return value == 0 and not set("123456789").isdisjoint(plain.casefold().partition("e")[0])


ONE_READING = N_("write {number}")
_SUCH_AS = N_("is not a number; write one such as 9.3")
_BLANKS = Pattern(r"[\s'’]+", 2 * _LONGEST)
_APART = Pattern(r"[0-9][\s'’]+(?![0-9]{3}(?![0-9]))[0-9]", 2 * _LONGEST)
"""Digits with a blank between them where no thousands end: two numbers, or a point that was missed."""


def _advice(text: str, unit: str = "", *, mostly_whole: bool = False, whole: bool = True) -> Sentence | None:
    """Advice in place of a number with this unit, None where there is none."""
    advice = _not_a_number(_tidy(text), "number", unit, mostly_whole=mostly_whole, whole=whole)
    return None if advice.template == _SUCH_AS else advice


def _not_a_number(text: str, kind: Kind, unit: str = "", *, mostly_whole: bool = False, whole: bool = True) -> Sentence:
    """Advice for a text that is no number: the numbers that it may stand for."""
    tight = _BLANKS.sub("", text)
    if len(tight) > _LONGEST:
        return Sentence(N_("is too long for a number"))
    numbers = [] if _APART.search(text) else [each for each in _readings(tight) if _ANY_NUMBER.fullmatch(each)]
    readings = [number for number in numbers if kind != "whole" or float(number).is_integer()]
    if numbers and not readings:
        return Sentence(NOT_WHOLE)
    if mostly_whole or kind == "whole":
        readings = [_without_zeros(reading) for reading in readings]
    return _to_write(readings, unit, whole=whole) if readings else Sentence(_SUCH_AS)


def _to_write(readings: Sequence[str], unit: str = "", *, whole: bool = True) -> Sentence:
    typed = [Typed(reading, unit, whole) for reading in readings]
    if len(typed) > 1:
        return Sentence(N_("write {first} or {second}"), {"first": typed[0], "second": typed[1]})
    return Sentence(ONE_READING, {"number": typed[0]})


def _readings(text: str) -> list[str]:
    """Numbers that a text may stand for under either decimal mark; `1,234` is either of two."""
    numbers = (plain_number(text.removesuffix(","), decimal) for decimal in reversed(DECIMALS))
    return [number for number in dict.fromkeys(numbers) if number]
