"""Torques of a motion's load in an emergency stop at any instant: pulling, driving and opposing."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hpn.physics.motion.course import Course
from hpn.physics.motion.mechanisms import RPM, ShaftLoad
from hpn.physics.motion.moves import Move


@dataclass(frozen=True, slots=True)
class StoppedLoad:
    """Load of a motion in a stop, its torques by magnitude in Nm at the mechanism's shaft.

    `external_Nm` is the largest external torque of any move, `driving_Nm` the largest that drives in its own move,
    `accelerating_Nm` the largest J α.
    """

    shaft: ShaftLoad
    external_Nm: float
    driving_Nm: float
    accelerating_Nm: float

    @property
    def pulling_at_gear_Nm(self) -> float:
        """Torque T_d = (W + E) / ratio at the gear."""
        return (self.shaft.weight_Nm + self.external_Nm) / self.shaft.ratio

    @property
    def driving_at_gear_Nm(self) -> float:
        """Torque T_v = (W + E_v) / ratio at the gear."""
        return (self.shaft.weight_Nm + self.driving_Nm) / self.shaft.ratio

    def friction_at_Nm(self, speed_rpm: float) -> float:
        """Friction at the mechanism, at a speed of the gear."""
        return self.shaft.friction_Nm + self.shaft.viscous_Nms * speed_rpm * RPM / self.shaft.ratio

    def opposing_at_gear_Nm(self, speed_rpm: float) -> float:
        """Torque T_o = (W + E + friction + J α) / (η ratio) at the gear, at a speed of the gear."""
        friction = self.friction_at_Nm(speed_rpm)
        opposing = self.shaft.weight_Nm + self.external_Nm + friction + self.accelerating_Nm
        return opposing / (self.shaft.efficiency * self.shaft.ratio)


def stopped_load(moves: Sequence[Move], course: Course) -> StoppedLoad:
    """Load of moves along their course; the largest acceleration is at an end of a piece."""
    load, pieces = course.load, course.pieces
    externals = [load.external_Nm * move.external for move in moves]
    driving = [-torque if move.way > 0 else torque for move, torque in zip(moves, externals, strict=True) if move.way]
    ends = np.abs([pieces.acceleration_at(t) for t in (pieces.start_s, pieces.end_s)]) * (pieces.sign != 0)
    return StoppedLoad(
        shaft=load,
        external_Nm=max(map(abs, externals)),
        driving_Nm=max((*driving, 0.0)),
        accelerating_Nm=load.inertia_kgm2 * float(ends.max()),
    )
