"""The canonical link of an application; `links.parse` reads it, and what people write by hand."""

from dataclasses import dataclass
from operator import itemgetter
from typing import Any
from urllib.parse import quote

from pydantic import BaseModel

from hpn.application import Application, DutyCycle, EmergencyStop, Motor, OutputLoad, Requirements
from hpn.web.symbols import BY_PARENT, Symbol

_EMPTY_LOAD = OutputLoad()


@dataclass(frozen=True, slots=True)
class _Field:
    """A field of one part of the application: where its symbol stands in a link, and what needs no mention."""

    place: int
    symbol: Symbol
    default: Any


_IN_ORDER = [symbol for symbols in BY_PARENT.values() for symbol in symbols]
_FIELDS: list[dict[str, _Field]] = [
    {s.path[-1]: _Field(_IN_ORDER.index(s), s, model.model_fields[s.path[-1]].default) for s in BY_PARENT[parent]}
    for parent, model in (
        ((), Application),
        (("duty_cycle",), DutyCycle),
        (("emergency_stop",), EmergencyStop),
        (("output_load",), OutputLoad),
        (("requirements",), Requirements),
        (("requirements", "motor"), Motor),
    )
]
"""Fields that have a symbol, by name, of the parts of an application in the order of `_parts`."""


def to_link(application: Application) -> str:
    """Canonical link of an application: only what differs from the defaults, numbers as short as they can be.

    `parse` gives the same application back; a motor of which nothing is known counts as no motor.
    """
    return "/?" + "&".join([_phases(application), *_other_pairs(application)])


def _phases(application: Application) -> str:
    phases = application.duty_cycle.phases
    pairs = [f"T={phase.torque_Nm!r}&n={phase.speed_rpm!r}&t={phase.duration_s!r}" for phase in phases]
    if application.loads is not None:
        loads = {"FRi": [phase.radial_N for phase in phases], "FAi": [phase.axial_N for phase in phases]}
        for name, values in loads.items():
            if any(value is not None for value in values):
                written = ["" if value is None else repr(value) for value in values]
                pairs = [f"{pair}&{name}={value}" for pair, value in zip(pairs, written, strict=True)]
    return _shortened("&".join(pairs))


def _other_pairs(application: Application) -> list[str]:
    pairs: list[tuple[int, str, Any]] = []
    for part, fields in zip(_parts(application), _FIELDS, strict=True):
        if part is None:
            continue
        values = part.__dict__
        for given in part.__pydantic_fields_set__:
            field = fields.get(given)
            if field is None or (value := values[given]) == field.default:
                continue
            if field.symbol.many:
                pairs += [(field.place, field.symbol.name, item) for item in value]
            else:
                pairs.append((field.place, field.symbol.name, value))
    pairs.sort(key=itemgetter(0))
    if application.output_load is not None and application.output_load == _EMPTY_LOAD:
        pairs.append((0, "fw", 1))  # a load case without a figure of its own must still be seen to exist
    return [f"{name}={_written(value)}" for _, name, value in pairs]


def _parts(application: Application) -> tuple[BaseModel | None, ...]:
    asked = application.requirements
    load, stop = application.output_load, application.emergency_stop
    return application, application.duty_cycle, stop, load, asked, asked.motor


def _written(value: float | str | None) -> str:
    if isinstance(value, float):
        return _shortened(repr(value))
    if isinstance(value, int):
        return str(value)
    return "" if value is None else quote(value)


def _shortened(numbers: str) -> str:
    """Numbers, between ampersands, without zeros and signs that say nothing."""
    text = numbers.replace(".0&", "&").removesuffix(".0")
    return text.replace("e+", "e").replace("e-0", "e-") if "e" in text else text
