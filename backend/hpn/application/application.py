"""Input models of an application: the one set behind form, link, REST, batch, command line and file.

Torque, speed and load may be signed; the equations take their magnitudes.
"""

from collections.abc import Iterator, Mapping
from types import UnionType
from typing import Annotated, Any, Literal, Self, Union, get_args, get_origin

from pydantic import (
    BaseModel,
    BeforeValidator,
    Field,
    ValidationInfo,
    WrapValidator,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from hpn.application.motion import Motion
from hpn.application.phase import Phase
from hpn.words.designations import canonical_size
from hpn.words.fields import (
    MAXIMUM_PHASES,
    WHOLE,
    Hours,
    Load,
    Model,
    MovingSpeed,
    Number,
    Positive,
    Ratio,
    Seconds,
    Share,
    Torque,
    at_most,
    in_parts,
    one_of,
    refused,
)
from hpn.words.wording import Sentence

BearingModel = Literal["linear", "iso281", "digitised"]
LifeBasis = Literal["L50", "L10"]
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
"""Product of speed and duration up to which a phase rests: the sums of eq. 17.2 and 17.4 would vanish."""


MOST_WISHES = 100
"""Ratios or sizes that may be asked for."""

WISHES: Any = Field(min_length=1, max_length=MOST_WISHES)
"""Bounds of the list itself: beside the field they would be taken for those of a text, since it may be null."""

Size = Annotated[str, Field(max_length=20), BeforeValidator(canonical_size)]


PHASES: Any = Field(min_length=1, max_length=MAXIMUM_PHASES)


class DutyCycle(Model):
    """Load phases or the motion that they come from, exactly one of both, and the pause t_p that follows them."""

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
        """Its phases, as they are typed or as they come out of the motion."""
        return self.motion.phases if self.motion is not None else self.phases or ()


class Brake(Model):
    """Brake at the motor that stops the axis from uniform running."""

    torque_Nm: Positive = Field(description="Largest torque T_B of the brake, at the motor.", examples=[8.0])
    rise_time_s: Seconds = Field(0.0, description="Time t_b in which the brake’s torque rises.", examples=[0.005])
    reaction_time_s: Seconds = Field(
        0.0, description="Time t_r from the command until the brake’s torque begins to rise.", examples=[0.02]
    )
    speed_rpm: MovingSpeed | None = Field(
        None, description="Output speed n_b at the command; without it the largest of the cycle.", examples=[250.0]
    )
    dynamic_factor: Annotated[Number, Field(ge=1, le=10)] | None = Field(
        None,
        description="Peak over steady torque of the stop; without it 2, or less where the rise time and the inertias "
        "say so.",
        examples=[2.0],
    )


class EmergencyStop(Model):
    """Momentary peak torque T_k, or the brake that causes it, and how often it is expected over the life."""

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
            problem = PydanticCustomError("no_stop", "is required, or a brake in its place")
            raise refused(self, (("torque_Nm",), problem))
        if self.torque_Nm is not None and self.brake is not None:
            problem = PydanticCustomError("stop_twice", "give either the torque of the stop or the brake, not both")
            raise refused(self, (("brake",), problem))
        return self


BEARING_LIFE_H = 20_000.0
"""Life for which an output bearing is judged where none is asked of it, as L50."""


class OutputLoad(Model):
    """Load on the output shaft: where no position is given, at the centre of the shaft and along its axis."""

    radial_N: Load | None = Field(None, description="Radial load of the whole cycle.", examples=[500.0])
    axial_N: Load | None = Field(None, description="Axial load of the whole cycle.", examples=[200.0])
    load_coefficient: Annotated[Number, Field(ge=1, le=3)] = Field(
        1.0, description="Load coefficient f_w multiplies the load; printed curves: 1, 1.2, 1.5.", examples=[1.2]
    )
    life_h: Hours = Field(BEARING_LIFE_H, description="Required life of the output bearing.", examples=[20000.0])
    life_basis: LifeBasis = Field("L50", description="L50: 50 % of the bearings survive it. L10: 90 % do.")
    model: BearingModel = Field("linear", description="How the envelope runs between the two published limits.")
    radial_position_mm: Annotated[Number, Field(ge=-1e6, le=1e6)] | None = Field(
        None,
        description="Where the radial load acts, x from the shaft’s shoulder, outwards positive; without it at the "
        "shaft’s centre.",
        examples=[45.0],
    )
    axial_radius_mm: Annotated[Number, Field(ge=0, le=1e6)] = Field(
        0.0, description="Distance y of the axial load from the shaft’s axis.", examples=[40.0]
    )
    shaft_centre_mm: Positive | None = Field(
        None,
        description="Distance x_c from the shoulder to the shaft’s centre, at least; for sizes of which the catalogue "
        "has none.",
        examples=[21.0],
    )


LISTED_FIGURES = ("maximum_speed_rpm", "peak_torque_Nm", "rated_torque_Nm", "rated_speed_rpm", "inertia_kgm2")
"""Figures of a motor that motors.csv lists."""


class Motor(Model):
    """Ratings and inertia of the motor, at its shaft."""

    maximum_speed_rpm: Positive | None = Field(None, description="Maximum motor speed.", examples=[4000.0])
    peak_torque_Nm: Positive | None = Field(None, description="Peak motor torque.", examples=[20.0])
    rated_torque_Nm: Positive | None = Field(None, description="Continuous motor torque.", examples=[8.0])
    rated_speed_rpm: Positive | None = Field(
        None, description="Rated motor speed, which the average speed keeps within.", examples=[3000.0]
    )
    inertia_kgm2: Positive | None = Field(
        None,
        description="Moment of inertia of the motor’s rotor; with a motion it counts in the torques.",
        examples=[0.00015],
    )
    inertia_ratio: Positive | None = Field(
        None, description="Largest permitted load inertia over i² times the motor’s.", examples=[5.0]
    )
    designation: Annotated[str, Field(min_length=1, max_length=100)] | None = Field(
        None, description="A motor of your motors.csv, in place of its figures.", examples=["M 40"]
    )

    @field_validator("designation")
    @classmethod
    def _stands_alone(cls, designation: str | None, info: ValidationInfo) -> str | None:
        if designation is not None and any(info.data.get(name) is not None for name in LISTED_FIGURES):
            raise PydanticCustomError(
                "motor_twice", "stands for the figures of a motor in motors.csv: give either it or the figures"
            )
        return designation


class Requirements(Model):
    """`ratios` and `sizes` restrict the list of candidates; every other requirement becomes a check."""

    ratios: Annotated[tuple[Ratio, ...], WISHES, at_most(MOST_WISHES)] | None = Field(
        None, description="Only these ratios.", examples=[[5]]
    )
    sizes: Annotated[tuple[Size, ...], WISHES, at_most(MOST_WISHES)] | None = Field(
        None, description="Only these sizes.", examples=[["14A", "20A"]]
    )
    life_h: Hours | None = Field(None, description="Required gear life L10 (eq. 17.10).", examples=[20000.0])
    backlash_arcmin: Positive | None = Field(None, description="Maximum backlash.", examples=[7.0])
    torsional_stiffness_Nm_per_rad: Positive | None = Field(
        None, description="Minimum torsional stiffness K_3.", examples=[5000.0]
    )
    weight_kg: Positive | None = Field(None, description="Maximum weight.", examples=[5.0])
    length_mm: Positive | None = Field(None, description="Maximum length L.", examples=[200.0])
    ambient_temperature_degC: Annotated[Number, Field(ge=-273.15, le=1000)] | None = Field(
        None, description="Ambient temperature of the gear.", examples=[25.0]
    )
    utilisation: Share = Field(
        1.0, description="Maximum utilisation u of the load checks: your own reserve.", examples=[1.0]
    )
    efficiency: Share | None = Field(
        None, description="Your assumption for the gear’s efficiency; without it the motor side is loss-free."
    )
    motor: Motor | None = Field(None, description="Limits of the motor.")
    load_inertia_kgm2: Positive | None = Field(
        None, description="Moment of inertia of the load at the gear’s output; a motion has its own.", examples=[0.8]
    )
    natural_frequency_Hz: Positive | None = Field(
        None, description="Minimum natural frequency of the load on the gear, the motor held.", examples=[25.0]
    )
    position_error_arcmin: Positive | None = Field(
        None, description="Maximum position error of the output as an angle.", examples=[20.0]
    )
    position_error_mm: Positive | None = Field(
        None, description="Maximum position error as a length at the radius.", examples=[0.5]
    )
    position_radius_mm: Positive | None = Field(
        None, description="Radius at which the position error is shown as a length.", examples=[250.0]
    )
    load_reverses: Annotated[bool, Field(strict=True)] | None = Field(
        None,
        description="True: the torque acts both ways. False: the signs of the torques hold as given. Without it, both "
        "ways where no torque is negative and there is no motion.",
        examples=[False],
    )

    @model_validator(mode="after")
    def _asks_for_one_error(self) -> Self:
        if self.position_error_mm is not None and self.position_error_arcmin is not None:
            problem = PydanticCustomError("error_twice", "give the position error as an angle or as a length, not both")
            raise refused(self, (("position_error_mm",), problem))
        if self.position_error_mm is not None and self.position_radius_mm is None:
            problem = PydanticCustomError("error_radius", "needs the radius, position_radius_mm")
            raise refused(self, (("position_error_mm",), problem))
        return self


class Application(Model):
    """One axis: its duty cycle, its loads, and what is required of the gear."""

    duty_cycle: DutyCycle = Field(description="Load phases and pause of the axis.")
    emergency_stop: EmergencyStop | None = Field(None, description="Emergency stop, where there is one.")
    output_load: OutputLoad | None = Field(None, description="Load on the output shaft and what its bearing must last.")
    requirements: Requirements = Field(default_factory=Requirements, description="Requirements on the gear.")
    application_area: ApplicationArea | None = Field(
        None, description="An area of use that needs the maker’s risk assessment and approval (handbook 2.4)."
    )
    rank_by: RankBy = Field("weight", description="Order of the suitable gears.")

    @field_validator("output_load")
    @classmethod
    def _loaded(cls, load: OutputLoad | None, info: Any) -> OutputLoad | None:
        cycle = info.data.get("duty_cycle")
        if load is None or cycle is None or load.radial_N is not None or load.axial_N is not None:
            return load
        if any(phase.radial_N is not None or phase.axial_N is not None for phase in cycle.load_phases):
            return load
        raise PydanticCustomError(
            "no_load", "no load is given: state radial_N or axial_N here or in a phase, or leave output_load out"
        )

    @field_validator("requirements")
    @classmethod
    def _knows_its_inertias(cls, asked: Requirements, info: ValidationInfo) -> Requirements:
        motion = info.data["duty_cycle"].motion if "duty_cycle" in info.data else None
        motor, given = asked.motor or Motor(), asked.load_inertia_kgm2 is not None
        if motion is not None and given:
            problem = PydanticCustomError("inertia_twice", "the motion has its own inertia of the load: leave it out")
            raise refused(asked, (("load_inertia_kgm2",), problem))
        if "duty_cycle" not in info.data:
            return asked
        ratio = ("motor", "inertia_ratio")
        if motor.inertia_ratio is not None and motor.inertia_kgm2 is None and motor.designation is None:
            raise refused(asked, (ratio, PydanticCustomError("inertia_of_motor", "needs the motor’s inertia_kgm2")))
        needing = {ratio: motor.inertia_ratio, ("natural_frequency_Hz",): asked.natural_frequency_Hz}
        places = [place for place, value in needing.items() if value is not None]
        if places and motion is None and not given:
            problem = PydanticCustomError("inertia_of_load", "needs a motion, or requirements.load_inertia_kgm2")
            raise refused(asked, *((place, problem) for place in places))
        return asked

    @field_validator("rank_by")
    @classmethod
    def _has_what_it_ranks_by(cls, rank_by: RankBy, info: ValidationInfo) -> RankBy:
        cycle, asked = info.data.get("duty_cycle"), info.data.get("requirements")
        known = cycle is None or asked is None or cycle.motion is not None or asked.load_inertia_kgm2 is not None
        if rank_by == "natural_frequency" and not known:
            raise PydanticCustomError("inertia_of_load", "needs a motion, or requirements.load_inertia_kgm2")
        return rank_by

    @property
    def loads(self) -> OutputLoad | None:
        """Conditions of the output load, or None where neither the cycle nor a phase carries a load."""
        if self.output_load is None:
            for phase in self.duty_cycle.load_phases:
                if phase.radial_N is not None or phase.axial_N is not None:
                    return OutputLoad()
        return self.output_load

    @classmethod
    def worked_example(cls) -> Self:
        """The handbook's worked example (chapter 4.1, equations 18.1 to 18.9)."""
        return cls.model_validate(WORKED_EXAMPLE)


def _number_paths(model: type[BaseModel], path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for name, field in model.model_fields.items():
        if field.annotation is not None and name != "motion":
            yield from _paths_below(field.annotation, (*path, name))


def _paths_below(annotation: Any, path: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    if get_origin(annotation) in (Annotated, Union, UnionType):
        for part in get_args(annotation):
            yield from _paths_below(part, path)
    elif annotation in (float, int):
        yield path
    elif isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield from _number_paths(annotation, path)


NUMBERS = tuple(_number_paths(Application))
"""Path of every single number of an application but its motion: ("requirements", "motor", "peak_torque_Nm")."""


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
"""Inputs as printed on the handbook's page 18."""


Location = tuple[str | int, ...]


class InputError(ValueError):
    """Input that is well formed but can't be answered; `problems` are (location, detail) pairs, in English."""

    def __init__(self, *sentences: tuple[Location, Sentence]) -> None:
        self.sentences = sentences
        self.problems = tuple((location, sentence.text) for location, sentence in sentences)
        super().__init__("; ".join(detail for _, detail in self.problems))

    def below(self, name: str) -> "InputError":
        """The same of an application that is a field of something else."""
        return InputError(*(((name, *location), sentence) for location, sentence in self.sentences))
