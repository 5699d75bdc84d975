"""Application of an axis from its own values and the common ones."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from hpn.application import Application
from hpn.application.faults import Location, sentences_of
from hpn.documents.axis import loads_in_phases
from hpn.documents.common import EXCLUSIVE, flat
from hpn.words.wording import Sentence

Json = dict[str, Any]

PARTS = ("requirements", "output_load", "tolerances")
"""Parts that are merged field by field; every other value is own or inherited as a whole."""

LOADING = ("radial_N", "axial_N", "from_motion", "drive")
"""Fields of `output_load` that give an axis a load."""

OF_NOTHING = ("tolerance_of_nothing", "tolerance_of_motion", "tolerance_path")
"""Codes of faults of a tolerance whose input the application lacks."""

LACKS = frozenset(("inertia_of_load", "no_rest", "error_radius", *OF_NOTHING))
"""Codes of faults where the application lacks something that a value needs: such a common value is then not asked."""


Fault = tuple[Location, Sentence, str]
"""Place of a fault, its sentence and a code for programs."""


@dataclass(frozen=True, slots=True)
class Resolved:
    """Application of an axis from its own and the common values that hold for it, as JSON and as a model.

    `inherited` are the paths of common values in it; `not_asked` are the paths of common values that need something the
    axis lacks. `application` is None where there are `faults`.
    """

    whole: Json
    inherited: frozenset[str]
    not_asked: tuple[str, ...] = ()
    application: Application | None = None
    faults: tuple[Fault, ...] = ()


def resolve(own: Mapping[str, Any], common: Mapping[str, Any], without: Collection[str] = ()) -> Resolved:
    """Application of an axis with these own and common values, given as JSON.

    A common value that the models refuse because this axis lacks something is left out, and named in `not_asked`.
    """
    not_asked: list[str] = []
    while True:
        whole, inherited = merged(own, common, {*without, *not_asked})
        try:
            application = Application.model_validate(whole)
        except ValidationError as error:
            lacking = _lacking(error, inherited)
            if not lacking:
                return Resolved(whole, inherited, tuple(not_asked), faults=tuple(sentences_of(error)))
            not_asked += lacking
        else:
            return Resolved(whole, inherited, tuple(not_asked), application)


def _lacking(error: ValidationError, inherited: Collection[str]) -> list[str]:
    """Paths of inherited values that are refused because the axis lacks something."""
    entries = error.errors(include_url=False, include_input=False, include_context=False)
    paths = (".".join(map(str, entry["loc"])) for entry in entries if entry["type"] in LACKS)
    return list(dict.fromkeys(path for path in paths if path in inherited))


def merged(own: Mapping[str, Any], common: Mapping[str, Any], left_out: Collection[str]) -> tuple[Json, frozenset[str]]:
    """Values of an axis: its own and the common ones that hold for it; and the paths of these common ones."""
    whole = {
        name: _without_nulls(value) if name in PARTS else value for name, value in own.items() if value is not None
    }
    common_values = {path: value for path, value in flat(common) if path not in left_out and _holds(path, whole, own)}
    for path, value in common_values.items():
        part, _, name = path.partition(".")
        if name:
            whole[part] = {**whole.get(part, {}), name: value}
        else:
            whole[part] = value
    return whole, frozenset(common_values)


def _without_nulls(part: Any) -> Any:
    """Part of an application without its nulls."""
    return {name: value for name, value in part.items() if value is not None} if isinstance(part, Mapping) else part


def _holds(path: str, whole: Mapping[str, Any], own: Mapping[str, Any]) -> bool:
    """True for a common value that holds for an axis with these own values."""
    part, _, name = path.partition(".")
    if not name:
        return part not in whole
    fields = whole.get(part, {})
    if not isinstance(fields, Mapping):  # not an object: the models report that
        return False
    if part == "output_load" and not (any(fields.get(each) for each in LOADING[2:]) or _is_loaded(fields, own)):
        return False
    names = {name, *(other.rpartition(".")[2] for pair in EXCLUSIVE for other in pair if path in pair)}
    return names.isdisjoint(fields)


def _is_loaded(load: Mapping[str, Any], own: Mapping[str, Any]) -> bool:
    return any(name in load for name in LOADING[:2]) or loads_in_phases(own)
