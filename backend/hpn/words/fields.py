"""Kinds of numbers with their bounds for the fields of input models, and the closed, frozen model.

Every field name ends in its unit. The bounds keep every power in chapter 4 far inside the range of a floating-point
number.
"""

from collections.abc import Callable
from functools import cache
from typing import Annotated, Any, ClassVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    model_validator,
)
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError, PydanticKnownError

from hpn.words.units import suffix_of, symbol_of

MAXIMUM_PHASES = 10_000

LEAST = 1e-12
"""Smallest divisor: a quotient by a smaller one could overflow."""


def _above_zero(value: float) -> float:
    """Refuse a number not above 0, or so small that a quotient by it could overflow."""
    if value <= 0:
        raise PydanticKnownError("greater_than", {"gt": 0})
    if value < LEAST:
        raise PydanticCustomError("vanishing", "must be at least 1e-12")
    return value


def at_most(most: int) -> BeforeValidator:
    """Refuse a longer list before its items are validated, which would collect an error for each."""

    def check(value: object) -> object:
        if isinstance(value, list | tuple) and len(value) > most:
            counts = {"field_type": "Tuple", "max_length": most, "actual_length": len(value)}
            raise PydanticKnownError("too_long", counts)
        return value

    return BeforeValidator(check)


PART = 500


def in_parts(value: Any, validate: Callable[[Any], tuple[Any, ...]]) -> tuple[Any, ...]:
    """Validate a long list part by part, so that other threads run in between, and only one part has errors.

    Validated items stay in front, so that the place in an error counts in the whole list.
    """
    if not isinstance(value, list | tuple) or len(value) <= PART:
        return validate(value)
    path: tuple[Any, ...] = ()
    for start in range(0, len(value), PART):
        path = validate((*path, *value[start : start + PART]))
    return path


def whole(value: object) -> object:
    """Whole floats as integers, as JSON Schema counts them; any other value unchanged."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


WHOLE = BeforeValidator(whole)
"""Validator behind an integer's bounds, so that these appear in its JSON Schema."""

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Torque = Annotated[Number, Field(ge=-1e6, le=1e6)]
TorqueMagnitude = Annotated[Number, Field(ge=0, le=1e6)]
Speed = Annotated[Number, Field(ge=-1e6, le=1e6)]
SpeedMagnitude = Annotated[Number, Field(ge=0, le=1e6)]
Duration = Annotated[Number, Field(gt=0, le=1e9)]
Seconds = Annotated[Number, Field(ge=0, le=1e6)]
Load = Annotated[Number, Field(ge=-1e9, le=1e9)]
SAYS_LEAST: Any = Field(json_schema_extra={"minimum": LEAST})
Hours = Annotated[Number, Field(le=1e9), AfterValidator(_above_zero), SAYS_LEAST]
MoveTime = Annotated[Number, Field(le=1e9), AfterValidator(_above_zero), SAYS_LEAST]
Positive = Annotated[Number, Field(le=1e12), AfterValidator(_above_zero), SAYS_LEAST]
MovingSpeed = Annotated[Number, Field(le=1e6), AfterValidator(_above_zero), SAYS_LEAST]
Share = Annotated[Number, Field(le=1), AfterValidator(_above_zero), SAYS_LEAST]
Ratio = Annotated[int, Field(strict=True, ge=1, le=10_000), WHOLE]


def name_units(schema: dict[str, Any]) -> None:
    """Add the unit of every field to the JSON Schema, read from the field's own name."""
    for name, entry in schema.get("properties", {}).items():
        if suffix_of(name):
            entry["x-unit"] = symbol_of(name)


def describe(schema: dict[str, Any]) -> None:
    """Mark nullable fields in a model's JSON Schema, and add the unit of every field."""
    for name, entry in schema.get("properties", {}).items():
        if name not in schema.get("required", ()):
            _let_be_null(entry)
    name_units(schema)


def _let_be_null(entry: dict[str, Any]) -> None:
    null = {"type": "null"}
    if null not in entry.get("anyOf", entry.get("oneOf", ())):
        moved = {key: entry.pop(key) for key in tuple(entry) if key not in BESIDE}
        entry["anyOf"] = [moved, null]


BESIDE = ("default", "description", "examples", "title")
"""Keys of a field's JSON Schema that apply to its null as well."""


def one_of(schema: dict[str, Any]) -> None:
    """Rename a union with exclusive members to `oneOf`, which generators of clients read as a union of types."""
    schema["oneOf"] = schema.pop("anyOf")


class Model(BaseModel):
    """Frozen, closed model: an unknown field is an error, never ignored. A null in an optional field counts as not
    given.

    `read_only` are fields of replies that are ignored in requests.
    """

    read_only: ClassVar[frozenset[str]] = frozenset()
    model_config = ConfigDict(frozen=True, extra="forbid", json_schema_extra=describe)

    @model_validator(mode="before")
    @classmethod
    def _reads_fields(cls, value: Any) -> Any:
        """The value without nulls in fields with another default; an unknown field is refused."""
        if not isinstance(value, dict) or isinstance(value, _Refused):
            return value
        if not cls.read_only.isdisjoint(value):
            value = {name: each for name, each in value.items() if name not in cls.read_only}
        if None in value.values():
            value = {name: each for name, each in value.items() if each is not None or name not in _defaults(cls)}
        if not value.keys() <= cls.model_fields.keys():
            cls._refuse_unknown(value)
        return value

    @classmethod
    def _refuse_unknown(cls, value: dict[str, Any]) -> None:
        """Raise the errors of a value with an unknown field; they include the known fields."""
        if len(value.keys() - cls.model_fields.keys()) > MOST_UNKNOWN:
            return
        try:
            cls.model_validate(_Refused(value))
        except ValidationError as error:
            errors = error.errors(include_url=False, include_input=False)
            details = [_with_fields(entry, tuple(cls.model_fields)) for entry in errors]
            raise ValidationError.from_exception_data(error.title, details) from None


class _Refused(dict[str, Any]):
    """A value with an unknown field, in its second validation."""


MOST_UNKNOWN = 20
"""Unknown fields, at most, that are compared with known ones; with more it is another kind of object."""


@cache
def _defaults(model: type[Model]) -> frozenset[str]:
    """Fields with a default other than null."""
    return frozenset(
        name
        for name, field in model.model_fields.items()
        if not field.is_required() and field.get_default(call_default_factory=True) is not None
    )


def _with_fields(entry: ErrorDetails, fields: tuple[str, ...]) -> InitErrorDetails:
    """A model's error, with the model's fields if it is about an unknown field."""
    is_unknown = entry["type"] == UNKNOWN and len(entry["loc"]) == 1
    context = {"fields": fields} if is_unknown else entry.get("ctx")
    error = PydanticCustomError(entry["type"], entry["msg"], context)
    return InitErrorDetails(type=error, loc=entry["loc"], input=None)


UNKNOWN = "extra_forbidden"
"""Pydantic's code for an unknown field."""


def refused(model: BaseModel, *problems: tuple[tuple[str | int, ...], PydanticCustomError]) -> ValidationError:
    """Error of a model at places below it, from pairs (location, error), for a validator to raise."""
    details = [InitErrorDetails(type=error, loc=location, input=None) for location, error in problems]
    return ValidationError.from_exception_data(type(model).__name__, details)
