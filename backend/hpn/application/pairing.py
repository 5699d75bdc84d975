"""A request for pairs of gear and motor: an application without a motor, motors, and the order of the pairs."""

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from hpn.application.application import Application
from hpn.application.motor import CURVE, STALL_TORQUE, Curve, Motor
from hpn.words.fields import Model, Positive, at_most, refused

PairRank = Literal["weight", "utilisation", "inertia_ratio", "resonance"]
BestOf = Literal["motor"]

MOST_MOTORS = 1000
"""Motors of a request, and pairs of a reply, at most."""


class MotorEntry(Model):
    """A motor of a list: its figures at the shaft, as in its data sheet."""

    designation: Annotated[str, Field(min_length=1, max_length=100, description="Name of the motor, unique in a list.")]
    maximum_speed_rpm: Positive | None = Field(None, description="Maximum motor speed.", examples=[6000.0])
    rated_speed_rpm: Positive | None = Field(
        None, description="Rated motor speed, the limit of the average speed.", examples=[3000.0]
    )
    rated_torque_Nm: Positive | None = Field(
        None, description="Continuous torque up to the rated speed, the limit of the RMS.", examples=[2.4]
    )
    stall_torque_Nm: Positive | None = STALL_TORQUE
    peak_torque_Nm: Positive | None = Field(None, description="Peak motor torque.", examples=[7.2])
    inertia_kgm2: Positive | None = Field(
        None, description="Moment of inertia of the motor’s rotor, its brake included.", examples=[0.00015]
    )
    weight_kg: Positive | None = Field(None, description="Weight of the motor.", examples=[2.1])
    curve: Curve | None = CURVE

    @model_validator(mode="after")
    def _is_in_order(self) -> Self:
        errors = [
            ((low,), PydanticCustomError("motor_order", "is above {high}", {"high": high}))
            for low, high in _IN_ORDER
            if (getattr(self, low) or 0.0) > (getattr(self, high) or float("inf"))
        ]
        if errors:
            raise refused(self, *errors)
        if all(getattr(self, name) is None for name in type(self).model_fields if name != "designation"):
            raise PydanticCustomError("no_figure", "has no figure at all: leave it out, or add one")
        return self


_IN_ORDER = (
    ("rated_speed_rpm", "maximum_speed_rpm"),
    ("rated_torque_Nm", "peak_torque_Nm"),
    ("stall_torque_Nm", "peak_torque_Nm"),
)
"""Figures of a motor; the first of each pair is no larger than the second."""


class Distinct(Model):
    """Base of a request with motors, whose designations are all different."""

    motors: tuple[MotorEntry, ...] | None = None

    @model_validator(mode="after")
    def _are_distinct(self) -> Self:
        seen, repeated = set[str](), []
        for place, motor in enumerate(self.motors or ()):
            if motor.designation in seen:
                repeated.append((("motors", place, "designation"), PydanticCustomError("twice", "is there twice")))
            seen.add(motor.designation)
        if repeated:
            raise refused(self, *repeated[:MOST_TOLD])
        return self


MOST_TOLD = 20
"""Repeated motors, at most, that an error lists."""

MOTORS: Any = Field(min_length=1, max_length=MOST_MOTORS)


def _for_motors(value: object) -> Application:
    return value if isinstance(value, Application) else Application.model_validate(value, context={"motors": True})


_OF_LIST = tuple(name for name in Motor.model_fields if name != "inertia_ratio")
"""Fields of a motor that a list provides."""


class Pairing(Distinct):
    """An application on every gear that it allows, with each motor of a list."""

    application: Annotated[Application, BeforeValidator(_for_motors)] = Field(
        description="The application; its own motor may have inertia_ratio only."
    )
    motors: Annotated[tuple[MotorEntry, ...], MOTORS, at_most(MOST_MOTORS)] | None = Field(
        None, description="The motors, in place of a list."
    )
    list: Annotated[str, Field(min_length=1, max_length=40)] | None = Field(
        None, description="Id of a stored list, in place of motors; server is motors.csv.", examples=["server"]
    )
    rank_by: PairRank = Field(
        "weight", description="Figure by which the pairs are ordered: ascending, a resonance descending."
    )
    drive_resonance_Hz: Positive | None = Field(
        None, description="Least resonance of load and motor against each other.", examples=[15.0]
    )
    top: Annotated[int, Field(ge=1, le=MOST_MOTORS, strict=True)] = Field(
        100, description="Largest number of pairs in the reply."
    )
    best_of: BestOf | None = Field(None, description="motor: only the best pair of each motor.")

    @field_validator("application")
    @classmethod
    def _has_no_motor(cls, application: Application) -> Application:
        motor = application.requirements.motor
        if motor is not None and any(getattr(motor, name) is not None for name in _OF_LIST):
            problem = PydanticCustomError("own_motor", "takes the place of the list: leave all but inertia_ratio out")
            raise refused(application, (("requirements", "motor"), problem))
        return application

    @field_validator("drive_resonance_Hz")
    @classmethod
    def _knows_its_load(cls, least: float | None, info: ValidationInfo) -> float | None:
        application: Application | None = info.data.get("application")
        if least is None or application is None:
            return least
        if application.duty_cycle.motion is None and application.requirements.load_inertia_kgm2 is None:
            raise PydanticCustomError("inertia_of_load", "needs a motion, or requirements.load_inertia_kgm2")
        return least

    @model_validator(mode="after")
    def _has_motors(self) -> Self:
        if (self.motors is None) == (self.list is None):
            problem = PydanticCustomError("motors_or_list", "give either motors or the id of a list")
            raise refused(self, (("motors",), problem))
        return self
