"""Axes in words, alike in every file of a machine."""

from collections.abc import Iterable
from itertools import groupby

import msgspec

from hpn.documents.revision import FrozenAxis
from hpn.documents.summary import gear_of
from hpn.engine.checks import allowed, name_of
from hpn.files.machine.inputs import label_of
from hpn.words.reader import Reader
from hpn.words.terms import VERDICTS
from hpn.words.wording import N_, Sentence

STATUS = {**VERDICTS, "open": N_("open")}
"""Verdicts on axes."""

NONE = N_("none; {gear} is the nearest")
MOST_FAULTS = 3
"""Faults of an axis that are written out."""


def named(axis: FrozenAxis) -> str:
    """Number and name of an axis."""
    return f"{axis.number} {axis.name}" if axis.name else str(axis.number)


def check_of(code: str | None, reader: Reader) -> str:
    """Name of a check inside a sentence; blank for none."""
    return reader.text(name_of(code)) if code else ""


def bound_of(axis: FrozenAxis) -> float:
    """Largest utilisation that is accepted of an axis's governing check."""
    requirements = msgspec.json.decode(axis.resolved).get("requirements") or {}
    own = requirements.get("utilisation") if isinstance(requirements, dict) else None
    return allowed(axis.answer.governing_check, own if isinstance(own, float | int) else 1.0)


def used(axis: FrozenAxis, reader: Reader) -> str:
    """Utilisation of an axis."""
    return reader.percent(axis.answer.utilisation, bound_of(axis))


def gear_phrase(axis: FrozenAxis, reader: Reader) -> str:
    """Gear of an axis, or the nearest one and that it has none; blank for an open axis."""
    if axis.answer.designation is None:
        return ""
    gear = gear_of(axis)
    return gear or reader.told(Sentence(NONE, {"gear": axis.answer.designation}))


def faults_of(axis: FrozenAxis, reader: Reader) -> list[str]:
    """Faults of an open axis, each with its place."""
    faults = axis.answer.faults[:MOST_FAULTS]
    return [f"{reader.told(label_of(fault.pointer))}: {reader.text(fault.detail)}" for fault in faults]


def ranges(numbers: Iterable[int]) -> str:
    """Numbers in short: `1–4, 7, 19`."""
    runs = list[str]()
    for _, run in groupby(enumerate(sorted(numbers)), key=lambda pair: pair[1] - pair[0]):
        members = [number for _, number in run]
        far = len(members) > 2
        runs += [f"{members[0]}–{members[-1]}"] if far else map(str, members)
    return ", ".join(runs)
