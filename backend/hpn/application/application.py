"""Input models of an application, the same for form, link, REST, batch, command line and file.

Torque, speed and load may be signed; the equations take their magnitudes.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationInfo, WrapValidator, field_validator, model_validator
from pydantic_core import PydanticCustomError

from hpn.application.motion import Motion
from hpn.application.motor import Motor
from hpn.application.phase import Phase
from hpn.application.requirements import OutputLoad, Requirements
from hpn.application.tolerances import Interval, Tolerances, intervals_of
from hpn.words.fields import (
    MAXIMUM_PHASES,
    WHOLE,
    Model,
    MovingSpeed,
    Number,
    Positive,
    Seconds,
    Torque,
    TorqueMagnitude,
    at_most,
    in_parts,
    one_of,
    refused,
)
from hpn.words.wording import N_

RankBy = Literal[
    "weight", "utilisation", "length", "motor_torque", "life", "stiffness", "natural_frequency", "position_error"
]
ApplicationArea = Literal[
    "aerospace",
    "explosive_area",
    "nuclear",
    "vacuum",
    "household",
    "medical",
    "human_contact",
    "people_transport",
    "amusement",
]


LEAST_MOTION = 1e-100
"""Product of speed and duration up to which a phase is at rest: the sums of eq. 17.2 and 17.4 would vanish."""


SHAFT_OF_MOTION = N_("needs the motion of a rack or belt with ratio 1, whose pinion or pulley sits on the gear’s shaft")
DRIVE_OF_PHASES = N_("is for typed phases: a motion has its own pinion or pulley, see from_motion")

PHASES: Any = Field(min_length=1, max_length=MAXIMUM_PHASES)


class DutyCycle(Model):
    """Either load phases or a motion, exactly one of the two, and the pause t_p after them."""

    phases: Annotated[tuple[Phase, ...], PHASES, WrapValidator(in_parts), at_most(MAXIMUM_PHASES)] | None = Field(
        None, description="Load phases; at least one moves."
    )
    motion: Motion | None = Field(
        None, description="Motion of a mechanism, in place of the phases.", json_schema_extra=one_of
    )
    pause_s: Annotated[Number, Field(ge=0, le=1e9)] = Field(
        0.0, description="Pause t_p: counts in the average speed (eq. 17.4), not in the average torque.", examples=[4.0]
    )

    @field_validator("phases")
    @classmethod
    def _moves(cls, phases: tuple[Phase, ...] | None) -> tuple[Phase, ...] | None:
        if phases is not None and not any(abs(phase.speed_rpm) * phase.duration_s > LEAST_MOTION for phase in phases):
            raise PydanticCustomError(
                "no_motion",
                "no phase moves, so the cycle has no average torque (eq. 17.2): give at least one phase a speed",
            )
        return phases

    @model_validator(mode="after")
    def _one_cycle(self) -> Self:
        if self.phases is None and self.motion is None:
            raise refused(self, (("phases",), PydanticCustomError("no_cycle", "give phases, or a motion")))
        if self.phases is not None and self.motion is not None:
            raise refused(
                self, (("motion",), PydanticCustomError("two_cycles", "give either phases or a motion, not both"))
            )
        return self

    @property
    def load_phases(self) -> tuple[Phase, ...]:
        """Its phases, typed or from the motion."""
        return self.motion.phases if self.motion is not None else self.phases or ()

    @property
    def is_loaded(self) -> bool:
        """True if a phase or a move has its own load."""
        parts = self.phases or () if self.motion is None else self.motion.moves
        return any(part.radial_N is not None or part.axial_N is not None for part in parts)

    @property
    def rests(self) -> bool:
        """True if it has a pause, or a phase at speed 0."""
        return self.pause_s > 0 or any(phase.speed_rpm == 0 for phase in self.load_phases)

    @property
    def rest_friction_Nm(self) -> float:
        """Largest torque in Nm at the gear that dry friction may hold in a motion's rest; 0 for phases, 0
        without rest.
        """
        if self.motion is None:
            return 0.0
        at_rest = [abs(phase.torque_Nm) for phase in self.motion.phases if phase.speed_rpm == 0]
        at_rest += [0.0] if self.pause_s > 0 else []
        return float(self.motion.mechanism.load.rest_friction_Nm(max(at_rest))) if at_rest else 0.0


class Brake(Model):
    """Brake at the motor that stops the axis."""

    torque_Nm: Positive = Field(description="Largest torque T_B of the brake, at the motor.", examples=[8.0])
    rise_time_s: Seconds = Field(0.0, description="Time t_b in which the brake’s torque rises.", examples=[0.005])
    reaction_time_s: Seconds = Field(
        0.0, description="Time t_r from the stop command until the brake’s torque begins to rise.", examples=[0.02]
    )
    speed_rpm: MovingSpeed | None = Field(
        None, description="Output speed n_b at the stop command; by default the largest of the cycle.", examples=[250.0]
    )
    load_torque_Nm: TorqueMagnitude | None = Field(
        None,
        description="Largest torque T_L of weight and process force at the gear, by magnitude; a motion has its own. "
        "Without it, no force is assumed to pull the load.",
        examples=[12.0],
    )
    opposing_torque_Nm: TorqueMagnitude | None = Field(
        None,
        description="Largest torque T_o: T_L with friction and the acceleration’s J α; at least T_L and by default "
        "T_L. A motion has its own.",
        examples=[15.0],
    )
    dynamic_factor: Annotated[Number, Field(ge=1, le=10)] | None = Field(
        None,
        description="Your own dynamic factor f: T_k = f T_r + (f − 1) T_o; by default the bound that follows from "
        "backlash and both flanks.",
        examples=[2.0],
    )

    @model_validator(mode="after")
    def _opposes_with_the_load(self) -> Self:
        if self.opposing_torque_Nm is not None and self.opposing_torque_Nm < (self.load_torque_Nm or 0.0):
            problem = PydanticCustomError("opposing_below_load", "must be at least load_torque_Nm, which is part of it")
            raise refused(self, (("opposing_torque_Nm",), problem))
        return self


STOP_LOADS = ("load_torque_Nm", "opposing_torque_Nm")
"""Torques of the load in a stop by the brake, which typed phases lack and a motion provides."""


class EmergencyStop(Model):
    """Emergency-stop torque T_k, or the brake that causes it, and the expected number of stops over the life."""

    torque_Nm: Torque | None = Field(None, description="Emergency-stop torque T_k.", examples=[200.0])
    brake: Brake | None = Field(
        None, description="Brake at the motor, in place of the torque.", examples=[{"torque_Nm": 8.0}]
    )
    count: Annotated[int, Field(strict=True, ge=0, le=10**15), WHOLE] | None = Field(
        None, description="Expected number of emergency stops over the life.", examples=[1000]
    )

    @model_validator(mode="after")
    def _one_cause(self) -> Self:
        if self.torque_Nm is None and self.brake is None:
            problem = PydanticCustomError("no_stop", "is required, unless a brake is given")
            raise refused(self, (("torque_Nm",), problem))
        if self.torque_Nm is not None and self.brake is not None:
            problem = PydanticCustomError("stop_twice", "give either the torque of the stop or the brake, not both")
            raise refused(self, (("brake",), problem))
        return self


class Application(Model):
    """One axis: its duty cycle, its loads, and the requirements on the gear."""

    duty_cycle: DutyCycle = Field(description="Load phases and pause of the axis.")
    emergency_stop: EmergencyStop | None = Field(None, description="Emergency stop, if any.")
    output_load: OutputLoad | None = Field(
        None, description="Load on the output shaft and the required life of its bearing."
    )
    requirements: Requirements = Field(default_factory=Requirements, description="Requirements on the gear.")
    application_area: ApplicationArea | None = Field(
        None, description="An area of use that needs a risk assessment and the manufacturer’s approval (handbook 2.4)."
    )
    rank_by: RankBy = Field("weight", description="Order of the suitable gears.")
    tolerances: Tolerances | None = Field(
        None,
        description="Tolerances of inputs by their paths: torque_Nm for every phase, phases.1.torque_Nm for one "
        "(counted from 0), pause_s, emergency_stop.torque_Nm, motion.mechanism.mass_kg.",
        examples=[{"torque_Nm": {"percent": 10.0}}],
    )

    def requiring(self, **changes: Any) -> "Application":
        """The application with other values of its requirements, which are not validated again."""
        return self.model_copy(update={"requirements": self.requirements.model_copy(update=changes)})

    @field_validator("tolerances")
    @classmethod
    def _some(cls, tolerances: Tolerances | None) -> Tolerances | None:
        return tolerances or None

    @model_validator(mode="after")
    def _bears_its_tolerances(self) -> Self:
        if self.tolerances:
            intervals_of(self, self.tolerances)
        return self

    @property
    def intervals(self) -> tuple[Interval, ...]:
        """Inputs with a tolerance, and their ends."""
        return intervals_of(self, self.tolerances) if self.tolerances else ()

    @field_validator("emergency_stop")
    @classmethod
    def _takes_loads_of_the_motion(cls, stop: EmergencyStop | None, info: ValidationInfo) -> EmergencyStop | None:
        cycle = info.data.get("duty_cycle")
        if stop is None or stop.brake is None or cycle is None or cycle.motion is None:
            return stop
        typed = [name for name in STOP_LOADS if getattr(stop.brake, name) is not None]
        if typed:
            problem = PydanticCustomError("load_twice", "the load’s torque follows from the motion: leave it out")
            raise refused(stop, *((("brake", name), problem) for name in typed))
        return stop

    @field_validator("output_load")
    @classmethod
    def _loaded(cls, load: OutputLoad | None, info: Any) -> OutputLoad | None:
        cycle = info.data.get("duty_cycle")
        if load is None or cycle is None:
            return load
        motion = cycle.motion
        if load.from_motion and (motion is None or motion.wheel is None):
            raise refused(load, (("from_motion",), PydanticCustomError("shaft_of_motion", SHAFT_OF_MOTION)))
        if load.drive is not None and motion is not None:
            raise refused(load, (("drive",), PydanticCustomError("drive_twice", DRIVE_OF_PHASES)))
        if load.from_motion or load.drive is not None or load.radial_N is not None or load.axial_N is not None:
            return load
        if cycle.is_loaded:
            return load
        raise PydanticCustomError(
            "no_load", "no load is given: state radial_N or axial_N here or in a phase, or leave output_load out"
        )

    @field_validator("requirements")
    @classmethod
    def _knows_its_inertias(cls, requirements: Requirements, info: ValidationInfo) -> Requirements:
        motion = info.data["duty_cycle"].motion if "duty_cycle" in info.data else None
        motor, has_inertia = requirements.motor or Motor(), requirements.load_inertia_kgm2 is not None
        if motion is not None and has_inertia:
            problem = PydanticCustomError("inertia_twice", "the load’s inertia follows from the motion: leave it out")
            raise refused(requirements, (("load_inertia_kgm2",), problem))
        if "duty_cycle" not in info.data:
            return requirements
        ratio = ("motor", "inertia_ratio")
        of_list = motor.designation is not None or "motors" in (info.context or {})
        if motor.inertia_ratio is not None and motor.inertia_kgm2 is None and not of_list:
            raise refused(
                requirements, (ratio, PydanticCustomError("inertia_of_motor", "needs the motor’s inertia_kgm2"))
            )
        needing = {ratio: motor.inertia_ratio, ("natural_frequency_Hz",): requirements.natural_frequency_Hz}
        places = [place for place, value in needing.items() if value is not None]
        if places and motion is None and not has_inertia:
            problem = PydanticCustomError("inertia_of_load", "needs a motion, or requirements.load_inertia_kgm2")
            raise refused(requirements, *((place, problem) for place in places))
        return requirements

    @field_validator("requirements")
    @classmethod
    def _knows_its_rest(cls, requirements: Requirements, info: ValidationInfo) -> Requirements:
        if "duty_cycle" not in info.data:
            return requirements
        cycle: DutyCycle = info.data["duty_cycle"]
        if cycle.motion is not None and requirements.rest_friction_Nm:
            problem = PydanticCustomError("friction_twice", "friction at rest follows from the motion: leave it out")
            raise refused(requirements, (("rest_friction_Nm",), problem))
        if requirements.position_error_at == "rest" and not cycle.rests:
            problem = PydanticCustomError("no_rest", "needs a phase with speed 0, a dwell or a pause")
            raise refused(requirements, (("position_error_at",), problem))
        return requirements

    @field_validator("rank_by")
    @classmethod
    def _has_what_it_ranks_by(cls, rank_by: RankBy, info: ValidationInfo) -> RankBy:
        cycle, requirements = info.data.get("duty_cycle"), info.data.get("requirements")
        known = (
            cycle is None
            or requirements is None
            or cycle.motion is not None
            or requirements.load_inertia_kgm2 is not None
        )
        if rank_by == "natural_frequency" and not known:
            raise PydanticCustomError("inertia_of_load", "needs a motion, or requirements.load_inertia_kgm2")
        return rank_by

    @property
    def loads(self) -> OutputLoad | None:
        """Conditions of the output load, or None if neither the cycle nor a phase has a load."""
        if self.output_load is None and self.duty_cycle.is_loaded:
            return OutputLoad()
        return self.output_load

    @property
    def shaft_drive(self) -> str:
        """Pinion (`rack_and_pinion`) or pulley (`belt`) on the gear's shaft with a load that counts; blank
        without one.
        """
        load, motion = self.output_load, self.duty_cycle.motion
        if load is None or (load.drive is None and not load.from_motion):
            return ""
        return load.drive.type if load.drive else (motion and motion.wheel) or ""

    @classmethod
    def worked_example(cls) -> Self:
        """The handbook's worked example (chapter 4.1, equations 18.1 to 18.9)."""
        return cls.model_validate(WORKED_EXAMPLE)


class BatchItem(Application):
    """An application of a batch, with the caller's own name for it."""

    reference: Annotated[str, Field(max_length=200)] | None = Field(
        None, description="Your name for this axis; it comes back with the result.", examples=["axis-7"]
    )


WORKED_EXAMPLE: Mapping[str, Any] = {
    "duty_cycle": {
        "phases": [
            {"torque_Nm": 40.0, "speed_rpm": 250.0, "duration_s": 0.3},
            {"torque_Nm": 32.0, "speed_rpm": 500.0, "duration_s": 3.0},
            {"torque_Nm": 20.0, "speed_rpm": 250.0, "duration_s": 0.4},
        ],
        "pause_s": 4.0,
    },
    "emergency_stop": {"torque_Nm": 200.0},
    "requirements": {"ratios": [5]},
}
"""Inputs of the example on the handbook's page 18."""
