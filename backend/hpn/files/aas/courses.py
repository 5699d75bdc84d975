"""Motion of an application in the form of 02021: sections of a motion pattern, each with its course over time as CSV.

Phases are rotative sections at the gear's output, one for each phase, or one for all where there are very many. A
motion has a section for each move, at the mechanism: rotative, or linear for a mass along a line. All values are in SI
units; a property of the metadata is 1 of its column's unit.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from hpn.application import DutyCycle
from hpn.application.motion import LinearMotion, RotaryMotion
from hpn.physics.equations import FloatArray
from hpn.physics.motion.mechanisms import RPM
from hpn.physics.motion.trace import trace_of

MOST_SECTIONS = 100
"""Most phases or moves with a section each; more share one."""

ROTATIVE = ("Time", "AngularPosition", "AngularVelocity", "AngularAcceleration")
LINEAR = ("Time", "Position", "LinearVelocity", "LinearAcceleration")
LOADS = ("LoadTorque", "RadialForce", "AxialForce")
"""Columns of a course, and columns of the loads that act on it."""


class MotionSection(NamedTuple):
    """Section: `kind` and `metadata` are short ids of the template; `rows` has a row for each instant, in SI units."""

    kind: str
    metadata: str
    constants: Mapping[str, float]
    columns: Sequence[str]
    rows: FloatArray

    def csv(self) -> bytes:
        """Course as CSV, with every digit of each number."""
        lines = [",".join(self.columns), *(",".join(map(repr, row)) for row in self.rows.tolist())]
        return "\r\n".join([*lines, ""]).encode()


def sections_of(cycle: DutyCycle) -> Iterator[MotionSection]:
    """Sections of a duty cycle in their order; the pause is the last one."""
    if cycle.motion is not None:
        yield from _of_motion(cycle.motion)
    else:
        yield from _of_phases(cycle)
    if cycle.pause_s:
        rows = np.array([[0.0, 0.0, 0.0, 0.0], [cycle.pause_s, 0.0, 0.0, 0.0]])
        yield _linear({}, rows) if isinstance(cycle.motion, LinearMotion) else _rotative({}, ROTATIVE, rows)


def _rotative(constants: Mapping[str, float], columns: Sequence[str], rows: FloatArray) -> MotionSection:
    return MotionSection("RotativeSection", "MetadataRotativeMotionFile", constants, columns, rows)


def _linear(constants: Mapping[str, float], rows: FloatArray) -> MotionSection:
    return MotionSection("LinearSection", "MetadataLinearMotionFile", constants, LINEAR, rows)


def _of_phases(cycle: DutyCycle) -> Iterator[MotionSection]:
    """Sections of typed phases; their torques act from outside, so they are the negative of the gear's."""
    phases = cycle.load_phases
    steps = [
        (
            np.array([0.0, phase.duration_s]),
            phase.speed_rpm * RPM,
            _acting(phase.torque_Nm, phase.radial_N, phase.axial_N),
        )
        for phase in phases
    ]
    if len(phases) <= MOST_SECTIONS:
        for time, speed, acting in steps:
            rows = np.column_stack((time, speed * time, np.full(2, speed), np.zeros(2)))
            yield _rotative({name: value for name, value in acting.items() if value is not None}, ROTATIVE, rows)
        return
    ends = np.concatenate(([0.0], np.cumsum([phase.duration_s for phase in phases])))
    angles = np.concatenate(([0.0], np.cumsum([phase.duration_s * phase.speed_rpm * RPM for phase in phases])))
    rows = np.array(
        [
            [ends[place + end], angles[place + end], speed, 0.0, *(acting[name] or 0.0 for name in LOADS)]
            for place, (_, speed, acting) in enumerate(steps)
            for end in (0, 1)
        ]
    )
    yield _rotative({}, (*ROTATIVE, *LOADS), rows)


def _acting(torque_Nm: float, radial_N: float | None, axial_N: float | None) -> dict[str, float | None]:
    return dict(zip(LOADS, (-torque_Nm, radial_N, axial_N), strict=True))


def _of_motion(motion: RotaryMotion | LinearMotion) -> Iterator[MotionSection]:
    load, course = motion.mechanism.load, motion.course
    trace = trace_of(course)
    moves = course.move[trace.phase]
    way = load.way_per_rad / 1000 if isinstance(motion, LinearMotion) else 1.0
    start = 0.0 if isinstance(motion, LinearMotion) else math.radians(motion.start_deg)
    per_gear = way / load.ratio
    columns = np.stack(
        (
            trace.time_s,
            start + trace.angle_rad * per_gear,
            trace.speed_rpm * RPM * per_gear,
            trace.acceleration_rad_per_s2 * per_gear,
        ),
        axis=-1,
    )
    for place, move in enumerate(motion.moves):
        rows = columns[moves == place].reshape(-1, 4)
        rows[:, 0] -= rows[0, 0]
        if isinstance(motion, LinearMotion):
            yield _linear({**_of_mass(motion), "LoadSideForce": -move.external}, rows)
        else:
            acting = _acting(move.external, move.radial_N, move.axial_N)
            forces = {name: value for name, value in acting.items() if value is not None}
            table = {"MomentOfInertiaOfLoad": load.inertia_kgm2, "FrictionTorque": load.friction_Nm}
            yield _rotative(table | forces, ROTATIVE, rows)


def _of_mass(motion: LinearMotion) -> dict[str, float]:
    mechanism = motion.mechanism
    return {
        "FrictionCoefficient": mechanism.friction_coefficient,
        "FrictionForce": mechanism.friction_force_N,
        "LoadMass": mechanism.mass_kg,
        "CounterMass": mechanism.counterweight_kg,
    }
