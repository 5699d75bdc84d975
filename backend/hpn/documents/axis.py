"""Axes of a document as they are sent, and the bounds of a document."""

import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from hpn.application.tolerances import MOST_TOLERANCES
from hpn.documents.common import COMMON, TOLERANCE, is_common
from hpn.words.fields import WHOLE, Model
from hpn.words.titles import Name, Note, Title

Json = dict[str, Any]

MOST_AXES, MOST_PHASES, MOST_BYTES, MOST_REVISIONS = 10_000, 200_000, 32_000_000, 1_000
"""Axes, phases or moves of all axes, bytes of a request, and revisions that a document may have."""

MOST_OF_A_KIND, MOST_NUMBER = 1_000_000, 2**31 - 1


def _distinct(paths: tuple[str, ...]) -> tuple[str, ...]:
    if len(set(paths)) < len(paths):
        raise PydanticCustomError("repeated", "must name each path once")
    return paths


def _common(path: str) -> str:
    if not is_common(path):
        raise PydanticCustomError("not_common", "is no path of a common value, such as requirements.life_h")
    return path


SCHEMAS: list[Any] = [{"enum": list(COMMON)}, {"pattern": f"^{re.escape(TOLERANCE)}[A-Za-z0-9_.]+$"}]
Path = Annotated[str, AfterValidator(_common), Field(json_schema_extra={"anyOf": SCHEMAS})]
Without = Annotated[tuple[Path, ...], Field(max_length=len(COMMON) + MOST_TOLERANCES), AfterValidator(_distinct)]
Quantity = Annotated[int, Field(strict=True, ge=1, le=MOST_OF_A_KIND), WHOLE]


class Axis(Model):
    """One axis: what it is called, how often there is one, and what is asked of it beside the common values."""

    number: Annotated[int, Field(strict=True, ge=1, le=MOST_NUMBER), WHOLE] | None = Field(
        None, description="Number of a removed axis, which comes back; else it is ignored."
    )
    name: Name | None = Field(None, description="Your name for the axis; it need not be unique.", examples=["Y bridge"])
    quantity: Quantity = Field(1, description="Number of such axes.", examples=[1])
    note: Note | None = Field(None, description="A note on the axis.")
    ordering_code: Title | None = Field(
        None,
        description="Gear, output version and motor adapter as ordered, as far as they are known; the axis then counts "
        "with this gear.",
        examples=["HPN-20A-5-J6-BH-AF1"],
    )
    without: Without = Field(
        (), description="Paths of common values that do not hold for this axis.", examples=[["requirements.life_h"]]
    )
    application: dict[str, Any] = Field(
        default_factory=dict,
        description="The axis’s own part of its application, kept as it is sent; what it lacks is inherited. One that "
        "cannot be calculated is kept, too, and leaves the axis open.",
    )

    @model_validator(mode="before")
    @classmethod
    def _leaves_out_what_is_given_alone(cls, value: Any) -> Any:
        if isinstance(value, dict) and not READ_ONLY.isdisjoint(value):
            return {name: each for name, each in value.items() if name not in READ_ONLY}
        return value


READ_ONLY = frozenset(("resolved", "answer", "updated", "updated_by"))
"""Fields of an axis that are given back, and ignored when they are sent."""


def phases_of(own: Mapping[str, Any]) -> int:
    """Number of phases or moves in an axis's own part of an application, whatever else is wrong with it."""
    return sum(len(rows) for rows in _rows_of(own))


def loads_in_phases(own: Mapping[str, Any]) -> bool:
    """True where a phase or move carries a load of its own."""
    return any(
        row.get(name) is not None
        for rows in _rows_of(own)
        for row in rows
        if isinstance(row, Mapping)
        for name in ("radial_N", "axial_N")
    )


def _rows_of(own: Mapping[str, Any]) -> list[list[Any]]:
    cycle = _object(own.get("duty_cycle"))
    rows = (cycle.get("phases"), _object(cycle.get("motion")).get("moves"))
    return [each for each in rows if isinstance(each, list)]


def _object(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}
