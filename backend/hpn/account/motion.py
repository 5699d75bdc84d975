"""A motion as it was given: its mechanism line by line and its moves column by column, for every file and page."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from hpn.account.inputs import InputLine
from hpn.application.motion import Motion
from hpn.words.motion import MOTION
from hpn.words.quantities import INPUTS
from hpn.words.reader import Reader
from hpn.words.terms import MECHANISMS, PROFILES
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Named

Value = float | str

LOADS = ("radial_N", "axial_N")
WORDS: Mapping[str, str] = {**MECHANISMS, **PROFILES}

_OF_MOVE = {name.removeprefix("move."): named for name, named in MOTION.items() if name.startswith("move.")}
MOVES = {name: named for name, named in _OF_MOVE.items() if name != "name"} | {
    name: INPUTS[f"phase.{name}"] for name in LOADS
}
"""Names of the fields that a move may have; its own name stands beside its number."""

PHASES_TITLE, MOTION_TITLE, MOVES_TITLE = N_("Load phases of the motion"), N_("Motion"), N_("Moves")


def mechanism_of(motion: Motion) -> Iterator[tuple[str, Named, Value]]:
    """Field, name and value of what is said of mechanism and start; what has its default is left out."""
    for path, named in MOTION.items():
        part, _, name = path.rpartition(".")
        owner: Any = motion.mechanism if part == "mechanism" else motion
        if part != "move" and _is_said(owner, name):
            yield name, named, getattr(owner, name)


def moves_of(motion: Motion) -> dict[str, Sequence[Value | None]]:
    """Values of the moves by field, None at the default; a field that no move sets is left out."""
    said = {name: [getattr(move, name) if _is_said(move, name) else None for move in motion.moves] for name in MOVES}
    return {name: values for name, values in said.items() if any(value is not None for value in values)}


def _is_said(owner: Any, name: str) -> bool:
    field = type(owner).model_fields.get(name)
    return field is not None and getattr(owner, name) not in (None, field.default)


def written(value: Value | None, name: str, reader: Reader) -> str:
    """A value as its reader finds it, without its unit; blank where nothing is said."""
    if value is None:
        return ""
    return reader.text(WORDS[value]) if isinstance(value, str) else reader.exact(value, suffix_of(name))


def lines(motion: Motion, reader: Reader) -> Iterator[InputLine]:
    """The mechanism, ready to read."""
    for name, named, value in mechanism_of(motion):
        text = reader.with_unit(written(value, name, reader), suffix_of(name) if name != "type" else "")
        yield InputLine(reader.text(named.name), named.symbol, text)


def move_line(motion: Motion, place: int, reader: Reader) -> str:
    """One move in one line, figures with their units."""
    move = motion.moves[place]
    said = ((name, getattr(move, name)) for name in MOVES if _is_said(move, name))
    told = (reader.with_unit(written(value, name, reader), suffix_of(name)) for name, value in said)
    return " · ".join([move.name, *told] if move.name else told)
