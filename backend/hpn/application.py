"""What the user asks: the one set of input models behind form, link, REST, batch, command line and file.

Every field name ends in its unit. Torque, speed and load may be signed; the equations take their magnitudes.
The bounds keep every power in chapter 4 far inside the range of a floating-point number.
"""

from collections.abc import Callable, Iterator, Mapping
from types import UnionType
from typing import Annotated, Any, Literal, Self, Union, get_args, get_origin

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, WrapValidator, field_validator
from pydantic_core import PydanticCustomError, PydanticKnownError

from hpn.gear import canonical_size
from hpn.units import suffix_of, symbol_of
from hpn.wording import Sentence

MAXIMUM_PHASES = 10_000

BearingModel = Literal["linear", "iso281", "digitised"]
LifeBasis = Literal["L50", "L10"]
RankBy = Literal["weight", "utilisation", "length", "motor_torque", "life", "stiffness"]
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


LEAST = 1e-12
"""Smallest number that stands below a fraction: a quotient by a smaller one could overflow."""


LEAST_MOTION = 1e-100
"""Product of speed and duration up to which a phase rests: the sums of eq. 17.2 and 17.4 would vanish."""


def _above_zero(value: float) -> float:
    """Refuse what is not above 0, and what is but so small that a quotient by it could overflow."""
    if value <= 0:
        raise PydanticKnownError("greater_than", {"gt": 0})
    if value < LEAST:
        raise PydanticCustomError("vanishing", "must be at least 1e-12")
    return value


def _at_most(most: int) -> BeforeValidator:
    """Refuse a longer list before its items are looked at: each wrong one would leave its errors behind."""

    def check(value: object) -> object:
        if isinstance(value, list | tuple) and len(value) > most:
            counts = {"field_type": "Tuple", "max_length": most, "actual_length": len(value)}
            raise PydanticKnownError("too_long", counts)
        return value

    return BeforeValidator(check)


PART = 500


def _in_parts(value: Any, validate: Callable[[Any], tuple[Any, ...]]) -> tuple[Any, ...]:
    """Validate a long list part by part: other threads get their turn in between, and only one part has errors.

    What is validated stays in front, so that an error is told at its place in the whole.
    """
    if not isinstance(value, list | tuple) or len(value) <= PART:
        return validate(value)
    done: tuple[Any, ...] = ()
    for start in range(0, len(value), PART):
        done = validate((*done, *value[start : start + PART]))
    return done


MOST_WISHES = 100
"""Ratios or sizes that may be asked for."""

WISHES: Any = Field(min_length=1, max_length=MOST_WISHES)
"""Bounds of the list itself: beside the field they would be taken for those of a text, since it may be null."""

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Torque = Annotated[Number, Field(ge=-1e6, le=1e6)]
Speed = Annotated[Number, Field(ge=-1e6, le=1e6)]
Load = Annotated[Number, Field(ge=-1e9, le=1e9)]
SAYS_LEAST: Any = Field(json_schema_extra={"minimum": LEAST})
Hours = Annotated[Number, Field(le=1e9), AfterValidator(_above_zero), SAYS_LEAST]
Positive = Annotated[Number, Field(le=1e12), AfterValidator(_above_zero), SAYS_LEAST]
Share = Annotated[Number, Field(le=1), AfterValidator(_above_zero), SAYS_LEAST]
Ratio = Annotated[int, Field(strict=True, ge=1, le=10_000)]
Size = Annotated[str, Field(max_length=20), BeforeValidator(canonical_size)]


def name_units(schema: dict[str, Any]) -> None:
    """Put the unit of every field beside it in the JSON Schema, read from the field's own name."""
    for name, entry in schema.get("properties", {}).items():
        if suffix_of(name):
            entry["x-unit"] = symbol_of(name)


class Model(BaseModel):
    """Frozen, and closed: an unknown field is an error, never ignored."""

    model_config = ConfigDict(frozen=True, extra="forbid", json_schema_extra=name_units)


class Phase(Model):
    """One load phase of the duty cycle (handbook, illustration 17.1)."""

    torque_Nm: Torque = Field(description="Output torque T; its magnitude counts.", examples=[40.0])
    speed_rpm: Speed = Field(description="Output speed n; 0 is a holding phase.", examples=[250.0])
    duration_s: Annotated[Number, Field(gt=0, le=1e9)] = Field(description="Duration t of the phase.", examples=[0.3])
    radial_N: Load | None = Field(
        None, description="Radial load on the shaft centre in this phase; without it the cycle’s.", examples=[500.0]
    )
    axial_N: Load | None = Field(
        None, description="Axial load on the shaft axis in this phase; without it the cycle’s.", examples=[200.0]
    )


class DutyCycle(Model):
    """Load phases and the pause t_p that follows them."""

    phases: Annotated[tuple[Phase, ...], WrapValidator(_in_parts), _at_most(MAXIMUM_PHASES)] = Field(
        min_length=1, max_length=MAXIMUM_PHASES, description="Load phases; at least one moves."
    )
    pause_s: Annotated[Number, Field(ge=0, le=1e9)] = Field(
        0.0, description="Pause t_p: counts in the average speed (eq. 17.4), not in the average torque.", examples=[4.0]
    )

    @field_validator("phases")
    @classmethod
    def _moves(cls, phases: tuple[Phase, ...]) -> tuple[Phase, ...]:
        if not any(abs(phase.speed_rpm) * phase.duration_s > LEAST_MOTION for phase in phases):
            raise PydanticCustomError(
                "no_motion",
                "no phase moves, so the cycle has no average torque (eq. 17.2): give at least one phase a speed",
            )
        return phases


class EmergencyStop(Model):
    """Momentary peak torque T_k, and how often it is expected over the life."""

    torque_Nm: Torque = Field(description="Emergency-stop torque T_k.", examples=[200.0])
    count: Annotated[int, Field(strict=True, ge=0, le=10**15)] | None = Field(
        None, description="Expected number of emergency stops over the life.", examples=[1000]
    )


class OutputLoad(Model):
    """Load on the output shaft, at the centre of the shaft and along its axis."""

    radial_N: Load | None = Field(None, description="Radial load of the whole cycle.", examples=[500.0])
    axial_N: Load | None = Field(None, description="Axial load of the whole cycle.", examples=[200.0])
    load_coefficient: Annotated[Number, Field(ge=1, le=3)] = Field(
        1.0, description="Load coefficient f_w multiplies the load; printed curves: 1, 1.2, 1.5.", examples=[1.2]
    )
    life_h: Hours = Field(20_000.0, description="Required life of the output bearing.", examples=[20000.0])
    life_basis: LifeBasis = Field("L50", description="L50: 50 % of the bearings survive it. L10: 90 % do.")
    model: BearingModel = Field("linear", description="How the envelope runs between the two published limits.")


class Motor(Model):
    """What the motor can do, at its shaft."""

    maximum_speed_rpm: Positive | None = Field(None, description="Maximum motor speed.", examples=[4000.0])
    peak_torque_Nm: Positive | None = Field(None, description="Peak motor torque.", examples=[20.0])
    rated_torque_Nm: Positive | None = Field(None, description="Continuous motor torque.", examples=[8.0])


class Requirements(Model):
    """`ratios` and `sizes` restrict the list of candidates; every other requirement becomes a check."""

    ratios: Annotated[tuple[Ratio, ...], WISHES, _at_most(MOST_WISHES)] | None = Field(
        None, description="Only these ratios.", examples=[[5]]
    )
    sizes: Annotated[tuple[Size, ...], WISHES, _at_most(MOST_WISHES)] | None = Field(
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


class Application(Model):
    """One axis: its duty cycle, its loads, and what is required of the gear."""

    duty_cycle: DutyCycle = Field(description="Load phases and pause of the axis.")
    emergency_stop: EmergencyStop | None = Field(None, description="Emergency stop, where there is one.")
    output_load: OutputLoad | None = Field(None, description="Load on the output shaft and what its bearing must last.")
    requirements: Requirements = Field(default_factory=Requirements, description="What is required of the gear.")
    application_area: ApplicationArea | None = Field(
        None, description="An area of use that needs the maker’s risk assessment and approval (handbook 2.4)."
    )
    rank_by: RankBy = Field("weight", description="What the suitable gears are ordered by.")

    @field_validator("output_load")
    @classmethod
    def _loaded(cls, load: OutputLoad | None, info: Any) -> OutputLoad | None:
        cycle = info.data.get("duty_cycle")
        if load is None or cycle is None or load.radial_N is not None or load.axial_N is not None:
            return load
        if any(phase.radial_N is not None or phase.axial_N is not None for phase in cycle.phases):
            return load
        raise PydanticCustomError(
            "no_load", "no load is given: state radial_N or axial_N here or in a phase, or leave output_load out"
        )

    @property
    def loads(self) -> OutputLoad | None:
        """Conditions of the output load, or None where neither the cycle nor a phase carries a load."""
        if self.output_load is None:
            for phase in self.duty_cycle.phases:
                if phase.radial_N is not None or phase.axial_N is not None:
                    return OutputLoad()
        return self.output_load

    @classmethod
    def worked_example(cls) -> Self:
        """The handbook's worked example (chapter 4.1, equations 18.1 to 18.9)."""
        return cls.model_validate(WORKED_EXAMPLE)


def _number_paths(model: type[BaseModel], path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for name, field in model.model_fields.items():
        if field.annotation is not None:
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
"""Path of every single number of an application, such as ("requirements", "motor", "peak_torque_Nm")."""


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
