"""Common values: they hold for every axis of a document without a value of its own."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Self

from pydantic import Field, create_model, model_validator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from hpn.application import ApplicationArea, OutputLoad, RankBy, Requirements
from hpn.application.input_fields import FIELDS, takes_tolerance
from hpn.application.tolerances import NO_INPUT, Tolerances
from hpn.words.fields import Model, refused

Json = dict[str, Any]

OWN = frozenset(
    (
        "requirements.load_inertia_kgm2",
        "requirements.rest_friction_Nm",
        "requirements.load_reverses",
        "output_load.radial_N",
        "output_load.axial_N",
        "output_load.radial_position_mm",
        "output_load.axial_radius_mm",
        "output_load.from_motion",
        "output_load.rack_helix_deg",
        "output_load.belt_tension_factor",
    )
)
"""Fields that are always the axis's own, though they stand beside common ones: they describe its build and load."""

OWN_PARTS = ("duty_cycle", "emergency_stop", "requirements.motor", "output_load.drive")
"""Parts of an application whose fields are all the axis's own."""

COMMON = tuple(
    path for path in FIELDS if path not in OWN and not any(path.startswith(f"{part}.") for part in OWN_PARTS)
)
"""Paths of the fields that common values may have: all except the axis's own."""

TOLERANCE = "tolerances."
"""Beginning of the path of a common tolerance; the path of its input follows."""

EXCLUSIVE = (("requirements.position_error_arcmin", "requirements.position_error_mm"),)
"""Pairs of fields of which an application has at most one: an own value displaces the common value of the other."""


def _inheritable(model: type[Model], part: str) -> Mapping[str, Any]:
    """Fields of a part of an application that may be common; each is null by default, and a null is inherited."""
    return {
        name: (
            _kind(field) | None,
            Field(
                None,
                description=field.description,
                examples=field.examples,
                json_schema_extra=field.json_schema_extra,
            ),
        )
        for name, field in model.model_fields.items()
        if f"{part}.{name}" in COMMON
    }


def _kind(field: FieldInfo) -> Any:
    """Type of a field with its bounds."""
    return Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation


CommonRequirements = create_model(
    "CommonRequirements",
    __base__=Model,
    __doc__="Requirements that hold for every axis without its own.",
    **_inheritable(Requirements, "requirements"),
)
CommonLoad = create_model(
    "CommonLoad",
    __base__=Model,
    __doc__="Conditions for the output bearing of every axis with a load.",
    **_inheritable(OutputLoad, "output_load"),
)


class Common(Model):
    """Values that every axis without its own inherits; null counts as not given."""

    requirements: CommonRequirements | None = Field(None, description="Requirements on every gear.")
    output_load: CommonLoad | None = Field(None, description="Conditions of every axis that has a load.")
    application_area: ApplicationArea | None = Field(None, description="Area of use of the machine.")
    rank_by: RankBy | None = Field(None, description="Order of the suitable gears.")
    tolerances: Tolerances | None = Field(
        None,
        description="Tolerances of inputs of every axis, by their paths as in an application; an axis without the "
        "input ignores its tolerance.",
        examples=[{"torque_Nm": {"percent": 10.0}}],
    )

    @model_validator(mode="after")
    def _has_tolerances_of_inputs(self) -> Self:
        problem = PydanticCustomError("tolerance_path", NO_INPUT)
        wrong = [path for path in self.tolerances or () if not takes_tolerance(path)]
        if wrong:
            raise refused(self, *((("tolerances", path), problem) for path in wrong))
        return self

    @model_validator(mode="after")
    def _has_one_of_each_pair(self) -> Self:
        values = self.values
        for one, other in EXCLUSIVE:
            if one in values and other in values:
                problem = PydanticCustomError(
                    "common_twice", "give one of {one} and {other}", {"one": one, "other": other}
                )
                raise refused(self, (tuple(other.split(".")), problem))
        return self

    @property
    def values(self) -> Json:
        """Given values, by their paths."""
        return dict(flat(self.as_json))

    @property
    def as_json(self) -> Json:
        """Given values as JSON."""
        return self.model_dump(mode="json", exclude_none=True)


def is_common(path: str) -> bool:
    """True for the path of a value that common values may have."""
    return path in COMMON or (path.startswith(TOLERANCE) and takes_tolerance(path.removeprefix(TOLERANCE)))


def flat(common: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Paths and values of all given values in JSON of common values."""
    for name, value in common.items():
        if isinstance(value, Mapping):
            yield from ((f"{name}.{inner}", each) for inner, each in value.items() if each is not None)
        elif value is not None:
            yield name, value
