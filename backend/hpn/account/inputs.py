"""Every input of an application as a reader finds it: name, symbol, value, unit."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from hpn.application import Application
from hpn.engine.notice import AREAS
from hpn.words.designations import OTHERS
from hpn.words.quantities import INPUTS
from hpn.words.reader import Reader
from hpn.words.terms import BEARING_MODELS, FOR_OTHERS, LIFE_BASES, MECHANISMS, POSITION_ERROR_AT, RANKINGS
from hpn.words.units import suffix_of
from hpn.words.wording import N_

Value = float | str | bool | tuple[str | int, ...] | dict[str, float]

LOAD_PATH, LOAD_INERTIA = "output_load.", "requirements.load_inertia_kgm2"
_LOADING = ("duty_cycle.", "emergency_stop.", LOAD_PATH)

LOADS = tuple(path for path in INPUTS if path.startswith(_LOADING))
"""Loads of the gear besides the phases, by their paths in the application."""

REQUIREMENTS = tuple(path for path in INPUTS if not path.startswith((*_LOADING, "phase.")))
"""Requirements of the gear, likewise."""

UNSAID: Mapping[str, Value] = {
    "requirements.position_error_at": "cycle",
    "requirements.rest_friction_Nm": 0.0,
    "output_load.from_motion": False,
}
"""Inputs whose default nobody needs to read, as it asks for nothing."""

OF_SHAFT: Mapping[str, tuple[str, ...]] = {
    "output_load.from_motion": ("rack_and_pinion", "belt"),
    "output_load.drive.type": ("rack_and_pinion", "belt"),
    "output_load.drive.diameter_mm": ("rack_and_pinion", "belt"),
    "output_load.rack_helix_deg": ("rack_and_pinion",),
    "output_load.belt_tension_factor": ("belt",),
}
"""Inputs of a pinion or pulley on the shaft, and with which of both they count."""

WORDS: Mapping[str, str] = {
    **BEARING_MODELS,
    **LIFE_BASES,
    **POSITION_ERROR_AT,
    **MECHANISMS,
    **{code: ranking.choice for code, ranking in RANKINGS.items()},
    "True": N_("yes"),
    "False": N_("no"),
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
    """Value of an application at a path of INPUTS, or None where nothing is said.

    Of the load, also the defaults that a phase's load has.
    """
    if path in OF_SHAFT and application.shaft_drive not in OF_SHAFT[path]:
        return None
    first, *rest = path.split(".")
    part: Any = application.loads if first == "output_load" else getattr(application, first)
    for step in rest:
        part = getattr(part, step, None)
    value: Value | None = part
    return None if value == UNSAID.get(path) else value


def given(application: Application, paths: Iterable[str], reader: Reader) -> Iterable[InputLine]:
    """Those inputs that are given or have a default."""
    for path in paths:
        value = value_of(application, path)
        if value is not None:
            yield InputLine(reader.text(INPUTS[path].name), INPUTS[path].symbol, written(value, path, reader))


def written(value: Value, path: str, reader: Reader) -> str:
    """A value of an input in words or with its unit."""
    if isinstance(value, tuple):
        return ", ".join(map(str, value))
    if isinstance(value, str | bool):
        return reader.text(WORDS.get(str(value), str(value)))
    unit = suffix_of(path)
    if isinstance(value, dict):
        return "; ".join(f"{_size(size, reader)}: {written(x, path, reader)}" for size, x in value.items())
    return reader.with_unit(reader.exact(value, unit), unit)


def _size(size: str, reader: Reader) -> str:
    return reader.text(FOR_OTHERS) if size == OTHERS else size
