"""Axes in words, alike in every file of a machine."""

from collections.abc import Iterable
from itertools import groupby

import msgspec
from msgspec.structs import replace

from hpn.application.faults import (
    MOVE_INPUT,
    NOT_A_NUMBER,
    NOT_AN_INTEGER,
    NOT_JSON_INTEGER,
    NOT_JSON_NUMBER,
    PHASE_INPUT,
    fault_sentence,
)
from hpn.documents.answers import AxisFault
from hpn.documents.revision import FrozenAxis
from hpn.documents.summary import gear_of
from hpn.engine.checks import allowed, name_of
from hpn.files.machine.inputs import MOVE, PHASE, label_of
from hpn.words.reader import Reader
from hpn.words.terms import VERDICTS
from hpn.words.wording import N_, Sentence

_IN_SENTENCE = {PHASE: PHASE_INPUT, MOVE: MOVE_INPUT}
_PLAIN = {NOT_JSON_NUMBER: NOT_A_NUMBER, NOT_JSON_INTEGER: NOT_AN_INTEGER}
"""Texts about JSON, and those of a reader who sees none."""

STATUS = {**VERDICTS, "open": N_("open")}
"""Verdicts on axes."""

NONE = N_("none; {gear} is the nearest")
MOST_FAULTS = 3
"""Most faults of an axis that are written out."""


def named(axis: FrozenAxis) -> str:
    """Number and name of an axis."""
    return f"{axis.number} {axis.name}" if axis.name else str(axis.number)


def check_of(code: str | None, reader: Reader) -> str:
    """Name of a check inside a sentence; blank for none."""
    return reader.text(name_of(code)) if code else ""


def bound_of(axis: FrozenAxis, *, in_worst_case: bool = False) -> float:
    """Largest accepted utilisation of an axis's governing check, as given or in its worst case."""
    requirements = msgspec.json.decode(axis.resolved).get("requirements") or {}
    values = requirements if isinstance(requirements, dict) else {}
    names = ("worst_case_utilisation", "utilisation") if in_worst_case else ("utilisation",)
    own = next((share for name in names if isinstance(share := values.get(name), float | int)), 1.0)
    return allowed(axis.answer.worst_governing_check if in_worst_case else axis.answer.governing_check, own)


def utilisation_text(axis: FrozenAxis, reader: Reader) -> str:
    """Utilisation of an axis."""
    return reader.percent(axis.answer.utilisation, bound_of(axis))


def worst_case(axis: FrozenAxis, reader: Reader) -> str:
    """Utilisation of an axis in its worst case over the tolerances."""
    return reader.percent(axis.answer.worst_utilisation, bound_of(axis, in_worst_case=True))


def gear_phrase(axis: FrozenAxis, reader: Reader) -> str:
    """Gear of an axis, or the words that it has none and which gear is nearest; blank for an open axis."""
    if axis.answer.designation is None:
        return ""
    gear = gear_of(axis)
    return gear or reader.sentence(Sentence(NONE, {"gear": axis.answer.designation}))


def faults_of(axis: FrozenAxis, reader: Reader) -> list[str]:
    """First faults of an open axis, each with the name of its input."""
    return [reader.sentence(fault_of(fault)) for fault in axis.answer.faults[:MOST_FAULTS]]


def fault_of(fault: AxisFault) -> Sentence:
    """Sentence on a fault of an axis, with the name of its input if it has one."""
    if not fault.pointer:
        return fault.wording
    name, text = label_of(fault.pointer), fault.wording
    plain = Sentence(_PLAIN[text.text]) if text.text in _PLAIN else text
    return fault_sentence(replace(name, template=_IN_SENTENCE.get(name.template, name.template)), plain)


def ranges(numbers: Iterable[int]) -> str:
    """Numbers as ranges: `1–4, 7, 19`."""
    runs = list[str]()
    for _, run in groupby(enumerate(sorted(numbers)), key=lambda pair: pair[1] - pair[0]):
        members = [number for _, number in run]
        far = len(members) > 2
        runs += [f"{members[0]}–{members[-1]}"] if far else map(str, members)
    return ", ".join(runs)
