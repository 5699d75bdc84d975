"""Every input of an application as a reader finds it: name, symbol, value, unit."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from hpn.application import Application
from hpn.notices import AREAS
from hpn.quantities import BEARING_MODELS, INPUTS, LIFE_BASES
from hpn.reader import Reader
from hpn.units import suffix_of
from hpn.wording import N_

Value = float | str | tuple[str | int, ...]

_LOADING = ("duty_cycle.", "emergency_stop.", "output_load.")

LOADS = tuple(path for path in INPUTS if path.startswith(_LOADING))
"""What loads the gear besides the phases, by its path in the application."""

REQUIREMENTS = tuple(path for path in INPUTS if not path.startswith((*_LOADING, "phase.")))
"""What is asked of the gear, likewise."""

WORDS: Mapping[str, str] = {
    **BEARING_MODELS,
    **LIFE_BASES,
    "weight": N_("weight"),
    "utilisation": N_("utilisation"),
    "length": N_("length"),
    "motor_torque": N_("motor torque"),
    "life": N_("life"),
    "stiffness": N_("stiffness"),
    **{str(area): text for area, text in AREAS.items()},
}
"""Values that are a code, in words."""


@dataclass(frozen=True, slots=True)
class InputLine:
    """One input that is given, ready to read."""

    label: str
    symbol: str
    text: str


def value_of(application: Application, path: str) -> Value | None:
    """What an application says at a path of INPUTS, or None; of the load, also the defaults that a phase's load has."""
    first, *rest = path.split(".")
    part: Any = application.loads if first == "output_load" else getattr(application, first)
    for step in rest:
        part = getattr(part, step, None)
    value: Value | None = part
    return value


def given(application: Application, paths: Iterable[str], reader: Reader) -> Iterable[InputLine]:
    """Those inputs that are given or have a default."""
    for path in paths:
        value = value_of(application, path)
        if value is not None:
            yield InputLine(reader.text(INPUTS[path].name), INPUTS[path].symbol, _written(value, path, reader))


def _written(value: Value, path: str, reader: Reader) -> str:
    if isinstance(value, tuple):
        return ", ".join(map(str, value))
    if isinstance(value, str):
        return reader.text(WORDS.get(value, value))
    unit = suffix_of(path) or ""
    return reader.with_unit(reader.exact(value, unit), unit)
