"""Every field of an application with its kind and bounds, read from the JSON Schema of the models."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from pydantic import BaseModel

from hpn.application import Application
from hpn.application.phase import Phase
from hpn.application.tolerances import WITHOUT as NO_TOLERANCE
from hpn.physics.motion.mechanisms import CLASSES, Rotary
from hpn.physics.motion.moves import Stroke, Turn

Kind = Literal["number", "integer", "string", "boolean", "points"]
Json = dict[str, Any]


@dataclass(frozen=True)
class InputField:
    """One field: its place in the application, or in a phase, and the permitted values of it or of its list's items.

    `least` and `most` may be reached, `above` may not. A `required` field is in every application, or in every phase. A
    field `by_size` may also be an object of such values by size; one of kind `points` is a list of objects.
    """

    path: tuple[str, ...]
    kind: Kind
    is_list: bool
    required: bool
    default: Any
    least: float
    most: float
    above: float
    choices: tuple[str, ...] | None
    by_size: bool = False


def _fields_below(schema: Json, definitions: Json, path: tuple[str, ...] = ()) -> Iterator[InputField]:
    required = schema.get("required", ())
    for name, entry in schema["properties"].items():
        place = (*path, name)
        if place in (("duty_cycle", "phases"), ("duty_cycle", "motion"), ("tolerances",)):
            continue  # a phase has its own table of fields, and a tolerance has the path of its input
        shape = _resolved(entry, definitions)
        if "properties" in shape:
            yield from _fields_below(shape, definitions, place)
        else:
            yield _field(place, entry, shape, required=name in required and not path)


def _resolved(entry: Json, definitions: Json) -> Json:
    """Schema of a field, its reference resolved, without null and without the alternative object by size."""
    entry = next((option for option in _options(entry) if option.get("type") != "null"), entry)
    return dict(definitions[entry["$ref"].rsplit("/", 1)[1]]) if "$ref" in entry else entry


def _options(entry: Json) -> list[Json]:
    """Alternative schemas of a field, values before objects of them; empty for a single schema."""
    options: Iterable[Json] = entry.get("anyOf", ()) or entry.get("oneOf", ())
    return sorted(options, key=_is_by_size)


def _is_by_size(option: Json) -> bool:
    return isinstance(option.get("additionalProperties"), dict)


def _field(path: tuple[str, ...], entry: Json, shape: Json, *, required: bool) -> InputField:
    item = shape["items"] if shape["type"] == "array" else shape
    is_points = "$ref" in item
    return InputField(
        path=path,
        kind="points" if is_points else item["type"],
        is_list=shape["type"] == "array" and not is_points,
        required=required,
        default=entry.get("default"),
        least=item.get("minimum", -math.inf),
        most=item.get("maximum", math.inf),
        above=item.get("exclusiveMinimum", -math.inf),
        choices=tuple(item["enum"]) if "enum" in item else None,
        by_size=any(map(_is_by_size, _options(entry))),
    )


def _of_phase() -> Iterator[InputField]:
    schema = Phase.model_json_schema()
    for name, entry in schema["properties"].items():
        yield _field((name,), entry, _resolved(entry, {}), required=name in schema["required"])


def _of_application() -> Iterator[InputField]:
    schema = Application.model_json_schema()
    return _fields_below(schema, schema["$defs"])


PHASE_FIELDS: Mapping[str, InputField] = {field.path[0]: field for field in _of_phase()}
"""Fields of a phase by name."""

PHASE_FIGURES = tuple(name for name, field in PHASE_FIELDS.items() if field.kind == "number")
"""Fields of a phase that are numbers: all except its name."""

FIELDS: Mapping[str, InputField] = {".".join(field.path): field for field in _of_application()}
"""Fields outside the phases and the motion by their path: `requirements.life_h`."""

ONE_PHASE = re.compile(r"phases\.(?:0|[1-9][0-9]{0,4})\.([A-Za-z_]+)")
OF_MOTION = re.compile(r"motion\.(?:(mechanism)\.|(moves)\.(?:0|[1-9][0-9]{0,4})\.)?([A-Za-z0-9_]+)")


def _motion_figures(*models: type[BaseModel]) -> frozenset[str]:
    """Numbers of a motion's parts by name."""
    entries = ((name, entry) for model in models for name, entry in model.model_json_schema()["properties"].items())
    return frozenset(name for name, entry in entries if _resolved(entry, {}).get("type") == "number")


MOTION_FIGURES: Mapping[str, frozenset[str]] = {
    "mechanism": _motion_figures(Rotary, *CLASSES.values()),
    "moves": _motion_figures(Turn, Stroke),
    "": frozenset(("start_deg",)),
}
"""Numbers of a motion by its part."""


def takes_tolerance(path: str) -> bool:
    """True for the path of an input that takes a tolerance in some application."""
    if match := ONE_PHASE.fullmatch(path):
        return match[1] in PHASE_FIGURES
    if path in NO_TOLERANCE or path.startswith("duty_cycle"):
        return False
    field = FIELDS.get("duty_cycle.pause_s" if path == "pause_s" else path)
    is_number = field is not None and field.kind == "number" and not field.is_list
    if match := OF_MOTION.fullmatch(path):
        return match[3] in MOTION_FIGURES[match[1] or match[2] or ""]
    return path in PHASE_FIGURES or is_number


NUMBERS = tuple(field.path for field in FIELDS.values() if field.kind in ("number", "integer") and not field.is_list)
"""Paths of all single numbers of an application outside its motion: ("requirements", "motor", "peak_torque_Nm")."""
