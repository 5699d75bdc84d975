"""A motion as somebody describes it: a mechanism and its moves."""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Annotated, Any, NoReturn, Self

import numpy as np
from pydantic import BeforeValidator, Field, WrapValidator, model_validator
from pydantic_core import InitErrorDetails, PydanticKnownError, ValidationError

from hpn.application.phase import Phase
from hpn.physics.equations import FloatArray
from hpn.physics.motion.course import Course, course_of
from hpn.physics.motion.mechanisms import CLASSES, RPM, TYPES, LinearMechanism, Mechanism, Rotary
from hpn.physics.motion.moves import Move, Stroke, Turn
from hpn.physics.motion.pieces import PlaceArray
from hpn.physics.motion.refusals import refusal
from hpn.physics.motion.stopped import StoppedLoad, stopped_load
from hpn.words.fields import MAXIMUM_PHASES, Model, Number, at_most, in_parts, one_of, refused
from hpn.words.wording import Quantity

MAXIMUM_MOVES = 1000

MOST_DEGREES = 720_000.0
"""Sum of the angles of a motion under gravity, which is looked at eighth by eighth of a turn."""

BOUNDS = {"motion_speed": 1e6, "motion_time": 1e9, "motion_torque": 1e6}
"""Bounds of a typed phase, by the code of the refusal."""

OF_ONE_TURN = 1e-9
"""Share of a turn within which a motion counts as back at its start."""


class _Motion(Model):
    """Base of both motions: the bounds that their moves keep, and the course and load phases that follow from them."""

    mechanism: Mechanism
    moves: tuple[Move, ...]

    @model_validator(mode="after")
    def _is_within_bounds(self) -> Self:
        moves = self.moves
        if not any(move.way for move in moves):
            raise refused(self, (("moves",), refusal("no_move")))
        load = self.mechanism.load
        turned = math.fsum(abs(move.way) for move in moves)
        if load.gravity_Nm and turned > MOST_DEGREES:
            self._refuse("motion_turns", turned, MOST_DEGREES, "deg")
        self._require("motion_speed", "rpm", [load.ratio * m.peak_speed / load.way_per_rad / RPM for m in moves])
        course = self.course
        if len(course.move) > MAXIMUM_PHASES:
            self._refuse("motion_phases", len(course.move), MAXIMUM_PHASES, "")
        self._require("motion_time", "s", course.duration_s, course.move)
        self._require("motion_torque", "Nm", course.peak_torque_Nm, course.move)
        return self

    def _require(
        self, code: str, unit: str, values: Sequence[float] | FloatArray, move: PlaceArray | None = None
    ) -> None:
        """Refuse the move with the largest of some values where that is beyond what a typed phase may have."""
        place = int(np.argmax(values))
        if not values[place] <= BOUNDS[code]:
            self._refuse(code, float(values[place]), BOUNDS[code], unit, place if move is None else int(move[place]))

    def _refuse(self, code: str, value: float, bound: float, unit: str, *move: int) -> NoReturn:
        said = {"found": str(Quantity(value, unit, 9, "up")), "bound": str(Quantity(bound, unit, 9))}
        raise refused(self, (("moves", *move), refusal(code, **said)))

    @cached_property
    def course(self) -> Course:
        """Torque and speed of the moves over time, at the gear's output."""
        return course_of(self.moves, getattr(self, "start_deg", 0.0), self.mechanism.load)

    @cached_property
    def stopped_load(self) -> StoppedLoad:
        """Torques of the load in an emergency stop at any instant of the moves."""
        return stopped_load(self.moves, self.course)

    @cached_property
    def phases(self) -> tuple[Phase, ...]:
        """The load phases that come out."""
        course = self.course
        columns = zip(
            course.move.tolist(),
            course.torque_Nm.tolist(),
            course.speed_rpm.tolist(),
            course.duration_s.tolist(),
            course.peak_torque_Nm.tolist(),
            course.peak_speed_rpm.tolist(),
            course.rms_torque_Nm.tolist(),
            course.least_torque_Nm.tolist(),
            strict=True,
        )
        return tuple(
            Phase.model_construct(
                torque_Nm=T,
                speed_rpm=n,
                duration_s=t,
                radial_N=self.moves[move].radial_N,
                axial_N=self.moves[move].axial_N,
                peak_torque_Nm=peak,
                peak_speed_rpm=fastest,
                rms_torque_Nm=rms,
                least_torque_Nm=least,
                name=self.moves[move].name,
            )
            for move, T, n, t, peak, fastest, rms, least in columns
        )

    @property
    def load_inertia_kgm2(self) -> float:
        """Moment of inertia of the load at the gear's output."""
        return self.course.load_inertia_kgm2

    @property
    def wheel(self) -> str | None:
        """Type of the mechanism where a pinion or pulley may sit on the gear's shaft; None for any other."""
        kind: str = getattr(self.mechanism, "type", "")
        return kind if kind in ("rack_and_pinion", "belt") and self.mechanism.ratio == 1 else None

    @property
    def triangles(self) -> tuple[int, ...]:
        """Places of the moves that came out as triangles nobody asked for."""
        ramped = ("trapezoidal", "s_curve")
        return tuple(k for k, move in enumerate(self.moves) if move.profile in ramped and move.timing.is_cut)

    @property
    def is_left_off(self) -> bool:
        """True for one that ends where gravity pulls otherwise than where it began."""
        if not self.mechanism.load.gravity_Nm:
            return False
        turns = math.fsum(move.way for move in self.moves) / 360
        return abs(turns - round(turns)) > OF_ONE_TURN


def _kind(value: dict[str, Any], *above: str) -> Any:
    """Type that a mechanism names; raises ValidationError where there is none or no such."""
    kind = value.get("type")
    if kind in TYPES:
        return kind
    listed = ", ".join(f"'{name}'" for name in TYPES[:-1]) + f" or '{TYPES[-1]}'"
    error = InitErrorDetails(type="literal_error", loc=(*above, "type"), input=kind, ctx={"expected": listed})
    if "type" not in value:
        error = InitErrorDetails(type="missing", loc=(*above, "type"), input=value)
    raise ValidationError.from_exception_data("Mechanism", [error])


def _as_linear(value: Any) -> Any:
    """A rack, belt or screw of the type that it names."""
    return CLASSES[_kind(value)].model_validate(value) if isinstance(value, dict) else value


class RotaryMotion(_Motion):
    """Moves of a mass that turns."""

    mechanism: Rotary = Field(description="Turning load.")
    start_deg: Annotated[Number, Field(ge=-1e6, le=1e6)] = Field(
        0.0, description="Angle of the gravity mass from the horizontal at the start.", examples=[0.0]
    )
    moves: Annotated[tuple[Turn, ...], WrapValidator(in_parts), at_most(MAXIMUM_MOVES)] = Field(
        min_length=1, max_length=MAXIMUM_MOVES, description="Moves in their order, each from rest to rest."
    )


class LinearMotion(_Motion):
    """Moves of a mass along a line."""

    mechanism: Annotated[LinearMechanism, BeforeValidator(_as_linear)] = Field(
        description="Mechanism that converts the gear’s rotation into travel.", json_schema_extra=one_of
    )
    moves: Annotated[tuple[Stroke, ...], WrapValidator(in_parts), at_most(MAXIMUM_MOVES)] = Field(
        min_length=1, max_length=MAXIMUM_MOVES, description="Moves in their order, each from rest to rest."
    )


def _of_mechanism(value: Any) -> Any:
    """A motion by the type of its mechanism, so that an error stands at its place in what was sent."""
    if value is None or isinstance(value, RotaryMotion | LinearMotion):
        return value
    if not isinstance(value, dict):
        raise PydanticKnownError("model_type", {"class_name": "Motion"})
    mechanism = value.get("mechanism")
    linear = isinstance(mechanism, dict) and _kind(mechanism, "mechanism") in CLASSES
    return (LinearMotion if linear else RotaryMotion).model_validate(value)


Motion = Annotated[RotaryMotion | LinearMotion, BeforeValidator(_of_mechanism)]
