"""What somebody typed into a field or wrote into a link, as a value, or a message that says what to write instead."""

import re

from hpn.web.form.entries import Entry
from hpn.web.form.messages import N_, Message
from hpn.web.form.symbols import Kind

_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
_GROUPED = re.compile(r"[+-]?[0-9]{1,3}(,[0-9]{3})+(?![0-9,])")
_LONGEST_TEXT = 60


def read_value(text: str, kind: Kind) -> float | int | str | Message:
    """Value that a text stands for, or what to write instead."""
    if isinstance(text, Entry) and text.refusal:
        return text.refusal
    text = text.strip()
    if kind == "text":
        return text if len(text) <= _LONGEST_TEXT else Message(N_("is too long"))
    plain = text.replace("\N{MINUS SIGN}", "-")
    if len(plain) > _LONGEST_TEXT or not _NUMBER.fullmatch(plain):
        return _not_a_number(plain)
    value = float(plain)
    if value in (float("inf"), float("-inf")):
        return Message(N_("is too large"))
    if kind == "number":
        return value
    return int(value) if value.is_integer() else Message(N_("must be a whole number"))


def _not_a_number(text: str) -> Message:
    """What to write instead, where it can be told."""
    tight = re.sub(r"[\s'’]", "", text)
    if len(tight) > _LONGEST_TEXT:
        return Message(N_("is too long for a number"))
    readings = [reading for reading in _readings(tight) if _NUMBER.fullmatch(reading)]
    if len(readings) > 1:
        return Message(N_("write %(first)s or %(second)s"), {"first": readings[0], "second": readings[1]})
    if readings:
        return Message(N_("write %(number)s"), {"number": readings[0]})
    return Message(N_("is not a number; write one such as 9.3"))


def _readings(text: str) -> list[str]:
    """Numbers that a text with commas may stand for; `1,234` is either of two."""
    if text.rfind(".") > text.rfind(",") or text.count(",") > 1:
        return [text.replace(",", "")] if _GROUPED.match(text) else []
    decimal = text.replace(".", "").replace(",", ".")
    if re.fullmatch(r"[+-]?[1-9][0-9]{0,2},[0-9]{3}", text):
        return [decimal, text.replace(",", "")]
    return [decimal]
