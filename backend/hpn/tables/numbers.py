"""Numbers as typed: in the user's units and with the user's decimal mark, converted to the wire's units and back.

A form's field `written` names its language and units. It takes numbers as pages print them: `20 000`, `1.5·10⁻³`, and
`1.167.276` in German. A link without that field takes plain numbers only. No digit is lost on the way: the field `was`
keeps a number that is shown rounded, and it counts until somebody edits the shown number. A number may carry a unit of
its own, `40 Nm`, or be a sum, `=40*2`: the wire has the plain number.
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

Kind = Literal["number", "whole", "text", "flag", "by_size", "curve"]

WRITTEN, WAS = "written", "was"
"""Fields for the notation of the others, and for the exact numbers behind them."""

DIGITS = 5
"""Digits of a converted number that was not typed here."""

LONGEST_TEXT = 100
_LONGEST = 60
"""Characters of a text, such as the designation of a motor, and of a number."""

_AMBIGUOUS = {
    decimal: Pattern(rf"[+-]?[1-9][0-9]{{0,2}}[{group}][0-9]{{3}}", _LONGEST)
    for decimal, group in ((".", ","), (",", "."))
}
"""Numbers whose mark may separate thousands, or be another language's decimal mark."""

_POWER = Pattern(r"\s?[·×]\s?10([⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]{1,3})", _LONGEST)
_RAISED = str.maketrans("⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "+-0123456789")
FLAGS: Mapping[str, bool] = {"0": False, "1": True, "false": False, "true": True}
"""Spellings of no and yes."""


class Entry(str):
    """A number in the wire's notation, with the text of its field, and the reason why it can't be read, if so."""

    field_text: str
    refusal: Sentence | None

    def __new__(cls, wire: str, field_text: str, refusal: Sentence | None = None) -> "Entry":
        """A text equal to `wire`."""
        entry = super().__new__(cls, wire)
        entry.field_text, entry.refusal = field_text, refusal
        return entry


class FieldTexts(NamedTuple):
    """Texts for the fields, one for each text of the wire, and the field `was`."""

    texts: list[str]
    was: str


class Notation:
    """Notation of the numbers of a form or link: its language, its units, and a form's exact numbers.

    `marker` is None for a link. A form's numbers may be written as pages print them.
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
        """A field's text in the wire's unit and notation; a text that is not a number stays as it is."""
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
        """Number in plain notation, or an error message, or None for no number; and its unit."""
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
        """Number within a sum in plain notation, or advice with the reader's decimal mark, since it replaces part of
        the text.
        """
        plain = read_decimal(number, self.decimal)
        advice = None if plain else _advice(self._with_comma(number), whole=False)
        return advice.marked(self.reader.decimal) if advice else plain

    def _with_comma(self, text: str) -> str:
        """A text as a link writes it: a comma is ambiguous there, a point is not."""
        return text.replace(".", ",") if self.decimal == "," and _AMBIGUOUS[","].fullmatch(_tidy(text)) else text


def _without_percent(number: str | None) -> Sentence | None:
    """Advice in place of a percentage."""
    return _to_write([f"{Decimal(number).scaleb(-2).normalize():f}"]) if number else None


def unit_code(spelled: str, unit: str) -> str | Sentence:
    """Code of a spelled unit for a quantity whose unit of the wire is `unit`, or an error message."""
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
    """Symbols of all units in which a quantity can be read."""
    return ", ".join(measures.READ[quantity].values())


def either(codes: Sequence[str], spelled: str) -> dict[str, Sentence]:
    """Two meanings of a spelling, as values of a sentence: two units, or a unit and an electrical frequency."""
    first, second = (Sentence(measures.symbol_of_code(code)) for code in codes[:2])
    return {"first": first, "second": Sentence(ELECTRICAL) if spelled.strip() == spellings.FREQUENCY else second}


def read_decimal(text: str, decimal: str) -> str | None:
    """A number as a page prints it, in plain notation; None for no number or an ambiguous one.

    Without a decimal mark only plain notation is read.
    """
    plain = _tidy(text)
    if len(plain) > _LONGEST or (decimal and _AMBIGUOUS[decimal].fullmatch(plain)):
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
    """Texts of the wire, with their units, as the reader's form shows them; `written` is the marker they came with.

    The reader's own entries stay as typed. Converted numbers are shown to five digits, or to all digits where two
    numbers would look alike; the field `was` keeps the full number where the shown one is rounded.
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
    """A text of the wire, and its text in the field; `value` is None where the field shows the wire's own unit."""

    def __init__(self, wire: str, unit: str, reader: Reader, *, own: bool) -> None:
        self.unit, self.reader, self.measure = unit, reader, reader.measure(unit)
        plain = _tidy(wire)
        number = bool(NUMBER.fullmatch(plain))
        self.value = float(plain) if number and not self.measure.same and isfinite(float(plain)) else None
        self.short = "" if self.value is None else self.measure.written(self.value, DIGITS), unit
        self.typed = wire.field_text if isinstance(wire, Entry) and (own or wire.refusal) else None
        self.wire = self._marked(wire) if number else wire

    @property
    def text(self) -> str:
        """Typed text, else the short number."""
        if self.typed is not None:
            return self.typed
        return self.wire if self.value is None else self._marked(self.short[0])

    @property
    def exact(self) -> str:
        """Typed text, else the number with every digit."""
        if self.typed is not None:
            return self.typed
        return self.wire if self.value is None else self._marked(self.measure.shortest(self.value))

    def read(self, text: str) -> float | None:
        """Number of the wire that a text gives without the field `was`."""
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
"""A decimal number that looks like a whole one with a point between thousands."""


def read_value(text: str, kind: Kind, *, mostly_whole: bool = False) -> float | int | str | Sentence:
    """Value of a text, or advice; `mostly_whole` marks inputs with hardly any decimals."""
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
    with_comma = isinstance(original, Entry) and "," in original.field_text
    if (mostly_whole or kind == "whole") and not with_comma and _IN_GROUPS.fullmatch(plain):
        decimal = _without_zeros(plain)
        return _to_write([decimal, plain.replace(".", "")][kind == "whole" and "." in decimal :])
    if kind == "number":
        return value
    return int(value) if value.is_integer() else Sentence(NOT_WHOLE)


def _without_zeros(number: str) -> str:
    """A number without trailing zeros that could pass for a group of thousands."""
    return number.rstrip("0").rstrip(".") if _IN_GROUPS.fullmatch(number) else number


def _is_too_small(plain: str, value: float) -> bool:
    """True where a number other than zero became zero."""
    return value == 0 and not set("123456789").isdisjoint(plain.casefold().partition("e")[0])


ONE_READING = N_("write {number}")
_SUCH_AS = N_("is not a number; write one such as 9.3")
_BLANKS = Pattern(r"[\s'’]+", 2 * _LONGEST)
_APART = Pattern(r"[0-9][\s'’]+(?![0-9]{3}(?![0-9]))[0-9]", 2 * _LONGEST)
"""Digits with a blank between them that separates no thousands: two numbers, or a missing point."""


def _advice(text: str, unit: str = "", *, mostly_whole: bool = False, whole: bool = True) -> Sentence | None:
    """Advice for a number with this unit; None without any."""
    advice = _not_a_number(_tidy(text), "number", unit, mostly_whole=mostly_whole, whole=whole)
    return None if advice.template == _SUCH_AS else advice


def _not_a_number(text: str, kind: Kind, unit: str = "", *, mostly_whole: bool = False, whole: bool = True) -> Sentence:
    """Advice for a text that is not a number: the numbers it may stand for."""
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
    """Numbers that a text may stand for under either decimal mark; `1,234` may be either of two."""
    numbers = (plain_number(text.removesuffix(","), decimal) for decimal in reversed(DECIMALS))
    return [number for number in dict.fromkeys(numbers) if number]
