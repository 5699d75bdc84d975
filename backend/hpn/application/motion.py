"""A motion as the user describes it: a mechanism and its moves."""

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Annotated, Any, NoReturn, Self

import numpy as np
from pydantic import BeforeValidator, Field, ValidationInfo, WrapValidator, model_validator
from pydantic_core import InitErrorDetails, PydanticKnownError, ValidationError

from hpn.application.phase import Phase
from hpn.physics.equations import FloatArray
from hpn.physics.motion.course import Course, course_of, courses_along
from hpn.physics.motion.mechanisms import CLASSES, RPM, TYPES, LinearMechanism, Mechanism, Rotary, ShaftLoad
from hpn.physics.motion.moves import Move, Stroke, Turn
from hpn.physics.motion.pieces import PlaceArray, pieces_of
from hpn.physics.motion.refusals import refusal
from hpn.physics.motion.stopped import StoppedLoad, stopped_load
from hpn.words.fields import MAXIMUM_PHASES, Model, Number, at_most, in_parts, one_of, refused
from hpn.words.wording import Quantity

MAXIMUM_MOVES = 1000

MOST_DEGREES = 720_000.0
"""Largest sum of the angles of a motion under gravity, in degrees: it is evaluated in eighths of a turn."""

BOUNDS = {"motion_speed": 1e6, "motion_time": 1e9, "motion_torque": 1e6}
"""Bounds of a typed phase, by the code of the refusal."""

OF_ONE_TURN = 1e-9
"""Share of a turn within which a motion counts as back at its start."""

TOGETHER = "together"
"""Key of a validation's context: the course is computed and checked later, with those of other motions."""

Place = tuple[str | int, ...]


class _Motion(Model):
    """Base of both motions: the bounds of their moves, and the course and load phases that result."""

    mechanism: Mechanism
    moves: tuple[Move, ...]

    @model_validator(mode="after")
    def _is_within_bounds(self, info: ValidationInfo) -> Self:
        self._require_turns()
        if not (info.context or {}).get(TOGETHER):
            self._require_course()
        return self

    def _require_turns(self) -> None:
        """Refuse moves without any motion, with too large an angle, or too fast."""
        moves = self.moves
        if not any(move.way for move in moves):
            raise refused(self, (("moves",), refusal("no_move")))
        load = self.mechanism.load
        turned = math.fsum(abs(move.way) for move in moves)
        if load.gravity_Nm and turned > MOST_DEGREES:
            self._refuse("motion_turns", turned, MOST_DEGREES, "deg")
        self._require("motion_speed", "rpm", [load.ratio * m.peak_speed / load.way_per_rad / RPM for m in moves])

    def _require_course(self) -> None:
        """Refuse a course beyond the bounds of typed phases."""
        course = self.course
        if len(course.move) > MAXIMUM_PHASES:
            self._refuse("motion_phases", len(course.move), MAXIMUM_PHASES, "")
        self._require("motion_time", "s", course.duration_s, course.move)
        self._require("motion_torque", "Nm", course.peak_torque_Nm, course.move)

    def _require(
        self, code: str, unit: str, values: Sequence[float] | FloatArray, move: PlaceArray | None = None
    ) -> None:
        """Refuse the move with the largest value if it is beyond the bound of a typed phase."""
        place = int(np.argmax(values))
        if not values[place] <= BOUNDS[code]:
            self._refuse(code, float(values[place]), BOUNDS[code], unit, place if move is None else int(move[place]))

    def _refuse(self, code: str, value: float, bound: float, unit: str, *move: int) -> NoReturn:
        values = {"found": str(Quantity(value, unit, 9, "up")), "bound": str(Quantity(bound, unit, 9))}
        raise refused(self, (("moves", *move), refusal(code, **values)))

    def changed(self, changes: Sequence[Mapping[Place, float]]) -> list[Self]:
        """Copies of the motion, each with other numbers at some places; raises ValidationError if one is invalid.

        Their courses are computed together.
        """
        others = [self.model_validate(_with(self, numbers), context={TOGETHER: True}) for numbers in changes]
        courses = courses_along([(pieces_of(*one.driven), one.mechanism.load) for one in others])
        for one, course in zip(others, courses, strict=True):
            one.__dict__["course"] = course
            one._require_course()
        return others

    @property
    def driven(self) -> tuple[tuple[Move, ...], float, ShaftLoad]:
        """Moves, angle at the start, and load on the mechanism's shaft."""
        return self.moves, getattr(self, "start_deg", 0.0), self.mechanism.load

    @cached_property
    def course(self) -> Course:
        """Torque and speed of the moves over time, at the gear's output."""
        return course_of(*self.driven)

    @cached_property
    def stopped_load(self) -> StoppedLoad:
        """Torques of the load in an emergency stop at any instant of the moves."""
        return stopped_load(self.moves, self.course)

    @cached_property
    def phases(self) -> tuple[Phase, ...]:
        """Load phases of the motion."""
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
        """Type of a mechanism whose pinion or pulley may sit on the gear's shaft; None for any other."""
        kind: str = getattr(self.mechanism, "type", "")
        return kind if kind in ("rack_and_pinion", "belt") and self.mechanism.ratio == 1 else None

    @property
    def triangles(self) -> tuple[int, ...]:
        """Places of the moves that became triangles without being requested as such."""
        ramped = ("trapezoidal", "s_curve")
        return tuple(k for k, move in enumerate(self.moves) if move.profile in ramped and move.timing.is_cut)

    @property
    def is_left_off(self) -> bool:
        """True for a motion that ends where gravity acts differently than at its start."""
        if not self.mechanism.load.gravity_Nm:
            return False
        turns = math.fsum(move.way for move in self.moves) / 360
        return abs(turns - round(turns)) > OF_ONE_TURN


def _with(part: Any, numbers: Mapping[Place, float]) -> Any:
    """A part of a motion with other numbers; its unchanged parts stay valid models."""
    if () in numbers:
        return numbers[()]
    below: dict[str | int, dict[Place, float]] = {}
    for (step, *place), number in numbers.items():
        below.setdefault(step, {})[tuple(place)] = number
    if isinstance(part, tuple):
        return [_with(one, below[k]) if k in below else one for k, one in enumerate(part)]
    content = {name: getattr(part, name) for name in part.model_fields_set}
    return content | {str(step): _with(getattr(part, str(step)), own) for step, own in below.items()}


def _kind(value: dict[str, Any], *above: str) -> Any:
    """Type of a mechanism; raises ValidationError without a known one."""
    kind = value.get("type")
    if kind in TYPES:
        return kind
    listed = ", ".join(f"'{name}'" for name in TYPES[:-1]) + f" or '{TYPES[-1]}'"
    error = InitErrorDetails(type="literal_error", loc=(*above, "type"), input=kind, ctx={"expected": listed})
    if "type" not in value:
        error = InitErrorDetails(type="missing", loc=(*above, "type"), input=value)
    raise ValidationError.from_exception_data("Mechanism", [error])


def _as_linear(value: Any) -> Any:
    """A rack, belt or screw, by its type."""
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
    """A motion, validated by the type of its mechanism, so that an error has its place in the request."""
    if value is None or isinstance(value, RotaryMotion | LinearMotion):
        return value
    if not isinstance(value, dict):
        raise PydanticKnownError("model_type", {"class_name": "Motion"})
    mechanism = value.get("mechanism")
    linear = isinstance(mechanism, dict) and _kind(mechanism, "mechanism") in CLASSES
    return (LinearMotion if linear else RotaryMotion).model_validate(value)


Motion = Annotated[RotaryMotion | LinearMotion, BeforeValidator(_of_mechanism)]
