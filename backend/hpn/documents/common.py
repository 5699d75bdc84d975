"""Common values: what holds for every axis of a document that has nothing of its own there."""

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
"""Fields beside common ones that are always the axis's own: they say how this axis is built and loaded."""

OWN_PARTS = ("duty_cycle", "emergency_stop", "requirements.motor", "output_load.drive")
"""Parts of an application of which every field is the axis's own."""

COMMON = tuple(
    path for path in FIELDS if path not in OWN and not any(path.startswith(f"{part}.") for part in OWN_PARTS)
)
"""Paths of the fields that common values may have: every one but those that are the axis's own."""

TOLERANCE = "tolerances."
"""Beginning of the path of a common tolerance, which ends with that of its input."""

EXCLUSIVE = (("requirements.position_error_arcmin", "requirements.position_error_mm"),)
"""Fields of which an application has one at most: an own value displaces the common one of the other."""


def _inheritable(model: type[Model], part: str) -> Mapping[str, Any]:
    """Fields of a part of an application that may be common, each null by default, which is inherited."""
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
    __doc__="How the output bearing of every loaded axis is judged.",
    **_inheritable(OutputLoad, "output_load"),
)


class Common(Model):
    """Values that every axis inherits where it has none of its own; a null counts as not given."""

    requirements: CommonRequirements | None = Field(None, description="Requirements on every gear.")
    output_load: CommonLoad | None = Field(None, description="Conditions of every axis that has a load.")
    application_area: ApplicationArea | None = Field(None, description="Area of use of the machine.")
    rank_by: RankBy | None = Field(None, description="Order of the suitable gears.")
    tolerances: Tolerances | None = Field(
        None,
        description="How far inputs of every axis may lie from their values, by their paths as in an application; an "
        "axis without that input skips it.",
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
        """Values that are given, by their paths."""
        return dict(flat(self.sent))

    @property
    def sent(self) -> Json:
        """The values that are given as JSON."""
        return self.model_dump(mode="json", exclude_none=True)


def is_common(path: str) -> bool:
    """True for the path of a value that common values may have."""
    return path in COMMON or (path.startswith(TOLERANCE) and takes_tolerance(path.removeprefix(TOLERANCE)))


def flat(common: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Path and value of everything that is given in JSON of common values."""
    for name, value in common.items():
        if isinstance(value, Mapping):
            yield from ((f"{name}.{inner}", each) for inner, each in value.items() if each is not None)
        elif value is not None:
            yield name, value
