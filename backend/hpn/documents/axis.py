"""Axes of a document as they are sent, and the bounds of a document."""

import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

from hpn.application.tolerances import MOST_TOLERANCES
from hpn.documents.common import COMMON, TOLERANCE, is_common
from hpn.words.fields import WHOLE, Model
from hpn.words.titles import Name, Note, Title

Json = dict[str, Any]

MOST_AXES, MOST_PHASES, MOST_BYTES, MOST_REVISIONS = 10_000, 200_000, 32_000_000, 1_000
"""Limits of a document: axes, phases or moves of all axes, bytes of a request, and revisions."""

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
    """One axis: its name, its quantity, and its own values beside the common ones."""

    read_only = frozenset(("resolved", "answer", "updated", "updated_by"))
    number: Annotated[int, Field(strict=True, ge=1, le=MOST_NUMBER), WHOLE] | None = Field(
        None, description="Number of a removed axis, to restore it; otherwise ignored."
    )
    name: Name | None = Field(None, description="Your name for the axis; it need not be unique.", examples=["Y bridge"])
    quantity: Quantity = Field(1, description="Number of equal axes.", examples=[1])
    note: Note | None = Field(None, description="A note on the axis.")
    ordering_code: Title | None = Field(
        None,
        description="Gear, output version and motor adapter as ordered, as far as they are known; the axis then counts "
        "with this gear.",
        examples=["HPN-20A-5-J6-BH-AF1"],
    )
    without: Without = Field(
        (), description="Paths of common values that this axis does not inherit.", examples=[["requirements.life_h"]]
    )
    application: dict[str, Any] = Field(
        default_factory=dict,
        description="The axis’s own part of its application, stored as sent; missing values are inherited. A part "
        "that cannot be calculated is stored, too, and leaves the axis open.",
    )


def phases_of(own: Mapping[str, Any]) -> int:
    """Number of phases or moves in an axis's own part of an application, also where that is invalid."""
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
