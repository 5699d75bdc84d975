"""Canonical link of an application; `link_reader.parse` reads it, and links written by hand."""

from collections.abc import Iterator, Mapping
from itertools import groupby
from typing import Any
from urllib.parse import quote

from pydantic import BaseModel

from hpn.application import (
    Application,
    Brake,
    CurvePoint,
    Drive,
    DutyCycle,
    EmergencyStop,
    Motor,
    OutputLoad,
    Requirements,
)
from hpn.application.motion import Motion
from hpn.links.row_symbols import PHASE_SYMBOLS, move_symbols
from hpn.links.symbols import CURVES, MECHANISM_SYMBOLS, SYMBOLS
from hpn.links.tolerances import written
from hpn.tables.by_size import BySize, Part
from hpn.words.designations import OTHERS

_EMPTY_LOAD = OutputLoad()

_WHERE_USED = PHASE_SYMBOLS[3:-1]
"""Figures of phases that a link has where a phase has one."""

_MODELS: tuple[type[BaseModel], ...] = (
    DutyCycle,
    EmergencyStop,
    Brake,
    OutputLoad,
    Drive,
    Requirements,
    Application,
    Motor,
)
_FIELDS = [
    [(s.path[-1], s.name, model.model_fields[s.path[-1]].default, s.many or s.name in CURVES) for s in symbols]
    for model, (_, symbols) in zip(_MODELS, groupby(SYMBOLS, lambda symbol: symbol.path[:-1]), strict=True)
]
"""Fields of each part of an application in a link: name, symbol, default (left out of links), and True for a list."""


def to_link(application: Application) -> str:
    """Canonical link of an application: only values that differ from the defaults, numbers as short as possible.

    `parse` returns the same application; a motor without any figure counts as no motor.
    """
    link = "/?" + _cycle(application)
    for part, fields in zip(_parts(application), _FIELDS, strict=True):
        if part is None:
            continue
        values = part.__dict__
        for field, symbol, default, many in fields:
            if (value := values[field]) == default:
                continue
            for item in value if many else _items(value):
                link += f"&{symbol}={_written(item)}"
    if application.tolerances:
        link += "".join(f"&tol={text}" for text in written(application))
    load = application.output_load
    # A load case without a figure of its own must stay visible.
    return link + "&fw=1" if load is not None and load == _EMPTY_LOAD else link


def _cycle(application: Application) -> str:
    motion = application.duty_cycle.motion
    if motion is not None:
        return "&".join((*_mechanism(motion), *_moves(motion)))
    phases = application.duty_cycle.load_phases
    pairs = [f"T={phase.torque_Nm!r}&n={phase.speed_rpm!r}&t={phase.duration_s!r}" for phase in phases]
    for symbol in _WHERE_USED:
        values: list[float | None] = [getattr(phase, symbol.path[0]) for phase in phases]
        if any(value is not None for value in values):
            written = ["" if value is None else repr(value) for value in values]
            pairs = [f"{pair}&{symbol.name}={value}" for pair, value in zip(pairs, written, strict=True)]
    if any(phase.name for phase in phases):
        return "&".join(f"{shortened(pair)}&pn={quote(p.name or '')}" for pair, p in zip(pairs, phases, strict=True))
    return shortened("&".join(pairs))


def _mechanism(motion: Motion) -> Iterator[str]:
    """Pairs of a mechanism and of the start of its motion, without defaults."""
    for symbol in MECHANISM_SYMBOLS:
        part = motion.mechanism if "mechanism" in symbol.path else motion
        field, fields = symbol.path[-1], type(part).model_fields
        if field in fields and (value := getattr(part, field)) != fields[field].default:
            yield f"{symbol.name}={_written(value)}"


def _moves(motion: Motion) -> Iterator[str]:
    """Pairs of moves, each move with every figure that one of them has."""
    fields = type(motion.moves[0]).model_fields
    columns = []
    for symbol in move_symbols(motion.mechanism.type):
        field = symbol.path[-1]
        values = [None if (v := getattr(move, field)) == fields[field].default else v for move in motion.moves]
        if any(value is not None for value in values):
            columns.append([f"{symbol.name}={'' if value is None else _written(value)}" for value in values])
    for move in zip(*columns, strict=True):
        yield from move


def _parts(application: Application) -> tuple[BaseModel | None, ...]:
    requirements, load = application.requirements, application.output_load
    stop = application.emergency_stop
    return (
        application.duty_cycle,
        stop,
        stop and stop.brake,
        load,
        load and load.drive,
        requirements,
        application,
        requirements.motor,
    )


def _items(value: Any) -> Iterator[Any]:
    """Values of a field one by one; numbers by size come with their size, except the one for all other sizes."""
    if not isinstance(value, dict):
        yield value
        return
    for size, number in value.items():
        yield number if size == OTHERS else BySize([Part(size, _written(number))])


def point_text(point: Mapping[str, Any]) -> str:
    """Point of a motor's torque over speed: `speed:continuous:peak`."""
    values = (point.get(name) for name in CurvePoint.model_fields)
    return ":".join(_written(float(v)) if isinstance(v, float | int) else "" for v in values)


def _written(value: float | str | CurvePoint) -> str:
    if isinstance(value, CurvePoint):
        return point_text(value.__dict__)
    if isinstance(value, float):
        return shortened(repr(value))
    if isinstance(value, int):
        return str(int(value))
    return quote(value, safe="/:" if isinstance(value, BySize) else "/")


def shortened(numbers: str) -> str:
    """Numbers between ampersands, without superfluous zeros and signs."""
    text = numbers.replace(".0&", "&").removesuffix(".0")
    return text.replace("e+", "e").replace("e-0", "e-") if "e" in text else text
