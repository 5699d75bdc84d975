"""Duty cycle from the sections of a motion pattern: a phase for each stretch of constant acceleration and load."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hpn.files.aas.courses import LINEAR, ROTATIVE, MotionSection
from hpn.physics.equations import FloatArray
from hpn.physics.motion.mechanisms import RPM, BallScrew, ShaftLoad
from hpn.tables.sheets import RefusedError
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.wording import N_

BoolArray = NDArray[np.bool_]

LACKS = N_("the sizing lacks {field}, without which the torque is not known")
NO_SPEED = N_("a course has neither speed nor position over time")
TOO_MANY = N_("the courses come to more than {most} phases")
ALIKE = 1e-9
"""Relative difference below which two accelerations or two loads count as equal."""


def cycle_of(sections: Sequence[MotionSection], mechanism: Mapping[str, float]) -> dict[str, Any]:
    """Phases at the gear's output, and the pause: the phases at rest without load at the end. Raises RefusedError."""
    phases = [phase for section in sections for phase in _phases(section, mechanism)]
    if len(phases) > MAXIMUM_PHASES:
        raise RefusedError(TOO_MANY, most=MAXIMUM_PHASES)
    pause = 0.0
    while len(phases) > 1 and not phases[-1]["speed_rpm"] and not phases[-1]["torque_Nm"]:
        pause += phases.pop()["duration_s"]
    return {"phases": phases, "pause_s": pause}


def _phases(section: MotionSection, mechanism: Mapping[str, float]) -> Iterator[dict[str, float]]:
    columns = dict(zip(section.columns, section.rows.T, strict=True))
    time = columns["Time"]
    if (np.diff(time) < 0).any():
        raise RefusedError(NO_SPEED)
    is_linear = section.kind == "LinearSection"
    load = _linear_load(section, mechanism) if is_linear else _rotary_load(section, mechanism)
    way = load.way_per_rad / 1000 if is_linear else 1.0
    speed = _speed(columns, time, LINEAR if is_linear else ROTATIVE) / way
    lasting = np.diff(time)
    moving = lasting > 0
    acceleration = np.divide(np.diff(speed), lasting, out=np.zeros_like(lasting), where=moving)
    name, of_friction = ("LoadSideForce", "FrictionForce") if is_linear else ("LoadTorque", "FrictionTorque")
    outside = _value(section, columns, name)[:-1] * load.external_Nm
    friction = _value(section, columns, of_friction)[:-1] * load.external_Nm
    varying = friction if of_friction in columns else np.full(len(lasting), load.friction_Nm)
    loads = {"radial_N": "RadialForce", "axial_N": "AxialForce"}
    acting = {
        field: np.abs(_value(section, columns, name)[:-1])
        for field, name in loads.items()
        if name in columns or name in section.constants
    }
    for start, end in _stretches(moving, speed, acceleration, outside, varying, *acting.values()):
        yield from _phase(slice(start, end), lasting, speed, acceleration, outside, varying, load, acting)


def _value(section: MotionSection, columns: Mapping[str, FloatArray], name: str) -> FloatArray:
    """Quantity over time: its column, else its constant of the section, else 0."""
    return columns[name] if name in columns else np.full(len(section.rows), section.constants.get(name, 0.0))


def _speed(columns: Mapping[str, FloatArray], time: FloatArray, names: Sequence[str]) -> FloatArray:
    if names[2] in columns:
        return columns[names[2]]
    if names[1] not in columns or len(time) < 3 or (np.diff(time) <= 0).any():
        raise RefusedError(NO_SPEED)
    slopes: FloatArray = np.gradient(columns[names[1]], time)
    return slopes


def _stretches(moving: BoolArray, speed: FloatArray, *steady: FloatArray) -> list[tuple[int, int]]:
    """First interval and end of stretches in which these values are constant, without a jump or a change of
    direction."""
    broken = ~(moving[1:] & moving[:-1]) | (speed[:-2] * speed[2:] < 0)
    for values in steady:
        broken |= np.abs(np.diff(values)) > ALIKE * np.abs(values).max(initial=0.0)
    edges = [0, *(np.flatnonzero(broken) + 1).tolist(), len(moving)]
    return [(start, end) for start, end in pairwise(edges) if moving[start]]


def _phase(
    part: slice,
    lasting: FloatArray,
    speed: FloatArray,
    acceleration: FloatArray,
    outside: FloatArray,
    friction: FloatArray,
    load: ShaftLoad,
    acting: Mapping[str, FloatArray],
) -> Iterator[dict[str, float]]:
    """Stretch as a phase, or as two where its direction changes within."""
    duration, first, last = float(lasting[part].sum()), float(speed[part.start]), float(speed[part.stop])
    legs = [(duration, first, last)]
    if first * last < 0:
        share = first / (first - last)
        legs = [(duration * share, first, 0.0), (duration * (1 - share), 0.0, last)]
    for length, begin, end in legs:
        mean, peak = (begin + end) / 2, max(abs(begin), abs(end))
        sense = math.copysign(1.0, mean) if mean else 0.0
        demand = load.inertia_kgm2 * float(acceleration[part.start]) + float(friction[part.start]) * sense
        demand += load.constant_Nm - float(outside[part.start])
        driven = demand * mean >= 0
        torque = demand / load.efficiency if driven else demand * load.efficiency
        phase = {"torque_Nm": torque if mean else demand, "speed_rpm": mean / RPM, "duration_s": length}
        if peak > abs(mean) * (1 + ALIKE):
            phase["peak_speed_rpm"] = peak / RPM
        yield phase | {name: float(values[part.start]) for name, values in acting.items()}


def _rotary_load(section: MotionSection, mechanism: Mapping[str, float]) -> ShaftLoad:
    return ShaftLoad(
        inertia_kgm2=section.constants.get("MomentOfInertiaOfLoad", 0.0) + mechanism.get("InertiaMotorSide", 0.0),
        friction_Nm=section.constants.get("FrictionTorque", 0.0) + mechanism.get("NoLoadTorque", 0.0),
        viscous_Nms=0.0,
        gravity_Nm=0.0,
        constant_Nm=0.0,
        way_per_rad=1.0,
        external_Nm=1.0,
        efficiency=_efficiency(mechanism),
        ratio=1.0,
    )


def _efficiency(mechanism: Mapping[str, float]) -> float:
    """Efficiency as a share; a value above 1 is in percent."""
    value = mechanism.get("Efficiency", 1.0)
    return value if value <= 1 else value / 100


def _linear_load(section: MotionSection, mechanism: Mapping[str, float]) -> ShaftLoad:
    """Load of a mass along a line, as on a ball screw: linear mechanisms differ only in their way per turn."""
    feed = mechanism.get("FeedConstant") or math.pi * mechanism.get("DiameterPinion", 0.0)
    mass = section.constants.get("LoadMass", 0.0)
    if not feed or not mass:
        resting = not np.any(section.rows[:, 1:])
        if resting:
            feed, mass = feed or 1.0, mass or 1.0
        else:
            raise RefusedError(LACKS, field="FeedConstant" if not feed else "LoadMass")
    incline = math.degrees(mechanism.get("InclinationAngle", 0.0))
    screw = {
        "type": "ball_screw",
        "lead_mm": 1000 * feed,
        "mass_kg": mass,
        "incline_deg": incline,
        "friction_coefficient": section.constants.get("FrictionCoefficient", mechanism.get("FrictionCoefficient", 0.0)),
        "friction_force_N": section.constants.get("FrictionForce", 0.0),
        "counterweight_kg": section.constants.get("CounterMass", 0.0) if incline else 0.0,
        "inertia_kgm2": mechanism.get("InertiaMotorSide", 0.0),
        "friction_torque_Nm": mechanism.get("NoLoadTorque", 0.0),
        "efficiency": _efficiency(mechanism),
    }
    return BallScrew.model_validate(screw).load
