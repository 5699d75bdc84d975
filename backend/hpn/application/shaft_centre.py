"""Distance x_c of the shaft's centre from its shoulder: one number for all sizes, or an object by size."""

import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, TypeAdapter, WrapValidator
from pydantic_core import InitErrorDetails, PydanticCustomError, PydanticKnownError, ValidationError

from hpn.words.designations import OTHERS, canonical_place
from hpn.words.fields import Positive
from hpn.words.wording import N_

MOST_SIZES = 100

NO_CENTRE = N_('must be a number, such as 21, or an object by size, such as {"20A": 21, "others": 18}')
TWICE = N_("is given twice: {size}")


_Number = TypeAdapter[float](Positive)
_BySize = TypeAdapter[dict[str, float]](dict[Annotated[str, BeforeValidator(canonical_place)], Positive])


def _of_either(value: Any, _: Any) -> float | dict[str, float] | None:
    """A number or an object, validated by its type, so that an error has its place in the request."""
    if isinstance(value, dict):
        return _by_size(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise PydanticCustomError("shaft_centre", NO_CENTRE)
    return _Number.validate_python(value)


def _by_size(value: dict[str, Any]) -> float | dict[str, float] | None:
    """Distances by size without nulls, in a fixed order: one distance for all sizes becomes a number, none becomes
    None.
    """
    if len(value) > MOST_SIZES:
        counts = {"field_type": "Tuple", "max_length": MOST_SIZES, "actual_length": len(value)}
        raise PydanticKnownError("too_long", counts)
    distances = {name: each for name, each in value.items() if each is not None}
    names: dict[str, str] = {}
    for name in distances:
        if names.setdefault(canonical_place(name), name) != name:
            error = PydanticCustomError("size_twice", TWICE, {"size": canonical_place(name)})
            details = InitErrorDetails(type=error, loc=(name,), input=None)
            raise ValidationError.from_exception_data("shaft_centre_mm", [details])
    by_size = _BySize.validate_python(distances)
    if by_size.keys() <= {OTHERS}:
        return by_size.get(OTHERS)
    return {size: by_size[size] for size in sorted(by_size, key=_place)}


def _place(size: str) -> tuple[bool, int, str]:
    number = re.match("[0-9]{1,9}", size)
    return size == OTHERS, int(number[0]) if number else 0, size


ShaftCentre = Annotated[
    Positive | Annotated[dict[str, Positive], Field(max_length=MOST_SIZES)], WrapValidator(_of_either)
]
"""A number holds for all sizes. An object with only `others` becomes a number, and an empty one becomes None."""


def of_others(centre: float | Mapping[str, float] | None) -> float | None:
    """Distance for sizes without their own; None if not given."""
    return centre.get(OTHERS) if isinstance(centre, Mapping) else centre


def by_size(centre: float | Mapping[str, float] | None) -> dict[str, float]:
    """Distances of sizes with their own."""
    return {size: x_c for size, x_c in centre.items() if size != OTHERS} if isinstance(centre, Mapping) else {}
